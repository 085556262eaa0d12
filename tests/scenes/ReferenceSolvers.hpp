// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <vector>

#include "ReferenceLaw.hpp"

namespace Haptos::Scenes {

/// \brief The contact problem on the contact rows alone; rows 3 i + (N, T1, T2) of pair i.
///
///   s = s0 - C lambda + H alpha,   H^T lambda = e,   lambda = P(lambda + r s)
///
/// C is the compliance of the bodies [length/force], H the rigid motions of the floating ones.
struct CondensedContact {
  Eigen::MatrixXd C, H;
  Eigen::VectorXd s0, e;

  Eigen::Index numPairs() const { return s0.size() / 3; }
  Eigen::VectorXd jump(const Eigen::VectorXd& lambda, const Eigen::VectorXd& alpha) const {
    return s0 - C * lambda + H * alpha;
  }
};

struct ContactState {
  Eigen::VectorXd lambda, alpha;
};

/// \brief Multipliers of bodies tied together at all pairs (s = 0), the first guess of the solvers.
ContactState tiedBodies(const CondensedContact& contact);

struct NewtonResult {
  double residual = 0;  ///< || (phi, balance) ||, relative to || s0 || and the first residual's size
  int steps = 0;
};

/// \brief Semismooth Newton's method for phi = (lambda - P(lambda + r s)) / r = 0 with a line search.
/// \param stepLength scales r, which is 1 / (normal compliance) of every pair
NewtonResult solveBySemismoothNewton(const CondensedContact& contact, const std::vector<ReferenceLaw>& laws,
                                     double stepLength, ContactState& state);

/// \brief Largest change of lambda for a unit change of the jumps s0, by the derivative at a solution (2-norm).
double sensitivity(const CondensedContact& contact, const std::vector<ReferenceLaw>& laws, const ContactState& state);

/// \brief One Tresca step: min lambda^T C lambda / 2 - s0^T lambda, H^T lambda = e, lambda in the set, by ADMM.
///
/// \param laws all with a slip force; \return change of the last sweep, relative
double solveTrescaByAdmm(const CondensedContact& contact, const std::vector<ReferenceLaw>& laws, double tolerance,
                         int maximumSweeps, ContactState& state);

}  // namespace Haptos::Scenes
