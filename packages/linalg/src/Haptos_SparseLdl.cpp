// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SparseLdl.hpp"

#include <Teuchos_Assert.hpp>
#include <algorithm>

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
  // Few entries a row, some thousand rows: minimum degree.
  Eigen::AMDOrdering<int> ordering;
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> toOld;
  ordering(A, toOld);
  order_ = toOld.size() > 0 ? toOld.inverse().eval() : toOld;
  Matrix permuted(A.rows(), A.cols());
  permuted = A.twistedBy(order_);
  findPattern(permuted);
  factor(permuted);
  for (int& row : dropped_) row = toOld.indices()[row];
  findPanels();
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
    else if (diagonal > 0) dropped_.push_back(k);
  }
}

// Columns one after the other whose rows are those of the last one, but for some zeros, are kept side by side: each row is then met once for all of
// them, and without a list.  As each is the parent of the one before, its rows are among those of the next.
void SparseLdl::findPanels() {
  constexpr double kZeros = 1.3;  // entries kept, of those there are
  const int n = int(parent_.size());
  const auto count = [this](int j) { return start_[std::size_t(j) + 1] - start_[std::size_t(j)]; };
  std::size_t size = 0;
  for (int first = 0, next = 0; first < n; first = next) {
    std::size_t entries = count(first), width = 1;
    for (next = first + 1; next < n && parent_[std::size_t(next) - 1] == next; ++next, ++width) {
      const std::size_t kept = width * (width + 1) / 2 + (width + 1) * count(next), there = entries + count(next);
      if (double(kept) > kZeros * double(there) + 4) break;
      entries = there;
    }
    panels_.push_back({first, int(width), start_[std::size_t(next) - 1], int(count(next - 1)), size});
    size += width * (width + count(next - 1));
  }
  std::vector<double> values(size, 0.0);
  for (const Panel& panel : panels_) {
    Eigen::Map<Eigen::MatrixXd> L(values.data() + panel.values, panel.width + panel.numRows, panel.width);
    const int *rows = rows_.data() + panel.rows, *end = rows + panel.numRows;
    for (int k = 0; k < panel.width; ++k)
      for (std::size_t p = start_[std::size_t(panel.first + k)]; p < start_[std::size_t(panel.first + k) + 1]; ++p) {
        const int row = rows_[p] - panel.first;
        L(row < panel.width ? row : panel.width + int(std::lower_bound(rows, end, rows_[p]) - rows), k) = values_[p];
      }
    mostRows_ = std::max(mostRows_, panel.numRows);
  }
  values_ = std::move(values);
}

// X := L^-T D^-1 L^-1 X, panel by panel
template <int Width>
void SparseLdl::solvePermuted(Eigen::MatrixXd& all) const {
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, Width>;
  Eigen::Map<Columns> X(all.data(), all.rows(), all.cols());
  Columns below(mostRows_, X.cols());
  const auto partOf = [&](const Panel& panel) { return Eigen::Map<const Eigen::MatrixXd>(values_.data() + panel.values, panel.width + panel.numRows, panel.width); };
  for (const Panel& panel : panels_) {
    const auto L = partOf(panel);
    auto x = X.middleRows(panel.first, panel.width);
    for (int k = 0; k + 1 < panel.width; ++k)
      x.bottomRows(panel.width - k - 1).noalias() -= L.col(k).segment(k + 1, panel.width - k - 1).lazyProduct(x.row(k));
    if (panel.numRows == 0) continue;
    auto b = below.topRows(panel.numRows);
    if constexpr (Width == Eigen::Dynamic) b.noalias() = L.bottomRows(panel.numRows) * x;
    else b.noalias() = L.bottomRows(panel.numRows).lazyProduct(x);
    const int* rows = rows_.data() + panel.rows;
    for (Eigen::Index v = 0; v < X.cols(); ++v)
      for (int i = 0; i < panel.numRows; ++i) X(rows[i], v) -= b(i, v);
  }
  X = Eigen::Map<const Eigen::VectorXd>(inversePivots_.data(), X.rows()).asDiagonal() * X;
  for (auto panel = panels_.rbegin(); panel != panels_.rend(); ++panel) {
    const auto L = partOf(*panel);
    auto x = X.middleRows(panel->first, panel->width);
    if (panel->numRows > 0) {
      auto b = below.topRows(panel->numRows);
      const int* rows = rows_.data() + panel->rows;
      for (Eigen::Index v = 0; v < X.cols(); ++v)
        for (int i = 0; i < panel->numRows; ++i) b(i, v) = X(rows[i], v);
      if constexpr (Width == Eigen::Dynamic) x.noalias() -= L.bottomRows(panel->numRows).transpose() * b;
      else x.noalias() -= L.bottomRows(panel->numRows).transpose().lazyProduct(b);
    }
    for (int k = panel->width - 1; k-- > 0;) {
      const auto below_k = L.col(k).segment(k + 1, panel->width - k - 1);
      x.row(k).noalias() -= below_k.transpose().lazyProduct(x.bottomRows(panel->width - k - 1));
    }
  }
}

Eigen::MatrixXd SparseLdl::solve(const Eigen::MatrixXd& B) const {
  if (B.isZero(0)) return B;  // most motions have nothing where rows couple
  Eigen::MatrixXd X = order_ * B;
  if (X.cols() == 1) solvePermuted<1>(X);
  else if (X.cols() == 3) solvePermuted<3>(X);
  else solvePermuted<Eigen::Dynamic>(X);
  return order_.inverse() * X;
}

}  // namespace Haptos
