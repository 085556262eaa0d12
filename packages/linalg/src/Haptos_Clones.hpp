// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Loops over a few dozen entries: the processor's widest registers pay, and a binary that runs anywhere is wanted.
// A level of the instruction set, not a processor's name: "arch=haswell" is taken on that one processor only.
#if !defined(__GNUC__) || defined(__clang__) || !defined(__x86_64__) || !defined(__linux__)
#define HAPTOS_CLONES
#elif __GNUC__ >= 12
#define HAPTOS_CLONES __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define HAPTOS_CLONES __attribute__((target_clones("avx2", "default")))
#endif
#define HAPTOS_INLINE inline __attribute__((always_inline))  // into every clone
