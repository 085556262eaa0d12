// SPDX-License-Identifier: BSD-3-Clause
#include "DenseReference.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace Haptos::Scenes {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

double ratio(double a, double b) { return a == 0 ? 0 : a / b; }

double largestNode(const VectorXd& v) {
  double largest = 0;
  for (Index i = 0; i < v.size(); i += 3) largest = std::max(largest, v.segment<3>(i).norm());
  return largest;
}

}  // namespace

DenseReference::DenseReference(ReferenceProblem problem)
    : problem_(std::move(problem)),
      bodies_(problem_.mesh, problem_.materials, problem_.materialOfBlock, problem_.formulation, problem_.held) {
  condense();
}

void DenseReference::condense() {
  const Index m = Index(problem_.pairs.size());
  std::vector<Eigen::Triplet<double>> triplets;
  d_ = VectorXd::Zero(3 * m);
  for (Index i = 0; i < m; ++i) {
    const ReferencePair& pair = problem_.pairs[i];
    laws_.push_back(pair.law);
    const Eigen::Vector3d axes[3] = {pair.n, pair.t1, pair.t2};
    for (int a = 0; a < 3; ++a) {
      double felt = 0;
      for (int side = 0; side < 2; ++side) {
        const std::int64_t node = side == 0 ? pair.secondary : pair.primary;
        if (node < 0) continue;
        for (int d = 0; d < 3; ++d) {
          const double value = (side == 0 ? 1.0 : -1.0) * axes[a][d];
          const int position = bodies_.position()[3 * node + d];
          d_[3 * i + a] += value * bodies_.held()[3 * node + d];
          if (position < 0 || std::abs(value) < 1e-12) continue;
          triplets.emplace_back(3 * i + a, position, value);
          felt += std::abs(value);
        }
      }
      if (felt == 0 && a == 0) laws_.back().normalPinned = true;
      // A slip that supports prescribe has a force by the law; without one any force would do.
      if (felt == 0 && a > 0 && d_[3 * i + a] == 0) laws_.back().coefficients[a - 1] = 0;
    }
    d_[3 * i] -= pair.gap;
  }
  B_.resize(3 * m, bodies_.numFree());
  B_.setFromTriplets(triplets.begin(), triplets.end());
  f_ = bodies_.reduce(problem_.loads);
  const Eigen::MatrixXd C = B_ * bodies_.solve(Eigen::MatrixXd(B_.transpose()));
  contact_.C = (C + C.transpose()) / 2;
  contact_.H = B_ * bodies_.R();
  contact_.e = bodies_.R().transpose() * f_;
  contact_.s0 = d_ + B_ * bodies_.solveRefined(f_);
}

DenseReference::Laws DenseReference::lawsWith(double factor, double floor) const {
  Laws laws = laws_;
  for (auto& law : laws) {
    const double largest = std::max(law.coefficients[0], law.coefficients[1]);
    for (auto& F : law.coefficients)
      if (F > 0) F = factor * std::max(F, floor * largest);
  }
  return laws;
}

// The tied bodies give the size that displacements should have.
double DenseReference::largestAllowedDisplacement() const {
  const ContactState tied = tiedBodies(contact_);
  const VectorXd u = bodies_.solveRefined(f_ - B_.transpose() * tied.lambda) + bodies_.R() * tied.alpha;
  double largest = std::max(largestNode(bodies_.expand(u)), largestNode(bodies_.expand(bodies_.solveRefined(f_))));
  if (floats())
    for (const auto& pair : problem_.pairs) largest = std::max(largest, std::abs(pair.gap));
  return 1e3 * largest;
}

// Errors of the contact law, as the contract defines kkt, and the states of the pairs.
void DenseReference::measureLaw(ReferenceSolution& r) const {
  for (Index i = 0; i < contact_.numPairs(); ++i) {
    const Eigen::Vector3d l = r.lambda.row(i), s = r.jump.row(i);
    const ReferenceLaw& law = laws_[i];
    const double stiffness = r.uRef > 0 ? r.lRef / r.uRef : 0;
    const Eigen::Vector3d P = projectOnLaw(law, l).point;
    Eigen::Vector3d pushed = l;
    pushed.tail<2>() += stiffness * s.tail<2>();
    r.kkt = std::max(r.kkt, ratio((l - P).norm(), r.lRef));
    r.kkt = std::max(r.kkt, ratio((l - projectOnLaw(law, pushed).point).tail<2>().norm(), r.lRef));
    if (!law.normalPinned) {
      r.kkt = std::max(r.kkt, ratio(std::max(0.0, s[0]), r.uRef));
      r.kkt = std::max(r.kkt, std::min(ratio(std::max(0.0, l[0]), r.lRef), ratio(std::max(0.0, -s[0]), r.uRef)));
    }
    const double g = law.slipForce < 0 ? l[0] : law.slipForce;
    double radius = 0;
    bool holds = false;
    for (int t = 0; t < 2; ++t)
      if (law.coefficients[t] > 0 && g > 0) radius = std::hypot(radius, l[1 + t] / (law.coefficients[t] * g)), holds = true;
    ++r.states[l[0] <= 1e-9 * r.lRef ? 2 : holds && radius < 1 - 1e-6 ? 0 : 1];
  }
}

ReferenceSolution DenseReference::check(const ContactState& state, VectorXd& jump) const {
  ReferenceSolution r;
  const Index m = contact_.numPairs();
  const VectorXd right = f_ - B_.transpose() * state.lambda;
  const VectorXd u = bodies_.solveRefined(right) + bodies_.R() * state.alpha;
  r.u = bodies_.expand(u);
  jump = d_ + B_ * u;
  r.lambda.resize(m, 3);
  r.jump.resize(m, 3);
  for (Index i = 0; i < m; ++i) {
    r.lambda.row(i) = state.lambda.segment<3>(3 * i).transpose();
    r.jump.row(i) = jump.segment<3>(3 * i).transpose();
  }
  VectorXd contactForces = VectorXd::Zero(r.u.size());
  for (Index i = 0; i < m; ++i) {
    const auto& pair = problem_.pairs[i];
    contactForces.segment<3>(3 * pair.secondary) += r.force(pair, i);
    if (pair.primary >= 0) contactForces.segment<3>(3 * pair.primary) -= r.force(pair, i);
  }
  VectorXd reactions = bodies_.forces(r.u) - problem_.loads - contactForces;
  for (Index i = 0; i < reactions.size(); ++i)
    if (bodies_.position()[i] >= 0) reactions[i] = 0;
  const double ext = std::max(problem_.loads.norm(), reactions.norm());
  const double load = std::max(largestNode(problem_.loads), largestNode(reactions));
  r.uRef = largestNode(r.u);
  r.lRef = std::max(m > 0 ? r.lambda.rowwise().norm().maxCoeff() : 0.0, 1e-3 * load);
  r.equilibrium = ratio(bodies_.residual(right, u).norm(), ext);
  r.roundOff = ratio(std::numeric_limits<double>::epsilon() * bodies_.roundOffScale(u), ext);
  measureLaw(r);
  r.kkt = std::max(r.kkt, ratio((contact_.H.transpose() * state.lambda - contact_.e).norm(), ext));
  return r;
}

// Newton at the wanted laws, then again with the jumps that u really has until nothing is left.
ReferenceSolution DenseReference::polish(const std::string& name, ContactState state, int steps) {
  ReferenceSolution best;
  best.kkt = std::numeric_limits<double>::infinity();
  CondensedContact corrected = contact_;
  for (int i = 0; i < 6; ++i) {
    steps += solveBySemismoothNewton(corrected, laws_, 1.0, state).steps;
    VectorXd jump;
    ReferenceSolution now = check(state, jump);
    now.how = name;
    now.newtonSteps = steps;
    if (now.kkt < best.kkt) best = now;
    if (best.kkt <= 1e-13) break;
    corrected.s0 += jump - corrected.jump(state.lambda, state.alpha);
  }
  if (best.uRef > 0 && best.lRef > 0) best.amplification = sensitivity(contact_, laws_, state) * best.uRef / best.lRef;
  best.converged = best.kkt <= 1e-11 && best.equilibrium <= std::max(1e-11, 10 * best.roundOff) &&
                   best.uRef <= largestAllowedDisplacement();
  return best;
}

ReferenceSolution DenseReference::tryPath(const std::string& name, const std::vector<Laws>& path, ContactState state) {
  int steps = 0;
  for (const Laws& laws : path) steps += solveBySemismoothNewton(contact_, laws, 1.0, state).steps;
  return polish(name, state, steps);
}

ReferenceSolution DenseReference::trySuccessiveTresca(ContactState state) {
  VectorXd bound = VectorXd::Zero(contact_.numPairs());
  for (int k = 0; k < 60; ++k) {
    Laws laws = laws_;
    double change = 0;
    for (Index i = 0; i < contact_.numPairs(); ++i) {
      if (laws[i].slipForce >= 0) continue;
      const double g = laws[i].normalPinned ? 0.0 : std::max(0.0, state.lambda[3 * i]);
      change = std::max(change, std::abs(g - bound[i]));
      bound[i] = laws[i].slipForce = g;
    }
    if (k > 0 && change <= 1e-10 * bound.cwiseAbs().maxCoeff()) break;
    if (solveTrescaByAdmm(contact_, laws, 1e-13, 20000, state) > 1e-8) break;  // balance and law do not meet
  }
  return polish("Tresca steps", state, 0);
}

ReferenceSolution DenseReference::solve() {
  const ContactState tied = tiedBodies(contact_);
  if (problem_.pairs.empty()) return polish("linear", tied, 0);
  double smallest = 1;
  for (const auto& law : laws_)
    for (double F : law.coefficients)
      if (F > 0) smallest = std::min(smallest, F / std::max(law.coefficients[0], law.coefficients[1]));
  std::vector<std::pair<std::string, std::vector<Laws>>> paths{
      {"Newton", {}}, {"from larger friction", {}}, {"from smaller friction", {}}};
  if (smallest < 0.1) {
    std::vector<Laws> path;
    for (double floor = 0.25; floor > smallest; floor /= 2) path.push_back(lawsWith(1.0, floor));
    paths.insert(paths.begin() + 1, {"from a rounder ellipse", path});
  }
  for (double factor : {8.0, 4.0, 3.0, 2.0, 1.7, 1.5, 1.35, 1.2, 1.1, 1.05, 1.02})
    paths[paths.size() - 2].second.push_back(lawsWith(factor, 0));
  for (int i = 0; i < 20; ++i) paths.back().second.push_back(lawsWith(i / 20.0, 0));
  for (const auto& [name, path] : paths) {
    const ReferenceSolution solution = tryPath(name, path, tied);
    if (solution.converged) return solution;
  }
  return trySuccessiveTresca(tied);
}

}  // namespace Haptos::Scenes
