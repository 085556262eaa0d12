// SPDX-License-Identifier: BSD-3-Clause
// Subdomains for tests, assembled independently of the elasticity package: trilinear hexahedra with 2 x 2 x 2 Gauss
// points on a box with distorted nodes, cut into jagged parts by METIS.
#pragma once
#include <metis.h>

#include <Eigen/LU>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <set>
#include <vector>

#include "DenseAlgebra.hpp"

namespace Haptos::Testing {

using Sparse = Eigen::SparseMatrix<double>;
using Dense = Eigen::MatrixXd;

struct TestMesh {
  std::vector<std::array<double, 3>> nodes;
  std::vector<std::array<int, 8>> elements;
};

struct TestSubdomain {
  Sparse K;
  Dense kernel;
  std::vector<std::array<double, 3>> coordinates;
  int facePieces;  ///< pieces connected through element faces
};

/// nx x ny x nz hexahedra on a box of the given size, inner nodes moved by up to `distortion` element sizes.
inline TestMesh boxMesh(std::array<int, 3> n, std::array<double, 3> size, double distortion) {
  TestMesh mesh;
  for (int k = 0; k <= n[2]; ++k)
    for (int j = 0; j <= n[1]; ++j)
      for (int i = 0; i <= n[0]; ++i) {
        const std::array<int, 3> at{i, j, k};
        std::array<double, 3> x;
        for (int c = 0; c < 3; ++c)
          x[c] = size[c] / n[c] * (at[c] + distortion * std::sin(12.9 * i + 78.2 * j + 37.7 * k + 1.7 * c));
        mesh.nodes.push_back(x);
      }
  const auto node = [&](int i, int j, int k) { return i + (n[0] + 1) * (j + (n[1] + 1) * k); };
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i)
        mesh.elements.push_back({node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k), node(i, j + 1, k),
                                 node(i, j, k + 1), node(i + 1, j, k + 1), node(i + 1, j + 1, k + 1),
                                 node(i, j + 1, k + 1)});
  return mesh;
}

/// Elements of every part of the METIS partition of the dual graph.
inline std::vector<std::vector<int>> cutByMetis(const TestMesh& mesh, int parts) {
  idx_t ne = idx_t(mesh.elements.size()), nn = idx_t(mesh.nodes.size()), common = 4, np = parts, cut = 0;
  std::vector<idx_t> starts(ne + 1), corners, ofElement(ne), ofNode(nn);
  for (idx_t e = 0; e < ne; ++e) {
    starts[e + 1] = 8 * (e + 1);
    corners.insert(corners.end(), mesh.elements[e].begin(), mesh.elements[e].end());
  }
  METIS_PartMeshDual(&ne, &nn, starts.data(), corners.data(), nullptr, nullptr, &common, &np, nullptr, nullptr, &cut,
                     ofElement.data(), ofNode.data());
  std::vector<std::vector<int>> result(parts);
  for (idx_t e = 0; e < ne; ++e) result[ofElement[e]].push_back(int(e));
  return result;
}

/// 24 x 24 stiffness of one hexahedron with corners `x`.
inline Dense elementStiffness(const std::array<std::array<double, 3>, 8>& x, double E, double nu) {
  static const int sign[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                 {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
  const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu)), g = 1 / std::sqrt(3.0);
  Dense D = Dense::Zero(6, 6);
  D.topLeftCorner(3, 3).setConstant(lambda);
  D.diagonal() += (Eigen::VectorXd(6) << 2 * mu, 2 * mu, 2 * mu, mu, mu, mu).finished();
  Dense Ke = Dense::Zero(24, 24);
  for (const auto& point : sign) {
    Eigen::Matrix<double, 8, 3> local, corner;  // gradients in the reference element; coordinates
    for (int a = 0; a < 8; ++a)
      for (int c = 0; c < 3; ++c) {
        local(a, c) = sign[a][c] / 8.0;
        for (int d = 0; d < 3; ++d)
          if (d != c) local(a, c) *= 1 + g * point[d] * sign[a][d];
        corner(a, c) = x[a][c];
      }
    const Eigen::Matrix3d jacobian = corner.transpose() * local;
    const Eigen::Matrix<double, 8, 3> grad = local * jacobian.inverse();
    Dense B = Dense::Zero(6, 24);
    for (int a = 0; a < 8; ++a) {
      for (int c = 0; c < 3; ++c) B(c, 3 * a + c) = grad(a, c);
      B(3, 3 * a) = B(4, 3 * a + 2) = grad(a, 1);
      B(3, 3 * a + 1) = B(5, 3 * a + 2) = grad(a, 0);
      B(4, 3 * a + 1) = B(5, 3 * a) = grad(a, 2);
    }
    Ke += jacobian.determinant() * B.transpose() * D * B;
  }
  return Ke;
}

/// Number of the piece of every listed element; pieces hang together through faces (4 common nodes).
inline std::vector<int> facePieces(const TestMesh& mesh, const std::vector<int>& elements) {
  std::vector<int> piece(elements.size());
  std::iota(piece.begin(), piece.end(), 0);
  const auto root = [&](int e) {
    while (piece[e] != e) e = piece[e];
    return e;
  };
  std::map<std::set<int>, int> faces;
  static const int corner[6][4] = {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  for (std::size_t e = 0; e < elements.size(); ++e)
    for (const auto& f : corner) {
      std::set<int> key;
      for (const int c : f) key.insert(mesh.elements[elements[e]][c]);
      const auto found = faces.emplace(key, int(e));
      if (!found.second) piece[root(int(e))] = root(found.first->second);
    }
  std::map<int, int> number;
  for (std::size_t e = 0; e < elements.size(); ++e) number.emplace(root(int(e)), int(number.size()));
  std::vector<int> result;
  for (std::size_t e = 0; e < elements.size(); ++e) result.push_back(number[root(int(e))]);
  return result;
}

/// Orthonormal kernel of a subdomain whose element e (local nodes in `elements`) belongs to rigid piece `piece`[e].
inline Dense rigidKernel(const std::vector<std::array<double, 3>>& x, const std::vector<std::array<int, 8>>& elements,
                         const std::vector<int>& piece) {
  const int pieces = 1 + *std::max_element(piece.begin(), piece.end());
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const auto& p : x) centre += Eigen::Map<const Eigen::Vector3d>(p.data()) / double(x.size());
  double radius = 0;
  for (const auto& p : x) radius = std::max(radius, (Eigen::Map<const Eigen::Vector3d>(p.data()) - centre).norm());
  const auto modes = [&](int node) {  // 3 x 6, rotations in units of the subdomain
    const Eigen::Vector3d r = (Eigen::Map<const Eigen::Vector3d>(x[node].data()) - centre) / radius;
    Dense m = Dense::Zero(3, 6);
    m.leftCols(3).setIdentity();
    m.rightCols(3) << 0, r[2], -r[1], -r[2], 0, r[0], r[1], -r[0], 0;
    return m;
  };
  std::vector<std::set<int>> piecesOf(x.size());
  for (std::size_t e = 0; e < elements.size(); ++e)
    for (const int node : elements[e]) piecesOf[node].insert(piece[e]);

  // Pieces that share nodes must move them alike: the kernel is the null space of these conditions.
  Dense conditions = Dense::Zero(1, 6 * pieces);
  for (std::size_t node = 0; node < x.size(); ++node)
    for (const int p : piecesOf[node])
      if (p != *piecesOf[node].begin()) {
        conditions.conservativeResize(conditions.rows() + 3, Eigen::NoChange);
        conditions.bottomRows(3).setZero();
        conditions.block(conditions.rows() - 3, 6 * *piecesOf[node].begin(), 3, 6) = modes(int(node));
        conditions.block(conditions.rows() - 3, 6 * p, 3, 6) -= modes(int(node));
      }
  const Dense motions = conditions.isZero(0) ? Dense::Identity(6 * pieces, 6 * pieces) : nullSpace(conditions, 1e-10);
  Dense R(3 * x.size(), motions.cols());
  for (std::size_t node = 0; node < x.size(); ++node)
    R.middleRows(3 * node, 3) = modes(int(node)) * motions.middleRows(6 * *piecesOf[node].begin(), 6);
  return thinQ(R);
}

/// The listed elements as one subdomain; `E` gives Young's modulus of an element of the mesh.
inline TestSubdomain makeSubdomain(const TestMesh& mesh, const std::vector<int>& elements,
                                   const std::function<double(int)>& E, double nu) {
  std::map<int, int> local;
  for (const int e : elements)
    for (const int node : mesh.elements[e]) local.emplace(node, 0);
  TestSubdomain s;
  for (auto& entry : local) {
    entry.second = int(s.coordinates.size());
    s.coordinates.push_back(mesh.nodes[entry.first]);
  }
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<std::array<int, 8>> corners;
  for (const int e : elements) {
    std::array<std::array<double, 3>, 8> x;
    corners.emplace_back();
    for (int a = 0; a < 8; ++a) {
      x[a] = mesh.nodes[mesh.elements[e][a]];
      corners.back()[a] = local[mesh.elements[e][a]];
    }
    const Dense Ke = elementStiffness(x, E(e), nu);
    for (int i = 0; i < 24; ++i)
      for (int j = 0; j < 24; ++j)
        entries.emplace_back(3 * corners.back()[i / 3] + i % 3, 3 * corners.back()[j / 3] + j % 3, Ke(i, j));
  }
  s.K.resize(3 * Eigen::Index(local.size()), 3 * Eigen::Index(local.size()));
  s.K.setFromTriplets(entries.begin(), entries.end());
  const auto piece = facePieces(mesh, elements);
  s.facePieces = 1 + *std::max_element(piece.begin(), piece.end());
  s.kernel = rigidKernel(s.coordinates, corners, piece);
  return s;
}

inline TestSubdomain makeSubdomain(const TestMesh& mesh, const std::vector<int>& elements, double E, double nu) {
  return makeSubdomain(mesh, elements, [E](int) { return E; }, nu);
}

inline std::vector<int> allElements(const TestMesh& mesh) {
  std::vector<int> all(mesh.elements.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

}  // namespace Haptos::Testing
