// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CondensedContact.hpp"

#include <Teuchos_RCP.hpp>
#include <Tpetra_Operator.hpp>
#include <algorithm>
#include <cmath>
#include <vector>

namespace Haptos {
namespace {

// (I - P') / r
ContactMatrix::Blocks blocksOfA(const LawLinearization& law) {
  ContactMatrix::Blocks A;
  for (std::size_t i = 0; i < law.dP.size(); ++i) A.push_back((Eigen::Matrix3d::Identity() - law.dP[i]) / law.r[Eigen::Index(i)]);
  return A;
}

}  // namespace

CondensedContact::CondensedContact(RCP<const Operator> M, const ContactMatrix& contact, SubspaceNewtonOptions::Condensed options)
    : M_(std::move(M)), contact_(contact), vectors_(contact.vectors()), options_(options), path_(options) {}

// (M s_E)_c of this rank
Eigen::VectorXd CondensedContact::forcesOfGluing(const Eigen::VectorXd& s) const {
  Eigen::VectorXd jumps = s;
  vectors_.setContact(jumps, Eigen::VectorXd::Zero(3 * vectors_.numPairs()));
  return contact_.scaling() * vectors_.contact(vectors_.apply(*M_, jumps));
}

// M (s_E, sigma)
Eigen::VectorXd CondensedContact::response(Eigen::VectorXd s, const Eigen::VectorXd& sigma) const {
  vectors_.setContact(s, sigma);
  return contact_.scaling() * vectors_.apply(*M_, s);
}

// The law at lambda + M_cc sigma, s - sigma; lambda: with m.
struct CondensedContact::Model {
  const ContactMatrix& M;
  const SubspaceNewtonOptions::Condensed& options;
  const std::vector<PairLaw>& pairs;
  const Eigen::VectorXd& r;
  ConePath& path;
  bool& isPathFirst;
  const Eigen::VectorXd& settled;
  Eigen::VectorXd lambda, s;

  struct Point {
    Eigen::VectorXd sigma, Msigma;
    LawLinearization law;
    double norm;
  };
  Point at(const Eigen::VectorXd& sigma, const Eigen::VectorXd& Msigma) const {
    Point point{sigma, Msigma, linearizeLaw(pairs, lambda + Msigma, s - sigma, r), 0};
    point.norm = M.vectors().norm(point.law.phi);
    return point;
  }
  Point at(const Eigen::VectorXd& sigma) const { return at(sigma, M.multiply(sigma)); }

  enum class Patience { Usual, Long };

  // Steps of few rows are cheap beside those of a path: an active set that moves a few pairs a step may come to its end.
  bool mayGoOn(const std::vector<double>& norms, double target, Patience patience) const {
    const int k = int(norms.size()) - 1, before = k - options.newtonSteps;
    if (patience == Patience::Long && (k < options.newtonSteps || (k < options.patientSteps && isOnCourse(norms, target)))) return true;
    if (patience == Patience::Usual && isPathShorter(norms)) return false;
    if (before < 0) return true;
    return k < options.smallSteps && M.wasSmall() && norms[std::size_t(k)] <= options.smallLeaves * norms[std::size_t(before)];
  }

  // At the rate of the last steps, so many more would get there.
  bool isOnCourse(const std::vector<double>& norms, double target) const {
    if (int(norms.size()) <= options.courseSteps) return true;
    const double now = *std::min_element(norms.begin(), norms.end()), before = *std::min_element(norms.begin(), norms.end() - options.courseSteps);
    return now * std::pow(now / before, double(options.patientSteps) / options.courseSteps) <= target;
  }

  // The last steps have left more than `trialLeaves`, and a path is at hand.  Not where a coarse space serves Krylov methods: a path wants two
  // solutions to 1e-6 a step, and there costs more than all steps of Newton's.
  bool isPathShorter(const std::vector<double>& norms) const {
    const std::size_t k = norms.size() - 1, before = std::size_t(options.trialSteps);
    if (k < before || !path.hasStages() || M.hasCoarse()) return false;
    return *std::min_element(norms.end() - options.trialSteps, norms.end()) > options.trialLeaves * norms[k - before];
  }

  // Damped Newton; where nothing descends, the full step lets the active set move, unless a path is at hand.  Returns the best point,
  // the first one if bodies that friction holds went off: where they are far away phi may be small, and is no solution.
  Point newton(Point point, double target, Patience patience = Patience::Usual) const {
    const Point first = point;
    const double farthest = M.hasKernel() ? options.farthest * M.vectors().norm(s - point.sigma) : 0.0;
    Point best = point;
    std::vector<double> norms{point.norm};
    while (point.norm > target && mayGoOn(norms, target, patience)) {
      const Eigen::VectorXd d = M.solve(blocksOfA(point.law), point.law.dP, -point.law.phi, options.linearTolerance), Md = M.multiply(d);
      if (const double length = M.vectors().norm(d); !std::isfinite(length) || length == 0) break;
      const auto along = [&](double t) { return at(point.sigma + t * d, point.Msigma + t * Md); };
      const Point whole = along(1);
      Point next = whole;  // the least residual of all trials, where none descends enough
      for (double t = 1; next.norm >= (1 - options.armijo * t) * point.norm && t > options.leastStep;) {
        t /= 2;
        Point trial = along(t);
        if (trial.norm < next.norm) next = std::move(trial);
      }
      point = next.norm < point.norm ? std::move(next) : whole;
      if (M.hasKernel() && M.vectors().norm(s - point.sigma) > farthest) return first;
      norms.push_back(point.norm);
      if (point.norm < best.norm) best = point;
    }
    return best;
  }

  // By the residual that another r makes of the law, as far as it gets; the norm of what it finds is that of r.
  Point newtonWith(double factor, const Point& from) const {
    const Eigen::VectorXd otherR = factor * r;
    const Model other{M, options, pairs, otherR, path, isPathFirst, settled, lambda, s};
    const Point begin = other.at(from.sigma, from.Msigma), end = other.newton(begin, options.otherReduction * options.reduction * begin.norm, Patience::Long);
    return at(end.sigma, end.Msigma);
  }

  // Steps lead somewhere where no motion is free, and where they are cheap they may be tried.
  Point withOtherPenalties(Point near, const Point& from, double target) const {
    for (double factor : options.otherPenalties) {
      if (near.norm <= target || (M.hasKernel() && !M.wasSmall())) break;
      Point other = newtonWith(factor, from);
      if (other.norm < near.norm) near = std::move(other);
    }
    return near;
  }

  // With the value of |F s_T| alone some paths end half way, with its derivative others.
  Point alongPaths(Point near, double target) const {
    const auto residual = [&](const Eigen::VectorXd& x) { return at(x).norm; };
    for (const auto& [slip, fromStages] : {std::pair(SlipTerm::Value, true), {SlipTerm::Value, false}, {SlipTerm::Derivative, false}}) {
      if (near.norm <= target) break;
      if (fromStages && !path.hasStages()) continue;
      Point far = newton(at(path.follow({pairs, M, lambda, s, slip}, residual, target, fromStages)), target);
      if (far.norm < near.norm) near = std::move(far);
    }
    return near;
  }

  // Models of one run differ little: where other penalties were of no use a path, which came to its end, comes first the next time.
  Point byOtherMeans(Point near, const Point& from, double target) const {
    if (!isPathFirst || !path.hasStages()) near = withOtherPenalties(std::move(near), from, target);
    if (near.norm <= target) return near;
    near = alongPaths(std::move(near), target);
    isPathFirst = near.norm <= target;
    return near;
  }

  // Where nothing moves, or where the last model was solved if that leaves less: models of one run differ little, and what a direction was
  // made for is not yet where the state is.
  Point nearest(const Point& start) const {
    if (M.vectors().sum(double(settled.size())) == 0) return start;
    const Point last = at(s - settled);
    return last.norm < start.norm ? last : start;
  }

  // A start near the solution is worth more than a path from no start: most solves need two or three Newton steps.
  Point solve(double& left) const {
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(s.size());
    const Point start = at(zero, zero);
    const Point from = nearest(start);
    // what is solved already is solved closer: the same direction again would bring nothing
    const double target = options.reduction * (from.norm > options.reduction * start.norm ? start.norm : from.norm);
    Point near = newton(from, target);
    if (near.norm > options.pathFrom * start.norm) near = byOtherMeans(std::move(near), from, target);
    left = start.norm > 0 ? near.norm / start.norm : 0.0;
    return near;
  }
};

// sigma = 0, nothing moves, is where Newton starts.
CondensedContact::Step CondensedContact::solveLaw(const std::vector<PairLaw>& pairs, const Eigen::VectorXd& r,
                                                 const Eigen::VectorXd& lambda, const Eigen::VectorXd& s) {
  const Model model{contact_, options_, pairs, r, path_, isPathFirst_, settled_, vectors_.contact(lambda) + forcesOfGluing(s), vectors_.contact(s)};
  double left = 0;
  const Eigen::VectorXd sigma = model.solve(left).sigma;
  settled_ = model.s - sigma;
  return {response(s, sigma), sigma, left};
}

}  // namespace Haptos
