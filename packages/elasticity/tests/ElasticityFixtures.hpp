// SPDX-License-Identifier: BSD-3-Clause
// Small meshes for the tests of this package.
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_CellMesh.hpp"
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

inline std::vector<Topology> allTopologies() {
  std::vector<Topology> all;
  for (int t = 0; t < kNumTopologies; ++t) all.push_back(Topology(t));
  return all;
}

/// A mesh in the unit cube as one subdomain; inner nodes are those that are not on the surface of the cube before `transform`.
inline Solid solidOf(const Mesh& mesh, const Transform& transform = nullptr) {
  Solid solid;
  for (const auto& x : mesh.coordinates) {
    solid.coordinates.push_back(transform ? transform(x) : x);
    solid.interior.push_back(std::all_of(x.begin(), x.end(), [](double c) { return c > 1e-9 && c < 1 - 1e-9; }));
  }
  int number = 1000;
  for (const auto& block : mesh.blocks) {
    ElementGroup group;
    group.topology = block.topology;
    group.blockName = block.name;
    group.connectivity.assign(block.connectivity.begin(), block.connectivity.end());
    for (int e = 0; e < group.numElements(); ++e) group.elementNumbers.push_back(++number);
    solid.groups.push_back(std::move(group));
  }
  return solid;
}

/// n[0] x n[1] x n[2] hexahedra on the unit cube; inner nodes move by `distortion` times the mesh width.
inline Mesh cubeOfHexahedra(std::array<int, 3> n, double distortion = 0.0) {
  BoxSpec box;
  box.blockName = "cube";
  box.divisions = n;
  return distortedBox(box, distortion);
}

/// The same with elements of one topology (Tet4: six around the diagonal of every brick), their middles on straight edges before
/// `transform`.
inline Solid makeSolid(Topology topology, std::array<int, 3> n, double distortion = 0.0, const Transform& transform = nullptr) {
  return solidOf(withElements(cubeOfHexahedra(n, distortion), topology), transform);
}

/// A layer each of hexahedra, pyramids and tetrahedra, and wedges; linear or quadratic.
inline Solid mixedSolid(int n, double distortion, ElementOrder order) {
  const Mesh hexahedra = cubeOfHexahedra({n, n, 3}, distortion);
  std::vector<Cell> cells;
  for (int e = 0; e < 3 * n * n; ++e) cells.push_back(std::array<Cell, 3>{Cell::Hexahedron, Cell::Pyramids, Cell::Wedges}[std::size_t(e / (n * n))]);
  return solidOf(withCells(hexahedra, cells, order));
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

/// \brief The `free` components of u, such that (K u)_i = f_i there; the others stay as they are given.
inline Eigen::VectorXd solveFree(const Eigen::SparseMatrix<double>& k, const std::vector<int>& free, const Eigen::VectorXd& f, Eigen::VectorXd u) {
  std::vector<int> position(std::size_t(k.rows()), -1);
  for (std::size_t i = 0; i < free.size(); ++i) position[std::size_t(free[i])] = int(i);
  for (const int i : free) u[i] = 0;
  const Eigen::VectorXd rest = f - k * u;
  std::vector<Eigen::Triplet<double>> entries;
  for (int j : free)
    for (Eigen::SparseMatrix<double>::InnerIterator it(k, j); it; ++it)
      if (position[std::size_t(it.row())] >= 0) entries.emplace_back(position[std::size_t(it.row())], position[std::size_t(j)], it.value());
  const auto n = Eigen::Index(free.size());
  Eigen::SparseMatrix<double> inner(n, n);
  inner.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(inner);
  Eigen::VectorXd right(n);
  for (Eigen::Index i = 0; i < n; ++i) right[i] = rest[free[std::size_t(i)]];
  const Eigen::VectorXd solution = factor.solve(right);
  for (Eigen::Index i = 0; i < n; ++i) u[free[std::size_t(i)]] = solution[i];
  return u;
}

}  // namespace Haptos::Fixtures
