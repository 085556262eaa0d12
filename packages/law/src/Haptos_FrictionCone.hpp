// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

namespace Haptos {

/// \brief Euclidean projection on the elliptic friction cone { N >= 0, || F^-1 T || <= N }, with derivative.
struct ConeProjection {
  std::array<double, 3> point;                ///< (N, T1, T2)
  std::array<std::array<double, 3>, 3> dPdx;  ///< symmetric, eigenvalues in [0, 1]
};

/// \brief Projects x = (N, T1, T2); coefficients F1, F2 >= 0, where 0 holds that component at 0.
///
/// The height g of the projected point is the root of the increasing function
/// g - N - (T - P(T, g)) . dP/dg, with P(., g) the projection on the ellipse with semi-axes F g.
ConeProjection projectOntoFrictionCone(const std::array<double, 3>& x, const std::array<double, 2>& coefficients);

}  // namespace Haptos
