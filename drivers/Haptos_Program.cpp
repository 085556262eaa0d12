// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Program.hpp"

#include <Teuchos_Comm.hpp>
#include <mpi.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <iostream>
#include <new>

#include "Haptos_CommandLine.hpp"
#include "Haptos_Build.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Format.hpp"
#include "Haptos_Parameters.hpp"
#include "Haptos_RunClock.hpp"
#include "Haptos_RunOptions.hpp"
#include "Haptos_Simulation.hpp"

namespace Haptos {
namespace {

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

// A line, on any number of ranks.
std::string memoryText(const MemoryReport& memory) {
  std::string line = "peak memory by rank [MB]:";
  if (memory.ofRank.size() <= 16 && !memory.ofRank.empty()) {
    for (double mb : memory.ofRank) line += " " + formatted("%.0f", mb);
    return line;
  }
  return line + formatted(" least %.0f,", memory.peak.least) + formatted(" mean %.0f,", memory.peak.mean) + formatted(" most %.0f", memory.peak.most);
}

void printCosts(Progress& progress, const RunReport& report) {
  char text[128];
  std::string line = "time:";
  for (std::size_t i = 0; i < numPhases; ++i) {
    std::snprintf(text, sizeof text, " %s %.2f", phaseName(Phase(i)), report.times.of(Phase(i)));
    line += text;
  }
  std::snprintf(text, sizeof text, ", total %.2f s", report.times.total.most);
  progress.line(line + text);
  progress.line(memoryText(report.memory));
}

int runSimulation(const RCP<const Communicator>& comm, const CommandLine& line) {
  const auto parameters = readParameters(*comm, line);
  Progress progress(*comm);
  Simulation simulation(comm, parameters, &progress);
  simulation.setBuild(buildText());
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

int runCommand(const RCP<const Communicator>& comm, int argc, char* argv[]) {
  const CommandLine line = parseCommandLine(argc, argv);
  const bool prints = comm->getRank() == 0;
  if (line.help || line.version || line.printParameters) {
    if (prints) std::cout << (line.help ? helpText() : line.version ? versionText() + "\n" : printedParameters());
    return kSolved;
  }
  return runSimulation(comm, line);
}

/// A message repeats what was given, which may be as long as it likes and have any signs in it; the message is one line.
std::string shortened(std::string message) {
  constexpr std::size_t most = 1000;
  std::replace_if(message.begin(), message.end(), [](unsigned char sign) { return std::iscntrl(sign) != 0; }, ' ');
  return message.size() <= most ? message : message.substr(0, most / 2) + " [...] " + message.substr(message.size() - most / 2);
}

}  // namespace

int runProgram(const RCP<const Communicator>& comm, int argc, char* argv[]) {
  const auto report = [&](const char* kind, const std::exception& e) {
    if (comm->getRank() == 0) std::cerr << "haptos: " << kind << shortened(e.what()) << std::endl;
  };
  try {
    return runCommand(comm, argc, argv);
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
    const bool isMemory = dynamic_cast<const std::bad_alloc*>(&e) != nullptr;
    std::cerr << "haptos: " << (isMemory ? "out of memory on rank " : "internal error on rank ") << comm->getRank() << ": "
              << shortened(e.what()) << (isMemory ? "; use more or larger machines, or a coarser mesh" : "") << std::endl;
    if (comm->getSize() > 1) MPI_Abort(MPI_COMM_WORLD, kInternalError);
    return kInternalError;
  }
}

}  // namespace Haptos
