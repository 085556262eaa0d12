// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_AutomaticSolver.hpp"

#include "Haptos_FetiSystem.hpp"
#include "Haptos_KktEstimator.hpp"
#include "Haptos_LocalSolverFactor.hpp"

namespace Haptos {

AutomaticSolver::AutomaticSolver(SolverContext context, const SolverOptions& options)
    : context_(std::move(context)),
      smalseOptions_(options.smalse),
      counted_(context_.system.dual().F->applications()),
      newton_(context_, options),
      current_(&newton_) {}

// Who did how much; one name alone where nobody helped.
std::string AutomaticSolver::name() const {
  if (work_.size() == 1) return work_.front().first;
  std::string text;
  for (const auto& [who, multiplications] : work_)
    text += (text.empty() ? "" : ", ") + who + " (" + std::to_string(multiplications) + ")";
  return text;
}

int AutomaticSolver::outerIterations() const {
  return newton_.outerIterations() + (smalse_ ? smalse_->outerIterations() : 0);
}

// A method's history and multiplications, those of its making included, are added to those of all; who goes on after himself is not
// named twice.
bool AutomaticSolver::run(ContactSolver& solver, const SolveRequest& request) {
  current_ = &solver;
  const std::size_t known = solver.history().size();
  const bool passed = solver.solve(request);
  history_.insert(history_.end(), solver.history().begin() + std::ptrdiff_t(known), solver.history().end());
  const long now = context_.system.dual().F->applications(), spent = now - counted_;
  counted_ = now;
  if (!work_.empty() && work_.back().first == solver.name()) work_.back().second += spent;
  else work_.emplace_back(solver.name(), spent);
  return passed;
}

bool AutomaticSolver::runNewton(const SolveRequest& request) try {
  return run(newton_, request);
} catch (const UselessFactor&) {  // on all ranks
  newtonFails_ = true;
  return false;
}

// By the same estimate for all methods, without a tolerance: what round-off hides counts as what it is.
void AutomaticSolver::keepIfBest(const ContactSolver& solver) {
  const DualSolution& solution = solver.solution();
  KktEstimator estimator(context_.system, context_.loads, KktEstimator::Balance::Sought);
  estimator.estimate(*solution.lambda, *solution.s, 0.0);
  if (!best_ || estimator.kkt() < best_->kkt) best_ = Attempt{solution, solver.outcome(), estimator.kkt(), estimator.isRoundOff()};
}

// Newton; SMALSE until the states of contact are settled; Newton from there; SMALSE to the end.  A further call goes on with
// whoever came last.
bool AutomaticSolver::tryInTurn(const SolveRequest& request) {
  constexpr double kStatesSettled = 1e-3;
  const auto needsHelp = [&] {
    if (newtonFails_) return true;
    keepIfBest(newton_);
    return newton_.gaveUp() && !best_->isRoundOff;
  };
  if (current_ == &newton_) {
    if (runNewton(request)) return true;
    if (!needsHelp()) return false;
  }
  SolveRequest others = request;
  others.jumps = Teuchos::null;  // they were of the last solution
  if (!smalse_) {
    SolverContext fromHere = context_;
    if (!newtonFails_) fromHere.start = newton_.solution().lambda;
    smalse_ = std::make_unique<SmalseContactSolver>(fromHere, smalseOptions_);
  }
  if (!handedBack_ && !newtonFails_) {
    handedBack_ = true;
    SolveRequest states = others;
    states.tolerance = std::max(kStatesSettled, request.tolerance);
    if (!run(*smalse_, states)) return false;
    newton_.startFrom(smalse_->solution());
    if (runNewton(others)) return true;
    if (!needsHelp()) return false;
  }
  return run(*smalse_, others);
}

// Newton goes on from whatever the last step came to.
void AutomaticSolver::renew() {
  const bool isOthers = best_ || current_ != &newton_;
  const DualSolution last = solution();
  best_.reset();
  smalse_.reset();
  handedBack_ = newtonFails_ = false;
  current_ = &newton_;
  history_.clear();
  work_.clear();
  counted_ = context_.system.dual().F->applications();
  newton_.renew();
  if (isOthers) newton_.startFrom(last);
}

bool AutomaticSolver::solve(const SolveRequest& request) {
  const bool passed = tryInTurn(request);
  if (passed) best_.reset();
  else if (current_ != &newton_) keepIfBest(*current_);
  return passed;
}

}  // namespace Haptos
