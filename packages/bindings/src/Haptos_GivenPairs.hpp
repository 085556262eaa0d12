// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_ContactSystem.hpp"
#include "haptos.h"

namespace Haptos {

/// \brief Looks at the primary nodes of pairs that are added together.
/// \throws InputError where their starts fall, do not begin with 0 or leave a pair without a node
void requirePrimaryNodes(const haptos_pairs& given);

/// \brief Pair i of them, after `requirePrimaryNodes`.
PairInput pairOf(const haptos_pairs& given, int i);

}  // namespace Haptos
