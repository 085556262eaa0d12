// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactFactor.hpp"

#include <cmath>
#include <limits>

namespace Haptos {
// The rest of (A M + B) d = b, G = A (M + sigma N N^T) + B being regular where only B resists the kernel N:
//
//   d = N a + y,  G y = b - B N a,  N^T y = 0   gives   (N^T G^-1 B N) a = N^T G^-1 b   for those N that B resists,
//
// whose small matrix keeps the digits of a weak B: N^T M N, which is round-off, is in none of it.  Where B feels nothing of motions N_0 there is a
// solution for b with Z^T b = 0 only, Z = G^-T N_0: Z^T (A M + B) = 0, as Z^T G is in the span of N^T.  The rest of b no solution can give.
ContactFactor::ContactFactor(const Eigen::MatrixXd& M, const Eigen::MatrixXd& kernel, Eigen::MatrixXd blocks, Shape shape)
    : M_(M), kernel_(kernel), blocks_(std::move(blocks)) {
  findRest();
  const Eigen::MatrixXd N = kernelOnRest();
  Eigen::MatrixXd G = shape == Shape::Symmetric ? symmetricRestMatrix() : restMatrix();
  if (N.cols() > 0) G += M_.diagonal().mean() * timesOnRest(&ContactFactor::A, N) * N.transpose();
  factor_ = DenseFactor(std::move(G), shape == Shape::Symmetric ? DenseFactor::Kind::Cholesky : DenseFactor::Kind::Lu);
  const MotionsOfB motions(timesOnRest(&ContactFactor::B, N));
  prepareKernel(N * motions.held);
  prepareImpossible(N * motions.free);
}

ContactFactor::ContactFactor(const Eigen::MatrixXd& M, const Eigen::MatrixXd& kernel, const Eigen::MatrixXd& C, Eigen::MatrixXd blocks)
    : M_(M), kernel_(kernel), blocks_(std::move(blocks)), forces_(std::in_place, C, kernel, blocks_) {
  findRest();
}

bool ContactFactor::isSmallerByForces(const Eigen::MatrixXd& blocks) {
  Eigen::Index forces = 0, jumps = 0;
  for (Eigen::Index row = 0; row < blocks.rows(); ++row) forces += ForceFactor::isKnown(blocks, row), jumps += isKnown(blocks, row);
  return forces > jumps;
}

// Rows of which M has nothing are pinned, or not there.
void ContactFactor::findRest() {
  for (Eigen::Index row = 0; row < M_.rows(); ++row)
    if (M_(row, row) > 0 && !isSolvedByPair(row)) rest_.push_back(row);
}

// The other rows; 0 where M has nothing.
Eigen::VectorXd ContactFactor::solvedByPairs(const Eigen::VectorXd& b) const {
  Eigen::VectorXd d = Eigen::VectorXd::Zero(b.size());
  for (Eigen::Index row = 0; row < b.size(); ++row)
    if (M_(row, row) > 0 && isSolvedByPair(row)) d[row] = b[row] / B(row, row % 3);
  return d;
}

// (A M + B)(rest, rest)
Eigen::MatrixXd ContactFactor::restMatrix() const {
  const Eigen::Index n = Eigen::Index(rest_.size());
  Eigen::MatrixXd block(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const Eigen::Index column = rest_[std::size_t(j)];
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Index row = rest_[std::size_t(i)], at = row - row % 3;
      block(i, j) = A(row, 0) * M_(at, column) + A(row, 1) * M_(at + 1, column) + A(row, 2) * M_(at + 2, column);
      if (column - column % 3 == at) block(i, j) += B(row, column % 3);
    }
  }
  return block;
}

// (M + B)(rest, rest), A = 1; mostly that is all rows.
Eigen::MatrixXd ContactFactor::symmetricRestMatrix() const {
  Eigen::MatrixXd block = M_;
  if (Eigen::Index(rest_.size()) < M_.rows()) block = M_(rest_, rest_);
  std::vector<Eigen::Index> place(std::size_t(M_.rows()), -1);
  for (std::size_t i = 0; i < rest_.size(); ++i) place[std::size_t(rest_[i])] = Eigen::Index(i);
  for (const Eigen::Index row : rest_)
    for (Eigen::Index k = 0; k < 3; ++k) {
      const Eigen::Index i = place[std::size_t(row)], j = place[std::size_t(row - row % 3 + k)];
      if (j >= 0) block(i, j) += B(row, k);
    }
  return block;
}

// (b - (A M + B) x)(rest), of b what is possible; what a motion of the kernel leaves of M by round-off is left out, as bodies may have gone far.
Eigen::VectorXd ContactFactor::residual(const Eigen::VectorXd& b, const Eigen::VectorXd& x) const {
  Eigen::VectorXd left = b(rest_);
  if (x.isZero(0)) return possible(left);  // a product is read from memory
  const Eigen::VectorXd bent = x - kernel_ * (kernel_.transpose() * x), Mx = symmetricTimes(M_, bent);
  for (Eigen::Index i = 0; i < left.size(); ++i) {
    const Eigen::Index row = rest_[std::size_t(i)], at = row - row % 3;
    for (Eigen::Index k = 0; k < 3; ++k) left[i] -= A(row, k) * Mx[at + k] + B(row, k) * x[at + k];
  }
  return possible(left);
}

// What is left where all of b is impossible is round-off.
Eigen::VectorXd ContactFactor::possible(const Eigen::VectorXd& b) const {
  constexpr double kNothing = 1e-12;
  if (impossible_.cols() == 0) return b;
  const Eigen::VectorXd left = b - impossible_ * (impossible_.transpose() * b);
  return left.norm() > kNothing * b.norm() ? left : Eigen::VectorXd(Eigen::VectorXd::Zero(b.size()));
}

Eigen::VectorXd ContactFactor::withRest(Eigen::VectorXd x, const Eigen::VectorXd& rest) const {
  for (std::size_t i = 0; i < rest_.size(); ++i) x[rest_[i]] = rest[Eigen::Index(i)];
  return x;
}

// (A X)(rest) or (B X)(rest) of values X on the rest
Eigen::MatrixXd ContactFactor::timesOnRest(double (ContactFactor::*block)(Eigen::Index, Eigen::Index) const, const Eigen::MatrixXd& X) const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(blocks_.rows(), X.cols()), Y(X.rows(), X.cols());
  for (std::size_t i = 0; i < rest_.size(); ++i) all.row(rest_[i]) = X.row(Eigen::Index(i));
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    const Eigen::Index row = rest_[i], at = row - row % 3;
    Y.row(Eigen::Index(i)).setZero();
    for (Eigen::Index k = 0; k < 3; ++k) Y.row(Eigen::Index(i)) += (this->*block)(row, k) * all.row(at + k);
  }
  return Y;
}

// Motions of the kernel that leave the other rows alone: M(rest, rest) does not feel them.
Eigen::MatrixXd ContactFactor::kernelOnRest() const {
  constexpr double kStays = 1e-10;  // of a motion of length 1
  if (kernel_.cols() == 0 || rest_.empty()) return Eigen::MatrixXd(Eigen::Index(rest_.size()), 0);
  Eigen::MatrixXd others = kernel_, inside(Eigen::Index(rest_.size()), kernel_.cols());
  for (std::size_t i = 0; i < rest_.size(); ++i) inside.row(Eigen::Index(i)) = kernel_.row(rest_[i]), others.row(rest_[i]).setZero();
  const RightSvd svd(others);  // not by a Gram matrix, whose round-off is 1e-8 of a motion
  Eigen::Index k = 0;
  while (k < kernel_.cols() && svd.values[kernel_.cols() - 1 - k] <= kStays) ++k;
  return inside * svd.V.rightCols(k);
}

void ContactFactor::prepareKernel(const Eigen::MatrixXd& held) {
  held_ = held;
  answers_ = factor_.solve(timesOnRest(&ContactFactor::B, held));
  const Eigen::MatrixXd H = held_.transpose() * answers_;
  scale_ = H.diagonal().cwiseAbs().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  small_ = scale_.asDiagonal() * H * scale_.asDiagonal();
}

// Of a singular G nothing is known; `isSolution` tells.
void ContactFactor::prepareImpossible(const Eigen::MatrixXd& free) {
  if (free.cols() == 0) return;
  const Eigen::MatrixXd Z = factor_.solveTransposed(free);
  if (Z.allFinite()) impossible_ = orthonormalBasis(Z);
}

// Where forces are solved for C has lost some digits of M's: what is left is solved for once more.
Eigen::VectorXd ContactFactor::solve(const Eigen::VectorXd& b) const {
  const Eigen::VectorXd d = solvedByPairs(b);
  if (forces_) {
    const Eigen::VectorXd first = forces_->solve(b);
    return first + forces_->solve(withRest(d, residual(b, first)));
  }
  Eigen::VectorXd y = factor_.solve(residual(b, d));
  if (held_.cols() > 0 && y.allFinite() && small_.allFinite()) {
    const Eigen::VectorXd a = Haptos::solveLeastSquares(small_, scale_.asDiagonal() * (held_.transpose() * y));
    y += (held_ - answers_) * scale_.cwiseProduct(a);
  }
  return withRest(d, y);
}

// Cholesky's method and LU are good for all but singular matrices.  Where x is far, as what is soft gives way, round-off leaves more of b: as long as
// that is all, nothing else does better.
bool ContactFactor::isSolution(const Eigen::VectorXd& x, const Eigen::VectorXd& b) const {
  constexpr double kUseless = 1e-6, kLost = 1e-2;  // residual of a solution that is none; that has no digits
  constexpr double kRoundOff = 1e-15;              // of the products in A M x and B x: 1e2 times what was seen
  if (!x.allFinite()) return false;
  const double left = residual(b, x).norm(), whole = residual(b, solvedByPairs(b)).norm();
  return left <= kUseless * whole || (left <= kLost * whole && left <= kRoundOff * sizeOfProducts(x));
}

// (A M x)_i is a sum of products M_kj x_j, of which M_kk^1/2 (sum_j M_jj x_j^2)^1/2 is a bound of the root of their squares.
double ContactFactor::sizeOfProducts(const Eigen::VectorXd& x) const {
  const Eigen::VectorXd root = M_.diagonal().cwiseMax(0).cwiseSqrt();
  const double energy = root.cwiseProduct(x).norm();
  Eigen::VectorXd sizes = Eigen::VectorXd::Zero(Eigen::Index(rest_.size()));
  for (Eigen::Index i = 0; i < sizes.size(); ++i) {
    const Eigen::Index row = rest_[std::size_t(i)], at = row - row % 3;
    for (Eigen::Index k = 0; k < 3; ++k) sizes[i] += std::abs(A(row, k)) * root[at + k] * energy + std::abs(B(row, k) * x[at + k]);
  }
  return sizes.norm();
}

// What nothing holds are motions of bodies mostly.
Eigen::VectorXd ContactFactor::solveLeastSquares(const Eigen::VectorXd& b) const {
  constexpr Eigen::Index kBody = 6;
  const Eigen::VectorXd d = solvedByPairs(b);
  return withRest(d, solveNearlySingular(restMatrix(), residual(b, d), kernel_.cols() + kBody));
}

int ContactFactor::numChanged(const Eigen::MatrixXd& blocks) const {
  int count = 0;
  for (Eigen::Index at = 0; at < blocks.rows(); at += 3) count += hasChanged(blocks_.middleRows<3>(at), blocks.middleRows<3>(at));
  return count;
}

}  // namespace Haptos
