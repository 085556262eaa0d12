// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ComponentLdl.hpp"

#include <vector>

namespace Haptos {
namespace {

// (3 i + d, 3 j + d) has what (3 i, 3 j) has, and others have nothing.
bool hasEqualComponents(const Eigen::SparseMatrix<double>& S) {
  using Entry = Eigen::SparseMatrix<double>::InnerIterator;
  for (Eigen::Index j = 0; j < S.cols(); j += 3) {
    if (S.cols() - j < 3) return false;
    Entry first(S, j);
    for (Entry second(S, j + 1), third(S, j + 2); first && second && third; ++first, ++second, ++third) {
      const bool areThree = first.row() % 3 == 0 && second.row() == first.row() + 1 && third.row() == first.row() + 2;
      if (!areThree || first.value() != second.value() || first.value() != third.value()) return false;
    }
    if (S.col(j).nonZeros() != S.col(j + 1).nonZeros() || S.col(j).nonZeros() != S.col(j + 2).nonZeros()) return false;
  }
  return S.cols() > 0;
}

// (3 i, 3 j)
Eigen::SparseMatrix<double> firstComponent(const Eigen::SparseMatrix<double>& S) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index j = 0; j < S.cols(); j += 3)
    for (Eigen::SparseMatrix<double>::InnerIterator it(S, j); it; ++it) entries.emplace_back(it.row() / 3, j / 3, it.value());
  Eigen::SparseMatrix<double> component(S.rows() / 3, S.cols() / 3);
  component.setFromTriplets(entries.begin(), entries.end());
  return component;
}

}  // namespace

ComponentLdl::ComponentLdl(const Eigen::SparseMatrix<double>& S)
    : numComponents_(hasEqualComponents(S) ? 3 : 1), factor_(isShared() ? firstComponent(S) : S) {}

// X row by row is one of three times the columns, a row for each node.
Eigen::MatrixXd ComponentLdl::solve(const Eigen::MatrixXd& X) const {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  if (X.size() == 0 || !isShared()) return X.size() == 0 ? X : factor_.solve(X);
  Rows Y = X;
  Eigen::Map<Rows> nodes(Y.data(), Y.rows() / numComponents_, numComponents_ * Y.cols());
  nodes = factor_.solve(nodes);
  return Y;
}

}  // namespace Haptos
