// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SupernodalFactor.hpp"

#include <Teuchos_Assert.hpp>
#include <Teuchos_BLAS.hpp>
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "Haptos_SupernodalKernels.hpp"

namespace Haptos {
namespace {

HAPTOS_CLONES void forwardOne(const FactorView<double>& L, double* x, double* work) { sweepForward(L, x, work); }
HAPTOS_CLONES void forwardOne(const FactorView<float>& L, float* x, float* work) { sweepForward(L, x, work); }
HAPTOS_CLONES void backwardOne(const FactorView<double>& L, double* x, double* work) { sweepBackward(L, x, work); }
HAPTOS_CLONES void backwardOne(const FactorView<float>& L, float* x, float* work) { sweepBackward(L, x, work); }

// max L_jj: L / scale has entries of at most about 1.
double largestPivot(const SupernodeView& v) {
  double largest = 0;
  for (int k = 0; k < v.supernodes; ++k)
    for (int j = 0, rows = v.pi[k + 1] - v.pi[k]; j < v.super[k + 1] - v.super[k]; ++j)
      largest = std::max(largest, v.x[std::size_t(v.px[k]) + std::size_t(j) * std::size_t(rows) + std::size_t(j)]);
  return largest;
}

}  // namespace

// Where everything goes first, then the entries, so that one allocation holds them in the order of a forward sweep: supernode by
// supernode its triangle, its rectangle.  Rows that fill the last register point to the zeros behind the vector.
template <class Scalar>
SupernodalFactor<Scalar>::SupernodalFactor(const SupernodeView& v) : perm_(v.perm, v.perm + v.n) {
  if (std::is_same<Scalar, float>::value) scale_ = largestPivot(v);
  constexpr int kCount = kPadding;
  static_assert(kCount == Lanes<Scalar>::kCount, "a register");
  std::size_t size = 0;
  for (int k = 0; k < v.supernodes; ++k) {
    const int columns = v.super[k + 1] - v.super[k], below = v.pi[k + 1] - v.pi[k] - columns;
    const int stored = (below + kCount - 1) / kCount * kCount;
    const std::size_t triangle = size, rectangle = triangle + std::size_t(columns) * std::size_t(columns + 1) / 2;
    nodes_.push_back({v.super[k], columns, below, stored, triangle, rectangle, rowsBelow_.size()});
    rowsBelow_.insert(rowsBelow_.end(), v.s + v.pi[k] + columns, v.s + v.pi[k + 1]);
    rowsBelow_.insert(rowsBelow_.end(), std::size_t(stored - below), v.n);
    size = rectangle + std::size_t(columns) * std::size_t(stored);
    largest_ = std::max(largest_, stored);
  }
  entries_.resize(Eigen::Index(size) + kCount);
  for (int k = 0; k < v.supernodes; ++k) append(nodes_[std::size_t(k)], v.x + v.px[k]);
  entries_.tail(kCount).setZero();  // the last column, too, is read to the end of a register
}

// L / scale without the zeros above the diagonal; 1 / L_jj in the place of L_jj, as a sweep multiplies by it.
template <class Scalar>
void SupernodalFactor<Scalar>::append(const Supernode& node, const double* block) {
  const int n = node.columns, rows = n + node.rowsBelow;
  Scalar *triangle = entries_.data() + node.triangle, *rectangle = entries_.data() + node.rectangle;
  const double scale = scale_, unit = 1 / scale_;
  for (int j = 0; j < n; ++j, block += rows, rectangle += node.storedRows) {
    *triangle++ = Scalar(scale / block[j]);
    for (int i = j + 1; i < n; ++i) *triangle++ = Scalar(block[i] * unit);
    for (int i = n; i < rows; ++i) rectangle[i - n] = Scalar(block[i] * unit);
    std::fill(rectangle + node.rowsBelow, rectangle + node.storedRows, Scalar(0));
  }
}

// T with zeros above and its own diagonal again, as BLAS wants it: many right-hand sides pay for the copy.
template <class Scalar>
typename SupernodalFactor<Scalar>::Matrix SupernodalFactor<Scalar>::triangleOf(const Supernode& node) const {
  Matrix T = Matrix::Zero(node.columns, node.columns);
  const Scalar* from = entries_.data() + node.triangle;
  for (int j = 0; j < node.columns; ++j) {
    T(j, j) = 1 / *from++;
    for (int i = j + 1; i < node.columns; ++i) T(i, j) = *from++;
  }
  return T;
}

// X := T^-1 X, [the supernode's columns x m].  BLAS wants T whole.
template <class Scalar>
void SupernodalFactor<Scalar>::solveTriangle(const Supernode& node, Scalar* X, int leading, int m) const {
  const Matrix T = triangleOf(node);
  Teuchos::BLAS<int, Scalar>().TRSM(Teuchos::LEFT_SIDE, Teuchos::LOWER_TRI, Teuchos::NO_TRANS, Teuchos::NON_UNIT_DIAG, node.columns, m, 1, T.data(),
                                    node.columns, X, leading);
}

// below := R X, [rows below x m]
template <class Scalar>
void SupernodalFactor<Scalar>::multiplyRectangle(const Supernode& node, const Scalar* X, int leading, int m, Scalar* below, int leadingBelow) const {
  Teuchos::BLAS<int, Scalar>().GEMM(Teuchos::NO_TRANS, Teuchos::NO_TRANS, node.rowsBelow, m, node.columns, 1, entries_.data() + node.rectangle,
                                    node.storedRows, X, leading, 0, below, leadingBelow);
}

// Supernode by supernode, n its columns and b the rows below: x_n := T^-1 x_n, x_b := x_b - R x_n.
template <class Scalar>
void SupernodalFactor<Scalar>::forward(Matrix& X) const {
  TEUCHOS_ASSERT(X.rows() == rows() + kPadding);
  if (X.cols() == 1) return forwardOne({nodes_, entries_.data(), rowsBelow_.data()}, X.data(), workspace().data());
  const int n = int(X.rows()), m = int(X.cols());
  Matrix below(largest_, m);
  for (const Supernode& node : nodes_) {
    solveTriangle(node, X.data() + node.first, n, m);
    if (node.rowsBelow == 0) continue;
    multiplyRectangle(node, X.data() + node.first, n, m, below.data(), largest_);
    const int* rows = rowsBelow_.data() + node.rows;
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < node.rowsBelow; ++i) X(rows[i], j) -= below(i, j);
  }
}

// From the last supernode to the first: x_n := T^-T (x_n - R^T x_b).
template <class Scalar>
void SupernodalFactor<Scalar>::backward(Matrix& X) const {
  TEUCHOS_ASSERT(X.rows() == rows() + kPadding);
  if (X.cols() == 1) return backwardOne({nodes_, entries_.data(), rowsBelow_.data()}, X.data(), workspace().data());
  const Teuchos::BLAS<int, Scalar> blas;
  const int n = int(X.rows()), m = int(X.cols());
  Matrix below(largest_, m);
  for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {
    const int* rows = rowsBelow_.data() + node->rows;
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < node->rowsBelow; ++i) below(i, j) = X(rows[i], j);
    if (node->rowsBelow > 0)
      blas.GEMM(Teuchos::TRANS, Teuchos::NO_TRANS, node->columns, m, node->rowsBelow, -1, entries_.data() + node->rectangle,
                node->storedRows, below.data(), largest_, 1, X.data() + node->first, n);
    const Matrix T = triangleOf(*node);
    blas.TRSM(Teuchos::LEFT_SIDE, Teuchos::LOWER_TRI, Teuchos::TRANS, Teuchos::NON_UNIT_DIAG, node->columns, m, 1, T.data(),
              node->columns, X.data() + node->first, n);
  }
}

// P A P^T = L L^T, L = scale (L / scale): x = P^T (L / scale)^-T (L / scale)^-1 P (b / unit), times unit / scale^2.
template <class Scalar>
void SupernodalFactor<Scalar>::solve(const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::Ref<Eigen::MatrixXd> X) const {
  TEUCHOS_ASSERT(B.rows() == rows() && X.rows() == B.rows() && X.cols() == B.cols());
  if (B.size() == 0) return;
  const double largest = std::is_same<Scalar, float>::value ? B.cwiseAbs().maxCoeff() : 1.0;
  const double unit = largest > 0 ? largest : 1.0;
  Matrix Y(B.rows() + kPadding, B.cols());
  for (Eigen::Index j = 0; j < B.cols(); ++j)
    for (Eigen::Index i = 0; i < B.rows(); ++i) Y(i, j) = Scalar(B(perm_[std::size_t(i)], j) / unit);
  Y.bottomRows(kPadding).setZero();
  forward(Y);
  backward(Y);
  const double back = unit / (scale_ * scale_);
  for (Eigen::Index j = 0; j < B.cols(); ++j)
    for (Eigen::Index i = 0; i < B.rows(); ++i) X(perm_[std::size_t(i)], j) = back * double(Y(i, j));
}

template class SupernodalFactor<double>;
template class SupernodalFactor<float>;

}  // namespace Haptos
