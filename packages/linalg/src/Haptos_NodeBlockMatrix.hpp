// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/SparseCore>
#include <vector>

namespace Haptos {

/// \brief A part of a stiffness in single precision, kept as 3 x 3 blocks between nodes, to be multiplied often.
///
/// A block takes 40 bytes where nine entries of a sparse matrix take 72; of a symmetric part one triangle is kept, and read once
/// a product. Vectors are padded to four entries a node, the fourth being zero, so that a column of a block is a register.
/// Local indices; nothing communicates.
class NodeBlockMatrix {
 public:
  static constexpr int kPadded = 4;  ///< entries of a padded vector a node

  NodeBlockMatrix() = default;
  /// \param K          [n x n], symmetric, both triangles; unknown = 3 x node + component
  /// \param rowOf      [nodes of K] row node of this part, or -1
  /// \param columns    nodes of K that are the columns, in their order
  /// \param rows       number of row nodes
  /// \param unit       that the entries are divided by
  /// \param symmetric  whether rows are the columns, in the same order
  NodeBlockMatrix(const Eigen::SparseMatrix<double>& K, const std::vector<int>& rowOf, const std::vector<int>& columns, int rows,
                  double unit, bool symmetric);

  /// \brief y += A x, y [4 x rows], x [4 x columns], both padded; the fourth entries of y are of no use after it.
  void add(const float* x, float* y) const;
  /// \brief y -= A^T x, y [4 x columns], x [4 x rows]; of a part that is not symmetric.
  void subtractTransposed(const float* x, float* y) const;

  /// \brief The columns of these unknowns, [3 rows x as many], of a symmetric part whole, entries as given to float precision.
  Eigen::SparseMatrix<double> columns(const std::vector<int>& unknowns) const;

 private:
  int numColumns() const { return int(starts_.size()) - 1; }
  void takeWholeNodes(const Eigen::SparseMatrix<double>& K, const std::vector<int>& rowOf, int node, int column);

  int rows_ = 0;
  bool symmetric_ = false;
  double unit_ = 1;
  std::vector<int> starts_{0};  // [columns + 1] into row_
  std::vector<int> row_;        // row node of every block; a symmetric part has row >= column
  std::vector<float> entries_;  // nine a block, by columns; one more, as registers hold four
};

}  // namespace Haptos
