// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

namespace Haptos {

/// \brief The unknowns 0 .. n - 1 that are not listed, ascending.
std::vector<int> complement(Eigen::Index n, const std::vector<int>& listed);

/// \brief K(rows, columns), in the order given.
Eigen::SparseMatrix<double> blockOf(const Eigen::SparseMatrix<double>& K, const std::vector<int>& rows, const std::vector<int>& columns);

/// \brief K + few, where most columns of `few` are empty: those are copied as they lie.  Both have their rows in order.
Eigen::SparseMatrix<double> withFewAdded(const Eigen::SparseMatrix<double>& K, const Eigen::SparseMatrix<double>& few);

/// \brief A(rows, :)
Eigen::MatrixXd rowsOf(const Eigen::Ref<const Eigen::MatrixXd>& A, const std::vector<int>& rows);

/// \brief A X, X dense with its columns beside each other, so that an entry of A is met once for all of them: by columns the products of SurfaceSchur took as
/// long as its solves.
template <class Sparse>
Eigen::MatrixXd timesColumns(const Sparse& A, const Eigen::Ref<const Eigen::MatrixXd>& X) {
  if (X.cols() == 1) return A * X.col(0);
  using ByRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const ByRows x = X, product = A * x;
  return product;
}

}  // namespace Haptos
