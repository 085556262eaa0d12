// SPDX-License-Identifier: BSD-3-Clause
// The program: XML in, Exodus and JSON out.
#include <Tpetra_Core.hpp>
#include <cstdint>
#include <cstdlib>
#include <cstring>
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

template <class Function>
Function* find(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
}

// Ranks are the parallelism here; threads would fight for their cores.  The BLAS has read its environment before main,
// and CHOLMOD asks OpenMP for four threads by number, so both are told by their own functions, where they are there.
void useOneThread() {
  if (std::getenv("OPENBLAS_NUM_THREADS") == nullptr)
    if (auto set = find<void(int)>("openblas_set_num_threads")) set(1);
  if (auto set = find<void(int)>("omp_set_max_active_levels")) set(0);
}

// Kernels of OpenBLAS that this processor can run, where an older OpenBLAS does not know it and has taken those of a Pentium 4: four
// times slower.  It chose before main; these are the functions that chose.  An OPENBLAS_CORETYPE of the user's is left alone.
void useVectorKernels() {
#if defined(__x86_64__) && defined(__GNUC__)
  const auto core = find<char*()>("openblas_get_corename");
  const auto begin = find<void()>("gotoblas_dynamic_init"), end = find<void()>("gotoblas_dynamic_quit");
  if (!core || !begin || !end || std::strcmp(core(), "Prescott") != 0 || std::getenv("OPENBLAS_CORETYPE") != nullptr) return;
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return;
  const bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
                    __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512cd");
  setenv("OPENBLAS_CORETYPE", wide ? "SkylakeX" : "Haswell", 1);
  end();
  begin();
#endif
}

// A process that no launcher has started would start a daemon of Open MPI and wait for it, a quarter of the seconds of a small run; it is for ranks that
// are spawned later, and we spawn none.  Without a daemon all such processes have the same job number, hence the same session folder: one run would
// remove it while another makes it.  A process by itself needs none; ranks do, for their shared memory.
void startNoDaemon() {
  for (const char* launched : {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID"})
    if (std::getenv(launched) != nullptr) return;
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
}

// Under AddressSanitizer malloc is its own, which writes an eighth of what is asked for: 2.6 GB and 4 s a process.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
#define HAPTOS_HAS_GLIBC_HEAP
#endif

#ifdef HAPTOS_HAS_GLIBC_HEAP
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
#ifdef HAPTOS_HAS_GLIBC_HEAP
  mallopt(M_TRIM_THRESHOLD, -1);  // what one phase frees serves the next
  mallopt(M_MMAP_MAX, 0);         // however large it is
  askForHugePages();
#endif
}

}  // namespace

int main(int argc, char* argv[]) {
  useVectorKernels();
  useOneThread();
  prepareHeap();
  startNoDaemon();
  // Kokkos would answer --help before us.
  char* programAlone[] = {argv[0], nullptr};
  char** arguments = programAlone;
  int count = 1;
  Tpetra::ScopeGuard mpi(&count, &arguments);
  return Haptos::runProgram(Tpetra::getDefaultComm(), argc, argv);
}
