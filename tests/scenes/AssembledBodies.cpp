// SPDX-License-Identifier: BSD-3-Clause
#include "AssembledBodies.hpp"

#include <Eigen/Core>
#include <numeric>
#include <stdexcept>

#include "DenseAlgebra.hpp"

namespace Haptos::Scenes {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

template <class Shape>
void addElements(const Mesh& mesh, const ElementBlock& block, const ElasticModuli& moduli, Formulation formulation,
                 Triplets& triplets) {
  ElementGroup group;
  group.topology = block.topology;
  for (auto node : block.connectivity) group.connectivity.push_back(int(node));
  for (int e = 0; e < group.numElements(); ++e) {
    ElementStiffness<Shape> K;
    elementStiffness<Shape>(elementGradients<Shape>(mesh.coordinates, group, e), moduli, formulation, K);
    const int* nodes = group.nodes(e);
    for (int i = 0; i < K.rows(); ++i)
      for (int j = 0; j < K.cols(); ++j)
        triplets.emplace_back(3 * nodes[i / 3] + i % 3, 3 * nodes[j / 3] + j % 3, K(i, j));
  }
}

Eigen::Matrix<double, 3, 6> rigidMotionsAt(const Eigen::Vector3d& x, double size) {
  Eigen::Matrix<double, 3, 6> m = Eigen::Matrix<double, 3, 6>::Zero();
  m.leftCols<3>().setIdentity();
  const Eigen::Vector3d r = x / size;
  m.col(3) << 0, -r[2], r[1];
  m.col(4) << r[2], 0, -r[0];
  m.col(5) << -r[1], r[0], 0;
  return m;
}

}  // namespace

std::vector<int> bodiesOfNodes(const Mesh& mesh, int& count) {
  std::vector<int> parent(mesh.numNodes(), -1);
  const auto root = [&](int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const auto& block : mesh.blocks) {
    const int n = nodesPerElement(block.topology);
    for (std::size_t i = 0; i < block.connectivity.size(); ++i) {
      const int node = int(block.connectivity[i]), first = int(block.connectivity[i - i % n]);
      if (parent[node] < 0) parent[node] = node;
      if (parent[first] < 0) parent[first] = first;
      parent[root(node)] = root(first);
    }
  }
  std::vector<int> body(mesh.numNodes(), -1), number(mesh.numNodes(), -1);
  count = 0;
  for (std::size_t node = 0; node < body.size(); ++node) {
    if (parent[node] < 0) continue;
    int& mine = number[root(int(node))];
    if (mine < 0) mine = count++;
    body[node] = mine;
  }
  return body;
}

AssembledBodies::AssembledBodies(const Mesh& mesh, const std::vector<IsotropicMaterial>& materials,
                                 const std::vector<int>& materialOfBlock, Formulation formulation,
                                 const std::vector<HeldComponent>& held) {
  Triplets triplets;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const auto moduli = elasticModuli(materials[materialOfBlock[b]]);
    withShape(mesh.blocks[b].topology,
              [&](auto shape) { addElements<decltype(shape)>(mesh, mesh.blocks[b], moduli, formulation, triplets); });
  }
  all_.resize(3 * Eigen::Index(mesh.numNodes()), 3 * Eigen::Index(mesh.numNodes()));
  all_.setFromTriplets(triplets.begin(), triplets.end());
  numberFree(held);
  findRigidMotions(mesh);
  factor();
}

void AssembledBodies::numberFree(const std::vector<HeldComponent>& held) {
  held_ = Eigen::VectorXd::Zero(all_.rows());
  position_.assign(all_.rows(), 0);
  for (const auto& h : held) {
    position_[3 * h.node + h.component] = -1;
    held_[3 * h.node + h.component] = h.value;
  }
  for (Eigen::Index i = 0; i < all_.rows(); ++i) {
    if (position_[i] < 0 || all_.col(i).nonZeros() == 0) {
      position_[i] = -1;
      continue;
    }
    position_[i] = int(free_.size());
    free_.push_back(int(i));
  }
  Triplets triplets;
  for (Eigen::Index column = 0; column < all_.cols(); ++column)
    for (Sparse::InnerIterator it(all_, column); it; ++it)
      if (position_[it.row()] >= 0 && position_[column] >= 0)
        triplets.emplace_back(position_[it.row()], position_[column], it.value());
  K_.resize(numFree(), numFree());
  K_.setFromTriplets(triplets.begin(), triplets.end());
}

// Of the six motions of every body, those that move no held component.
void AssembledBodies::findRigidMotions(const Mesh& mesh) {
  int bodies = 0;
  const auto bodyOf = bodiesOfNodes(mesh, bodies);
  R_.resize(numFree(), 0);
  for (int b = 0; b < bodies; ++b) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    double count = 0, size = 0;
    const auto at = [&](std::size_t node) -> Eigen::Vector3d { return Eigen::Vector3d(mesh.coordinates[node].data()) - centre; };
    for (std::size_t node = 0; node < bodyOf.size(); ++node)
      if (bodyOf[node] == b) centre += Eigen::Vector3d(mesh.coordinates[node].data()), ++count;
    centre /= count;
    for (std::size_t node = 0; node < bodyOf.size(); ++node)
      if (bodyOf[node] == b) size = std::max(size, at(node).norm());
    Eigen::Matrix<double, 6, 6> felt = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(numFree(), 6);
    for (std::size_t node = 0; node < bodyOf.size(); ++node) {
      if (bodyOf[node] != b) continue;
      const auto m = rigidMotionsAt(at(node), size);
      for (int d = 0; d < 3; ++d) {
        const int position = position_[3 * node + d];
        if (position >= 0) motions.row(position) = m.row(d);
        else felt += m.row(d).transpose() * m.row(d);
      }
    }
    const Testing::SymmetricSpectrum spectrum(felt);
    int k = 0;
    while (k < 6 && spectrum.values[k] <= 1e-9) ++k;
    if (k == 0) continue;
    const Eigen::MatrixXd mine = motions * spectrum.vectors.leftCols(k);
    const Eigen::MatrixXd Q = Testing::thinQ(mine);
    R_.conservativeResize(Eigen::NoChange, R_.cols() + k);
    R_.rightCols(k) = Q;
  }
}

// Fixes as many well placed degrees of freedom as there are rigid motions; the rest is positive definite.
void AssembledBodies::factor() {
  keep_.assign(numFree(), 1);
  if (R_.cols() > 0) {
    const std::vector<int> pivots = Testing::pivotedColumns(R_.transpose());
    for (Eigen::Index i = 0; i < R_.cols(); ++i) keep_[pivots[std::size_t(i)]] = 0;
  }
  std::vector<int> number(numFree(), -1);
  for (Eigen::Index i = 0; i < numFree(); ++i)
    if (keep_[i]) number[i] = int(kept_.size()), kept_.push_back(int(i));
  Triplets triplets;
  for (Eigen::Index column = 0; column < K_.cols(); ++column)
    for (Sparse::InnerIterator it(K_, column); it; ++it)
      if (keep_[it.row()] && keep_[column]) triplets.emplace_back(number[it.row()], number[column], it.value());
  Sparse Kr(Eigen::Index(kept_.size()), Eigen::Index(kept_.size()));
  Kr.setFromTriplets(triplets.begin(), triplets.end());
  factor_.compute(Kr);
  if (factor_.info() != Eigen::Success) throw std::runtime_error("reference: the stiffness matrix has no factor");
}

Eigen::VectorXd AssembledBodies::reduce(const Eigen::VectorXd& load) const {
  const Eigen::VectorXd all = load - all_ * held_;
  Eigen::VectorXd result(numFree());
  for (Eigen::Index i = 0; i < numFree(); ++i) result[i] = all[free_[i]];
  return result;
}

Eigen::MatrixXd AssembledBodies::solve(const Eigen::MatrixXd& right) const {
  const Eigen::MatrixXd balanced = right - R_ * (R_.transpose() * right);
  Eigen::MatrixXd small(Eigen::Index(kept_.size()), right.cols());
  for (std::size_t i = 0; i < kept_.size(); ++i) small.row(Eigen::Index(i)) = balanced.row(kept_[i]);
  const Eigen::MatrixXd x = factor_.solve(small);
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(numFree(), right.cols());
  for (std::size_t i = 0; i < kept_.size(); ++i) u.row(kept_[i]) = x.row(Eigen::Index(i));
  return u - R_ * (R_.transpose() * u);
}

Eigen::VectorXd AssembledBodies::solveRefined(const Eigen::VectorXd& right) const {
  const Eigen::VectorXd balanced = right - R_ * (R_.transpose() * right);
  Eigen::VectorXd u = solve(balanced);
  for (int i = 0; i < 3; ++i) u += solve(residual(balanced, u));
  return u;
}

Eigen::VectorXd AssembledBodies::residual(const Eigen::VectorXd& right, const Eigen::VectorXd& u) const {
  std::vector<long double> sum(right.data(), right.data() + right.size());
  for (Eigen::Index column = 0; column < K_.cols(); ++column)
    for (Sparse::InnerIterator it(K_, column); it; ++it) sum[it.row()] -= static_cast<long double>(it.value()) * u[column];
  Eigen::VectorXd result(right.size());
  for (Eigen::Index i = 0; i < right.size(); ++i) result[i] = double(sum[i]);
  return result;
}

double AssembledBodies::roundOffScale(const Eigen::VectorXd& u) const {
  return (K_.cwiseAbs() * u.cwiseAbs()).norm();
}

Eigen::VectorXd AssembledBodies::expand(const Eigen::VectorXd& u) const {
  Eigen::VectorXd all = held_;
  for (Eigen::Index i = 0; i < numFree(); ++i) all[free_[i]] = u[i];
  return all;
}

}  // namespace Haptos::Scenes
