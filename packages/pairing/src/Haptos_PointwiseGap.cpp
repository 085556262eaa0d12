// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_PointwiseGap.hpp"

#include <cmath>
#include <sstream>

#include "Haptos_NagataSurface.hpp"
#include "Haptos_ProjectedFace.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
std::string describe(const RoundSurface& round, const std::string& name, const std::string& interface) {
  std::ostringstream text;
  text << "gaps of '" << interface << "' are measured to the " << (round.axis ? "cylinder" : "sphere") << " of radius " << round.radius << " about ("
       << round.centre[0] << ", " << round.centre[1] << ", " << round.centre[2] << ")";
  if (round.axis) text << ", axis (" << (*round.axis)[0] << ", " << (*round.axis)[1] << ", " << (*round.axis)[2] << "),";
  text << " that was fitted to '" << name << "'; nodes lie off it by at most " << round.misfit;
  return text.str();
}

std::optional<RoundSurface> roundSurface(const ContactSurface& primary, PrimarySmoothing smoothing) {
  if (smoothing == PrimarySmoothing::Cylinder) return fitCylinder(primary);
  if (smoothing == PrimarySmoothing::Sphere) return fitSphere(primary);
  return {};
}

PointwiseGap::PointwiseGap(const ContactSurface& primary, PrimarySmoothing smoothing)
    : p_(smoothing == PrimarySmoothing::Nagata ? nagataSurface(primary) : primary),
      tree_(p_),
      round_(roundSurface(primary, smoothing)) {}

std::optional<double> PointwiseGap::at(const ContactSurface& secondary, int node) {
  const auto i = std::size_t(node);
  const ProjectionPlane plane(secondary.coordinates[i], secondary.normals[i]);
  tree_.facetsNearLine(plane.origin, plane.normal, found_);
  std::optional<double> nearest;
  for (const int facet : found_) {
    if (Vec3::dot(plane.normal, p_.facetNormals[std::size_t(facet)]) >= opposing) continue;
    const ProjectedFace face(p_, p_.faceOfFacet[std::size_t(facet)], plane);
    const auto point = face.pointAt({0, 0});
    if (!point || distanceOutside(face.face.size, *point) > besideFace) continue;
    const auto x = face.sum(faceValues(face.face.size, *point).N);
    const double gap = Vec3::dot(Vec3::subtract(x, plane.origin), plane.normal);
    if (!nearest || std::abs(gap) < std::abs(*nearest)) nearest = gap;
  }
  return nearest && round_ ? distanceAlong(*round_, plane.origin, plane.normal, *nearest) : nearest;
}

}  // namespace Haptos
