// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <optional>

#include "Haptos_SmalseContactSolver.hpp"
#include "Haptos_SubspaceNewtonSolver.hpp"

namespace Haptos {

/// \brief Subspace Newton; where it gives up, SMALSE settles the states of contact and hands back.
///
/// If Newton gives up a second time, or a coarse matrix of its active rows is singular (parts joined by next to nothing), SMALSE goes
/// on to the end; where round-off stops Newton, nobody does.  Without success
/// the best of what the methods came to is the solution.  `name` tells who did how many multiplications.
class AutomaticSolver final : public ContactSolver {
 public:
  AutomaticSolver(SolverContext context, const SolverOptions& options);

  std::string name() const override;
  bool solve(const SolveRequest& request) override;
  void renew() override;
  bool tracksJumps() const override { return current_->tracksJumps(); }
  const DualSolution& solution() const override { return best_ ? best_->solution : current_->solution(); }
  Outcome outcome() const override { return best_ ? best_->outcome : current_->outcome(); }
  int outerIterations() const override;
  const std::vector<HistoryEntry>& history() const override { return history_; }
  SubspaceReport subspace() const override { return newton_.subspace(); }
  DeflationReport deflation() const override { return newton_.deflation(); }

 private:
  struct Attempt {
    DualSolution solution;
    Outcome outcome;
    double kkt;  // as KktEstimator sees it
    bool isRoundOff;
  };

  bool tryInTurn(const SolveRequest& request);
  bool run(ContactSolver& solver, const SolveRequest& request);
  bool runNewton(const SolveRequest& request);
  void keepIfBest(const ContactSolver& solver);

  SolverContext context_;
  SmalseOptions smalseOptions_;
  long counted_;  // multiplications by F that work_ and those before it know of
  SubspaceNewtonSolver newton_;
  std::unique_ptr<SmalseContactSolver> smalse_;
  ContactSolver* current_;
  bool handedBack_ = false;
  bool newtonFails_ = false;
  std::optional<Attempt> best_;  // of those that failed, until one succeeds
  std::vector<std::pair<std::string, long>> work_;  // who, multiplications
  std::vector<HistoryEntry> history_;
};

}  // namespace Haptos
