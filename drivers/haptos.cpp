// SPDX-License-Identifier: BSD-3-Clause
// The program: XML in, Exodus and JSON out.
#include <Teuchos_DefaultComm.hpp>
#include <Tpetra_Core.hpp>
#include <cstdio>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include <dlfcn.h>
#ifdef __GLIBC__
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>
#endif

#include "Haptos_CommandLine.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Format.hpp"
#include "Haptos_Parameters.hpp"
#include "Haptos_RunClock.hpp"
#include "Haptos_RunOptions.hpp"
#include "Haptos_Simulation.hpp"

namespace {

using namespace Haptos;

enum ExitStatus { kSolved = 0, kWrongInput = 1, kNotConverged = 2, kNoSolution = 3, kInternalError = 70 };

void printResult(Progress& progress, const SimulationResult& result) {
  const RunReport& report = result.report;
  progress.finish();
  progress.line(report.solver.status + ": kkt " + formatted("%.2e", report.accuracy.errors.kkt()) + " (tolerance " +
                formatted("%.1e", report.tolerance) + ") after " + std::to_string(report.solver.hessianMultiplications) +
                " multiplications by F (" + report.solver.method + ")");
  if (!report.solver.reason.empty()) progress.warn(report.solver.reason);
  for (std::size_t i = 0; i < report.interfaces.size(); ++i) {
    const InterfaceResult& r = report.interfaces[i];
    std::string force;
    for (double component : r.tangentialForce) force += (force.empty() ? "" : ", ") + formatted("%.6g", component);
    progress.line("contact '" + report.interfaceNames[i] + "': normal force " + formatted("%.6g", r.normalForce) + ", tangential force (" +
                  force + "); " + std::to_string(r.stick) + " stick, " + std::to_string(r.slip) + " slip, " + std::to_string(r.open) + " open");
  }
}

void printCosts(Progress& progress, const RunReport& report) {
  char text[128];
  std::string line = "time:";
  for (std::size_t i = 0; i < numPhases; ++i) {
    std::snprintf(text, sizeof text, " %s %.2f", phaseName(Phase(i)), report.times.seconds[i]);
    line += text;
  }
  std::snprintf(text, sizeof text, ", total %.2f s", report.times.total);
  progress.line(line + text);
  line = "peak memory by rank [MB]:";
  for (double mb : report.peakMemoryMb) {
    std::snprintf(text, sizeof text, " %.0f", mb);
    line += text;
  }
  progress.line(line);
}

int runSimulation(const RCP<const Communicator>& comm, const CommandLine& line) {
  const auto parameters = readParameters(*comm, line);
  Progress progress(*comm);
  Simulation simulation(comm, parameters, &progress);
  simulation.prepare();
  if (line.validateOnly) {
    const auto summary = runOptions(parameters).output.summary;
    runOnRoot(*comm, [&] {
      if (!summary.empty()) writeTextFile(summary, modelJson(simulation.report()));
    });
    progress.line("the input is valid; nothing was solved");
    return kSolved;
  }
  SimulationResult result = simulation.solve();
  printResult(progress, result);
  simulation.write(result);
  printCosts(progress, result.report);
  return result.solved ? kSolved : kNotConverged;
}

int runProgram(const RCP<const Communicator>& comm, int argc, char* argv[]) {
  const CommandLine line = parseCommandLine(argc, argv);
  const bool prints = comm->getRank() == 0;
  if (line.help || line.version || line.printParameters) {
    if (prints) std::cout << (line.help ? helpText() : line.version ? versionText() + "\n" : printedParameters());
    return kSolved;
  }
  return runSimulation(comm, line);
}

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
  const auto comm = Tpetra::getDefaultComm();
  const auto report = [&](const char* kind, const std::exception& e) {
    if (comm->getRank() == 0) std::cerr << "haptos: " << kind << e.what() << std::endl;
  };
  try {
    return runProgram(comm, argc, argv);
  } catch (const InputError& e) {  // thrown on all ranks
    report("", e);
    return kWrongInput;
  } catch (const InsufficientModel& e) {  // thrown on all ranks
    report("", e);
    return kNoSolution;
  } catch (const CollectiveError& e) {  // thrown on all ranks
    report("internal error: ", e);
    return kInternalError;
  } catch (const std::exception& e) {  // may have been thrown on one rank alone
    std::cerr << "haptos: internal error on rank " << comm->getRank() << ": " << e.what() << std::endl;
    if (comm->getSize() > 1) MPI_Abort(MPI_COMM_WORLD, kInternalError);
    return kInternalError;
  }
}
