// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_RowGram.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <algorithm>
#include <numeric>

#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {
namespace {

struct Touch {
  std::uint64_t dof;  // subdomain and degree of freedom
  int row;
  double scaled;  // value * sqrt(W)
};

std::vector<Touch> sortedTouches(const MultiplierMap& multipliers, bool stiffnessScaling) {
  std::vector<Touch> touches;
  const auto& offsets = multipliers.ownedOffsets();
  for (std::size_t row = 0; row + 1 < offsets.size(); ++row)
    for (auto k = offsets[row]; k < offsets[row + 1]; ++k) {
      const RowEntry& entry = multipliers.ownedEntries()[k];
      const double w = stiffnessScaling ? 1.0 / entry.weight : 1.0;
      touches.push_back({(std::uint64_t(entry.subdomain) << 32) | std::uint32_t(entry.dof), int(row), entry.value * std::sqrt(w)});
    }
  std::sort(touches.begin(), touches.end(), [](const Touch& a, const Touch& b) {
    return a.dof != b.dof ? a.dof < b.dof : a.row < b.row;
  });
  return touches;
}

int findRoot(std::vector<int>& parent, int i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

// Rows that are connected through shared degrees of freedom.
std::vector<std::vector<int>> findBlocks(const std::vector<Touch>& touches, int rows) {
  std::vector<int> parent(rows);
  std::iota(parent.begin(), parent.end(), 0);
  for (std::size_t i = 1; i < touches.size(); ++i)
    if (touches[i].dof == touches[i - 1].dof) parent[findRoot(parent, touches[i].row)] = findRoot(parent, touches[i - 1].row);
  std::vector<int> number(rows, -1);
  std::vector<std::vector<int>> blocks;
  for (int row = 0; row < rows; ++row) {
    int& n = number[findRoot(parent, row)];
    if (n < 0) {
      n = int(blocks.size());
      blocks.emplace_back();
    }
    blocks[n].push_back(row);
  }
  return blocks;
}

Eigen::MatrixXd pseudoInverse(Eigen::MatrixXd A) {
  constexpr double kDependent = 1e-10;
  Eigen::VectorXd d = A.diagonal();
  for (auto& value : d) value = value > 0 ? 1.0 / std::sqrt(value) : 0.0;
  A = d.asDiagonal() * A * d.asDiagonal();
  const SymmetricEigen eigen(A);
  Eigen::VectorXd inverse = eigen.values;
  for (auto& value : inverse) value = value > kDependent ? 1.0 / value : 0.0;
  return d.asDiagonal() * (eigen.vectors * inverse.asDiagonal() * eigen.vectors.transpose()) * d.asDiagonal();
}

}  // namespace

RowGram::RowGram(const MultiplierMap& multipliers, bool stiffnessScaling) {
  const int rows = int(multipliers.ownedOffsets().size()) - 1;
  const auto touches = sortedTouches(multipliers, stiffnessScaling);
  Eigen::SparseMatrix<double> gram(rows, rows);
  std::vector<Eigen::Triplet<double>> triplets;
  for (std::size_t i = 0, j; i < touches.size(); i = j) {
    for (j = i; j < touches.size() && touches[j].dof == touches[i].dof;) ++j;
    for (auto a = i; a < j; ++a)
      for (auto b = i; b < j; ++b) triplets.emplace_back(touches[a].row, touches[b].row, touches[a].scaled * touches[b].scaled);
  }
  gram.setFromTriplets(triplets.begin(), triplets.end());
  triplets.clear();
  for (const auto& block : findBlocks(touches, rows)) {
    const int n = int(block.size());
    Eigen::MatrixXd A(n, n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) A(i, j) = gram.coeff(block[i], block[j]);
    const Eigen::MatrixXd inverse = pseudoInverse(std::move(A));
    const double negligible = 1e-15 * inverse.cwiseAbs().maxCoeff();
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        if (std::abs(inverse(i, j)) > negligible) triplets.emplace_back(block[i], block[j], inverse(i, j));
  }
  inverse_.resize(rows, rows);
  inverse_.setFromTriplets(triplets.begin(), triplets.end());
}

void RowGram::apply(const MultiVector& x, MultiVector& y) const {
  for (std::size_t v = 0; v < x.getNumVectors(); ++v) {
    const auto in = x.getData(v);
    const Eigen::VectorXd product = inverse_ * Eigen::Map<const Eigen::VectorXd>(in.getRawPtr(), in.size());
    const auto out = y.getDataNonConst(v);
    Eigen::Map<Eigen::VectorXd>(out.getRawPtr(), out.size()) = product;
  }
}

}  // namespace Haptos
