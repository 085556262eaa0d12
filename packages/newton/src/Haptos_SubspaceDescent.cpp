// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SubspaceDescent.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace Haptos {

SubspaceDescent::SubspaceDescent(const Setting& setting, const NewtonState& state, LawLinearization law, double norm)
    : setting_(setting),
      lambda0_(setting.vectors.contact(state.lambda)),
      s0_(setting.vectors.contact(state.s)),
      gluing0_(setting.subspace.projectGluing(setting.vectors.gluing(state.s))),
      reach_(setting.isFloating ? setting.options.farthest * setting.vectors.norm(state.s) : std::numeric_limits<double>::infinity()),
      y_(Eigen::VectorXd::Zero(setting.subspace.size())),
      law_(std::move(law)),
      norm_(norm) {}

// Q^T (s_E + Q R y): gluing rows are known by their parts in Q alone
Eigen::VectorXd SubspaceDescent::gluingAt(const Eigen::VectorXd& y) const {
  return gluing0_.inside + setting_.subspace.R().triangularView<Eigen::Upper>() * y;
}

// || (s_E, phi) ||^2 = || s_E outside of Q ||^2 + || Q^T s_E + R y ||^2 + || phi(lambda_c + V_c y, s_c + S_c y) ||^2
SubspaceDescent::Candidate SubspaceDescent::at(const Eigen::VectorXd& y) const {
  const RecycledSubspace& pairs = setting_.subspace;
  const double gluing2 = gluing0_.outside2() + gluingAt(y).squaredNorm();
  const Eigen::VectorXd s = s0_ + pairs.Sc() * y;
  Candidate candidate{y, linearizeLaw(setting_.pairs, lambda0_ + pairs.Vc() * y, s, setting_.r), 0, 0};
  Eigen::Matrix<double, 2, 1> sums(candidate.law.phi.squaredNorm(), s.squaredNorm());
  setting_.vectors.sum(sums);
  candidate.norm = std::sqrt(std::max(0.0, gluing2) + sums[0]);
  candidate.jumps = std::sqrt(sums[1]);
  return candidate;
}

void SubspaceDescent::moveTo(Candidate&& candidate) {
  y_ = std::move(candidate.y);
  norm_ = candidate.norm;
  law_ = std::move(candidate.law);
}

// What a full step would leave of the residual if the law were linear.
double SubspaceDescent::promise(const SmallSystem& system, const Eigen::VectorXd& dy) const {
  return std::hypot(std::sqrt(gluing0_.outside2()), system.residual(dy)) / norm_;
}

// Along dy as far as it descends, else damped steps: they turn towards the gradient, where the corner of a cone stops dy.
SubspaceDescent::Search SubspaceDescent::search(const SmallSystem& system, const Eigen::VectorXd& dy, bool isFrozen) const {
  const auto& o = setting_.options;
  double fullNorm = 0;
  for (double t = 1; t > o.shortestStep; t /= 2) {
    Candidate candidate = at(y_ + t * dy);
    const bool isNear = isWithinReach(candidate);
    if (t == 1) fullNorm = isNear ? candidate.norm : std::numeric_limits<double>::infinity();
    if (isNear && candidate.norm < (1 - o.armijo * t) * norm_) return {std::move(candidate), fullNorm};
  }
  if (!isFrozen)
    for (double damping : o.dampings) {
      Candidate candidate = at(y_ + system.solve(damping));
      if (isWithinReach(candidate) && candidate.norm < (1 - o.armijo) * norm_) return {std::move(candidate), fullNorm};
    }
  return {std::nullopt, fullNorm};
}

// y := y + t dy, M dy = rhs at y, until the span has no more to give: that is known before a step, from what the linear model
// promises, and after it, from what it left.
void SubspaceDescent::run(bool isFrozen, double bestNorm) {
  const auto& o = setting_.options;
  for (int step = 0; step < o.gaussNewtonSteps; ++step) {
    const SmallSystem system(setting_.subspace, law_, gluingAt(y_), setting_.vectors.comm());
    const Eigen::VectorXd dy = system.solve();
    // The subspace does not carry this linearisation: new directions first.
    if (step > 0 && promise(system, dy) > (isFrozen ? o.forcing : o.worthTrying)) return;
    Search found = search(system, dy, isFrozen);
    if (found.better) {
      const double reduction = found.better->norm / norm_;
      moveTo(std::move(*found.better));
      if (reduction > o.hardlyLess && !isFrozen) return;
      continue;
    }
    // A full step without descent lets the active set move; bounded by the best residual so far.
    if (step > 0 || !std::isfinite(found.fullNorm) || !(isFrozen || found.fullNorm < o.ascent * bestNorm)) return;
    moveTo(at(y_ + dy));
    if (!isFrozen) return;
  }
}

// A state that hardly moves gets the same direction from the same model the next time: then the plan is taken as it is, and the next model
// begins there.
void SubspaceDescent::runFrom(const Eigen::VectorXd& planned, bool isFrozen, double bestNorm) {
  const Candidate plan = at(planned);
  const double before = norm_;
  runFromBoth(plan, isFrozen, bestNorm);
  const bool goesUp = plan.norm > before && plan.norm < setting_.options.ascent * std::min(bestNorm, before);
  if (goesUp && norm_ > setting_.options.stays * before) moveTo(Candidate(plan));
}

// Where bodies float, what a model leaves of a step that goes up often falls below all that can be reached from here: its slip directions
// are the better ones.  Where they do not, that helped nowhere, and took 79 F instead of 65 on an edge under Coulomb's law.  From there the
// reach is that of the model: a body that friction all but lets go slides as far as the model says.
void SubspaceDescent::runFromBoth(const Candidate& plan, bool isFrozen, double bestNorm) {
  const bool descends = plan.norm < norm_;
  if (!std::isfinite(plan.norm) || !(descends || setting_.isFloating)) return run(isFrozen, bestNorm);
  Candidate here{y_, law_, norm_, 0};
  const double reach = std::exchange(reach_, std::max(reach_, setting_.options.farthest * plan.jumps));
  moveTo(Candidate(plan));
  run(isFrozen, bestNorm);
  if (descends) return;
  Candidate there{y_, law_, norm_, 0};
  reach_ = reach;
  moveTo(std::move(here));
  run(isFrozen, bestNorm);
  if (there.norm < norm_) moveTo(std::move(there));
}

}  // namespace Haptos
