// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cmath>
#include <vector>

namespace Haptos {

/// \brief Node coordinates of one subdomain [numNodes], in the user's unit of length.
using Coordinates = std::vector<std::array<double, 3>>;

}  // namespace Haptos

/// \brief Plain arithmetic on points and directions of space.
namespace Haptos::Vec3 {

using Array = std::array<double, 3>;

inline Array add(const Array& a, const Array& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Array subtract(const Array& a, const Array& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Array scale(double s, const Array& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline double dot(const Array& a, const Array& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline double norm(const Array& a) { return std::hypot(a[0], a[1], a[2]); }

inline Array cross(const Array& a, const Array& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// \brief a / |a|; `a` must not be zero.
inline Array normalized(const Array& a) { return scale(1.0 / norm(a), a); }

/// \brief Length of the part of `a` that is orthogonal to the unit vector `direction`.
inline double distanceFromLine(const Array& a, const Array& direction) {
  return norm(subtract(a, scale(dot(a, direction), direction)));
}

inline bool isFinite(const Array& a) {
  return std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]);
}

}  // namespace Haptos::Vec3
