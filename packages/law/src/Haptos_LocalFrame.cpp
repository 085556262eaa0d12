// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_LocalFrame.hpp"

#include <algorithm>
#include <cmath>

#include "Haptos_InputCheck.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

// sin(0.1 degrees): a direction nearer to the normal has no usable projection on the tangent plane
constexpr double smallestSine = 1.7453283658983088e-3;

Vec3::Array unitOf(const Vec3::Array& a, const char* what) {
  const double largest = std::max({std::abs(a[0]), std::abs(a[1]), std::abs(a[2])});
  HAPTOS_REFUSE_IF(!Vec3::isFinite(a) || !(largest > 0.0),
                   what << " (" << a[0] << ", " << a[1] << ", " << a[2] << ") must be finite and must not be zero.");
  const Vec3::Array scaled = {a[0] / largest, a[1] / largest, a[2] / largest};  // very small or large a
  return Vec3::normalized(scaled);
}

Vec3::Array tangentialPart(const Vec3::Array& a, const Vec3::Array& normal) {
  return Vec3::subtract(a, Vec3::scale(Vec3::dot(a, normal), normal));
}

}  // namespace

LocalFrame makeFrame(const std::array<double, 3>& normal, const std::array<double, 3>& principalDirection) {
  const Vec3::Array n = unitOf(normal, "Contact normal");
  const Vec3::Array wanted = unitOf(principalDirection, "Principal Direction");
  for (const Vec3::Array& direction : {wanted, Vec3::Array{1, 0, 0}, Vec3::Array{0, 0, 1}}) {
    const Vec3::Array projection = tangentialPart(direction, n);
    if (Vec3::norm(projection) <= smallestSine) continue;
    // projected twice: the first projection of a direction near n has lost digits
    const Vec3::Array t1 = Vec3::normalized(tangentialPart(Vec3::normalized(projection), n));
    return {n, t1, Vec3::cross(n, t1)};
  }
  throw std::logic_error("makeFrame: x and z cannot both be along the normal");
}

}  // namespace Haptos
