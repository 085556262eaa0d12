// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_RecycledSubspace.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace Haptos {

RecycledSubspace::RecycledSubspace(const DualVectors& vectors, Eigen::Index maximum)
    : vectors_(vectors), maximum_(maximum), V_(vectors.numRows()), Q_(Eigen::Index(vectors.gluingRows().size())) {
  constexpr Eigen::Index kExpected = 16;  // pairs: few runs need less
  V_.reserve(std::min(kExpected, maximum));
  Q_.reserve(std::min(kExpected, maximum));
}

void RecycledSubspace::clear() {
  size_ = permanent_ = 0;
  V_.truncate(0);
  Q_.truncate(0);
}

// Columns are taken out as they are, (v_j, s_j) with s_j from Q R, and added again: R of a subset of columns is not a part of R.
void RecycledSubspace::dropOldest() {
  const Eigen::Index kept = std::max<Eigen::Index>(1, 2 * maximum_ / 3 - 2), dropped = size_ - permanent_ - kept;
  if (dropped <= 0) return;
  ++compressions_;
  std::vector<Eigen::VectorXd> multipliers, jumpsOf;
  for (Eigen::Index j = permanent_ + dropped; j < size_; ++j) {
    multipliers.push_back(V_.column(j));
    jumpsOf.push_back(jumps(Eigen::VectorXd::Unit(size_, j)));
  }
  size_ = permanent_;  // columns before stay as they are, with their Q and R
  V_.truncate(size_);
  Q_.truncate(size_);
  for (std::size_t j = 0; j < jumpsOf.size(); ++j) add(multipliers[j], jumpsOf[j]);
}

// S y: Q R y on gluing rows, Sc y on contact rows; the jumps themselves are not kept
Eigen::VectorXd RecycledSubspace::jumps(const Eigen::VectorXd& y) const {
  Eigen::VectorXd s = Eigen::VectorXd::Zero(vectors_.numRows()), gluing = Eigen::VectorXd::Zero(Eigen::Index(vectors_.gluingRows().size()));
  Q_.addProduct(R().triangularView<Eigen::Upper>() * y, gluing);
  vectors_.setGluing(s, gluing);
  vectors_.setContact(s, Sc() * y);
  return s;
}

// lambda += V y, s += S y
void RecycledSubspace::addCombination(const Eigen::VectorXd& y, Eigen::VectorXd& lambda, Eigen::VectorXd& s) const {
  V_.addProduct(y, lambda);
  s += jumps(y);
}

// R, V_c and S_c are small beside V and Q: they may move when they grow.
void RecycledSubspace::growDense() {
  constexpr Eigen::Index kFirst = 32;  // most runs need no more
  const Eigen::Index capacity = std::max(kFirst, 2 * R_.cols());
  R_.conservativeResize(capacity, capacity);
  Vc_.conservativeResize(3 * vectors_.numPairs(), capacity);
  Sc_.conservativeResize(3 * vectors_.numPairs(), capacity);
}

// Classical Gram-Schmidt, q := q - Q Q^T q, again as long as most is taken off: what is left is then as good as its length.  Its
// length comes with the same sums, |q - Q d|^2 = |q|^2 - |d|^2; where that is a difference of equal numbers another pass follows.
double RecycledSubspace::add(const Eigen::VectorXd& v, const Eigen::VectorXd& s) {
  constexpr double kDependent = 1e-13;  // of the length: the rest is round-off, its direction chance
  constexpr int kPasses = 3;            // twice is enough for what is independent
  const Eigen::Index m = size_;
  if (m == R_.cols()) growDense();
  Eigen::VectorXd q = vectors_.gluing(s), coefficients = Eigen::VectorXd::Zero(m), sums(m + 2);
  const double mine = s.squaredNorm();
  double left2 = 0;
  for (int pass = 0; pass < kPasses; ++pass) {
    sums << Q_.transposedTimes(q), q.squaredNorm(), mine;
    vectors_.sum(sums);
    const Eigen::VectorXd d = sums.head(m);
    Q_.addProduct(-d, q);
    coefficients += d;
    left2 = std::max(0.0, sums[m] - d.squaredNorm());
    if (left2 >= 0.5 * sums[m]) break;
  }
  const double size = std::sqrt(sums[m + 1]), left = std::sqrt(left2);
  if (size == 0) return 0;
  const bool independent = left > kDependent * size;
  R_.row(m).head(m + 1).setZero();
  R_.col(m).head(m) = coefficients / size;
  R_(m, m) = independent ? left / size : 0.0;
  Q_.append(independent ? Eigen::VectorXd(q / left) : Eigen::VectorXd::Zero(q.size()));
  V_.append(v / size);
  Vc_.col(m) = vectors_.contact(v) / size;
  Sc_.col(m) = vectors_.contact(s) / size;
  largest_ = std::max(largest_, ++size_);
  return size;
}

// Q^T s_E and || s_E ||^2 in one sum: what lies outside of Q is their difference.
RecycledSubspace::Projected RecycledSubspace::projectGluing(const Eigen::VectorXd& gluing) const {
  Eigen::VectorXd sums(size_ + 1);
  sums << Q_.transposedTimes(gluing), gluing.squaredNorm();
  vectors_.sum(sums);
  return {sums.head(size_), sums[size_]};
}

double RecycledSubspace::memoryMb() const {
  return double(V_.bytes() + Q_.bytes() + std::size_t(R_.size() + Vc_.size() + Sc_.size()) * sizeof(double)) / (1 << 20);
}

}  // namespace Haptos
