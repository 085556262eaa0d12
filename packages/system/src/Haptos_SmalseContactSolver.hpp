// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "Haptos_ContactSolver.hpp"
#include "Haptos_Options.hpp"

namespace Haptos {

/// \brief The method of the paper: SMALSE-M with MPGP inside, Coulomb by connected successive approximations.
///
/// Its outer test estimates kkt from lambda and the gradient of the Lagrangian, which is -(B u - c).
class SmalseContactSolver final : public ContactSolver {
 public:
  SmalseContactSolver(SolverContext context, const SmalseOptions& options);
  ~SmalseContactSolver() override;

  std::string name() const override { return "SMALSE"; }
  bool solve(const SolveRequest& request) override;
  void renew() override;
  const DualSolution& solution() const override { return solution_; }
  Outcome outcome() const override;
  int outerIterations() const override;
  const std::vector<HistoryEntry>& history() const override { return history_; }

 private:
  struct Impl;
  void begin(const RCP<const Vector>& start);
  double estimateKkt(const MultiVector& lambda, const MultiVector& gradient);
  void record(double residual);

  SolverContext context_;
  SmalseOptions options_;
  std::unique_ptr<Impl> impl_;
  DualSolution solution_;
  std::vector<HistoryEntry> history_;
};

}  // namespace Haptos
