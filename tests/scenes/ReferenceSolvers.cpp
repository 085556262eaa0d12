// SPDX-License-Identifier: BSD-3-Clause
#include "ReferenceSolvers.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "DenseAlgebra.hpp"

namespace Haptos::Scenes {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double largestCompliance(const CondensedContact& contact) {
  return contact.numPairs() > 0 ? std::max(contact.C.diagonal().maxCoeff(), 1e-300) : 1.0;
}

// Newton's system at a state: unknowns lambda / scale and alpha, all rows are lengths.
class NewtonSystem {
 public:
  NewtonSystem(const CondensedContact& contact, const std::vector<ReferenceLaw>& laws, double stepLength)
      : contact_(contact), laws_(laws), r_(contact.numPairs()) {
    const double largest = largestCompliance(contact);
    for (Index i = 0; i < contact.numPairs(); ++i) {
      const double own = std::max(contact.C(3 * i, 3 * i), 1e-6 * largest);
      r_[i] = stepLength / own;
    }
    scale_ = 1 / largest;
  }

  VectorXd residual(const ContactState& x) const {
    const VectorXd s = contact_.jump(x.lambda, x.alpha);
    VectorXd f(s.size() + contact_.e.size());
    for (Index i = 0; i < contact_.numPairs(); ++i) {
      const Eigen::Vector3d l = x.lambda.segment<3>(3 * i);
      f.segment<3>(3 * i) = (l - projectOnLaw(laws_[i], l + r_[i] * s.segment<3>(3 * i)).point) / r_[i];
    }
    f.tail(contact_.e.size()) = (contact_.H.transpose() * x.lambda - contact_.e) / scale_;
    return f;
  }

  // Derivative of the residual by (lambda / scale, alpha); `dJump`: by s0.
  MatrixXd derivative(const ContactState& x, MatrixXd* dJump = nullptr) const {
    const Index n = contact_.s0.size(), k = contact_.e.size();
    const VectorXd s = contact_.jump(x.lambda, x.alpha);
    MatrixXd J = MatrixXd::Zero(n + k, n + k);
    if (dJump) *dJump = MatrixXd::Zero(n + k, n);
    for (Index i = 0; i < contact_.numPairs(); ++i) {
      const Eigen::Vector3d y = x.lambda.segment<3>(3 * i) + r_[i] * s.segment<3>(3 * i);
      const Eigen::Matrix3d D = projectOnLaw(laws_[i], y).derivative;
      J.block(3 * i, 0, 3, n) = D * contact_.C.middleRows(3 * i, 3);
      J.block<3, 3>(3 * i, 3 * i) += (Eigen::Matrix3d::Identity() - D) / r_[i];
      J.block(3 * i, n, 3, k) = -D * contact_.H.middleRows(3 * i, 3);
      if (dJump) dJump->block<3, 3>(3 * i, 3 * i) = -D;
    }
    J.leftCols(n) *= scale_;
    J.bottomLeftCorner(k, n) = contact_.H.transpose();
    return J;
  }

  double scale() const { return scale_; }

  ContactState step(const ContactState& x, const VectorXd& f) const {
    const Index n = contact_.s0.size(), k = contact_.e.size();
    const MatrixXd J = derivative(x);
    VectorXd d = Testing::luSolve(J, -f);
    if (!d.allFinite() || (J * d + f).norm() > 1e-6 * f.norm())  // free motions of open bodies: least norm
      d = Testing::leastNormSolve(J, -f);
    return {scale_ * d.head(n), d.tail(k)};
  }

 private:
  const CondensedContact& contact_;
  const std::vector<ReferenceLaw>& laws_;
  VectorXd r_;
  double scale_;
};

ContactState moved(const ContactState& x, const ContactState& d, double t) {
  return {x.lambda + t * d.lambda, x.alpha + t * d.alpha};
}

}  // namespace

ContactState tiedBodies(const CondensedContact& contact) {
  const Index n = contact.s0.size(), k = contact.e.size();
  if (n == 0) return {VectorXd(0), VectorXd::Zero(k)};
  const double scale = largestCompliance(contact);
  MatrixXd A = MatrixXd::Zero(n + k, n + k);
  A.topLeftCorner(n, n) = contact.C / scale;
  A.topRightCorner(n, k) = -contact.H;
  A.bottomLeftCorner(k, n) = contact.H.transpose();
  VectorXd b(n + k);
  b << contact.s0, contact.e * scale;
  const VectorXd x = Testing::leastNormSolve(A, b);
  return {x.head(n) / scale, x.tail(k)};
}

NewtonResult solveBySemismoothNewton(const CondensedContact& contact, const std::vector<ReferenceLaw>& laws,
                                     double stepLength, ContactState& state) {
  const NewtonSystem system(contact, laws, stepLength);
  const double scale = std::max(contact.s0.norm(), 1e-300);
  VectorXd f = system.residual(state);
  NewtonResult result;
  if (contact.numPairs() == 0) return result;
  double best = f.norm();
  ContactState bestState = state;
  for (; result.steps < 80 && f.norm() > 1e-15 * scale; ++result.steps) {
    const ContactState d = system.step(state, f);
    if (!d.lambda.allFinite() || !d.alpha.allFinite()) break;
    double t = 1, kept = 1, least = std::numeric_limits<double>::infinity();
    for (; t > 1e-3; t /= 2) {
      const double norm = system.residual(moved(state, d, t)).norm();
      if (norm < least) least = norm, kept = t;
      if (norm < (1 - 1e-4 * t) * f.norm()) break;
    }
    if (!(least < f.norm())) kept = 1;  // no descent: the full step changes the active sets
    state = moved(state, d, kept);
    f = system.residual(state);
    const bool stalled = f.norm() < 1e-12 * scale && f.norm() > 0.5 * best;
    if (f.norm() < best) best = f.norm(), bestState = state;
    if (stalled) break;
  }
  state = bestState;
  result.residual = best / scale;
  return result;
}

double sensitivity(const CondensedContact& contact, const std::vector<ReferenceLaw>& laws, const ContactState& state) {
  if (contact.numPairs() == 0) return 0;
  const NewtonSystem system(contact, laws, 1.0);
  MatrixXd dJump;
  const MatrixXd J = system.derivative(state, &dJump);
  const MatrixXd change = Testing::leastNormSolve(J, dJump).topRows(contact.s0.size());
  return system.scale() * std::sqrt(Testing::symmetricEigenvalues(change.transpose() * change).tail<1>()[0]);
}

double solveTrescaByAdmm(const CondensedContact& contact, const std::vector<ReferenceLaw>& laws, double tolerance,
                         int maximumSweeps, ContactState& state) {
  const Index n = contact.s0.size(), k = contact.e.size();
  const VectorXd spectrum = Testing::symmetricEigenvalues(contact.C);
  const double largest = spectrum[n - 1], rho = std::sqrt(largest * std::max(spectrum[0], 1e-4 * largest));
  const double scale = 1 / std::max(largest, 1e-300);  // lambda = scale x
  MatrixXd A = MatrixXd::Zero(n + k, n + k);
  A.topLeftCorner(n, n) = (contact.C + rho * MatrixXd::Identity(n, n)) * scale;
  A.topRightCorner(n, k) = -contact.H;
  A.bottomLeftCorner(k, n) = contact.H.transpose();
  const Testing::Solve solve = Testing::luFactor(A);
  VectorXd z = state.lambda, dual = VectorXd::Zero(n), b(n + k);
  double change = 1;
  for (int sweep = 0; sweep < maximumSweeps && change > tolerance; ++sweep) {
    b << contact.s0 + rho * (z - dual), contact.e / scale;
    const VectorXd x = solve(b);
    const VectorXd relaxed = 1.6 * scale * x.head(n) - 0.6 * z;
    const VectorXd before = z;
    for (Index i = 0; i < contact.numPairs(); ++i)
      z.segment<3>(3 * i) = projectOnLaw(laws[i], relaxed.segment<3>(3 * i) + dual.segment<3>(3 * i)).point;
    dual += relaxed - z;
    state.alpha = x.tail(k);
    change = std::max((z - before).norm(), (scale * x.head(n) - z).norm()) / std::max(z.norm(), 1e-300);
  }
  state.lambda = z;
  return change;
}

}  // namespace Haptos::Scenes
