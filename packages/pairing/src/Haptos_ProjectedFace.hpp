// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>

#include "Haptos_ContactSurface.hpp"
#include "Haptos_FaceShapes.hpp"

namespace Haptos {

constexpr double opposing = -0.17;   ///< cosine: faces that enclose less than 100 degrees do not face each other
constexpr double roundOff = 1e-12;   ///< of lengths, in the size of a facet
constexpr double besideFace = 0.05;  ///< of the size of a facet: how far beyond it a node is opposite all the same, as curved edges are chords

/// \brief A plane with axes, in which faces that lie opposite each other are compared.
struct ProjectionPlane {
  std::array<double, 3> origin, e1, e2, normal;

  /// \param n of length 1
  ProjectionPlane(const std::array<double, 3>& x, const std::array<double, 3>& n);
  Point2 project(const std::array<double, 3>& x) const;
};

/// \brief A face of a surface, projected on a plane along its normal.  The surface must outlive it.
struct ProjectedFace {
  const ContactSurface& surface;
  const SurfaceFace& face;
  std::array<Point2, 9> places{};  ///< [nodes of the face]

  ProjectedFace(const ContactSurface& surface, int face, const ProjectionPlane& plane);

  /// \brief Its point at a place of the plane; nothing where Newton's method does not settle.
  std::optional<Point2> pointAt(const Point2& target) const { return referencePoint(face.size, places, target); }
  const std::array<double, 3>& at(std::size_t i) const { return surface.coordinates[std::size_t(face.nodes[i])]; }
  std::array<double, 3> sum(const std::array<double, 9>& weights) const;  ///< of the places of nodes, in space
  /// \brief A linear quadrilateral whose map varies in area by more than 2 : the place where it is not invertible lies near, and maps
  /// back vary much.
  bool isSkew() const;
  /// \brief A triangle of straight edges with middles, if any, in the middle, or a parallelogram of four nodes; up to round-off in lengths of
  /// `size`.  Products of their functions are of degree 4.
  bool isAffine(double size) const;
};

}  // namespace Haptos
