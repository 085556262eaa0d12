// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "Haptos_ContactSolver.hpp"

namespace Haptos {

/// \brief Subspace Newton with continuation in the friction coefficients, all pairs kept between the levels.
///
/// Levels: where the axes differ by more than 10 the small coefficient is raised and lowered again step by step; then
/// 1.5 times the coefficients; then the true ones.  A stall drops all pairs and comes back through more levels.
/// `gaveUp` tells that four restarts did not help: another method may go on from `solution`.
class SubspaceNewtonSolver final : public ContactSolver {
 public:
  explicit SubspaceNewtonSolver(SolverContext context);
  ~SubspaceNewtonSolver() override;

  std::string name() const override { return "Subspace Newton"; }
  bool solve(const SolveRequest& request) override;
  const DualSolution& solution() const override;
  const std::string& reason() const override;
  int outerIterations() const override;
  const std::vector<HistoryEntry>& history() const override;

  /// \brief Goes on from another method's multipliers and jumps, without continuation.  Collective.
  void startFrom(const DualSolution& solution);

  bool gaveUp() const;
  double subspaceMemoryMb() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace Haptos
