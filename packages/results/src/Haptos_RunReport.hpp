// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "Haptos_Accuracy.hpp"
#include "Haptos_ContactResults.hpp"
#include "Haptos_RunClock.hpp"

namespace Haptos {

/// \brief The model that was, or would be, solved.
struct ModelReport {
  int bodies = 0;
  int subdomains = 0;
  int congruenceClasses = 0;
  int explicitSubdomains = 0;   ///< whose F and S are dense matrices
  double explicitMemoryMb = 0;  ///< of those, over all ranks
  long primalUnknowns = 0;   ///< n
  long dualUnknowns = 0;     ///< n_d
  long kernelDimension = 0;  ///< l
  long contactPairs = 0;     ///< m_c
  long pinnedRows = 0;
  std::string discretization, law, localSolver, preconditioner, formulation;
  std::vector<std::string> leftOut;
  std::vector<std::string> notes;
};

struct HistoryEntry {
  long hessianMultiplications;
  double residual;
  long stick, slip, open;
};

struct SolverReport {
  std::string method;
  std::string status;  ///< "converged" or "not converged"
  std::string reason;
  int outerIterations = 0;
  long hessianMultiplications = 0, preconditionerApplications = 0, coarseSolves = 0, localSolves = 0;
  std::vector<HistoryEntry> history;
};

/// \brief Everything that the summary says.
struct RunReport {
  std::string version;
  int ranks = 1;
  ModelReport model;
  SolverReport solver;
  Accuracy accuracy;
  double tolerance = 0;
  std::vector<std::string> interfaceNames;
  std::vector<InterfaceResult> interfaces;
  PhaseTimes times;
  std::vector<double> peakMemoryMb;
};

std::string modelText(const ModelReport& model);    ///< for people, a few lines
std::string modelJson(const RunReport& report);     ///< only `haptos` and `model`
std::string summaryJson(const RunReport& report);

/// \brief Writes a text under a temporary name and renames it, so that no part passes for the whole.
/// \throws std::runtime_error
void writeTextFile(const std::string& path, const std::string& text);

}  // namespace Haptos
