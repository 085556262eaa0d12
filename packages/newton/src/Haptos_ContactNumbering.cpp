// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactNumbering.hpp"

#include "Haptos_Reductions.hpp"

namespace Haptos {

ContactNumbering::ContactNumbering(const DualVectors& vectors) : vectors_(vectors), mine_(3 * vectors.numPairs()) {
  first_ = sumOfLower(vectors.comm(), mine_);
  size_ = sumOfAll(vectors.comm(), mine_);
}

// By one sum of numbers that are 0 elsewhere.
Eigen::MatrixXd ContactNumbering::onAllRanks(const Eigen::MatrixXd& mine) const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(size_, mine.cols());
  all.middleRows(first_, mine_) = mine;
  vectors_.sum(all);
  return all;
}

Eigen::MatrixXd ContactNumbering::blocksOfAll(const std::vector<Eigen::Matrix3d>& A, const std::vector<Eigen::Matrix3d>& B) const {
  Eigen::MatrixXd mine(mine_, 6);
  for (std::size_t i = 0; i < A.size(); ++i) mine.middleRows<3>(3 * Eigen::Index(i)) << A[i], B[i];
  return onAllRanks(mine);
}

bool isKnown(const Eigen::MatrixXd& blocks, Eigen::Index row) {
  for (Eigen::Index k = 0; k < 3; ++k)
    if (blocks(row, k) != 0 || (blocks(row, 3 + k) != 0) != (k == row % 3)) return false;
  return true;
}

bool hasBlockChanged(const Eigen::Matrix3d& before, const Eigen::Matrix3d& now) {
  constexpr double kMuch = 0.1;
  return (now - before).norm() > kMuch * before.norm();
}

bool hasChanged(const Eigen::Ref<const Eigen::MatrixXd>& before, const Eigen::Ref<const Eigen::MatrixXd>& now) {
  return hasBlockChanged(before.leftCols<3>(), now.leftCols<3>()) || hasBlockChanged(before.rightCols<3>(), now.rightCols<3>());
}

}  // namespace Haptos
