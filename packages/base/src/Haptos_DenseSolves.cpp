// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Teuchos_BLAS.hpp>
#include <Teuchos_LAPACK.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "Haptos_DenseDecompositions.hpp"

// Teuchos has none with pivoting.
extern "C" void dpstrf_(const char* uplo, const int* n, double* A, const int* lda, int* pivots, int* rank, const double* least, double* work,
                        int* info);

namespace Haptos {

// OpenBLAS' kernels of 2004 (decisions/044) read y up to 32 bytes beyond its end, where there may be no memory.
Eigen::VectorXd symmetricTimes(const Eigen::MatrixXd& A, const Eigen::VectorXd& x) {
  constexpr int kReadAhead = 4;
  const int n = int(A.rows()), stride = 1;
  const double one = 1, zero = 0;
  Eigen::VectorXd y(n + kReadAhead);
  if (n > 0) dsymv_("L", &n, &one, A.data(), &n, x.data(), &stride, &zero, y.data(), &stride);
  return y.head(n);
}

namespace {

// y += alpha op(A) x; a BLAS complains of empty matrices.
void addGemv(Teuchos::ETransp op, double alpha, const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::VectorXd>& x,
             Eigen::Ref<Eigen::VectorXd>& y) {
  if (A.size() == 0) return;
  Teuchos::BLAS<int, double>().GEMV(op, int(A.rows()), int(A.cols()), alpha, A.data(), int(A.outerStride()), x.data(), 1, 1.0, y.data(), 1);
}

}  // namespace

void addProduct(double alpha, const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::Ref<Eigen::VectorXd> y) {
  addGemv(Teuchos::NO_TRANS, alpha, A, x, y);
}

void addTransposedProduct(double alpha, const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::VectorXd>& x,
                          Eigen::Ref<Eigen::VectorXd> y) {
  addGemv(Teuchos::TRANS, alpha, A, x, y);
}

Eigen::MatrixXd product(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::MatrixXd>& X) {
  if (X.cols() != 1) return A * X;
  Eigen::MatrixXd y = Eigen::MatrixXd::Zero(A.rows(), 1);
  addProduct(1, A, X.col(0), y.col(0));
  return y;
}

Eigen::MatrixXd transposedProduct(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::MatrixXd>& X) {
  if (X.cols() != 1) return A.transpose() * X;
  Eigen::MatrixXd y = Eigen::MatrixXd::Zero(A.cols(), 1);
  addTransposedProduct(1, A, X.col(0), y.col(0));
  return y;
}

// A P = Q R: the columns of A that pivoting finds independent, and Q.
PivotedQr::PivotedQr(const Eigen::MatrixXd& A) : Q(A.rows(), 0) {
  if (A.size() == 0) return;  // the decomposition looks for a largest column
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
  for (Eigen::Index k = 0; k < qr.rank(); ++k) columns.push_back(qr.colsPermutation().indices()[k]);
  Q = qr.householderQ() * Eigen::MatrixXd::Identity(A.rows(), std::min(A.rows(), A.cols()));
}

PivotedCholesky::PivotedCholesky(Eigen::MatrixXd A, double least) : size_(A.rows()) {
  const int n = int(size_);
  std::vector<int> pivots(static_cast<std::size_t>(n));
  std::vector<double> work(std::size_t(2 * n));
  int rank = 0, info = 0;
  if (n > 0) dpstrf_("L", &n, A.data(), &n, pivots.data(), &rank, &least, work.data(), &info);
  L_ = A.topLeftCorner(rank, rank);
  for (int k = 0; k < rank; ++k) pivots_.push_back(pivots[std::size_t(k)] - 1);
}

Eigen::MatrixXd PivotedCholesky::solveHalf(const Eigen::MatrixXd& B) const {
  Eigen::MatrixXd X(rank(), B.cols());
  if (X.size() == 0) return X;  // a rank without contact rows asks for no column, and Eigen would take the address of the first
  for (Eigen::Index k = 0; k < rank(); ++k) X.row(k) = B.row(pivots_[std::size_t(k)]);
  L_.triangularView<Eigen::Lower>().solveInPlace(X);
  return X;
}

Eigen::MatrixXd PivotedCholesky::solve(const Eigen::MatrixXd& B) const {
  Eigen::MatrixXd X = solveHalf(B), all = Eigen::MatrixXd::Zero(size_, B.cols());
  if (X.size() == 0) return all;
  L_.triangularView<Eigen::Lower>().transpose().solveInPlace(X);
  for (Eigen::Index k = 0; k < rank(); ++k) all.row(pivots_[std::size_t(k)]) = X.row(k);
  return all;
}

Eigen::VectorXd solveByLdlt(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) { return A.ldlt().solve(b); }

// LAPACK's, which runs at the speed of the machine's BLAS: Eigen's took four times as long from 300 rows on.
DenseFactor::DenseFactor(Eigen::MatrixXd A, Kind kind) : kind_(kind), factor_(std::move(A)), pivots_(std::size_t(factor_.rows()) + 1) {
  const int n = int(factor_.rows()), rows = std::max(1, n);
  int info = 0;
  if (kind_ == Kind::Cholesky) Teuchos::LAPACK<int, double>().POTRF('L', n, factor_.data(), rows, &info);
  else Teuchos::LAPACK<int, double>().GETRF(n, n, factor_.data(), rows, pivots_.data(), &info);
  isRegular_ = info == 0;
}

Eigen::MatrixXd DenseFactor::solve(Eigen::MatrixXd B, char transposed) const {
  const int n = int(factor_.rows()), rows = std::max(1, n), columns = int(B.cols());
  int info = 0;
  if (!isRegular_) B.setConstant(std::numeric_limits<double>::quiet_NaN());
  else if (kind_ == Kind::Cholesky) Teuchos::LAPACK<int, double>().POTRS('L', n, columns, factor_.data(), rows, B.data(), rows, &info);
  else Teuchos::LAPACK<int, double>().GETRS(transposed, n, columns, factor_.data(), rows, pivots_.data(), B.data(), rows, &info);
  return B;
}

Eigen::MatrixXd solveByLu(Eigen::MatrixXd A, Eigen::MatrixXd B) { return DenseFactor(std::move(A), DenseFactor::Kind::Lu).solve(std::move(B)); }

Eigen::MatrixXd inverseByCholesky(Eigen::MatrixXd A) {
  const int n = int(A.rows()), rows = std::max(1, n);
  int info = 0;
  Teuchos::LAPACK<int, double>().POTRF('L', n, A.data(), rows, &info);
  if (info == 0) Teuchos::LAPACK<int, double>().POTRI('L', n, A.data(), rows, &info);
  if (info != 0) return {};
  A.triangularView<Eigen::StrictlyUpper>() = A.transpose();
  return A;
}

namespace {

// An upper bound of the largest absolute eigenvalue of a symmetric matrix.
double largestRowSum(const Eigen::MatrixXd& A) {
  const Eigen::MatrixXd all = A.selfadjointView<Eigen::Lower>();
  return all.cwiseAbs().colwise().sum().maxCoeff();  // as those of rows, and read as they lie
}

Eigen::MatrixXd pseudoInverseByEigenvectors(const Eigen::MatrixXd& A, double least) {
  const SymmetricEigen eigen(A);
  const auto isFelt = eigen.values.array() > least * eigen.values[A.rows() - 1];
  const Eigen::VectorXd roots = isFelt.select(eigen.values.array().abs().sqrt().inverse(), 0.0);
  const Eigen::MatrixXd V = eigen.vectors * roots.asDiagonal();
  return V * V.transpose();
}

}  // namespace

// (A + w N N^T)^-1 = A^+ + N N^T / w, if no eigenvalue but those of the kernel N is as small as round-off: bounds of the norms of A and of the
// inverse tell.
Eigen::MatrixXd pseudoInverse(const Eigen::MatrixXd& A, const Eigen::MatrixXd& kernel, double least) {
  if (A.rows() == 0) return A;
  const double weight = A.diagonal().mean();
  Eigen::MatrixXd inverse = inverseByCholesky(A + weight * kernel * kernel.transpose());
  if (inverse.size() == 0 || !(least * largestRowSum(A) * largestRowSum(inverse) < 1)) return pseudoInverseByEigenvectors(A, least);
  inverse.noalias() -= kernel * (kernel.transpose() / weight);
  return inverse;
}

Eigen::VectorXd solveLeastSquares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double threshold) {
  if (A.size() == 0) return Eigen::VectorXd::Zero(A.cols());  // the decomposition looks for a largest column
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> qr;
  if (threshold > 0) qr.setThreshold(threshold);
  return qr.compute(A).solve(b);
}

namespace {

// Columns of X that A has nothing of, combined: X^T X = 1.
Eigen::MatrixXd kernelIn(const Eigen::MatrixXd& X, const Eigen::MatrixXd& AX, double nothing) {
  if (!AX.allFinite()) return X;
  const RightSvd svd(AX);
  return X * svd.V.rightCols((svd.values.array() <= nothing).count());
}

}  // namespace

// Inverse iteration on a block, A^-1 and A^-T by turns, finds bases V of the kernel and U of what A does not reach.  A + w U V^T is regular, and
//
//   x = (1 - V V^T) (A + w U V^T)^-1 (1 - U U^T) b.
Eigen::VectorXd solveNearlySingular(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, Eigen::Index most) {
  constexpr Eigen::Index kSmall = 200;  // rows: the other way takes milliseconds
  const Eigen::Index n = A.rows(), k = most + 1;
  if (n <= std::max(kSmall, 2 * k)) return solveLeastSquares(A, b);
  const double nothing = double(n) * std::numeric_limits<double>::epsilon() * A.norm();
  Eigen::MatrixXd shifted = A;
  shifted.diagonal().array() += 0.01 * nothing;  // no pivot is exactly 0
  const DenseFactor factor(std::move(shifted), DenseFactor::Kind::Lu);
  Eigen::MatrixXd U, V = orthonormalBasis(Eigen::MatrixXd::NullaryExpr(n, k, [](Eigen::Index i, Eigen::Index j) { return std::sin(double(1 + i) * double(2 + j)); }));
  for (int turn = 0; turn < 2; ++turn) {
    U = orthonormalBasis(factor.solveTransposed(V));
    V = orthonormalBasis(factor.solve(U));
  }
  U = kernelIn(U, A.transpose() * U, nothing);
  V = kernelIn(V, A * V, nothing);
  if (U.cols() != V.cols() || V.cols() == k) return solveLeastSquares(A, b);
  const Eigen::VectorXd x = solveByLu(A + A.norm() / double(n) * U * V.transpose(), b - U * (U.transpose() * b));
  return x - V * (V.transpose() * x);
}

void addGram(const Eigen::MatrixXd& T, Eigen::MatrixXd& A) {
  const int n = int(T.cols()), m = int(T.rows());
  Teuchos::BLAS<int, double>().SYRK(Teuchos::LOWER_TRI, Teuchos::TRANS, n, m, 1.0, T.data(), std::max(1, m), 1.0, A.data(), std::max(1, n));
}

Eigen::VectorXd solveByPivotedQr(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) { return A.colPivHouseholderQr().solve(b); }

Eigen::MatrixXd orthonormalBasis(const Eigen::MatrixXd& A) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(A).householderQ() * Eigen::MatrixXd::Identity(A.rows(), A.cols());
}

void factorQrInPlace(Eigen::MatrixXd& A) { Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(A); }

}  // namespace Haptos
