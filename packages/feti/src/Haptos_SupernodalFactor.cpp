// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SupernodalFactor.hpp"

#include <Eigen/Dense>
#include <Teuchos_Assert.hpp>
#include <Teuchos_BLAS.hpp>
#include <algorithm>
#include <cmath>
#include <type_traits>

// Loops over a few hundred entries: the processor's widest registers pay, and a binary that runs anywhere is wanted.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__linux__)
#define HAPTOS_CLONES __attribute__((target_clones("arch=haswell", "default")))
#define HAPTOS_INLINE inline __attribute__((always_inline))  // into every clone
#else
#define HAPTOS_CLONES
#define HAPTOS_INLINE inline
#endif

namespace Haptos {
namespace {

// y := A x for A [m x n] by columns; four columns at once touch y a quarter as often.
template <class Scalar>
HAPTOS_INLINE void product(int m, int n, const Scalar* A, const Scalar* x, Scalar* y) {
  for (int i = 0; i < m; ++i) y[i] = 0;
  int j = 0;
  for (; j + 3 < n; j += 4, A += 4 * std::size_t(m)) {
    const Scalar *a = A, *b = a + m, *c = b + m, *d = c + m;
    const Scalar x0 = x[j], x1 = x[j + 1], x2 = x[j + 2], x3 = x[j + 3];
    for (int i = 0; i < m; ++i) y[i] += a[i] * x0 + b[i] * x1 + (c[i] * x2 + d[i] * x3);
  }
  for (; j < n; ++j, A += m)
    for (int i = 0; i < m; ++i) y[i] += A[i] * x[j];
}

// z -= A^T w
template <class Scalar>
HAPTOS_INLINE void subtractTransposed(int m, int n, const Scalar* A, const Scalar* w, Scalar* z) {
  int j = 0;
  for (; j + 3 < n; j += 4, A += 4 * std::size_t(m)) {
    const Scalar *a = A, *b = a + m, *c = b + m, *d = c + m;
    Scalar s0 = 0, s1 = 0, s2 = 0, s3 = 0;
#pragma omp simd reduction(+ : s0, s1, s2, s3)
    for (int i = 0; i < m; ++i) {
      s0 += a[i] * w[i];
      s1 += b[i] * w[i];
      s2 += c[i] * w[i];
      s3 += d[i] * w[i];
    }
    z[j] -= s0;
    z[j + 1] -= s1;
    z[j + 2] -= s2;
    z[j + 3] -= s3;
  }
  for (; j < n; ++j, A += m) {
    Scalar sum = 0;
#pragma omp simd reduction(+ : sum)
    for (int i = 0; i < m; ++i) sum += A[i] * w[i];
    z[j] -= sum;
  }
}

// x := T^-1 x, T by columns from the diagonal down, the diagonal being its reciprocal.
template <class Scalar>
HAPTOS_INLINE void solveTriangle(int n, const Scalar* T, Scalar* x) {
  for (int j = 0; j < n; T += n - j, ++j) {
    const Scalar xj = x[j] *= T[0];
    for (int i = j + 1; i < n; ++i) x[i] -= T[i - j] * xj;
  }
}

template <class Scalar>
HAPTOS_INLINE void solveTransposedTriangle(int n, const Scalar* T, Scalar* x) {
  T += std::size_t(n) * std::size_t(n + 1) / 2;
  for (int j = n - 1; j >= 0; --j) {
    T -= n - j;
    Scalar sum = 0;
#pragma omp simd reduction(+ : sum)
    for (int i = j + 1; i < n; ++i) sum += T[i - j] * x[i];
    x[j] = (x[j] - sum) * T[0];
  }
}

template <class Scalar>
struct Parts {
  const std::vector<Supernode>& nodes;
  const Scalar *triangles, *rectangles;
  const int* rowsBelow;
};

template <class Scalar>
HAPTOS_INLINE void sweepForward(const Parts<Scalar>& L, Scalar* x, Scalar* work) {
  for (const Supernode& node : L.nodes) {
    solveTriangle(node.columns, L.triangles + node.triangle, x + node.first);
    product(node.rowsBelow, node.columns, L.rectangles + node.rectangle, x + node.first, work);
    const int* rows = L.rowsBelow + node.rows;
    for (int i = 0; i < node.rowsBelow; ++i) x[rows[i]] -= work[i];
  }
}

template <class Scalar>
HAPTOS_INLINE void sweepBackward(const Parts<Scalar>& L, Scalar* x, Scalar* work) {
  for (auto node = L.nodes.rbegin(); node != L.nodes.rend(); ++node) {
    const int* rows = L.rowsBelow + node->rows;
    for (int i = 0; i < node->rowsBelow; ++i) work[i] = x[rows[i]];
    subtractTransposed(node->rowsBelow, node->columns, L.rectangles + node->rectangle, work, x + node->first);
    solveTransposedTriangle(node->columns, L.triangles + node->triangle, x + node->first);
  }
}

HAPTOS_CLONES void sweep(const Parts<double>& L, double* x, double* work) {
  sweepForward(L, x, work);
  sweepBackward(L, x, work);
}

HAPTOS_CLONES void sweep(const Parts<float>& L, float* x, float* work) {
  sweepForward(L, x, work);
  sweepBackward(L, x, work);
}

double largestPivot(const SupernodeView& v) {
  double largest = 0;
  for (int k = 0; k < v.supernodes; ++k)
    for (int j = 0, rows = v.pi[k + 1] - v.pi[k]; j < v.super[k + 1] - v.super[k]; ++j)
      largest = std::max(largest, v.x[std::size_t(v.px[k]) + std::size_t(j) * std::size_t(rows) + std::size_t(j)]);
  return largest;
}

}  // namespace

template <class Scalar>
SupernodalFactor<Scalar>::SupernodalFactor(const SupernodeView& v) : perm_(v.perm, v.perm + v.n) {
  if (std::is_same<Scalar, float>::value) scale_ = largestPivot(v);
  std::size_t triangle = 0, rectangle = 0;
  for (int k = 0; k < v.supernodes; ++k) {
    const int columns = v.super[k + 1] - v.super[k], below = v.pi[k + 1] - v.pi[k] - columns;
    nodes_.push_back({v.super[k], columns, below, triangle, rectangle, rowsBelow_.size()});
    rowsBelow_.insert(rowsBelow_.end(), v.s + v.pi[k] + columns, v.s + v.pi[k + 1]);
    triangle += std::size_t(columns) * std::size_t(columns + 1) / 2;
    rectangle += std::size_t(columns) * std::size_t(below);
    largest_ = std::max(largest_, below);
  }
  triangles_.reserve(triangle);
  rectangles_.reserve(rectangle);
  for (int k = 0; k < v.supernodes; ++k) {
    const Supernode& node = nodes_[std::size_t(k)];
    const int rows = node.columns + node.rowsBelow;
    for (int j = 0; j < node.columns; ++j) {
      const double* column = v.x + v.px[k] + std::size_t(j) * std::size_t(rows);
      triangles_.push_back(Scalar(scale_ / column[j]));
      for (int i = j + 1; i < node.columns; ++i) triangles_.push_back(Scalar(column[i] / scale_));
      for (int i = node.columns; i < rows; ++i) rectangles_.push_back(Scalar(column[i] / scale_));
    }
  }
}

template <class Scalar>
typename SupernodalFactor<Scalar>::Matrix SupernodalFactor<Scalar>::triangleOf(const Supernode& node) const {
  Matrix T = Matrix::Zero(node.columns, node.columns);
  const Scalar* from = triangles_.data() + node.triangle;
  for (int j = 0; j < node.columns; ++j) {
    T(j, j) = 1 / *from++;
    for (int i = j + 1; i < node.columns; ++i) T(i, j) = *from++;
  }
  return T;
}

template <class Scalar>
void SupernodalFactor<Scalar>::forward(Matrix& X) const {
  const Teuchos::BLAS<int, Scalar> blas;
  const int n = int(X.rows()), m = int(X.cols());
  Matrix below(largest_, m);
  for (const Supernode& node : nodes_) {
    const Matrix T = triangleOf(node);
    blas.TRSM(Teuchos::LEFT_SIDE, Teuchos::LOWER_TRI, Teuchos::NO_TRANS, Teuchos::NON_UNIT_DIAG, node.columns, m, 1, T.data(),
              node.columns, X.data() + node.first, n);
    if (node.rowsBelow == 0) continue;
    blas.GEMM(Teuchos::NO_TRANS, Teuchos::NO_TRANS, node.rowsBelow, m, node.columns, 1, rectangles_.data() + node.rectangle,
              node.rowsBelow, X.data() + node.first, n, 0, below.data(), largest_);
    const int* rows = rowsBelow_.data() + node.rows;
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < node.rowsBelow; ++i) X(rows[i], j) -= below(i, j);
  }
}

template <class Scalar>
void SupernodalFactor<Scalar>::backward(Matrix& X) const {
  const Teuchos::BLAS<int, Scalar> blas;
  const int n = int(X.rows()), m = int(X.cols());
  Matrix below(largest_, m);
  for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {
    const int* rows = rowsBelow_.data() + node->rows;
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < node->rowsBelow; ++i) below(i, j) = X(rows[i], j);
    if (node->rowsBelow > 0)
      blas.GEMM(Teuchos::TRANS, Teuchos::NO_TRANS, node->columns, m, node->rowsBelow, -1, rectangles_.data() + node->rectangle,
                node->rowsBelow, below.data(), largest_, 1, X.data() + node->first, n);
    const Matrix T = triangleOf(*node);
    blas.TRSM(Teuchos::LEFT_SIDE, Teuchos::LOWER_TRI, Teuchos::TRANS, Teuchos::NON_UNIT_DIAG, node->columns, m, 1, T.data(),
              node->columns, X.data() + node->first, n);
  }
}

template <class Scalar>
void SupernodalFactor<Scalar>::solve(const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::Ref<Eigen::MatrixXd> X) const {
  TEUCHOS_ASSERT(B.rows() == rows() && X.rows() == B.rows() && X.cols() == B.cols());
  if (B.size() == 0) return;
  const double largest = std::is_same<Scalar, float>::value ? B.cwiseAbs().maxCoeff() : 1.0;
  const double unit = largest > 0 ? largest : 1.0;
  Matrix Y(B.rows(), B.cols());
  for (Eigen::Index j = 0; j < B.cols(); ++j)
    for (Eigen::Index i = 0; i < B.rows(); ++i) Y(i, j) = Scalar(B(perm_[std::size_t(i)], j) / unit);
  if (B.cols() == 1) {
    std::vector<Scalar> work(std::size_t(largest_) + 1);
    sweep({nodes_, triangles_.data(), rectangles_.data(), rowsBelow_.data()}, Y.data(), work.data());
  } else {
    forward(Y);
    backward(Y);
  }
  const double back = unit / (scale_ * scale_);
  for (Eigen::Index j = 0; j < B.cols(); ++j)
    for (Eigen::Index i = 0; i < B.rows(); ++i) X(perm_[std::size_t(i)], j) = back * double(Y(i, j));
}

template class SupernodalFactor<double>;
template class SupernodalFactor<float>;

}  // namespace Haptos
