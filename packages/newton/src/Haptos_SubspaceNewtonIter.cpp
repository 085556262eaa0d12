// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SubspaceNewtonIter.hpp"

#include <Eigen/Dense>
#include <Teuchos_Assert.hpp>
#include <cmath>
#include <limits>
#include <optional>

#include "Haptos_StackedQr.hpp"

namespace Haptos {
namespace {

constexpr int kGaussNewtonSteps = 8;   // in the subspace, between two directions
constexpr int kWindow = 3;             // steps over which the residual must fall by kWindowFactor
constexpr double kWindowFactor = 0.6;
constexpr double kForcing = 0.2;       // linear residual of an inexact Newton step, relative
constexpr double kWorthTrying = 0.9999; // the same of a further Gauss-Newton step: beyond, all of its trials would fail
constexpr int kMaxLinear = 40;         // directions for one linearisation
constexpr double kArmijo = 1e-4;        // descent asked of a step, relative to its length
constexpr double kShortestStep = 1.0 / 40;
constexpr double kHardlyLess = 0.98;    // a step that leaves so much is the last one
constexpr double kRankTolerance = 1e-12;
constexpr double kUnfelt = 1e-13;      // column of the small system
constexpr double kPenalties[] = {1.0, 0.3, 0.1};  // r relative to the nodal stiffness, in the order of trial

}  // namespace

// min || M y - rhs ||: gluing rows in factored form, contact rows compressed by QR on every rank.
struct SubspaceNewtonIter::SmallSystem {
  Eigen::MatrixXd M;       // columns scaled to length 1
  Eigen::VectorXd rhs, scale;

  Eigen::VectorXd solve(double damping = 0) const {
    const Eigen::Index m = M.cols();
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> qr;
    qr.setThreshold(kRankTolerance);
    if (damping == 0) return qr.compute(M).solve(rhs).cwiseQuotient(scale);
    Eigen::MatrixXd damped(M.rows() + m, m);
    damped << M, std::sqrt(damping) * Eigen::MatrixXd::Identity(m, m);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(damped.rows());
    b.head(M.rows()) = rhs;
    return qr.compute(damped).solve(b).cwiseQuotient(scale);
  }
  double residual(const Eigen::VectorXd& y) const { return (M * y.cwiseProduct(scale) - rhs).norm(); }
};

struct SubspaceNewtonIter::Trial {
  LawLinearization law;
  double norm;
};

SubspaceNewtonIter::SubspaceNewtonIter(const ContactOperators& dual, const DualVectors& vectors, const GluingBalance& balance,
                                       NewtonDirection& direction, RecycledSubspace& subspace, Eigen::VectorXd r)
    : dual_(dual), vectors_(vectors), balance_(balance), direction_(direction), subspace_(subspace), baseR_(std::move(r)), r_(baseR_) {}

SubspaceNewtonIter::Trial SubspaceNewtonIter::evaluate(const Eigen::VectorXd& lambda, const Eigen::VectorXd& s, double gluing2) const {
  Trial trial{linearizeLaw(*pairs_, lambda, s, r_), 0};
  trial.norm = std::sqrt(std::max(0.0, gluing2) + vectors_.sum(trial.law.phi.squaredNorm()));
  return trial;
}

void SubspaceNewtonIter::linearize(const NewtonState& state) {
  law_ = linearizeLaw(*pairs_, vectors_.contact(state.lambda), vectors_.contact(state.s), r_);
  measure(state);
}

// law_ is that of the state already
void SubspaceNewtonIter::measure(const NewtonState& state) {
  norm_ = std::sqrt(vectors_.sum(vectors_.gluing(state.s).squaredNorm() + law_.phi.squaredNorm()));
}

SubspaceNewtonIter::SmallSystem SubspaceNewtonIter::smallSystem(const LawLinearization& law, const Eigen::VectorXd& gluing) const {
  const Eigen::Index m = subspace_.size();
  Eigen::MatrixXd J(law.phi.size(), m + 1);
  J << law.multiply(subspace_.Vc(), subspace_.Sc()), -law.phi;
  J = stackedQr(vectors_.comm(), J);
  SmallSystem system{Eigen::MatrixXd(2 * m + 1, m), Eigen::VectorXd(2 * m + 1), {}};
  system.M << Eigen::MatrixXd(subspace_.R().triangularView<Eigen::Upper>()), J.leftCols(m);
  system.rhs << -gluing, J.rightCols(1);
  system.scale = system.M.colwise().norm().transpose();
  for (Eigen::Index j = 0; j < m; ++j) {  // jumps have length 1: a motion that the law of the day does not feel is left alone
    if (system.scale[j] > kUnfelt) continue;
    system.scale[j] = 1;
    system.M.col(j).setZero();
  }
  for (Eigen::Index j = 0; j < m; ++j) system.M.col(j) /= system.scale[j];
  return system;
}

// Drops old pairs where the subspace is full; the way from the origin to here and the step in the making stay in it.
void SubspaceNewtonIter::makeRoom(const Eigen::VectorXd& dLambda, const Eigen::VectorXd& dS, const NewtonState& state) {
  if (!subspace_.isFull()) return;
  subspace_.dropOldest();
  if (origin_.lambda.size() == state.lambda.size()) subspace_.add(state.lambda - origin_.lambda, state.s - origin_.s);
  subspace_.add(dLambda, dS);
}

void SubspaceNewtonIter::addDirection(const Eigen::VectorXd& dLambda, const Eigen::VectorXd& dS, const NewtonState& state) {
  const Eigen::VectorXd lambda = state.lambda + dLambda, s = state.s + dS;
  const Eigen::VectorXd phi = law_.phi + law_.multiply(vectors_.contact(dLambda), vectors_.contact(dS));
  const bool nonlinear = direction_.hasModel() && !linear_;
  Eigen::VectorXd v, sigma;
  if (nonlinear) {
    CondensedNewton::Step step = direction_.computeNonlinear(*pairs_, law_, {lambda, s, phi});
    v = std::move(step.z);
    sigma = std::move(step.sigma);
  } else {
    v = direction_.compute(*pairs_, law_, {lambda, s, phi});
  }
  Eigen::VectorXd sv = -vectors_.apply(*dual_.F, v);
  balance_.removeRigidPart(sv);
  makeRoom(dLambda, dS, state);
  const double length = subspace_.add(v, sv);
  TEUCHOS_TEST_FOR_EXCEPTION(!std::isfinite(length), std::runtime_error,
                             "subspace Newton: the direction is not finite; is a stiffness or load out of range?");
  if (nonlinear && length > 0) planStep(length, sigma);
}

// The whole step of the last direction, with the motions of floating bodies that bring the contact jumps nearest to -sigma.
void SubspaceNewtonIter::planStep(double length, const Eigen::VectorXd& sigma) {
  const Eigen::Index m = subspace_.size(), k = balance_.numFloating();
  step_ = Eigen::VectorXd::Zero(m);
  step_[m - 1] = length;
  if (k == 0) return;
  const auto H = subspace_.Sc().leftCols(k);
  Eigen::MatrixXd sums(k, k + 1);
  sums << H.transpose() * H, -(H.transpose() * (sigma + length * subspace_.Sc().col(m - 1)));
  vectors_.sum(sums);
  step_.head(k) = Eigen::MatrixXd(sums.leftCols(k)).completeOrthogonalDecomposition().solve(sums.rightCols(1));
}

// Directions for the frozen linearisation until its residual is below the target.
void SubspaceNewtonIter::linearPass(const NewtonState& state, const NewtonLimits& limits, double target) {
  const Eigen::VectorXd gluing = vectors_.gluing(state.s);
  Eigen::VectorXd dLambda = Eigen::VectorXd::Zero(state.lambda.size()), dS = dLambda;
  double residual = norm_;
  const auto solve = [&] {
    const auto projected = subspace_.projectGluing(gluing);
    const SmallSystem system = smallSystem(law_, projected.inside);
    const Eigen::VectorXd y = system.solve();
    residual = std::hypot(std::sqrt(projected.outside2()), system.residual(y));
    dLambda.setZero();
    dS.setZero();
    subspace_.addCombination(y, dLambda, dS);
  };
  if (subspace_.size() > 0) solve();
  for (int k = 0; (residual > target || (k == 0 && idle_)) && k < kMaxLinear && applications() < limits.maxApplications &&
                  !hasStalled(limits, 2);
       ++k) {
    addDirection(dLambda, dS, state);
    solve();
  }
}

bool SubspaceNewtonIter::hasStalled(const NewtonLimits& limits, int patience) const {
  constexpr int kLinearPatience = 3;
  return limits.stall > 0 && applications() - halvedAt_ >= long(linear_ ? kLinearPatience * patience : patience) * limits.stall;
}

// Where Gauss-Newton in the subspace stands: coefficients y of the pairs; the law there is the iteration's.
struct SubspaceNewtonIter::Descent {
  struct Candidate {
    Eigen::VectorXd y;
    Trial trial;
  };
  struct Search {
    std::optional<Candidate> better;
    double fullNorm;  // of the full step
  };

  SubspaceNewtonIter& iter;
  const Eigen::VectorXd lambda0, s0;  // contact values at y = 0
  const RecycledSubspace::Projected gluing0;
  Eigen::VectorXd y;
  double norm;

  Descent(SubspaceNewtonIter& i, const NewtonState& state)
      : iter(i),
        lambda0(i.vectors_.contact(state.lambda)),
        s0(i.vectors_.contact(state.s)),
        gluing0(i.subspace_.projectGluing(i.vectors_.gluing(state.s))),
        y(Eigen::VectorXd::Zero(i.subspace_.size())),
        norm(i.norm_) {}

  Eigen::VectorXd gluingAt(const Eigen::VectorXd& point) const {
    return gluing0.inside + iter.subspace_.R().triangularView<Eigen::Upper>() * point;
  }
  Candidate at(const Eigen::VectorXd& point) const {
    const double gluing2 = gluing0.outside2() + gluingAt(point).squaredNorm();
    return {point, iter.evaluate(lambda0 + iter.subspace_.Vc() * point, s0 + iter.subspace_.Sc() * point, gluing2)};
  }
  void moveTo(Candidate&& candidate) {
    y = std::move(candidate.y);
    norm = candidate.trial.norm;
    iter.law_ = std::move(candidate.trial.law);
  }
  // What a full step would leave of the residual if the law were linear.
  double promise(const SmallSystem& system, const Eigen::VectorXd& dy) const {
    return std::hypot(std::sqrt(gluing0.outside2()), system.residual(dy)) / norm;
  }
  Search search(const SmallSystem& system, const Eigen::VectorXd& dy) const;
};

// Along dy as far as it descends, else damped steps.
SubspaceNewtonIter::Descent::Search SubspaceNewtonIter::Descent::search(const SmallSystem& system, const Eigen::VectorXd& dy) const {
  double fullNorm = 0;
  for (double t = 1; t > kShortestStep; t /= 2) {
    Candidate candidate = at(y + t * dy);
    if (t == 1) fullNorm = candidate.trial.norm;
    if (candidate.trial.norm < (1 - kArmijo * t) * norm) return {std::move(candidate), fullNorm};
  }
  if (!iter.linear_)
    for (double mu : {1e-3, 1e-2, 1e-1, 1.0}) {
      Candidate candidate = at(y + system.solve(mu));
      if (candidate.trial.norm < (1 - kArmijo) * norm) return {std::move(candidate), fullNorm};
    }
  return {std::nullopt, fullNorm};
}

// Gauss-Newton inside the subspace.
void SubspaceNewtonIter::solveInSubspace(NewtonState& state) {
  Descent descent(*this, state);
  if (step_.size() == descent.y.size()) {
    Descent::Candidate planned = descent.at(step_);
    if (planned.trial.norm < descent.norm) descent.moveTo(std::move(planned));
    step_.resize(0);
  }
  for (int step = 0; step < kGaussNewtonSteps; ++step) {
    const SmallSystem system = smallSystem(law_, descent.gluingAt(descent.y));
    const Eigen::VectorXd dy = system.solve();
    // The subspace does not carry this linearisation: new directions first.
    if (step > 0 && descent.promise(system, dy) > (linear_ ? kForcing : kWorthTrying)) break;
    Descent::Search found = descent.search(system, dy);
    if (found.better) {
      const double reduction = found.better->trial.norm / descent.norm;
      descent.moveTo(std::move(*found.better));
      if (reduction > kHardlyLess && !linear_) break;
      continue;
    }
    // A full step without descent lets the active set move; bounded by the best residual so far.
    if (step > 0 || !(linear_ || found.fullNorm < 3 * bestNorm_)) break;
    descent.moveTo(descent.at(descent.y + dy));
    if (!linear_) break;
  }
  subspace_.addCombination(descent.y, state.lambda, state.s);
}

bool SubspaceNewtonIter::isPoor() const {
  const std::size_t n = window_.size();
  return !linear_ && int(n) > kWindow && window_[n - 1] > kWindowFactor * window_[n - 1 - kWindow];
}

// A slow way that is nearly done is shorter than a new one.
bool SubspaceNewtonIter::isNearlyThere(const NewtonLimits& limits) const {
  constexpr double kFewSteps = 15;
  const std::size_t n = window_.size();
  if (int(n) <= kWindow || !(window_[n - 1] < window_[n - 1 - kWindow])) return false;
  const double perStep = std::log(window_[n - 1 - kWindow] / window_[n - 1]) / kWindow;
  return std::log(window_[n - 1] / std::max(limits.tolerance * limits.reference, 1e-300)) < kFewSteps * perStep;
}

bool SubspaceNewtonIter::hasMorePenalties() const { return penaltyTried_ + 1 < int(std::size(kPenalties)); }

// The merit function depends on r, the pairs do not: another r often sees a way on.  If none does, inexact Newton steps.
void SubspaceNewtonIter::leavePlateau(const NewtonState& state) {
  window_.clear();
  const bool another = hasMorePenalties();
  ++penaltyTried_;
  if (another) {
    r_ = baseR_ * kPenalties[penaltyTried_];
    linearize(state);
    bestNorm_ = halved_ = std::numeric_limits<double>::infinity();
    return;
  }
  linear_ = true;
  goodSteps_ = 0;
  halvedAt_ = applications();  // an inexact Newton step needs many directions before it pays
}

void SubspaceNewtonIter::chooseMode(double before) {
  idle_ = linear_ && norm_ > 0.9 * before;  // a pass without descent must add a direction: no endless loop without F
  if (!linear_) return;
  if (norm_ < 0.5 * before) ++goodSteps_;
  if (goodSteps_ >= 2) {
    linear_ = false;
    window_.clear();
  }
}

void SubspaceNewtonIter::begin(const std::vector<PairLaw>& pairs, const NewtonState& state) {
  pairs_ = &pairs;
  firstApplication_ = dual_.F->applications();
  linear_ = idle_ = false;
  goodSteps_ = penaltyTried_ = 0;
  r_ = baseR_ * kPenalties[0];
  window_.clear();
  linearize(state);
  bestNorm_ = halved_ = std::numeric_limits<double>::infinity();
  halvedAt_ = 0;
}

bool SubspaceNewtonIter::isAccepted(const NewtonState& state, const NewtonLimits& limits) const {
  const double relative = limits.reference > 0 ? norm_ / limits.reference : 0.0;
  return limits.accept ? limits.accept(state.lambda, state.s, relative) : relative <= limits.tolerance;
}

void SubspaceNewtonIter::noteHalving() {
  if (!(norm_ < 0.5 * halved_)) return;
  halved_ = norm_;
  halvedAt_ = applications();
}

// A model of the direction may help where the pairs do not.
bool SubspaceNewtonIter::isStuck(const NewtonLimits& limits) const {
  return hasStalled(limits, 1) || (isPoor() && direction_.mayHaveModel() && !hasMorePenalties() && !isNearlyThere(limits));
}

// One step: a direction, or directions for the frozen linearisation, and Gauss-Newton in what there is then.
void SubspaceNewtonIter::advance(NewtonState& state, const NewtonLimits& limits, bool needsDirection) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(state.lambda.size());
  if (linear_) linearPass(state, limits, std::max(kForcing * norm_, 0.3 * limits.tolerance * limits.reference));
  else if (needsDirection) addDirection(zero, zero, state);
  const double before = norm_;
  solveInSubspace(state);
  measure(state);  // the norm in the subspace is a difference
  chooseMode(before);
}

NewtonStop SubspaceNewtonIter::iterate(const std::vector<PairLaw>& pairs, NewtonState& state, const NewtonLimits& limits,
                                       bool needsDirection) {
  begin(pairs, state);
  NewtonState best = state;
  NewtonStop stop = NewtonStop::Limit;
  for (;; ++steps_) {
    window_.push_back(norm_);
    const bool done = isAccepted(state, limits);
    if (done || norm_ < bestNorm_) best = state;
    bestNorm_ = std::min(bestNorm_, norm_);
    if (done) stop = NewtonStop::Converged;
    if (done || applications() >= limits.maxApplications) break;
    noteHalving();
    if (isStuck(limits)) {
      stop = direction_.mayHaveModel() ? NewtonStop::Plateau : NewtonStop::Stalled;
      break;
    }
    if (isPoor()) leavePlateau(state);
    advance(state, limits, needsDirection);
    needsDirection = true;
  }
  state = std::move(best);
  linearize(state);
  return stop;
}

}  // namespace Haptos
