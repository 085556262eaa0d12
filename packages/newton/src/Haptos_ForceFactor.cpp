// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ForceFactor.hpp"

#include <algorithm>

namespace Haptos {
namespace {

// B X, three rows of `blocks` a pair
Eigen::MatrixXd timesB(const Eigen::MatrixXd& blocks, const Eigen::MatrixXd& X) {
  Eigen::MatrixXd BX(X.rows(), X.cols());
  for (Eigen::Index at = 0; at < X.rows(); at += 3) BX.middleRows<3>(at) = blocks.block<3, 3>(at, 3) * X.middleRows<3>(at);
  return BX;
}

}  // namespace

// An SVD of values that are not finite would tell each rank something else.
MotionsOfB::MotionsOfB(const Eigen::MatrixXd& images) : held(Eigen::MatrixXd::Identity(images.cols(), images.cols())), free(images.cols(), 0) {
  constexpr double kNothing = 1e-13;
  if (images.cols() == 0 || !images.allFinite()) return;
  const RightSvd svd(images);
  const Eigen::Index numHeld = (svd.values.array() > kNothing * svd.values[0]).count();
  held = svd.V.leftCols(numHeld);
  free = svd.V.rightCols(images.cols() - numHeld);
}

bool ForceFactor::isKnown(const Eigen::MatrixXd& blocks, Eigen::Index row) {
  for (Eigen::Index k = 0; k < 3; ++k)
    if (blocks(row, 3 + k) != 0 || (blocks(row, k) != 0) != (k == row % 3)) return false;
  return true;
}

// With S the other rows, f_K = A_KK^-1 b_K:
//
//   (A + B C)_SS f_S + (B N)_S a = (b - (A + B C) f_K)_S,   N_S^T f_S = - N_K^T f_K,
//
// as forces on a motion that M does not feel are in balance.
ForceFactor::ForceFactor(const Eigen::MatrixXd& C, const Eigen::MatrixXd& kernel, const Eigen::MatrixXd& blocks)
    : C_(C), kernel_(kernel * MotionsOfB(timesB(blocks, kernel)).held), blocks_(blocks) {
  for (Eigen::Index row = 0; row < C_.rows(); ++row)
    if (C_(row, row) > 0) (isKnown(blocks_, row) ? known_ : unknown_).push_back(row);
  if (unknown_.empty() && kernel_.cols() == 0) return;
  length_ = C_.diagonal().mean();
  factor_ = DenseFactor(matrix(), DenseFactor::Kind::Lu);
}

// Column by column, as C lies in memory.
Eigen::MatrixXd ForceFactor::matrix() const {
  const Eigen::Index m = Eigen::Index(unknown_.size()), k = kernel_.cols();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(m + k, m + k);
  for (Eigen::Index j = 0; j < m; ++j) {
    const Eigen::Index column = unknown_[std::size_t(j)];
    const auto compliance = C_.col(column);
    for (Eigen::Index i = 0; i < m; ++i) matrix(i, j) = times(3, unknown_[std::size_t(i)], compliance);
    for (Eigen::Index i = std::max<Eigen::Index>(0, j - 2); i < std::min(m, j + 3); ++i) {
      const Eigen::Index row = unknown_[std::size_t(i)];
      if (row - row % 3 == column - column % 3) matrix(i, j) += blocks_(row, column % 3);
    }
    matrix.col(j).tail(k) = length_ * kernel_.row(column).transpose();
  }
  for (Eigen::Index a = 0; a < k; ++a)
    for (Eigen::Index i = 0; i < m; ++i) matrix(i, m + a) = length_ * times(3, unknown_[std::size_t(i)], kernel_.col(a));
  return matrix;
}

Eigen::VectorXd ForceFactor::knownForces(const Eigen::VectorXd& b) const {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(b.size());
  for (const Eigen::Index row : known_) f[row] = b[row] / blocks_(row, row % 3);
  return f;
}

// (A x) or (B x) of a row, by the first column of its block
double ForceFactor::times(int first, Eigen::Index row, const Eigen::Ref<const Eigen::VectorXd>& x) const {
  const Eigen::Index at = row - row % 3;
  return blocks_(row, first) * x[at] + blocks_(row, first + 1) * x[at + 1] + blocks_(row, first + 2) * x[at + 2];
}

Eigen::VectorXd ForceFactor::solve(const Eigen::VectorXd& b) const {
  Eigen::VectorXd f = knownForces(b), d = symmetricTimes(C_, f), unknown = Eigen::VectorXd::Zero(b.size());
  const Eigen::Index m = Eigen::Index(unknown_.size()), k = kernel_.cols();
  Eigen::VectorXd rest(m + k);
  for (Eigen::Index i = 0; i < m; ++i) {
    const Eigen::Index row = unknown_[std::size_t(i)];
    rest[i] = b[row] - times(0, row, f) - times(3, row, d);
  }
  rest.tail(k) = -length_ * (kernel_.transpose() * f);
  rest = factor_.solve(rest);
  for (Eigen::Index i = 0; i < m; ++i) unknown[unknown_[std::size_t(i)]] = rest[i];
  d += symmetricTimes(C_, unknown);
  d += kernel_ * (length_ * rest.tail(k));
  for (Eigen::Index row = 0; row < d.size(); ++row)
    if (!(C_(row, row) > 0)) d[row] = 0;
  return d;
}

}  // namespace Haptos
