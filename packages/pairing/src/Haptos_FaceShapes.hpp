// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>

namespace Haptos {

using Point2 = std::array<double, 2>;

/// \brief Nodal shape functions of a face and their derivatives at one point; [9], as many used as the face has nodes.
struct FaceValues {
  std::array<double, 9> N{}, dXi{}, dEta{};
};

// The number of its nodes tells the shape of a face, in Exodus' order: corners, middles of edges, centre.  3, 6: triangle
// (0,0), (1,0), (0,1); 4, 8 (serendipity), 9: square [-1,1]^2.

constexpr bool isTriangle(int numNodes) { return numNodes == 3 || numNodes == 6; }
constexpr bool isLinear(int numNodes) { return numNodes <= 4; }
constexpr int numCorners(int numNodes) { return isTriangle(numNodes) ? 3 : 4; }

Point2 nodeOfFace(int numNodes, int node);  ///< its reference place
FaceValues faceValues(int numNodes, const Point2& at);

/// \brief How far a point lies beyond the edges of the reference face, in lengths of its edges; negative inside.
double distanceOutside(int numNodes, const Point2& at);

/// \brief The reference point of sum N_i x_i = target, by Newton from the centre of the face, which is kept near to it:
/// a bilinear map has a second solution outside.
/// \param x [numNodes] places of the nodes in a plane
/// \return nothing where the iteration does not settle
std::optional<Point2> referencePoint(int numNodes, const std::array<Point2, 9>& x, const Point2& target);

}  // namespace Haptos
