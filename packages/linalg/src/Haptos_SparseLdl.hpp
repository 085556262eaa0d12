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

  /// [size x any], row by row: an entry of the factor is read once for all right-hand sides.
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  /// \brief A^-1 B [size x any].
  Rows solve(const Eigen::Ref<const Rows>& B) const;
  Eigen::Index size() const { return order_.size(); }
  int numDropped() const { return numDropped_; }  ///< empty rows do not count

 private:
  void findPattern(const Eigen::SparseMatrix<double>& A);
  void factor(const Eigen::SparseMatrix<double>& A);
  template <int Width>
  void solvePermuted(Rows& X) const;

  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order_;
  std::vector<int> parent_;         // elimination tree
  std::vector<std::size_t> start_;  // [n + 1] columns of L below the diagonal
  std::vector<int> rows_;
  std::vector<double> values_, inversePivots_;
  int numDropped_ = 0;
};

}  // namespace Haptos
