// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SparseLdl.hpp"

#include <Teuchos_Assert.hpp>

namespace Haptos {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

constexpr double kDependent = 1e-10;

// visit(i, a_ik) for i <= k
template <class Visit>
void forEachAbove(const Matrix& A, int k, Visit&& visit) {
  for (Matrix::InnerIterator it(A, k); it; ++it)
    if (it.row() <= k) visit(int(it.row()), it.value());
}

}  // namespace

SparseLdl::SparseLdl(const Matrix& A) {
  TEUCHOS_ASSERT(A.rows() == A.cols());
  // Few entries a row, some thousand rows: minimum degree, no supernodes.
  Eigen::AMDOrdering<int> ordering;
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> toOld;
  ordering(A, toOld);
  order_ = toOld.size() > 0 ? toOld.inverse().eval() : toOld;
  Matrix permuted(A.rows(), A.cols());
  permuted = A.twistedBy(order_);
  findPattern(permuted);
  factor(permuted);
}

// Row k of L has the nodes on the paths of the tree from the entries of A's column k up to k.
void SparseLdl::findPattern(const Matrix& A) {
  const int n = int(A.cols());
  parent_.assign(std::size_t(n), -1);
  std::vector<int> seen(std::size_t(n), -1);
  start_.assign(std::size_t(n) + 1, 0);
  for (int k = 0; k < n; ++k) {
    seen[std::size_t(k)] = k;
    forEachAbove(A, k, [&](int i, double) {
      for (; seen[std::size_t(i)] != k; i = parent_[std::size_t(i)]) {
        if (parent_[std::size_t(i)] < 0) parent_[std::size_t(i)] = k;
        ++start_[std::size_t(i) + 1];
        seen[std::size_t(i)] = k;
      }
    });
  }
  for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
  rows_.resize(start_.back());
  values_.resize(start_.back());
}

// Row k: L(0..k-1, 0..k-1) D y = A(0..k-1, k), d_k = a_kk - y^T D y
void SparseLdl::factor(const Matrix& A) {
  const int n = int(A.cols());
  std::vector<int> seen(std::size_t(n), -1), path(std::size_t(n), 0), pattern(std::size_t(n), 0);
  std::vector<std::size_t> end(start_.begin(), start_.end() - 1);
  std::vector<double> y(std::size_t(n), 0.0);
  inversePivots_.assign(std::size_t(n), 0.0);
  for (int k = 0; k < n; ++k) {
    int top = n;
    double pivot = 0;
    seen[std::size_t(k)] = k;
    forEachAbove(A, k, [&](int i, double value) {
      if (i == k) pivot = value;
      else y[std::size_t(i)] += value;
      int length = 0;
      for (; seen[std::size_t(i)] != k; i = parent_[std::size_t(i)]) {
        path[std::size_t(length++)] = i;
        seen[std::size_t(i)] = k;
      }
      while (length > 0) pattern[std::size_t(--top)] = path[std::size_t(--length)];
    });
    // What a row has before anything is taken off is the measure of what it depends on others by.
    const double diagonal = pivot;
    for (; top < n; ++top) {
      const std::size_t i = std::size_t(pattern[std::size_t(top)]);
      const double yi = y[i], l = yi * inversePivots_[i];
      y[i] = 0;
      for (std::size_t p = start_[i]; p < end[i]; ++p) y[std::size_t(rows_[p])] -= values_[p] * yi;
      pivot -= l * yi;
      rows_[end[i]] = k;
      values_[end[i]++] = l;
    }
    if (pivot > kDependent * diagonal) inversePivots_[std::size_t(k)] = 1 / pivot;
    // Its inverse pivot stays 0: the row takes no part in solves, as if it were left out of A.
    else if (diagonal > 0) ++numDropped_;
  }
}

// X := L^-T D^-1 L^-1 X
template <int Width>
void SparseLdl::solvePermuted(Rows& X) const {
  using Row = Eigen::Map<Eigen::Matrix<double, 1, Width>>;
  const Eigen::Index width = X.cols();
  const auto row = [&](auto i) { return Row(X.data() + Eigen::Index(i) * width, width); };
  const std::size_t n = inversePivots_.size();
  for (std::size_t i = 0; i < n; ++i) {
    const auto xi = row(i);
    for (std::size_t p = start_[i]; p < start_[i + 1]; ++p) row(rows_[p]) -= values_[p] * xi;
  }
  for (std::size_t i = 0; i < n; ++i) row(i) *= inversePivots_[i];
  for (std::size_t i = n; i-- > 0;) {
    auto xi = row(i);
    for (std::size_t p = start_[i]; p < start_[i + 1]; ++p) xi -= values_[p] * row(rows_[p]);
  }
}

SparseLdl::Rows SparseLdl::solve(const Eigen::Ref<const Rows>& B) const {
  if (B.isZero(0)) return B;  // most motions have nothing where rows couple
  Rows X = order_ * B;
  if (X.cols() == 1) solvePermuted<1>(X);
  else if (X.cols() == 3) solvePermuted<3>(X);
  else solvePermuted<Eigen::Dynamic>(X);
  return order_.inverse() * X;
}

}  // namespace Haptos
