// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DenseSymmetric.hpp"

#include <Teuchos_Assert.hpp>
#include <Teuchos_BLAS.hpp>
#include <Teuchos_LAPACK.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_MoreBlas.hpp"

namespace Haptos {
namespace {

int leading(const Eigen::MatrixXd& A) { return std::max(1, int(A.outerStride())); }

// The lower triangle by columns, times a factor.
template <class Scalar, class Matrix>
std::vector<Scalar> pack(const Matrix& lower, double factor) {
  const Eigen::Index n = lower.rows();
  std::vector<Scalar> packed(std::size_t(n) * std::size_t(n + 1) / 2);
  Scalar* to = packed.data();
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = j; i < n; ++i) *to++ = Scalar(factor * double(lower(i, j)));
  return packed;
}

// Both triangles, times a factor.
template <class Scalar>
std::vector<Scalar> unfold(const Eigen::MatrixXd& lower, double factor) {
  const Eigen::Index n = lower.rows();
  std::vector<Scalar> full(std::size_t(n) * std::size_t(n));
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = j; i < n; ++i) full[std::size_t(j * n + i)] = full[std::size_t(i * n + j)] = Scalar(factor * lower(i, j));
  return full;
}

// Y [n x m] := A X; a few columns are faster one by one.
template <class Scalar>
void multiplyFull(const Scalar* A, int n, int m, const Scalar* X, int ldX, Scalar* Y, int ldY) {
  constexpr int kFew = 3;
  const Teuchos::BLAS<int, Scalar> blas;
  if (m > kFew) return blas.GEMM(Teuchos::NO_TRANS, Teuchos::NO_TRANS, n, m, n, Scalar(1), A, n, X, ldX, Scalar(0), Y, ldY);
  for (int j = 0; j < m; ++j)
    blas.GEMV(Teuchos::NO_TRANS, n, n, Scalar(1), A, n, X + std::ptrdiff_t(j) * ldX, 1, Scalar(0), Y + std::ptrdiff_t(j) * ldY, 1);
}

// Y [n x m] := A X by both triangles of a packed A: many columns are worth the copy.
template <class Scalar>
void multiplyUnpacked(const std::vector<Scalar>& A, int n, int m, const Scalar* X, int ldX, Scalar* Y, int ldY) {
  std::vector<Scalar> full(std::size_t(n) * std::size_t(n));  // the lower triangle of it
  const Scalar* from = A.data();
  for (std::size_t j = 0; j < std::size_t(n); ++j, from += std::size_t(n) - j + 1) std::copy_n(from, std::size_t(n) - j, full.data() + j * std::size_t(n) + j);
  Teuchos::BLAS<int, Scalar>().SYMM(Teuchos::LEFT_SIDE, Teuchos::LOWER_TRI, n, m, Scalar(1), full.data(), n, X, ldX, Scalar(0), Y, ldY);
}

constexpr int kManyColumns = 8;  // of a product with a packed matrix, which are worth its copy

}  // namespace

namespace Lapack {

bool choleskyInPlace(Eigen::MatrixXd& A) {
  if (A.rows() == 0) return true;
  int info = 0;
  Teuchos::LAPACK<int, double>().POTRF('L', int(A.rows()), A.data(), leading(A), &info);
  return info == 0;
}

// POTRI writes the lower triangle of the inverse over L.
void invertFromCholesky(Eigen::MatrixXd& L) {
  if (L.rows() == 0) return;
  int info = 0;
  Teuchos::LAPACK<int, double>().POTRI('L', int(L.rows()), L.data(), leading(L), &info);
  TEUCHOS_ASSERT_EQUALITY(info, 0);
}

void solveLower(const Eigen::MatrixXd& L, Eigen::MatrixXd& B) {
  if (B.size() == 0) return;
  Teuchos::BLAS<int, double>().TRSM(Teuchos::LEFT_SIDE, Teuchos::LOWER_TRI, Teuchos::NO_TRANS, Teuchos::NON_UNIT_DIAG,
                                    int(B.rows()), int(B.cols()), 1.0, L.data(), leading(L), B.data(), leading(B));
}

// SYRK: half of the operations of A^T A by GEMM
void subtractGram(const Eigen::MatrixXd& A, Eigen::MatrixXd& C) {
  if (A.size() == 0) return;
  Teuchos::BLAS<int, double>().SYRK(Teuchos::LOWER_TRI, Teuchos::TRANS, int(A.cols()), int(A.rows()), -1.0, A.data(), leading(A),
                                    1.0, C.data(), leading(C));
}

// SYR2K: both products at the price of one, one triangle written
void addSymmetricProduct(double alpha, const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, Eigen::MatrixXd& C) {
  if (A.size() == 0) return;
  Blas::syr2k(int(A.rows()), int(A.cols()), alpha, A.data(), leading(A), B.data(), leading(B), C.data(), leading(C));
}

std::vector<double> packLower(const Eigen::MatrixXd& A) { return pack<double>(A, 1); }

void unpackLower(const std::vector<double>& packed, Eigen::MatrixXd& A) {
  TEUCHOS_ASSERT(packed.size() == std::size_t(A.rows()) * std::size_t(A.rows() + 1) / 2);
  const double* from = packed.data();
  for (Eigen::Index j = 0; j < A.rows(); ++j)
    for (Eigen::Index i = j; i < A.rows(); ++i) A(i, j) = *from++;
}

}  // namespace Lapack

// Single precision holds A / scale, scale the largest diagonal entry.
DenseSymmetric::DenseSymmetric(const Eigen::MatrixXd& lower, Storage storage, Precision precision)
    : n_(lower.rows()), storage_(storage) {
  TEUCHOS_ASSERT(lower.rows() == lower.cols());
  const bool packed = storage == Storage::Packed;
  if (precision == Precision::Double) {
    doubles_ = packed ? pack<double>(lower, 1) : unfold<double>(lower, 1);
    return;
  }
  // the largest entry of a semidefinite matrix is on its diagonal
  for (Eigen::Index j = 0; j < n_; ++j) scale_ = std::max(j == 0 ? 0.0 : scale_, std::abs(lower(j, j)));
  if (scale_ == 0) scale_ = 1;
  singles_ = packed ? pack<float>(lower, 1 / scale_) : unfold<float>(lower, 1 / scale_);
}

// Full matrices by BLAS 3, packed ones column by column if columns are few: SPMV reads half of the bytes of GEMV.
void DenseSymmetric::apply(const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::Ref<Eigen::MatrixXd> Y) const {
  TEUCHOS_ASSERT(X.rows() == n_ && Y.rows() == n_ && X.cols() == Y.cols());
  if (X.size() == 0) return;
  if (!singles_.empty()) return applySingle(X, Y);
  const int n = int(n_);
  if (storage_ == Storage::Full)
    return multiplyFull(doubles_.data(), n, int(X.cols()), X.data(), int(X.outerStride()), Y.data(), int(Y.outerStride()));
  if (X.cols() >= kManyColumns)
    return multiplyUnpacked(doubles_, n, int(X.cols()), X.data(), int(X.outerStride()), Y.data(), int(Y.outerStride()));
  for (Eigen::Index j = 0; j < X.cols(); ++j)
    Blas::spmv(n, doubles_.data(), X.col(j).data(), Y.col(j).data());
}

// y = (A / scale) (x / unit) in single precision: neither factor can overflow or vanish, whatever the units.
void DenseSymmetric::applySingle(const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::Ref<Eigen::MatrixXd> Y) const {
  const int n = int(n_), m = int(X.cols());
  const double largest = X.cwiseAbs().maxCoeff(), unit = largest > 0 ? largest : 1.0;
  Eigen::MatrixXf x = (X / unit).cast<float>(), y(n_, X.cols());
  if (storage_ == Storage::Full) multiplyFull(singles_.data(), n, m, x.data(), n, y.data(), n);
  else if (m >= kManyColumns) multiplyUnpacked(singles_, n, m, x.data(), n, y.data(), n);
  else
    for (int j = 0; j < m; ++j) Blas::spmv(n, singles_.data(), x.col(j).data(), y.col(j).data());
  Y = y.cast<double>() * (scale_ * unit);
}

// Entry (i, j), i >= j: column j of the packed triangle begins at j n - j (j - 1) / 2 with (j, j).
Eigen::MatrixXd DenseSymmetric::block(const std::vector<int>& c) const {
  const Eigen::Index m = Eigen::Index(c.size());
  const auto at = [&](Eigen::Index i, Eigen::Index j) {  // i >= j
    const auto k = std::size_t(storage_ == Storage::Packed ? j * n_ - j * (j + 1) / 2 + i : j * n_ + i);
    return singles_.empty() ? doubles_[k] : scale_ * double(singles_[k]);
  };
  Eigen::MatrixXd part(m, m);
  for (Eigen::Index j = 0; j < m; ++j)
    for (Eigen::Index i = 0; i < m; ++i) {
      const Eigen::Index a = c[std::size_t(i)], b = c[std::size_t(j)];
      part(i, j) = at(std::max(a, b), std::min(a, b));
    }
  return part;
}

std::size_t DenseSymmetric::bytes(Eigen::Index n, Storage storage, Precision precision) {
  const std::size_t entries = storage == Storage::Packed ? std::size_t(n) * std::size_t(n + 1) / 2 : std::size_t(n) * std::size_t(n);
  return entries * (precision == Precision::Double ? sizeof(double) : sizeof(float));
}

DenseCholesky::DenseCholesky(Eigen::MatrixXd L, DenseSymmetric::Storage storage) : n_(L.rows()) {
  if (storage == DenseSymmetric::Storage::Full) full_ = std::move(L);
  else packed_ = Lapack::packLower(L);
}

// x = L^-T L^-1 b: BLAS 2 for one column, which reads L twice, BLAS 3 for many; a packed L has BLAS 2 only.
void DenseCholesky::solve(Eigen::Ref<Eigen::MatrixXd> B) const {
  TEUCHOS_ASSERT(B.rows() == n_);
  if (B.size() == 0) return;
  const int n = int(n_);
  if (packed_.empty() && B.cols() == 1) {
    for (const bool transposed : {false, true}) Blas::trsv(transposed, n, full_.data(), B.data());
    return;
  }
  if (packed_.empty()) {
    for (const Teuchos::ETransp side : {Teuchos::NO_TRANS, Teuchos::TRANS})
      Teuchos::BLAS<int, double>().TRSM(Teuchos::LEFT_SIDE, Teuchos::LOWER_TRI, side, Teuchos::NON_UNIT_DIAG, n, int(B.cols()), 1.0,
                                        full_.data(), leading(full_), B.data(), int(B.outerStride()));
    return;
  }
  for (Eigen::Index j = 0; j < B.cols(); ++j)
    for (const bool transposed : {false, true}) Blas::tpsv(transposed, n, packed_.data(), B.col(j).data());
}

// D A D = L L^T with D = diag(A)^-1/2, so that entries are at most 1 and pivots lie in (0, 1].  What comes back from A x, x known,
// tells the digits that are left, at the price of a product.
bool SingleCholesky::factor(const Eigen::MatrixXd& A) {
  constexpr double kThreeDigits = 1e-3;
  const Eigen::Index n = A.rows();
  if (n == 0) return true;
  if (!(A.diagonal().minCoeff() > 0)) return false;
  scale_ = A.diagonal().cwiseSqrt().cwiseInverse();
  Eigen::MatrixXf L(n, n);
  for (Eigen::Index j = 0; j < n; ++j)
    L.col(j).tail(n - j) = (scale_[j] * scale_.tail(n - j).cwiseProduct(A.col(j).tail(n - j))).cast<float>();
  int info = 0;
  Teuchos::LAPACK<int, float>().POTRF('L', int(n), L.data(), int(n), &info);
  if (info != 0) return false;
  L_ = pack<float>(L, 1);
  Eigen::VectorXd known(n);  // in the scale of the unknowns
  for (Eigen::Index i = 0; i < n; ++i) known[i] = std::sin(1.0 + 7.0 * double(i)) * scale_[i];
  Eigen::MatrixXd x = A.selfadjointView<Eigen::Lower>() * known;
  solve(x);
  return (x - known).cwiseQuotient(scale_).norm() <= kThreeDigits * known.cwiseQuotient(scale_).norm();  // false for a NaN
}

// A^-1 b = D L^-T L^-1 D b
void SingleCholesky::solve(Eigen::Ref<Eigen::MatrixXd> B) const {
  TEUCHOS_ASSERT(B.rows() == scale_.size());
  const int n = int(B.rows());
  for (Eigen::Index j = 0; j < B.cols() && n > 0; ++j) {
    const Eigen::VectorXd b = B.col(j).cwiseProduct(scale_);
    const double largest = b.cwiseAbs().maxCoeff(), unit = largest > 0 ? largest : 1.0;
    Eigen::VectorXf x = (b / unit).cast<float>();
    for (const bool transposed : {false, true}) Blas::tpsv(transposed, n, L_.data(), x.data());
    B.col(j) = unit * scale_.cwiseProduct(x.cast<double>());
  }
}

}  // namespace Haptos
