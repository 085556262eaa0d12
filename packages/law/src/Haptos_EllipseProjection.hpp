// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

namespace Haptos {

/// \brief Euclidean projection of a point on an ellipse, with its derivatives.
///
///   P(x, g) = argmin { |y - x| : (y1/a1)^2 + (y2/a2)^2 <= 1 },  a_i = F_i g
///
/// Inside, dP/dx is the identity.  On the boundary dP/dx = sigma e e^T, with e the unit tangent at P and
/// 0 <= sigma < 1.  A semi-axis 0 leaves an interval on the other axis (two of them leave the origin); then
/// dP/dx is 1 along the axis on which the point is strictly inside and 0 elsewhere.
struct EllipseProjection {
  std::array<double, 2> point;                ///< P, in the unit of x
  bool onBoundary;                            ///< x was not inside: P was moved to the boundary
  std::array<std::array<double, 2>, 2> dPdx;  ///< [-], symmetric
  std::array<double, 2> dPdg;                 ///< dP_i/dg; 0 inside
  double sigma;                               ///< [-], eigenvalue of dP/dx along `tangent`; 1 inside
  std::array<double, 2> tangent;              ///< e, unit; {0, 0} where there is none (inside, or P = x = 0)
};

/// \brief Projection with derivatives on the ellipse with semi-axes `coefficients[i] * g`.
///
/// At g = 0 the point is the origin and dP/dg its one-sided limit F^2 x / |F x| (0 where F x = 0), which is what
/// Coulomb's law needs at vanishing pressure.  The arithmetic is long double: the point is exact to a few units in
/// the last place of its larger semi-axis at any axis ratio and, where that type is wider than double, so is each
/// component in units of its own semi-axis.
EllipseProjection projectOntoEllipse(const std::array<double, 2>& x, const std::array<double, 2>& coefficients,
                                     double g);

/// \brief The point alone, given the semi-axes [unit of x]; `moved` tells whether x was outside.
std::array<double, 2> projectOntoEllipse(const std::array<double, 2>& x, const std::array<double, 2>& semiAxes,
                                         bool& moved);

}  // namespace Haptos
