// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ApproachDirections.hpp"

#include <algorithm>

#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

// Area-weighted; zero where the normals cancel (a closed surface).
Vec3::Array meanNormal(const ContactSurface& surface) {
  Vec3::Array mean{};
  double area = 0.0;
  for (std::size_t i = 0; i < surface.numNodes(); ++i) {
    mean = Vec3::add(mean, Vec3::scale(surface.areas[i], surface.normals[i]));
    area += surface.areas[i];
  }
  const double length = Vec3::norm(mean);
  return length > 0.1 * area ? Vec3::scale(1.0 / length, mean) : Vec3::Array{};
}

// No node on an edge.
bool isSmooth(const ContactSurface& surface) {
  return std::all_of(surface.turns.begin(), surface.turns.end(),
                     [](double turn) { return turn < smoothTurn; });
}

}  // namespace

// n of the secondary surface, m against that of the primary one, and what lies between them; a closed surface has no mean normal.
std::vector<Vec3::Array> approachDirections(const ContactSurface& secondary, const ContactSurface& primary) {
  std::vector<Vec3::Array> directions;
  if (!isSmooth(secondary) || !isSmooth(primary)) return directions;
  const auto n = meanNormal(secondary), m = Vec3::scale(-1.0, meanNormal(primary));
  const auto isClose = [&](const Vec3::Array& a) {
    return std::all_of(secondary.normals.begin(), secondary.normals.end(),
                       [&](const auto& normal) { return Vec3::dot(normal, a) > approachCosine; });
  };
  for (const auto& sum : {Vec3::add(n, m), m, n}) {
    if (!(Vec3::norm(sum) > 0.5)) continue;
    const auto direction = Vec3::normalized(sum);
    if (isClose(direction)) directions.push_back(direction);
  }
  return directions;
}

}  // namespace Haptos
