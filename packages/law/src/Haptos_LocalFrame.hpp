// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

namespace Haptos {

/// \brief Right-handed orthonormal axes of one contact pair, in global components: t1 x t2 = normal.
///
/// t1 and t2 are the principal axes of friction; the coefficients F1 and F2 belong to them.
struct LocalFrame {
  std::array<double, 3> normal;  ///< outward from the secondary surface
  std::array<double, 3> t1;
  std::array<double, 3> t2;  ///< normal x t1
};

/// \brief Axes with t1 along the projection of `principalDirection` on the plane orthogonal to `normal`.
///
/// Where the direction is within 0.1 degrees of the normal (in either sense) the next global axis takes
/// its place: x, and where x is along the normal too, z.
/// \param normal not zero; need not be of length 1
/// \throws InputError if one of the two is zero or not finite
LocalFrame makeFrame(const std::array<double, 3>& normal, const std::array<double, 3>& principalDirection);

}  // namespace Haptos
