// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "Haptos_ContactSolver.hpp"
#include "Haptos_RunClock.hpp"
#include "Haptos_SystemModel.hpp"

namespace Haptos {
enum class SmoothingEffort;

/// \brief What one step leaves.
struct StepResult {
  bool solved = false;  ///< kkt <= tolerance
  std::string method;   ///< who solved it
  std::string reason;   ///< why it is not solved; empty if it is
  RCP<Vector> u;        ///< primal map, the copies of a node apart
  DualSolution dual;
  Accuracy accuracy;
  int outerIterations = 0;
  long multiplications = 0;  ///< by F, of this step
  std::vector<HistoryEntry> history;
  SubspaceReport subspace;
  DeflationReport deflation;
};

/// \brief Solves a system step after step, doing again only what has changed.
///
/// A new step goes on from the multipliers of the last one, and Subspace Newton from its pairs.  All Collective.
class StepSolver {
 public:
  struct Observer {
    RunClock* clock = nullptr;                          ///< or none
    std::function<void(const HistoryEntry&)> progress;  ///< called now and then
  };

  StepSolver(SystemModel model, SystemOptions options, Observer observer);
  ~StepSolver();

  /// \brief All that can be checked without a factorisation.
  /// \throws InputError, InsufficientModel on all ranks
  void prepare();
  void check(StepData step);

  /// \brief Checks the step, factors what is not factored, solves and measures.  Not converging is a result.
  StepResult solve(StepData step);

  /// \brief Names and laws of all interfaces, also of new ones whose rows come by `renewRows` next; the same on all ranks.
  void setFriction(std::vector<std::string> names, std::vector<FrictionSpec> friction);
  void setTolerance(double tolerance) { options_.solver.tolerance = tolerance; }
  /// \brief Other pairs or axes on the same subdomains: rows, G, G G^T and surfaces are made again, sparse factors stay.
  void renewRows(RCP<const MultiplierMap> multipliers);
  enum class Rows { Same, Others };
  /// \brief Other values of K: all but the multipliers is made again, and these too where rows are others.
  /// \param multipliers rows with the weights of the new K
  void renewStiffness(std::shared_ptr<const SubdomainStiffness> stiffness, RCP<const MultiplierMap> multipliers, Rows rows);

  const FetiSystem& system() const { return *system_; }
  const LoadScales& loads() const { return loads_; }
  const SystemOptions& options() const { return options_; }
  long factorizations() const;   ///< of subdomain matrices on this rank, since construction
  long multiplications() const;  ///< by F, since construction

 private:
  std::unique_ptr<ContactSolver> makeSolver() const;
  void factor();
  using Drive = std::array<double, 3>;
  Drive measureDrive() const;
  StepResult run();
  Accuracy measure(const DualSolution& solution, RCP<Vector>& u, RCP<Vector>& jumps, SmoothingEffort effort) const;
  bool iterate(StepResult& result);
  std::optional<RunClock::Scope> time(Phase phase) const;

  SystemOptions options_;
  Observer observer_;
  std::unique_ptr<FetiSystem> system_;
  LoadScales loads_;
  Drive drive_{};  // of the last solve
  bool hasMatrices_ = false;  // until they are factored
  std::unique_ptr<ContactSolver> solver_;
  RCP<const Vector> start_;  // multipliers of the last step, for a new solver
  long factoredBefore_ = 0, multipliedBefore_ = 0;  // by systems that are gone
};

}  // namespace Haptos
