// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "Haptos_ContactSolver.hpp"
#include "Haptos_Options.hpp"

namespace Haptos {

/// \brief SubspaceNewtonSolMgr on the operators of a FETI system, stopped by the estimate of kkt.
///
/// `gaveUp` tells that restarts did not help: another method may go on from `solution`.
class SubspaceNewtonSolver final : public ContactSolver {
 public:
  SubspaceNewtonSolver(SolverContext context, const SolverOptions& options);
  ~SubspaceNewtonSolver() override;

  std::string name() const override { return "Subspace Newton"; }
  bool solve(const SolveRequest& request) override;
  /// Pairs are kept, too: they depend on F and G alone.
  void renew() override;
  bool tracksJumps() const override { return true; }
  const DualSolution& solution() const override;
  Outcome outcome() const override;
  int outerIterations() const override;
  const std::vector<HistoryEntry>& history() const override;

  /// \brief Goes on from another method's multipliers and jumps, without continuation.  Collective.
  void startFrom(const DualSolution& solution);

  bool gaveUp() const;
  SubspaceReport subspace() const override;
  DeflationReport deflation() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace Haptos
