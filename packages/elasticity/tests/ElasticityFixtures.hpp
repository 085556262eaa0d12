// SPDX-License-Identifier: BSD-3-Clause
// Small meshes for the tests of this package.
#pragma once
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "Haptos_StiffnessAssembler.hpp"

namespace Haptos::Fixtures {

struct Solid {
  Coordinates coordinates;
  std::vector<ElementGroup> groups;
  std::vector<bool> interior;  ///< nodes not on the surface
};

using Transform = std::function<std::array<double, 3>(std::array<double, 3>)>;

inline const std::vector<IsotropicMaterial>& steel() {
  static const std::vector<IsotropicMaterial> materials{{"steel", 2.1e5, 0.3}};
  return materials;
}

/// n[0] x n[1] x n[2] elements on the unit cube; inner nodes move by `distortion` times the mesh width.
/// Tet4: every brick is cut into six tetrahedra around its diagonal.
inline Solid makeSolid(Topology topology, std::array<int, 3> n, double distortion = 0.0,
                       const Transform& transform = nullptr) {
  Solid solid;
  const auto node = [&](int i, int j, int k) { return i + (n[0] + 1) * (j + (n[1] + 1) * k); };
  for (int k = 0; k <= n[2]; ++k)
    for (int j = 0; j <= n[1]; ++j)
      for (int i = 0; i <= n[0]; ++i) {
        const bool inner = i > 0 && j > 0 && k > 0 && i < n[0] && j < n[1] && k < n[2];
        std::array<double, 3> x{double(i) / n[0], double(j) / n[1], double(k) / n[2]};
        if (inner)
          for (int c = 0; c < 3; ++c)
            x[c] += distortion / n[c] * std::sin(12.9 * i + 78.2 * j + 37.7 * k + 4.1 * c);
        solid.coordinates.push_back(transform ? transform(x) : x);
        solid.interior.push_back(inner);
      }
  ElementGroup group;
  group.topology = topology;
  group.blockName = "cube";
  constexpr std::array<std::array<int, 4>, 6> tets{
      {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}}};
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        const std::array<int, 8> hex{
            node(i, j, k),     node(i + 1, j, k),     node(i + 1, j + 1, k),     node(i, j + 1, k),
            node(i, j, k + 1), node(i + 1, j, k + 1), node(i + 1, j + 1, k + 1), node(i, j + 1, k + 1)};
        if (topology == Topology::Hex8)
          group.connectivity.insert(group.connectivity.end(), hex.begin(), hex.end());
        else
          for (const auto& tet : tets)
            for (int corner : tet) group.connectivity.push_back(hex[std::size_t(corner)]);
      }
  for (int e = 0; e < group.numElements(); ++e) group.elementNumbers.push_back(1001 + e);
  solid.groups.push_back(std::move(group));
  return solid;
}

/// One hexahedron whose nodes are numbered in Exodus' order, so that element and subdomain vectors coincide.
inline Solid singleHex(const std::array<std::array<double, 3>, 8>& corners) {
  Solid solid;
  solid.coordinates.assign(corners.begin(), corners.end());
  solid.groups.resize(1);
  solid.groups[0].connectivity = {0, 1, 2, 3, 4, 5, 6, 7};
  solid.groups[0].blockName = "single";
  return solid;
}

inline Solid brick(std::array<double, 3> h) {
  return singleHex({{{0, 0, 0},
                     {h[0], 0, 0},
                     {h[0], h[1], 0},
                     {0, h[1], 0},
                     {0, 0, h[2]},
                     {h[0], 0, h[2]},
                     {h[0], h[1], h[2]},
                     {0, h[1], h[2]}}});
}

/// A general hexahedron: no two edges parallel, no flat side.
inline Solid distortedHex() {
  auto solid = brick({1, 1, 1});
  for (std::size_t a = 0; a < 8; ++a)
    for (std::size_t c = 0; c < 3; ++c)
      solid.coordinates[a][c] += 0.17 * std::sin(1.0 + 3.7 * double(a) + 5.3 * double(c));
  return solid;
}

/// u = H x + c at every node.
inline Eigen::VectorXd linearField(const Coordinates& coordinates, const Eigen::Matrix3d& H,
                                   const Eigen::Vector3d& c = Eigen::Vector3d::Zero()) {
  Eigen::VectorXd u(3 * Eigen::Index(coordinates.size()));
  for (std::size_t i = 0; i < coordinates.size(); ++i)
    u.segment<3>(3 * Eigen::Index(i)) = H * Eigen::Map<const Eigen::Vector3d>(coordinates[i].data()) + c;
  return u;
}

/// A gradient without symmetry, with volume change.
inline Eigen::Matrix3d someGradient() {
  Eigen::Matrix3d H;
  H << 1.3, -0.4, 0.7, 0.2, -0.6, 1.1, -0.6, 0.5, 0.8;
  return 1e-3 * H;
}

/// A vector of reproducible values in [-1, 1].
inline Eigen::VectorXd someVector(Eigen::Index n) {
  Eigen::VectorXd v(n);
  for (Eigen::Index i = 0; i < n; ++i) v(i) = std::sin(1.0 + 7.3 * double(i) * double(i % 17 + 1));
  return v;
}

}  // namespace Haptos::Fixtures
