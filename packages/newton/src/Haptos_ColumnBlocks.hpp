// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {

/// \brief A tall matrix that grows by columns: a few columns to an allocation, nothing is moved.
///
/// Such pieces fit where an earlier phase has left memory; one array for all columns would be new pages (decisions/019).
class ColumnBlocks {
 public:
  explicit ColumnBlocks(Eigen::Index rows) : rows_(rows) {}

  Eigen::Index cols() const { return cols_; }

  /// \brief Makes room, and touches it: pages that ranks get one by one between two reductions keep all others waiting.
  void reserve(Eigen::Index cols) {
    while (capacity() < cols) blocks_.push_back(Eigen::MatrixXd::Zero(rows_, kColumns));
  }

  void append(const Eigen::VectorXd& column) {
    reserve(cols_ + 1);
    blocks_[std::size_t(cols_ / kColumns)].col(cols_ % kColumns) = column;
    ++cols_;
  }

  /// \brief Drops the columns from this one on; their room is kept.
  void truncate(Eigen::Index cols) { cols_ = cols; }

  Eigen::VectorXd column(Eigen::Index j) const { return blocks_[std::size_t(j / kColumns)].col(j % kColumns); }

  /// \brief x += A y, x [rows], y [cols]
  void addProduct(const Eigen::VectorXd& y, Eigen::VectorXd& x) const {
    for (Eigen::Index first = 0; first < cols_; first += kColumns) Haptos::addProduct(1, part(first), y.segment(first, widthAt(first)), x);
  }

  /// \brief A^T x [cols], x [rows]
  Eigen::VectorXd transposedTimes(const Eigen::VectorXd& x) const {
    Eigen::VectorXd y = Eigen::VectorXd::Zero(cols_);
    for (Eigen::Index first = 0; first < cols_; first += kColumns)
      Haptos::addTransposedProduct(1, part(first), x, y.segment(first, widthAt(first)));
    return y;
  }

  std::size_t bytes() const { return std::size_t(rows_ * capacity()) * sizeof(double); }

 private:
  static constexpr Eigen::Index kColumns = 4;

  Eigen::Index capacity() const { return Eigen::Index(blocks_.size()) * kColumns; }
  Eigen::Index widthAt(Eigen::Index first) const { return std::min(kColumns, cols_ - first); }
  Eigen::Block<const Eigen::MatrixXd, Eigen::Dynamic, Eigen::Dynamic, true> part(Eigen::Index first) const {
    return blocks_[std::size_t(first / kColumns)].leftCols(widthAt(first));
  }

  Eigen::Index rows_, cols_ = 0;
  std::vector<Eigen::MatrixXd> blocks_;  // [rows x kColumns] each
};

}  // namespace Haptos
