// SPDX-License-Identifier: BSD-3-Clause
// Rings of hexahedra about the z axis.
#pragma once
#include <array>
#include <cmath>
#include <string>

#include "Haptos_Mesh.hpp"

namespace Haptos::Verification {

/// \brief inner <= r <= outer, 0 <= z <= length; nodes on the inner and outer cylinders.
struct RingSpec {
  std::string name;
  double inner, outer, length;
  std::array<int, 3> divisions;  ///< around, across, along
  double turn = 0;               ///< [rad] by which all nodes are turned
};

/// \brief Adds a ring as one more block, with the side sets `name`_inner and `name`_outer.
inline void addRing(Mesh& mesh, const RingSpec& spec) {
  constexpr double kTurn = 6.283185307179586;
  const auto [na, nr, nz] = spec.divisions;
  const auto first = std::int64_t(mesh.numNodes()), firstElement = std::int64_t(mesh.numElements());
  const auto node = [&, na = na, nr = nr](int a, int r, int z) { return first + (a % na) + std::int64_t(na) * (r + std::int64_t(nr + 1) * z); };
  for (int z = 0; z <= nz; ++z)
    for (int r = 0; r <= nr; ++r)
      for (int a = 0; a < na; ++a) {
        const double radius = spec.inner + (spec.outer - spec.inner) * r / nr, angle = spec.turn + kTurn * a / na;
        mesh.coordinates.push_back({radius * std::cos(angle), radius * std::sin(angle), spec.length * z / nz});
      }
  ElementBlock block{std::int64_t(mesh.blocks.size()) + 1, spec.name, Topology::Hex8, {}};
  const auto number = std::int64_t(mesh.sideSets.size());
  SideSet inside{number + 1, spec.name + "_inner", {}}, outside{number + 2, spec.name + "_outer", {}};
  auto element = firstElement;
  for (int z = 0; z < nz; ++z)
    for (int r = 0; r < nr; ++r)
      for (int a = 0; a < na; ++a, ++element) {
        for (int k : {z, z + 1})
          for (const auto& [da, dr] : {std::array{0, 0}, {0, 1}, {1, 1}, {1, 0}}) block.connectivity.push_back(node(a + da, r + dr, k));
        if (r == 0) inside.sides.push_back({element, 3});
        if (r == nr - 1) outside.sides.push_back({element, 1});
      }
  mesh.blocks.push_back(std::move(block));
  mesh.sideSets.push_back(std::move(inside));
  mesh.sideSets.push_back(std::move(outside));
}

}  // namespace Haptos::Verification
