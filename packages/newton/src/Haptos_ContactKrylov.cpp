// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactKrylov.hpp"

#include <Eigen/Jacobi>
#include <cmath>
#include <vector>

#include "Haptos_ColumnBlocks.hpp"

namespace Haptos {

// The next r^T z follows from sums that are taken with this step's, (r - alpha A p)^T D^-1 (r - alpha A p) = r^T z
// - 2 alpha r^T D^-1 A p + alpha^2 (A p)^T D^-1 A p: one reduction a step.  It decides how far to go, and is summed anew by the next
// step.
Eigen::VectorXd ContactEquations::solveByCg(const DualVectors& vectors, const Eigen::VectorXd& b) const {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size()), r = b, z = preconditioner(r), p = z;
  double target = -1;
  for (int step = 0; step < steps; ++step) {
    const Eigen::VectorXd Ap = matrix(p), DAp = preconditioner(Ap);
    Eigen::Vector4d sums(r.dot(z), p.dot(Ap), r.dot(DAp), Ap.dot(DAp));
    vectors.sum(sums);
    const double rz = sums[0];
    if (rz == 0) break;
    const double alpha = rz / sums[1], next = rz - 2 * alpha * sums[2] + alpha * alpha * sums[3];
    x += alpha * p;
    if (step == 0) target = tolerance * tolerance * rz;
    if (next <= target) break;
    r -= alpha * Ap;
    z = preconditioner(r);
    p = z + (next / rz) * p;
  }
  return x;
}

namespace {

// Orthonormal vectors V with A D^-1 V_k = V_k+1 h, h [k + 1 x k] made triangular by rotations as it grows.
class Arnoldi {
 public:
  Arnoldi(const DualVectors& vectors, const Eigen::VectorXd& b, int steps)
      : vectors_(vectors), V_(b.size()), R_(Eigen::MatrixXd::Zero(steps, steps)), rhs_(Eigen::VectorXd::Zero(steps + 1)) {
    rhs_[0] = vectors.norm(b);
    if (rhs_[0] > 0) V_.append(b / rhs_[0]);
  }

  double residual() const { return std::abs(rhs_[size_]); }
  Eigen::VectorXd last() const { return V_.column(size_); }
  bool isExhausted() const { return V_.cols() == size_; }

  void add(Eigen::VectorXd w) {
    Eigen::VectorXd h = Eigen::VectorXd::Zero(size_ + 1), sums(size_ + 2);
    double left2 = 0, whole2 = 0;
    for (int pass = 0; pass < 2; ++pass) {  // classical Gram-Schmidt, twice
      sums << V_.transposedTimes(w), w.squaredNorm();
      vectors_.sum(sums);
      V_.addProduct(-sums.head(size_ + 1), w);
      h += sums.head(size_ + 1);
      left2 = std::max(0.0, sums[size_ + 1] - sums.head(size_ + 1).squaredNorm());
      if (pass == 0) whole2 = sums[size_ + 1];
    }
    constexpr double kDependent = 1e-28;  // of the square: round-off
    const double left = left2 > kDependent * whole2 ? std::sqrt(left2) : 0.0;
    if (left > 0) V_.append(w / left);
    rotate(h, left);
  }

  Eigen::VectorXd solution() const {
    const Eigen::Index k = size_;
    const Eigen::VectorXd y = R_.topLeftCorner(k, k).triangularView<Eigen::Upper>().solve(rhs_.head(k));
    Eigen::VectorXd x = Eigen::VectorXd::Zero(V_.column(0).size()), padded = Eigen::VectorXd::Zero(V_.cols());
    padded.head(k) = y;
    V_.addProduct(padded, x);
    return x;
  }

 private:
  void rotate(Eigen::VectorXd& h, double below) {
    for (Eigen::Index j = 0; j < size_; ++j) h.applyOnTheLeft(j, j + 1, rotations_[std::size_t(j)].adjoint());
    Eigen::JacobiRotation<double> rotation;
    double pivot = 0;
    rotation.makeGivens(h[size_], below, &pivot);
    rotations_.push_back(rotation);
    R_.col(size_).head(size_) = h.head(size_);
    R_(size_, size_) = pivot;
    rhs_.applyOnTheLeft(size_, size_ + 1, rotation.adjoint());
    ++size_;
  }

  const DualVectors& vectors_;
  ColumnBlocks V_;
  Eigen::MatrixXd R_;
  Eigen::VectorXd rhs_;
  std::vector<Eigen::JacobiRotation<double>> rotations_;
  Eigen::Index size_ = 0;
};

}  // namespace

Eigen::VectorXd ContactEquations::solveByGmres(const DualVectors& vectors, const Eigen::VectorXd& b) const {
  Arnoldi basis(vectors, b, steps);
  const double target = tolerance * basis.residual();
  if (target == 0) return Eigen::VectorXd::Zero(b.size());
  for (int step = 0; step < steps && basis.residual() > target && !basis.isExhausted(); ++step)
    basis.add(matrix(preconditioner(basis.last())));
  return preconditioner(basis.solution());
}

}  // namespace Haptos
