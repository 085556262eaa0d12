// SPDX-License-Identifier: BSD-3-Clause
// The program: XML in, Exodus and JSON out.
#include <Tpetra_Core.hpp>
#include <cstdint>
#include <cstdlib>
#include <fstream>

#include <dlfcn.h>
#ifdef __GLIBC__
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>
#endif

#include "Haptos_Program.hpp"
#include "Haptos_RunClock.hpp"

namespace {

// Ranks are the parallelism here; threads would fight for their cores.  The BLAS has read its environment before main,
// and CHOLMOD asks OpenMP for four threads by number, so both are told by their own functions, where they are there.
void useOneThread() {
  if (std::getenv("OPENBLAS_NUM_THREADS") == nullptr)
    if (auto set = reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"))) set(1);
  if (auto set = reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "omp_set_max_active_levels"))) set(0);
}

#ifdef __GLIBC__
// Addresses cost nothing unless the system counts them as memory.
bool countsAddresses() {
  std::ifstream setting("/proc/sys/vm/overcommit_memory");
  return setting.get() == '2';
}

// The heap may grow to most of the memory: that range is asked to lie in huge pages before any page of it is used.
void askForHugePages() {
  if (countsAddresses()) return;
  const std::size_t page = std::size_t(sysconf(_SC_PAGESIZE));
  const auto reserve = std::size_t(0.8 * Haptos::physicalMemoryBytes());
  if (void* range = std::malloc(reserve)) {
    const auto first = (reinterpret_cast<std::uintptr_t>(range) + page - 1) / page * page;
    madvise(reinterpret_cast<void*>(first), (reserve - page) / page * page, MADV_HUGEPAGE);
    std::free(range);
  }
}
#endif

// A run touches all of its memory in every iteration, and vectors come and go: a page should be asked for once, and be large.
void prepareHeap() {
#ifdef __GLIBC__
  mallopt(M_TRIM_THRESHOLD, -1);  // what one phase frees serves the next
  mallopt(M_MMAP_MAX, 0);         // however large it is
  askForHugePages();
#endif
}

}  // namespace

int main(int argc, char* argv[]) {
  useOneThread();
  prepareHeap();
  // Kokkos would answer --help before us.
  char* programAlone[] = {argv[0], nullptr};
  char** arguments = programAlone;
  int count = 1;
  Tpetra::ScopeGuard mpi(&count, &arguments);
  return Haptos::runProgram(Tpetra::getDefaultComm(), argc, argv);
}
