// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <vector>

namespace Haptos {

/// \brief P A P^T = L D L^T of a sparse symmetric positive semidefinite matrix, unknowns that depend on others left out.
///
/// A pivot below 1e-10 of its diagonal entry drops its unknown: A^-1 is that of the rest, with 0 for what was dropped.
/// Row by row (up-looking) in an order of approximate minimum degree; source: Davis 2005, Algorithm 849 (LDL).
class SparseLdl {
 public:
  SparseLdl() = default;
  explicit SparseLdl(const Eigen::SparseMatrix<double>& A);

  /// \brief A^-1 B [size x any].
  Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;
  Eigen::Index size() const { return order_.size(); }
  double numEntries() const { return double(values_.size()); }  ///< of L, that a column of a solve meets twice
  const std::vector<int>& dropped() const { return dropped_; }  ///< rows of A; empty ones do not count
  int numDropped() const { return int(dropped_.size()); }

 private:
  void findPattern(const Eigen::SparseMatrix<double>& A);
  void factor(const Eigen::SparseMatrix<double>& A);
  void findPanels();
  template <int Width>
  void solvePermuted(Eigen::MatrixXd& X) const;

  // Columns side by side, [width + rows x width] by columns, with what L has of the rows below them.
  struct Panel {
    int first, width;
    std::size_t rows;  // begin in rows_
    int numRows;
    std::size_t values;  // begin in values_
  };

  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order_;
  std::vector<int> parent_;         // elimination tree
  std::vector<std::size_t> start_;  // [n + 1] columns of L below the diagonal
  std::vector<int> rows_;
  std::vector<double> values_, inversePivots_;  // of L by columns, then by panels
  std::vector<Panel> panels_;
  int mostRows_ = 0;
  std::vector<int> dropped_;
};

}  // namespace Haptos
