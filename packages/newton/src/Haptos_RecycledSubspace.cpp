// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_RecycledSubspace.hpp"

#include <cmath>
#include <vector>

namespace Haptos {

void RecycledSubspace::clear() { size_ = permanent_ = 0; }

void RecycledSubspace::dropOldest() {
  const Eigen::Index kept = std::max<Eigen::Index>(1, 2 * maximum_ / 3 - 2), dropped = size_ - permanent_ - kept;
  if (dropped <= 0) return;
  ++compressions_;
  const Eigen::MatrixXd V = V_.middleCols(permanent_ + dropped, kept);
  std::vector<Eigen::VectorXd> jumps;
  for (Eigen::Index j = 0; j < kept; ++j) jumps.push_back(combineS(Eigen::VectorXd::Unit(size_, permanent_ + dropped + j)));
  size_ = permanent_;  // columns before stay as they are, with their Q and R
  for (Eigen::Index j = 0; j < kept; ++j) add(V.col(j), jumps[std::size_t(j)]);
}

Eigen::VectorXd RecycledSubspace::combineS(const Eigen::VectorXd& y) const {
  Eigen::VectorXd s = Eigen::VectorXd::Zero(vectors_.numRows());
  const Eigen::VectorXd q = R().triangularView<Eigen::Upper>() * y;
  vectors_.setGluing(s, Q_.leftCols(size_) * q);
  vectors_.setContact(s, Sc_.leftCols(size_) * y);
  return s;
}

void RecycledSubspace::grow() {
  constexpr Eigen::Index kFirst = 32;  // most runs need no more
  const Eigen::Index most = permanent_ + std::min(maximum_, kUnlimited - permanent_);
  const Eigen::Index capacity = std::max(size_ + 1, std::min(most, std::max(kFirst, 2 * V_.cols())));
  const auto resize = [&](Eigen::MatrixXd& m, Eigen::Index rows) { m.conservativeResize(rows, capacity); };
  resize(V_, vectors_.numRows());
  resize(Q_, Eigen::Index(vectors_.gluingRows().size()));
  resize(R_, capacity);
  resize(Vc_, 3 * vectors_.numPairs());
  resize(Sc_, 3 * vectors_.numPairs());
}

void RecycledSubspace::add(const Eigen::VectorXd& v, const Eigen::VectorXd& s) {
  constexpr double kDependent = 1e-13;
  if (size_ == V_.cols()) grow();
  const Eigen::Index m = size_;
  Eigen::VectorXd q = vectors_.gluing(s), coefficients = Eigen::VectorXd::Zero(m);
  for (int pass = 0; pass < 2; ++pass) {
    const Eigen::VectorXd d = projectGluing(q);
    q -= Q_.leftCols(m) * d;
    coefficients += d;
  }
  Eigen::Vector2d norms(q.squaredNorm(), s.squaredNorm());
  vectors_.sum(norms);
  const double norm = std::sqrt(norms[0]);
  const bool independent = norm > kDependent * std::sqrt(norms[1]);
  R_.row(m).head(m + 1).setZero();
  R_.col(m).head(m) = coefficients;
  R_(m, m) = independent ? norm : 0.0;
  if (independent) Q_.col(m) = q / norm;
  else Q_.col(m).setZero();
  V_.col(m) = v;
  Vc_.col(m) = vectors_.contact(v);
  Sc_.col(m) = vectors_.contact(s);
  largest_ = std::max(largest_, ++size_);
}

Eigen::VectorXd RecycledSubspace::projectGluing(const Eigen::VectorXd& gluing) const {
  Eigen::VectorXd result = Q_.leftCols(size_).transpose() * gluing;
  vectors_.sum(result);
  return result;
}

double RecycledSubspace::memoryMb() const {
  return double(V_.size() + Q_.size() + R_.size() + Vc_.size() + Sc_.size()) * sizeof(double) / (1 << 20);
}

}  // namespace Haptos
