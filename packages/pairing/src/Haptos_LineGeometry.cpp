// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_LineGeometry.hpp"

#include "Haptos_ContactSurface.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {

// On the inner side of every edge, seen along the line, but for the margin: edge x line is the inward normal of an edge in that view,
// the distance from it (x - a) . inward / |inward|.
bool passesThrough(const ContactSurface& surface, int facet, const Line& line, double margin) {
  const auto& corners = surface.facets[std::size_t(facet)];
  const int size = surface.facetSize(facet);
  const double sign = Vec3::dot(surface.facetNormals[std::size_t(facet)], line.direction) < 0.0 ? -1.0 : 1.0;
  for (int i = 0; i < size; ++i) {
    const auto& a = surface.coordinates[std::size_t(corners[std::size_t(i)])];
    const auto& b = surface.coordinates[std::size_t(corners[std::size_t((i + 1) % size)])];
    const auto edge = Vec3::subtract(b, a);
    const auto inward = Vec3::scale(sign, Vec3::cross(line.direction, edge));
    const double length = Vec3::norm(inward);
    if (Vec3::dot(Vec3::subtract(line.origin, a), inward) < -margin * length) return false;
  }
  return true;
}

// (x + t d - corner) . n = 0; a warped quadrilateral is taken for the plane through its first corner
double distanceToFacet(const ContactSurface& surface, int facet, const Line& line) {
  const auto& normal = surface.facetNormals[std::size_t(facet)];
  const auto& corner = surface.coordinates[std::size_t(surface.facets[std::size_t(facet)][0])];
  return Vec3::dot(Vec3::subtract(corner, line.origin), normal) / Vec3::dot(line.direction, normal);
}

}  // namespace Haptos
