// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <limits>

#include "Haptos_Error.hpp"
#include "Haptos_SmalseSolMgr.hpp"
#include "Haptos_VectorDetails.hpp"

namespace Haptos {
namespace Details {

/// \brief Checked; `list` gets all defaults, and new names for old ones.
SmalseSolMgrOptions readSmalseParameters(Teuchos::ParameterList& list);
Teuchos::ParameterList smalseParameters(const SmalseSolMgrOptions& options);

}  // namespace Details

template <class Scalar, class MV, class OP>
SmalseSolMgr<Scalar, MV, OP>::SmalseSolMgr() : inner_(Teuchos::rcp(new Inner)) {
  setParameters(Teuchos::rcp(new Teuchos::ParameterList));
}

template <class Scalar, class MV, class OP>
RCP<Belos::SolverManager<Scalar, MV, OP>> SmalseSolMgr<Scalar, MV, OP>::clone() const {
  return Teuchos::rcp(new SmalseSolMgr);
}

template <class Scalar, class MV, class OP>
void SmalseSolMgr<Scalar, MV, OP>::setProblem(const RCP<Belos::LinearProblem<Scalar, MV, OP>>& problem) {
  problem_ = Teuchos::rcp_dynamic_cast<Problem>(problem);
  TEUCHOS_TEST_FOR_EXCEPTION(problem_.is_null(), std::invalid_argument,
                             "Haptos SMALSE: the problem must be a Haptos::QuadraticProgram");
  startMultiplier_ = Teuchos::null;
  givenNorm_ = {};
  reset(Belos::Problem);
}

template <class Scalar, class MV, class OP>
void SmalseSolMgr<Scalar, MV, OP>::setParameters(const RCP<Teuchos::ParameterList>& parameters) {
  const RCP<Teuchos::ParameterList> p =
      parameters.is_null() ? Teuchos::rcp(new Teuchos::ParameterList) : parameters;
  options_ = Details::readSmalseParameters(*p);
  parameters_ = p;
}

template <class Scalar, class MV, class OP>
void SmalseSolMgr<Scalar, MV, OP>::setOptions(const SmalseSolMgrOptions& options) {
  setParameters(Teuchos::rcp(new Teuchos::ParameterList(Details::smalseParameters(options))));
}

template <class Scalar, class MV, class OP>
RCP<const Teuchos::ParameterList> SmalseSolMgr<Scalar, MV, OP>::getValidParameters() const {
  return Teuchos::rcp(new Teuchos::ParameterList(Details::smalseParameters({})));
}

template <class Scalar, class MV, class OP>
void SmalseSolMgr<Scalar, MV, OP>::reset(const Belos::ResetType type) {
  if ((type & Belos::Problem) == 0) return;
  iter_ = Teuchos::null;
  history_.clear();
  normApplications_ = 0;
  residual_ = -1;
}

/// First call: norm of A, start vectors.  Later calls: the gradient again, if the caller changed x.
template <class Scalar, class MV, class OP>
void SmalseSolMgr<Scalar, MV, OP>::prepare() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  if (iter_.is_null()) {
    OperatorNorm norm = givenNorm_;
    if (!(norm.value > 0)) {
      norm = estimateOperatorNorm(*problem_, options_.normApplications);
      normApplications_ = norm.applications;
    }
    iter_ = Teuchos::rcp(new Iteration(problem_, inner_, norm, options_));
    for (RCP<MV>* v : {&xStart_, &gStart_, &xLast_}) *v = MVT::Clone(*problem_->getLHS(), 1);
    rho_ = options_.rhoFactor * norm.value;
    iter_->setPenalty(rho_, startMultiplier_);
    M_ = options_.mFactor * rho_;
    iter_->initialize();
    reference_ = Details::norm<Scalar>(*problem_->getRHS());
    if (!(reference_ > 0)) reference_ = norm.value * Details::norm<Scalar>(*iter_->getCurrentUpdate());
    if (!(reference_ > 0)) reference_ = iter_->projectedGradientNorm();
  } else {
    MVT::MvAddMv(1, iter_->solution(), -1, *xLast_, *xStart_);
    if (Details::norm<Scalar>(*xStart_) > 0) iter_->initialize();
  }
  monitorIsValid_ = false;
  setChange_ = update_.is_null() ? 0.0 : 1.0;
  stepsWithoutGain_ = 0;
  bestResidual_ = std::numeric_limits<double>::infinity();
  solveStart_ = counts().hessianApplications;
}

template <class Scalar, class MV, class OP>
Belos::ReturnType SmalseSolMgr<Scalar, MV, OP>::solve() {
  TEUCHOS_TEST_FOR_EXCEPTION(problem_.is_null(), std::invalid_argument, "Haptos SMALSE: call setProblem first");
  prepare();
  outcome_.reset();
  for (int k = 0; k < options_.maximumIterations && !outcome_; ++k) outerStep();
  if (!outcome_) outcome_ = Outcome::IterationLimit;
  Details::copy<Scalar>(iter_->solution(), *xLast_);
  return outcome_ == Outcome::Converged ? Belos::Converged : Belos::Unconverged;
}

template <class Scalar, class MV, class OP>
void SmalseSolMgr<Scalar, MV, OP>::outerStep() {
  Details::copy<Scalar>(iter_->solution(), *xStart_);
  Details::copy<Scalar>(iter_->gradient(), *gStart_);
  setInnerTest();
  iter_->iterate();
  monitorLagrangian();
  double change = 0;
  // the gradient before the multiplier's update is A x - b + mu after it
  residual_ = outerTest_ ? outerTest_(iter_->solution(), iter_->gradient()) : builtInResidual(*iter_);
  const bool solved = inner_->cause() == Inner::Cause::accepted;
  if (!solved && !update_.is_null()) {
    const RCP<MV> x = iter_->getCurrentUpdate();
    Details::copy<Scalar>(*x, *xLast_);
    change = update_->update(*x);
    setChange_ = change;
    if (!outerTest_) residual_ = std::max(residual_, change);
  }
  recordStep(change);
  if (solved || isFinished()) {
    if (change != 0) Details::copy<Scalar>(*xLast_, *iter_->getCurrentUpdate());
    if (!outcome_) outcome_ = Outcome::Converged;
    return;
  }
  iter_->updateMultiplier();
  if (change != 0) iter_->feasibleSetChanged(*xLast_);
}

/// M must fall where the Lagrangian grew by less than rho/2 ||Q (x - x0)||^2 since the step before.
template <class Scalar, class MV, class OP>
void SmalseSolMgr<Scalar, MV, OP>::monitorLagrangian() {
  Belos::MultiVecTraits<Scalar, MV>::MvAddMv(1, iter_->solution(), -1, *xStart_, *xStart_);
  // L(x^k, mu^k) - L(x^{k-1}, mu^k); xStart_ holds x^k - x^{k-1}
  const double grown =
      (Details::dot<Scalar>(*xStart_, *gStart_) + Details::dot<Scalar>(*xStart_, iter_->gradient())) / 2;
  const double cNow = iter_->equalityNorm();
  const double cBefore = history_.empty() ? 0.0 : history_.back().equality * reference_ / rho_;
  // the multiplier's update alone raised L by rho ||Q (x^{k-1} - x0)||^2
  if (monitorIsValid_ && rho_ * cBefore * cBefore + grown < rho_ / 2 * cNow * cNow)
    M_ = std::max(M_ / options_.beta,
                  std::min(M_, options_.mFloor * rho_));
  monitorIsValid_ = true;
}

template <class Scalar, class MV, class OP>
void SmalseSolMgr<Scalar, MV, OP>::setInnerTest() {
  const double eps = std::numeric_limits<double>::epsilon();
  const double roundOff =
      4 * eps * (reference_ + iter_->operatorNorm().value * Details::norm<Scalar>(iter_->solution()));
  inner_->M = M_;
  inner_->eta = options_.etaFactor * reference_;
  // without gain for a while: back to the stopping test with the convergence proof
  const bool proven = stepsWithoutGain_ > options_.stagnationSteps / 3;
  const double start =
      proven ? 0.0 : options_.innerReduction * iter_->projectedGradientNorm();
  inner_->floor = std::max({roundOff, outerTest_ ? 0.0 : 0.02 * options_.tolerance * reference_, std::min(start, inner_->eta)});
  inner_->maxApplications = options_.maximumMultiplications - normApplications_;
  inner_->accept = [this](const Iteration& iter) { return accepts(iter); };
}

template <class Scalar, class MV, class OP>
bool SmalseSolMgr<Scalar, MV, OP>::accepts(const Iteration& iter) const {
  if (outerTest_) return outerTest_(iter.solution(), iter.gradient()) <= options_.tolerance;
  return builtInResidual(iter) <= options_.tolerance && setChange_ <= options_.tolerance;
}

template <class Scalar, class MV, class OP>
double SmalseSolMgr<Scalar, MV, OP>::builtInResidual(const Iteration& iter) const {
  if (!(reference_ > 0)) return 0;
  return std::max<double>(iter.projectedGradientNorm(), rho_ * iter.equalityNorm()) / reference_;
}

template <class Scalar, class MV, class OP>
void SmalseSolMgr<Scalar, MV, OP>::recordStep(double change) {
  SmalseRecord r;
  r.hessianApplications = counts().hessianApplications;
  r.residual = residual_;
  r.setChange = change;
  if (reference_ > 0) {
    r.projectedGradient = iter_->projectedGradientNorm() / reference_;
    r.equality = rho_ * iter_->equalityNorm() / reference_;
  }
  history_.push_back(r);
  if (observer_) observer_(r);
}

template <class Scalar, class MV, class OP>
bool SmalseSolMgr<Scalar, MV, OP>::isFinished() {
  if (residual_ <= options_.tolerance)
    outcome_ = Outcome::Converged;
  else if (inner_->cause() == Inner::Cause::limit)
    outcome_ = Outcome::MultiplicationLimit;
  else if (stagnates())
    outcome_ = Outcome::Stagnated;
  return outcome_.has_value();
}

/// Many outer steps without gain: the residual's round-off is above the tolerance, or the fixed point does not exist.
template <class Scalar, class MV, class OP>
bool SmalseSolMgr<Scalar, MV, OP>::stagnates() {
  if (residual_ < 0.9 * bestResidual_) {
    bestResidual_ = residual_;
    stepsWithoutGain_ = 0;
  }
  return ++stepsWithoutGain_ > options_.stagnationSteps;
}

template <class Scalar, class MV, class OP>
MpgpCounts SmalseSolMgr<Scalar, MV, OP>::counts() const {
  MpgpCounts c = iter_.is_null() ? MpgpCounts{} : iter_->counts();
  c.hessianApplications += normApplications_;
  return c;
}

template <class Scalar, class MV, class OP>
OperatorNorm SmalseSolMgr<Scalar, MV, OP>::operatorNorm() const {
  return iter_.is_null() ? givenNorm_ : iter_->operatorNorm();
}

template <class Scalar, class MV, class OP>
RCP<const MV> SmalseSolMgr<Scalar, MV, OP>::multiplier() const {
  return iter_.is_null() ? RCP<const MV>() : Teuchos::rcpFromRef(iter_->multiplier());
}

template <class Scalar, class MV, class OP>
RCP<const MV> SmalseSolMgr<Scalar, MV, OP>::gradient() const {
  return iter_.is_null() ? RCP<const MV>() : Teuchos::rcpFromRef(iter_->gradient());
}

template <class Scalar, class MV, class OP>
double SmalseSolMgr<Scalar, MV, OP>::projectedGradient() const {
  return iter_.is_null() || !(reference_ > 0) ? 0.0 : iter_->projectedGradientNorm() / reference_;
}

}  // namespace Haptos
