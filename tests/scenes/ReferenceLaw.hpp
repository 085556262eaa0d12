// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <array>

namespace Haptos::Scenes {

/// \brief Orthotropic friction of one pair in the reference, order N, T1, T2.
struct ReferenceLaw {
  std::array<double, 2> coefficients{0, 0};  ///< F1, F2; 0 holds that component at 0
  double slipForce = -1;                     ///< Tresca bound [force]; negative: Coulomb
  bool normalPinned = false;
};

/// \brief A point on the law's set and its derivative.
struct ReferenceProjection {
  Eigen::Vector3d point;
  Eigen::Matrix3d derivative;
};

/// \brief Nearest point of the ellipse (y1/a1)^2 + (y2/a2)^2 <= 1, by bisection in long double.
///
/// The nearest point of an outer y is a_i^2 y_i / (a_i^2 + tau), tau > 0 the root of
/// sum (a_i y_i / (a_i^2 + tau))^2 = 1.  Slow and plain; nothing of the library is used.
/// \param tau [out] 0 where y lies inside
std::array<double, 2> nearestOnEllipse(const std::array<double, 2>& y, const std::array<double, 2>& a, double& tau);

/// \brief P(x): x_N to max(0, x_N), x_T to the ellipse F_i g with g = P_N (Coulomb) or the slip force.
ReferenceProjection projectOnLaw(const ReferenceLaw& law, const Eigen::Vector3d& x);

}  // namespace Haptos::Scenes
