// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SubspaceNewtonRun.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <cmath>
#include <utility>

#include "Haptos_FoundationStart.hpp"

namespace Haptos {

SubspaceNewtonRun::SubspaceNewtonRun(const ContactOperators& dual, const Vector& start, const SubspaceNewtonOptions& options,
                                     const SubspaceNewtonSolMgr::Hooks& hooks)
    : dual_(dual),
      options_(options),
      hooks_(hooks),
      vectors_(dual.F->getDomainMap(), dual.pairs, dual.gluingRows),
      balance_(dual, vectors_),
      directions_(dual, DualVectors::fromVector(*dual.diagonalOfM), vectors_, balance_, options),
      subspace_(vectors_, options.maximumPairs),
      r_((balance_.numFloating() > 0 ? options.floatingPenalty : 1.0) * directions_.pairStiffness()),
      iteration_({dual, vectors_, balance_, directions_, subspace_}, r_, options.steps),
      first_(DualVectors::fromVector(start)) {}

// s = h - F lambda + G^T a without rigid part on gluing rows
Eigen::VectorXd SubspaceNewtonRun::jumpsOf(const Eigen::VectorXd& lambda) const {
  Eigen::VectorXd s = dual_.jumpsOf ? DualVectors::fromVector(*dual_.jumpsOf(*vectors_.toVector(lambda)))
                                    : Eigen::VectorXd(DualVectors::fromVector(*dual_.h) - vectors_.apply(*dual_.F, lambda));
  balance_.removeRigidPart(s);
  return s;
}

// The state that all pairs start from, and the motions of floating bodies, which need no F: pairs (0, G^T Zk V).
void SubspaceNewtonRun::keepOrigin() {
  for (Eigen::Index j = 0; j < balance_.numFloating(); ++j)
    subspace_.add(Eigen::VectorXd::Zero(vectors_.numRows()), balance_.jumps().col(j));
  subspace_.makePermanent();
  iteration_.setOrigin(state_);
}

// Multipliers in balance and their jumps; their length is what residuals of levels are compared with.
void SubspaceNewtonRun::start() {
  subspace_.clear();
  if (isFloating()) {
    startOnFoundation();
  } else {
    state_.lambda = first_;
    liftRest();
    state_.s = jumpsOf(state_.lambda);
  }
  keepOrigin();
  reference_ = vectors_.norm(state_.s);
  isStarted_ = true;
}

// Rigid bodies on springs r at the pairs, H^T P(r H a) = load, give contact forces that carry the loads.  With the deformation s
// that these cause, x = lambda + r s in P(x + r H a) gives the motions a.  The friction is that of the first level: near its
// limit rigid bodies run away at the true one.
void SubspaceNewtonRun::startOnFoundation() {
  const std::vector<PairLaw> easier = scaledCoefficients(dual_.pairs, options_.continuation.firstFactor);
  const auto solve = [&](const Eigen::VectorXd& x) { return solveFoundation(easier, x, r_, balance_, options_.foundation); };
  state_.lambda = Eigen::VectorXd::Zero(vectors_.numRows());
  vectors_.setContact(state_.lambda, solve(Eigen::VectorXd::Zero(3 * vectors_.numPairs())).forces);
  balance_.balance(state_.lambda, dual_.e);  // G lambda = e by the gluing rows
  liftRest();
  state_.s = jumpsOf(state_.lambda);
  const Eigen::VectorXd least = state_.s - balance_.nearestMotion(state_.s);
  if (directions_.isCondensed()) {  // they would not make up for slides on the way through levels, of which they have none
    state_.s = least;
    return;
  }
  Eigen::VectorXd x = vectors_.contact(state_.s);
  for (Eigen::Index i = 0; i < r_.size(); ++i) x.segment<3>(3 * i) *= r_[i];
  x += vectors_.contact(state_.lambda);
  state_.s += balance_.jumps() * solve(x).a;
  const auto length = [&](const Eigen::VectorXd& s) { return vectors_.norm(vectors_.contact(s)); };
  if (length(state_.s) > options_.foundation.farthest * length(least)) state_.s = least;
}

// What is not in balance at the start is shared by all rows: lambda - G^T (G G^T)^-1 (G lambda - e).
void SubspaceNewtonRun::liftRest() {
  constexpr double kBalanced = 1e-12;  // of the loads: round-off
  const Eigen::VectorXd rest = balance_.applyG(state_.lambda) - dual_.e;
  if (rest.norm() > kBalanced * dual_.e.norm()) state_.lambda -= multiply(*dual_.GT, dual_.GGT->solve(rest));
}

// At the true coefficients by the status test, which may measure by other norms; before, by the residual.
double SubspaceNewtonRun::measure(const Eigen::VectorXd& lambda, const Eigen::VectorXd& s, double residual, const Level& level) {
  const auto l = vectors_.toVector(lambda);
  if (level.isFinal && hooks_.statusTest) residual = hooks_.statusTest(*l, *vectors_.toVector(s));
  if (level.isFinal) residual_ = residual;
  noteLeast(residual, level);
  if (hooks_.observer) hooks_.observer({dual_.F->applications(), residual, level.isFinal}, *l);
  return residual == 0 ? 0 : residual / (level.isFinal ? options_.tolerance : level.tolerance);
}

// What a level leaves in parts of the start is no measure where floating bodies start far away: once the answer is measured that counts alone (decisions/055).
void SubspaceNewtonRun::noteLeast(double residual, const Level& level) {
  if (level.isFinal && !std::exchange(isAnswerMeasured_, true)) least_ = 1;
  if (level.isFinal || !isAnswerMeasured_) least_ = std::min(least_, residual);
}

// At the rate of all F so far, whatever the level, the answer is far, and there is an M that was too dear.
bool SubspaceNewtonRun::isLongWay() const {
  const auto& steps = options_.steps;
  const long n = dual_.F->applications() - begunAt_;
  if (directions_.mayCondense() || !directions_.mayCondenseAtAnyPrice() || n < steps.slowLook) return false;
  return double(n) * std::log(options_.tolerance) < steps.longWay * std::log(least_);
}

// One law, from the state as it is.
NewtonStop SubspaceNewtonRun::runLevel(const std::vector<PairLaw>& law, const Level& level, bool pairsFirst) {
  NewtonLimits limits;
  limits.tolerance = level.tolerance;
  limits.wayAfter = std::max(1.0, level.tolerance / options_.tolerance);
  limits.reference = reference_;
  limits.stall = level.patience;
  limits.maxApplications = left();
  limits.measure = [&](const Eigen::VectorXd& lambda, const Eigen::VectorXd& s, double relative) {
    return measure(lambda, s, relative, level);
  };
  limits.isLongWay = [this] { return isLongWay(); };
  limits.renew = [this] {
    liftRest();
    takeJumps(jumpsOf(state_.lambda));
  };
  const NewtonStop stop = iteration_.iterate(law, state_, limits, !pairsFirst);
  return stop == NewtonStop::LongWay && level.isFinal ? NewtonStop::Plateau : stop;
}

SubspaceNewtonRun::LevelsEnd SubspaceNewtonRun::runLevels(const FrictionLevels& levels) {
  LevelsEnd end;
  for (const auto& law : levels.laws) {
    const NewtonStop stop = runLevel(law, {levels.tolerance, levels.patience, false}, end.isFresh && isFloating());
    // At any price only for the answer, or where it is far.
    end.isPlateau = stop == NewtonStop::LongWay || (stop == NewtonStop::Plateau && directions_.mayCondense());
    end.isFresh = false;
    if (end.isPlateau) break;
  }
  return end;
}

void SubspaceNewtonRun::condense(Reason reason) {
  if (!(reason == Reason::Law ? directions_.condenseForLaw() : directions_.condense())) return;
  r_ = directions_.pairStiffness();
  iteration_.setPenalty(r_);
}

void SubspaceNewtonRun::noteBegin() {
  least_ = 1;
  isAnswerMeasured_ = false;
  begunAt_ = dual_.F->applications();
}

// Condensed directions are taken from the start where M is known to be poor or ellipses are long, else on a plateau: from the state
// reached, which is worth more than a fresh start, unless it leads nowhere.
NewtonStop SubspaceNewtonRun::solveFromStart() {
  noteBegin();
  const ContinuationPolicy policy(dual_.pairs, options_.continuation, vectors_.comm());
  if (dual_.needsDeflatedM) condense(Reason::M);
  else if (policy.isElongated()) condense(Reason::Law);
  NewtonStop stop = descend();
  while (stop == NewtonStop::Plateau) {
    stop = leavePlateau(finalLevel(options_.continuation.patience));
    if (stop == NewtonStop::Stalled && left() > 0) stop = descend();
  }
  return stop;
}

// By condensed directions, where they are too dear as before, until there is no other way.
NewtonStop SubspaceNewtonRun::leavePlateau(const Level& level) {
  condense(Reason::M);
  const NewtonStop stop = runLevel(dual_.pairs, level);
  return stop == NewtonStop::Plateau ? leavePlateau(level) : stop;
}

// From the last step's multipliers, brought to today's loads, and with its pairs: these first, as most of what loads change lies
// in their span.  What they cannot do is a case for a fresh start.
// No pairs are there where the last step was solved as it began.
NewtonStop SubspaceNewtonRun::solveRenewed() {
  noteBegin();
  isRenewed_ = isFresh_ = false;
  balance_.balance(state_.lambda, dual_.e);
  liftRest();
  refreshJumps();
  iteration_.setOrigin(state_);
  reference_ = std::max(reference_, vectors_.norm(state_.s));
  const Level level = finalLevel(options_.continuation.patience);
  NewtonStop stop = runLevel(dual_.pairs, level, subspace_.size() > 0);
  if (stop == NewtonStop::Plateau) stop = leavePlateau(level);
  return stop == NewtonStop::Stalled && left() > 0 ? solveFromStart() : stop;
}

// A start and levels of friction; after a stall a new start and finer levels.
NewtonStop SubspaceNewtonRun::descend() {
  const ContinuationPolicy policy(dual_.pairs, options_.continuation, vectors_.comm());
  start();
  LevelsEnd levels = runLevels(policy.first(!directions_.isCondensed()));
  for (int restart = 0;; ++restart) {
    if (levels.isPlateau) return NewtonStop::Plateau;
    const NewtonStop stop = runLevel(dual_.pairs, finalLevel(options_.continuation.patience), levels.isFresh && isFloating());
    if (stop != NewtonStop::Stalled || restart == options_.continuation.maximumRestarts || left() <= 0) return stop;
    start();
    levels = runLevels(policy.detour(restart));
  }
}

// The recursion for s drifts after a blow-up; afterwards the jumps are those of lambda again.  Which motion the floating bodies
// have made is not in lambda: min || s + jumps a - s_before ||.
void SubspaceNewtonRun::refreshJumps() {
  if (!std::exchange(isFresh_, false)) takeJumps(jumpsOf(state_.lambda));
}

void SubspaceNewtonRun::takeJumps(Eigen::VectorXd s) {
  s += balance_.nearestMotion(state_.s - s);
  state_.s = std::move(s);
}

void SubspaceNewtonRun::setJumps(const Vector& given) {
  if (!isStarted_) return;
  Eigen::VectorXd s = DualVectors::fromVector(given);
  balance_.removeRigidPart(s);
  takeJumps(std::move(s));
  isFresh_ = true;
}

bool SubspaceNewtonRun::goOn() {
  isRenewed_ = isStarted_;
  return balance_.isOf(dual_.pairs);
}

// A further call asks for more of the same answer: the jumps anew, no levels, longer patience.
NewtonStop SubspaceNewtonRun::solve() {
  subspace_.setMaximum(options_.maximumPairs);
  if (!isStarted_) return solveFromStart();
  if (isRenewed_) return solveRenewed();
  refreshJumps();
  const Level level = finalLevel(options_.continuation.patienceFactorAtAnswer * options_.continuation.patience);
  const NewtonStop stop = runLevel(dual_.pairs, level);
  return stop == NewtonStop::Plateau ? leavePlateau(level) : stop;
}

// Pairs of before may have been what led astray; the other method's state has its balance by all rows, here gluing rows see to it.
void SubspaceNewtonRun::startFrom(const Vector& lambda, const Vector& s) {
  if (!isStarted_) start();
  subspace_.clear();
  isFresh_ = false;
  state_.lambda = DualVectors::fromVector(lambda);
  balance_.balance(state_.lambda, dual_.e);
  state_.s = DualVectors::fromVector(s);
  keepOrigin();
}

}  // namespace Haptos
