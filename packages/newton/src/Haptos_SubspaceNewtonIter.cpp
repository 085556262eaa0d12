// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SubspaceNewtonIter.hpp"

#include <Teuchos_Assert.hpp>
#include <cmath>
#include <limits>

#include "Haptos_DenseDecompositions.hpp"

// One step, at (lambda, s) with G lambda = e and s = h - F lambda + G^T a:
//
//   v    := direction for the residual (s_E, phi)       M, the coarse matrix, the law: `NewtonDirection`
//   s_v  := - F v + G^T a,  G_E s_v,E = 0               the only F; (v, s_v) joins the pairs
//   min over y of || (s_E + S_E y, phi(lambda_c + V_c y, s_c + S_c y)) ||     Gauss-Newton: `SubspaceDescent`
//   (lambda, s) := (lambda + V y, s + S y)
//
// Where the residual hardly falls: condensed directions, with one r after the other; where they cannot be had, another r, then directions for one
// frozen linearisation.
namespace Haptos {

SubspaceNewtonIter::SubspaceNewtonIter(const Parts& parts, Eigen::VectorXd r, const SubspaceNewtonOptions::Steps& options)
    : dual_(parts.dual),
      vectors_(parts.vectors),
      balance_(parts.balance),
      directions_(parts.directions),
      subspace_(parts.subspace),
      options_(options),
      baseR_(std::move(r)),
      r_(baseR_) {}

void SubspaceNewtonIter::linearize(const NewtonState& state) {
  law_ = linearizeLaw(*pairs_, vectors_.contact(state.lambda), vectors_.contact(state.s), r_);
  measure(state);
}

// || (s_E, phi) || with law_, which is that of the state already.
void SubspaceNewtonIter::measure(const NewtonState& state) {
  norm_ = std::sqrt(vectors_.sum(vectors_.gluing(state.s).squaredNorm() + law_.phi.squaredNorm()));
}

// Drops old pairs where the subspace is full; the way from the origin to here and the step in the making stay in it.
void SubspaceNewtonIter::makeRoom(const Eigen::VectorXd& dLambda, const Eigen::VectorXd& dS, const NewtonState& state) {
  if (!subspace_.isFull()) return;
  subspace_.dropOldest();
  if (origin_.lambda.size() == state.lambda.size()) subspace_.add(state.lambda - origin_.lambda, state.s - origin_.s);
  subspace_.add(dLambda, dS);
}

// (v, s_v) with s_v = - F v + G^T a, a such that G_E s_v,E = 0: whatever combination y of pairs is added to (lambda, s), G lambda = e
// and s = h - F lambda + G^T a' stay true.  v is made for the linearised residual phi + A dlambda + B ds at the step in the making,
// and kept as it is: orthogonal is only what gluing rows see of it.
void SubspaceNewtonIter::addDirection(const Eigen::VectorXd& dLambda, const Eigen::VectorXd& dS, const NewtonState& state) {
  const Eigen::VectorXd lambda = state.lambda + dLambda, s = state.s + dS;
  const Eigen::VectorXd phi = law_.phi + law_.multiply(vectors_.contact(dLambda), vectors_.contact(dS));
  const Direction direction = directions_.current().compute(*pairs_, law_, {lambda, s, phi});
  hopeless_ = direction.leadsOn ? 0 : hopeless_ + 1;
  Eigen::VectorXd sv = -vectors_.apply(*dual_.F, direction.v);  // the only F of a step
  balance_.removeRigidPart(sv);
  if (direction.isWhole) directions_.current().learn(-vectors_.sum(direction.v.dot(sv)));
  makeRoom(dLambda, dS, state);
  const double length = subspace_.add(direction.v, sv);
  TEUCHOS_TEST_FOR_EXCEPTION(!std::isfinite(length), std::runtime_error,
                             "subspace Newton: the direction is not finite; is a stiffness or load out of range?");
  if (direction.isWhole && length > 0) planStep(length, direction.jumpChange);
}

// The whole step of the last direction, with the motions a of floating bodies that bring the contact jumps nearest to what it is
// for: min || H a + length S_v - jumpChange ||, the pair being scaled to length 1.  H without rows that never carry a force: a model may
// slide along them as far as it likes, by motions that are none of a, and would turn those that are.
void SubspaceNewtonIter::planStep(double length, const Eigen::VectorXd& jumpChange) {
  const Eigen::Index m = subspace_.size(), k = balance_.numFloating();
  step_ = Eigen::VectorXd::Zero(m);
  step_[m - 1] = length;
  if (k == 0) return;
  const Eigen::MatrixXd H = carriedRows(subspace_.Sc().leftCols(k), *pairs_);
  Eigen::MatrixXd sums(k, k + 1);
  sums << H.transpose() * H, H.transpose() * (jumpChange - length * subspace_.Sc().col(m - 1));
  vectors_.sum(sums);
  step_.head(k) = solveLeastSquares(sums.leftCols(k), sums.rightCols(1));
}

// An inexact Newton step: A, B and phi stay, min || (s_E + ds_E, phi + A dlambda + B ds) || over the span of all pairs, and
// directions for what is left, until that is below the target.  What it moves is taken over by `solveInSubspace`, by the law itself.
void SubspaceNewtonIter::linearPass(const NewtonState& state, const NewtonLimits& limits, double target) {
  const Eigen::VectorXd gluing = vectors_.gluing(state.s);
  Eigen::VectorXd dLambda = Eigen::VectorXd::Zero(state.lambda.size()), dS = dLambda;
  double residual = norm_;
  const auto solve = [&] {
    const auto projected = subspace_.projectGluing(gluing);
    const SmallSystem system(subspace_, law_, projected.inside, vectors_.comm());
    const Eigen::VectorXd y = system.solve();
    residual = std::hypot(std::sqrt(projected.outside2()), system.residual(y));
    dLambda.setZero();
    dS.setZero();
    subspace_.addCombination(y, dLambda, dS);
  };
  if (subspace_.size() > 0) solve();
  for (int k = 0; (residual > target || (k == 0 && idle_)) && k < options_.maximumDirections && applications() < limits.maxApplications &&
                  !hasStalled(limits, options_.passPatience);
       ++k) {
    addDirection(dLambda, dS, state);
    solve();
  }
}

// So many F since the residual was last halved; twice the patience within a pass, which should not be cut off.
bool SubspaceNewtonIter::hasStalled(const NewtonLimits& limits, int patience) const {
  return limits.stall > 0 && applications() - halvedAt_ >= long(linear_ ? options_.linearPatience * patience : patience) * limits.stall;
}

// The best of the span, sought from the step that the last direction was made for, if there is one.
void SubspaceNewtonIter::solveInSubspace(NewtonState& state) {
  SubspaceDescent descent({subspace_, vectors_, *pairs_, r_, options_, balance_.numFloating() > 0}, state, std::move(law_), norm_);
  if (step_.size() == subspace_.size()) descent.runFrom(step_, linear_, bestNorm_);
  else descent.run(linear_, bestNorm_);
  step_.resize(0);
  law_ = descent.takeLaw();
  subspace_.addCombination(descent.y(), state.lambda, state.s);
}

// || (s_E, phi) || fell by less than the factor over the window; where the linearisation is frozen it may.
bool SubspaceNewtonIter::isPoor(double factor) const {
  const std::size_t n = window_.size();
  return !linear_ && int(n) > options_.window && window_[n - 1] > factor * window_[n - 1 - std::size_t(options_.window)];
}

// A slow way that is nearly done is shorter than a new one: at its rate, so much a step, few steps are left of this level and those to come.  By what is
// accepted: jumps of the start, which floating bodies make as long as they like, are no measure (decisions/055).
bool SubspaceNewtonIter::isNearlyThere(const NewtonLimits& limits) const {
  const std::size_t n = window_.size(), window = std::size_t(options_.window);
  if (n <= window || !(window_[n - 1] < window_[n - 1 - window])) return false;
  const double perStep = std::log(window_[n - 1 - window] / window_[n - 1]) / options_.window;
  return std::log(measures_.back() * limits.wayAfter) < options_.fewSteps * perStep;
}

// At its rate the whole way would take too many steps, where a better M is likely to make it shorter.  Looked at now and then: what is accepted
// goes up and down.
bool SubspaceNewtonIter::isSlow() const {
  const int n = int(measures_.size()) - 1;
  if (!dual_.mayNeedDeflatedM || !directions_.mayCondense() || n <= 0 || n % options_.slowLook != 0) return false;
  return n * std::log(measures_.front()) > options_.slowSteps * std::log(measures_.front() / measures_.back());
}

// The residual falls, and what is accepted does not feel it: pairs that nearly depend on each other have been added up in large numbers, and round-off has
// taken the balance of forces, or the jumps, off those of the multipliers.
bool SubspaceNewtonIter::isMeasureDeaf() const {
  const std::size_t n = measures_.size(), steps = std::size_t(options_.deafSteps);
  if (n <= renewedAt_ + steps || window_.size() <= steps) return false;
  const double before = measures_[n - 1 - steps];
  return window_.back() < options_.deafFalls * window_[window_.size() - 1 - steps] && std::abs(measures_.back() - before) < options_.deafChange * before;
}

bool SubspaceNewtonIter::hasMorePenalties() const { return penaltyTried_ + 1 < int(options_.penalties.size()); }

void SubspaceNewtonIter::takePenalty(int tried, const NewtonState& state) {
  penaltyTried_ = tried;
  r_ = baseR_ * options_.penalties[std::size_t(tried)];
  linearize(state);
  bestNorm_ = halved_ = std::numeric_limits<double>::infinity();  // phi with another r cannot be compared
}

// The merit function depends on r, the pairs do not: another r often sees a way on.  If none does, inexact Newton steps, unless
// directions are condensed or can be: made for the law itself, they are not bettered by a frozen linearisation (decisions/045).
void SubspaceNewtonIter::leavePlateau(const NewtonState& state) {
  window_.clear();
  if (hasMorePenalties()) return takePenalty(penaltyTried_ + 1, state);
  if (directions_.isCondensed()) {
    takePenalty(0, state);
    isRoundForNothing_ = norm_ > options_.roundLeaves * roundNorm_;
    roundNorm_ = norm_;
    return;
  }
  if (directions_.mayCondense()) return;  // nearly there, or it would be stuck: fewer steps are left than a linearisation takes
  linear_ = true;
  goodSteps_ = 0;
  halvedAt_ = applications();  // an inexact Newton step needs many directions before it pays
}

// Linearisations are frozen until two passes were good; one that moved nothing must add a direction the next time.
void SubspaceNewtonIter::chooseMode(double before) {
  idle_ = linear_ && norm_ > options_.idle * before;
  if (!linear_) return;
  if (norm_ < options_.goodStep * before) ++goodSteps_;
  if (goodSteps_ >= options_.goodSteps) {
    linear_ = false;
    window_.clear();
  }
}

// A level begins with the first r and without memory of how others went; the pairs are there.
void SubspaceNewtonIter::begin(const std::vector<PairLaw>& pairs, const NewtonState& state) {
  pairs_ = &pairs;
  firstApplication_ = dual_.F->applications();
  linear_ = idle_ = false;
  goodSteps_ = hopeless_ = penaltyTried_ = 0;
  isRoundForNothing_ = false;
  roundNorm_ = std::numeric_limits<double>::infinity();
  r_ = baseR_ * options_.penalties[0];
  window_.clear();
  measures_.clear();
  renewedAt_ = 0;
  linearize(state);
  bestNorm_ = halved_ = std::numeric_limits<double>::infinity();
  halvedAt_ = 0;
}

// By the caller's test, or by the residual relative to the jumps of the start.
double SubspaceNewtonIter::measureOf(const NewtonState& state, const NewtonLimits& limits) const {
  const double relative = limits.reference == 0 ? 0.0 : norm_ / limits.reference;  // NaN is no success
  if (limits.measure) return limits.measure(state.lambda, state.s, relative);
  return relative == 0 ? 0 : relative / limits.tolerance;
}

void SubspaceNewtonIter::noteHalving() {
  if (!(norm_ < 0.5 * halved_)) return;
  halved_ = norm_;
  halvedAt_ = applications();
}

// Condensed directions may help where the pairs do not.  Another r sets the count of a stall back, so a round of them has a bound of its own.
bool SubspaceNewtonIter::isStuck(const NewtonLimits& limits) const {
  const double factor = int(measures_.size()) <= options_.firstSteps ? options_.windowFactorAtFirst : options_.windowFactorOfBetter;
  const bool isOnPlateau = directions_.mayCondense() && isPoor(factor) && !isNearlyThere(limits);
  return hasStalled(limits, 1) || isSlow() || (limits.stall > 0 && isRoundForNothing_) || hopeless_ >= options_.hopelessDirections || isOnPlateau;
}

// One step: a direction, or directions for the frozen linearisation, and Gauss-Newton in what there is then.
void SubspaceNewtonIter::advance(NewtonState& state, const NewtonLimits& limits, bool needsDirection) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(state.lambda.size());
  if (linear_) linearPass(state, limits, std::max(options_.forcing * norm_, options_.tightestForcing * limits.tolerance * limits.reference));
  else if (needsDirection) addDirection(zero, zero, state);
  const double before = norm_;
  solveInSubspace(state);
  measure(state);  // the norm in the subspace is a difference
  if (norm_ > std::max(options_.stays * before, options_.roundOff * limits.reference)) dropRigidPart(state);
  chooseMode(before);
}

// Pairs that a poor M made long leave round-off of their way in the jumps.  As far as that is a motion of subdomains no direction takes it off,
// as none sees it (decisions/010).
void SubspaceNewtonIter::dropRigidPart(NewtonState& state) {
  balance_.removeRigidPart(state.s);
  linearize(state);
}

NewtonStop SubspaceNewtonIter::iterate(const std::vector<PairLaw>& pairs, NewtonState& state, const NewtonLimits& limits,
                                       bool needsDirection) {
  begin(pairs, state);
  NewtonState best = state;
  NewtonStop stop = NewtonStop::Limit;
  for (;; ++steps_) {
    window_.push_back(norm_);
    measures_.push_back(measureOf(state, limits));
    const bool done = measures_.back() <= 1;
    if (done || norm_ < bestNorm_) best = state;  // what is given back where it ends without success
    bestNorm_ = std::min(bestNorm_, norm_);
    if (done) stop = NewtonStop::Converged;
    if (done || applications() >= limits.maxApplications) break;
    noteHalving();
    if (limits.isLongWay && limits.isLongWay()) {
      stop = NewtonStop::LongWay;
      break;
    }
    if (isStuck(limits)) {
      stop = directions_.mayCondenseAtAnyPrice() ? NewtonStop::Plateau : NewtonStop::Stalled;
      break;
    }
    if (limits.renew && isMeasureDeaf()) {
      limits.renew();
      linearize(state);
      renewedAt_ = measures_.size();
    }
    if (isPoor(options_.windowFactor)) leavePlateau(state);
    advance(state, limits, needsDirection);
    needsDirection = true;
  }
  state = std::move(best);  // the last state need not be it: r changed, or a step went up
  linearize(state);
  return stop;
}

}  // namespace Haptos
