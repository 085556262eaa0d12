// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ProjectedFace.hpp"

#include <algorithm>
#include <cmath>

#include "Haptos_Vec3.hpp"

namespace Haptos {

ProjectionPlane::ProjectionPlane(const Vec3::Array& x, const Vec3::Array& n) : origin(x), normal(n) {
  Vec3::Array axis{};
  axis[std::size_t(std::min_element(n.begin(), n.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }) - n.begin())] = 1;
  e1 = Vec3::normalized(Vec3::cross(n, axis));
  e2 = Vec3::cross(n, e1);
}

Point2 ProjectionPlane::project(const Vec3::Array& x) const {
  const auto y = Vec3::subtract(x, origin);
  return {Vec3::dot(y, e1), Vec3::dot(y, e2)};
}

ProjectedFace::ProjectedFace(const ContactSurface& s, int f, const ProjectionPlane& plane) : surface(s), face(s.faces[std::size_t(f)]) {
  for (std::size_t i = 0; i < std::size_t(face.size); ++i) places[i] = plane.project(at(i));
}

Vec3::Array ProjectedFace::sum(const std::array<double, 9>& weights) const {
  Vec3::Array x{};
  for (std::size_t i = 0; i < std::size_t(face.size); ++i) x = Vec3::add(x, Vec3::scale(weights[i], at(i)));
  return x;
}

// The determinant of a bilinear map is linear: it is least and largest in corners.
bool ProjectedFace::isSkew() const {
  if (face.size != 4) return false;
  double least = 1e300, largest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Point2 &x = places[i], &next = places[(i + 1) % 4], &last = places[(i + 3) % 4];
    const double area = std::abs((next[0] - x[0]) * (last[1] - x[1]) - (next[1] - x[1]) * (last[0] - x[0]));
    least = std::min(least, area);
    largest = std::max(largest, area);
  }
  return least < 0.5 * largest;
}

bool ProjectedFace::isAffine(double size) const {
  const auto areOne = [&](const Vec3::Array& x, const Vec3::Array& y) { return Vec3::norm(Vec3::subtract(x, y)) <= roundOff * size; };
  if (face.size == 4) return areOne(Vec3::add(at(0), at(2)), Vec3::add(at(1), at(3)));
  if (face.size == 6)
    return areOne(Vec3::add(at(0), at(1)), Vec3::scale(2, at(3))) && areOne(Vec3::add(at(1), at(2)), Vec3::scale(2, at(4))) &&
           areOne(Vec3::add(at(2), at(0)), Vec3::scale(2, at(5)));
  return face.size == 3;
}

}  // namespace Haptos
