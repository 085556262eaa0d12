// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactKrylov.hpp"

#include <Eigen/Jacobi>
#include <cmath>
#include <utility>
#include <vector>

#include "Haptos_ColumnBlocks.hpp"

namespace Haptos {

// The next r^T z follows from sums that are taken with this step's, (r - alpha A p)^T D^-1 (r - alpha A p) = r^T z
// - 2 alpha r^T D^-1 A p + alpha^2 (A p)^T D^-1 A p: one reduction a step.  It decides how far to go, and is summed anew by the next
// step.  z follows as r does: one application of D^-1 a step.  With W = A H of known motions and E = H^T W, x = H E^-1 H^T b + y: every p is kept W^T p = 0, so
// that H^T r stays 0; W^T z follows as r^T z does.
ContactEquations::Solution ContactEquations::solveByCg(const DualVectors& vectors, const Eigen::VectorXd& b) const {
  const Eigen::MatrixXd none(b.size(), 0);  // products want its rows
  const bool isAny = known.motions.cols() > 0;
  const auto &H = isAny ? known.motions : none, &W = isAny ? known.images : none;
  const auto summed = [&](Eigen::VectorXd values) {
    if (values.size() > 0) vectors.sum(values);
    return values;
  };
  const auto solved = [&](const Eigen::VectorXd& g) { return known.solve ? known.solve(g) : g; };
  const Eigen::VectorXd a = solved(summed(H.transpose() * b));
  Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size()), r = b;
  if (a.size() > 0) x = H * a, r -= W * a;
  Eigen::VectorXd z = preconditioner(r), g = summed(W.transpose() * z), p = z, sums(4 + a.size());
  if (a.size() > 0) p -= H * solved(g);
  double target = -1;
  for (int step = 0; step < steps; ++step) {
    const Eigen::VectorXd Ap = matrix(p), DAp = preconditioner(Ap);
    sums << r.dot(z), p.dot(Ap), r.dot(DAp), Ap.dot(DAp), W.transpose() * DAp;
    vectors.sum(sums);
    const double rz = sums[0];
    if (rz == 0) return {x, true, step + 1};
    const double alpha = rz / sums[1], next = rz - 2 * alpha * sums[2] + alpha * alpha * sums[3];
    x += alpha * p;
    if (step == 0) target = tolerance * tolerance * rz;
    if (next <= target) return {x, true, step + 1};
    r -= alpha * Ap;
    z -= alpha * DAp;
    p = z + (next / rz) * p;
    if (a.size() == 0) continue;
    g -= alpha * sums.tail(a.size());
    p -= H * solved(g);
  }
  return {x, false, steps};
}

namespace {

// Orthonormal vectors (W, V) with A D^-1 V_k = W c + V_k+1 h, h [k + 1 x k] made triangular by rotations as it grows.
class Arnoldi {
 public:
  Arnoldi(const DualVectors& vectors, const Eigen::MatrixXd& W, Eigen::VectorXd b, int steps)
      : vectors_(vectors),
        numKnown_(W.cols()),
        V_(b.size()),
        R_(Eigen::MatrixXd::Zero(steps, steps)),
        c_(numKnown_, steps),
        rhs_(Eigen::VectorXd::Zero(steps + 1)),
        known_(numKnown_) {
    for (Eigen::Index j = 0; j < numKnown_; ++j) V_.append(W.col(j));
    if (numKnown_ > 0) {
      known_ = W.transpose() * b;
      vectors.sum(known_);
      b -= W * known_;
    }
    rhs_[0] = vectors.norm(b);
    if (rhs_[0] > 0) V_.append(b / rhs_[0]);
  }

  double residual() const { return std::abs(rhs_[size_]); }
  Eigen::VectorXd last() const { return V_.column(numKnown_ + size_); }
  bool isExhausted() const { return V_.cols() == numKnown_ + size_; }

  void add(Eigen::VectorXd w) {
    const Eigen::Index n = V_.cols();
    Eigen::VectorXd h = Eigen::VectorXd::Zero(n), sums(n + 1);
    double left2 = 0, whole2 = 0;
    for (int pass = 0; pass < 2; ++pass) {  // classical Gram-Schmidt, twice
      sums << V_.transposedTimes(w), w.squaredNorm();
      vectors_.sum(sums);
      V_.addProduct(-sums.head(n), w);
      h += sums.head(n);
      left2 = std::max(0.0, sums[n] - sums.head(n).squaredNorm());
      if (pass == 0) whole2 = sums[n];
    }
    constexpr double kDependent = 1e-28;  // of the square: round-off
    const double left = left2 > kDependent * whole2 ? std::sqrt(left2) : 0.0;
    if (left > 0) V_.append(w / left);
    c_.col(size_) = h.head(numKnown_);
    h = h.tail(n - numKnown_).eval();
    rotate(h, left);
  }

  // x = D^-1 V y + H a with R y = rhs, a = W^T b - c y; given are D V y and a.
  std::pair<Eigen::VectorXd, Eigen::VectorXd> solution(Eigen::Index rows) const {
    const Eigen::Index k = size_;
    Eigen::VectorXd x = Eigen::VectorXd::Zero(rows), padded = Eigen::VectorXd::Zero(V_.cols());
    padded.segment(numKnown_, k) = R_.topLeftCorner(k, k).triangularView<Eigen::Upper>().solve(rhs_.head(k));
    V_.addProduct(padded, x);
    return {x, known_ - c_.leftCols(k) * padded.segment(numKnown_, k)};
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
  Eigen::Index numKnown_;  // columns of W
  ColumnBlocks V_;         // W first
  Eigen::MatrixXd R_, c_;
  Eigen::VectorXd rhs_, known_;
  std::vector<Eigen::JacobiRotation<double>> rotations_;
  Eigen::Index size_ = 0;
};

}  // namespace

ContactEquations::Solution ContactEquations::solveByGmres(const DualVectors& vectors, const Eigen::VectorXd& b) const {
  Arnoldi basis(vectors, known.images, b, steps);
  const double target = tolerance * basis.residual();
  int products = 0;
  for (; products < steps && basis.residual() > target && !basis.isExhausted(); ++products)
    basis.add(matrix(preconditioner(basis.last())));
  const auto [v, a] = basis.solution(b.size());
  Eigen::VectorXd x = preconditioner(v);
  if (a.size() > 0) x += known.motions * a;
  return {x, basis.residual() <= target, products};
}

}  // namespace Haptos
