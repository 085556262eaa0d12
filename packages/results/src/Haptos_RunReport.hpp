// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "Haptos_Accuracy.hpp"
#include "Haptos_ContactResults.hpp"
#include "Haptos_Machine.hpp"
#include "Haptos_RunClock.hpp"
#include "Haptos_SolverReport.hpp"

namespace Haptos {

/// \brief The model that was, or would be, solved.
struct ModelReport {
  int bodies = 0;
  int subdomains = 0;
  int congruenceClasses = 0;    ///< factors, over all ranks
  int explicitSubdomains = 0;   ///< whose F and S are dense matrices
  double explicitMemoryMb = 0;  ///< of those, over all ranks
  long primalUnknowns = 0;   ///< n
  long dualUnknowns = 0;     ///< n_d
  long kernelDimension = 0;  ///< l
  long contactPairs = 0;     ///< m_c
  long pinnedRows = 0;
  long tiedPairs = 0;        ///< bonded, beside the contact pairs
  std::string discretization, law, localSolver, preconditioner, formulation;
  std::vector<std::string> leftOut;
  std::vector<std::string> notes;
};

struct SolverReport {
  std::string method;
  std::string status;  ///< "converged" or "not converged"
  std::string reason;
  int outerIterations = 0;
  long hessianMultiplications = 0, preconditionerApplications = 0, coarseSolves = 0, localSolves = 0;
  SubspaceReport subspace;
  DeflationReport deflation;
  std::vector<HistoryEntry> history;
};

/// \brief Of the busiest rank, and of all together.
struct WorkOverRanks {
  double most = 0, all = 0;
};

/// \brief The coarse matrices of a run: G G^T and those of the method.  Largest of the ranks; calls are those of rank 0.
struct CoarseReport {
  long unknowns = 0;            ///< of one matrix
  int factors = 0;              ///< ranks that hold one; 1 where all ranks share it
  long setUps = 0, solves = 0;  ///< matrices made, right-hand sides
  long blocks = 0;              ///< 6 x 6, lower triangle, of G G^T
  WorkOverRanks factorEntries;  ///< of the largest factor or share of one
  WorkOverRanks flops;          ///< multiplications in factors; 0 where nothing is condensed or shared
  WorkOverRanks entriesRead;    ///< of factors in all solves
  long between = 0, last = 0;  ///< unknowns that groups of one rank eliminate, the most of any; all ranks, last: 0 where nothing is shared
  double setUpSeconds = 0, solveSeconds = 0;
  long setUpReductions = 0, solveReductions = 0;                          ///< 0 where nothing counts, as below
  long long setUpBytes = 0, setUpMessageBytes = 0, solveBytes = 0;
};

/// \brief Work on subdomains.
struct LocalReport {
  WorkOverRanks elements;
  WorkOverRanks factorEntries, flops;  ///< of K and K_ii, or of dense matrices
  WorkOverRanks bytesRead;             ///< of those, in all solves and applications
};

/// \brief What B and B^T sent, the most part of the messages of an iteration.
struct JumpReport {
  long forwardVectors = 0, transposedVectors = 0;  ///< vectors multiplied by B, by B^T
  CountsOverRanks forward, transposed;
};

/// \brief Everything that the summary says.
struct RunReport {
  std::string version, title;  ///< title: of the input
  std::string build;           ///< commit and flags of the program; may be empty
  int ranks = 1;
  ModelReport model;
  SolverReport solver;
  Accuracy accuracy;
  double tolerance = 0;
  std::vector<std::string> interfaceNames;
  std::vector<InterfaceResult> interfaces;
  std::vector<InitialOverlap> overlaps;  ///< [interfaces]
  PhaseTimes times;
  MemoryReport memory;
  Machine machine;
  LocalReport local;
  CoarseReport coarse;
  JumpReport jump;
  CommunicationReport communication;
};

std::string modelText(const ModelReport& model);    ///< for people, a few lines
std::string modelJson(const RunReport& report);     ///< only `haptos` and `model`
std::string summaryJson(const RunReport& report);

/// \brief Writes a text under a temporary name and renames it, so that no part passes for the whole.
/// \throws std::runtime_error
void writeTextFile(const std::string& path, const std::string& text);

}  // namespace Haptos
