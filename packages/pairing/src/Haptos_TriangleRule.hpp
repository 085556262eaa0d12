// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

namespace Haptos {

/// \brief A point of a triangle by the shares of its corners, and its part of the area.
struct TrianglePoint {
  std::array<double, 3> shares;
  double weight;
};

/// \brief 7 points, exact to degree 5 (Radon 1948): products of linear shape functions under affine maps.
const std::vector<TrianglePoint>& sevenPoints();

/// \brief 36 points, exact to degree 10: 6 x 6 Gauss points of a square, one edge of which is collapsed.  Where a map back to
/// a distorted face is not polynomial, 7 points leave 1e-6 of the force, these 1e-10.
const std::vector<TrianglePoint>& thirtySixPoints();

/// \brief 64 points, exact to degree 14, for maps back to quadrilaterals that are nearly triangles.
const std::vector<TrianglePoint>& sixtyFourPoints();

}  // namespace Haptos
