// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Teuchos_LAPACK.hpp>
#include <algorithm>
#include <limits>
#include <vector>

#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {

// A P = Q R: the columns of A that pivoting finds independent, and Q.
PivotedQr::PivotedQr(const Eigen::MatrixXd& A) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
  for (Eigen::Index k = 0; k < qr.rank(); ++k) columns.push_back(qr.colsPermutation().indices()[k]);
  Q = qr.householderQ() * Eigen::MatrixXd::Identity(A.rows(), std::min(A.rows(), A.cols()));
}

struct PivotedLdlt::Factor : Eigen::LDLT<Eigen::MatrixXd> {
  using LDLT::LDLT;
};

PivotedLdlt::PivotedLdlt(const Eigen::MatrixXd& A) : factor_(std::make_unique<Factor>(A)) {}
PivotedLdlt::~PivotedLdlt() = default;

// P A P^T = L D L^T, X = P^T L^-T D^+ L^-1 P B: pivots that are round-off count as 0.
Eigen::MatrixXd PivotedLdlt::solve(const Eigen::MatrixXd& B, double least) const {
  Eigen::MatrixXd X = factor_->transpositionsP() * B;
  factor_->matrixL().solveInPlace(X);
  const auto pivots = factor_->vectorD();
  for (Eigen::Index i = 0; i < X.rows(); ++i) X.row(i) *= pivots[i] > least ? 1 / pivots[i] : 0.0;
  factor_->matrixU().solveInPlace(X);
  return factor_->transpositionsP().transpose() * X;
}

Eigen::VectorXd solveByLdlt(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) { return A.ldlt().solve(b); }

// LAPACK's, which runs at the speed of the machine's BLAS: Eigen's took four times as long from 300 rows on.
Eigen::VectorXd solveByLu(Eigen::MatrixXd A, Eigen::VectorXd b) {
  const int n = int(b.size());
  std::vector<int> pivots(std::size_t(n) + 1);
  int info = 0;
  Teuchos::LAPACK<int, double>().GESV(n, 1, A.data(), std::max(1, n), pivots.data(), b.data(), std::max(1, n), &info);
  if (info > 0) b.setConstant(std::numeric_limits<double>::quiet_NaN());
  return b;
}

Eigen::VectorXd solveByCholesky(Eigen::MatrixXd A, Eigen::VectorXd b) {
  const int n = int(b.size());
  int info = 0;
  Teuchos::LAPACK<int, double>().POSV('L', n, 1, A.data(), std::max(1, n), b.data(), std::max(1, n), &info);
  if (info > 0) b.setConstant(std::numeric_limits<double>::quiet_NaN());
  return b;
}

Eigen::VectorXd solveLeastSquares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double threshold) {
  if (A.size() == 0) return Eigen::VectorXd::Zero(A.cols());  // the decomposition looks for a largest column
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> qr;
  if (threshold > 0) qr.setThreshold(threshold);
  return qr.compute(A).solve(b);
}

Eigen::VectorXd solveByPivotedQr(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) { return A.colPivHouseholderQr().solve(b); }

Eigen::MatrixXd orthonormalBasis(const Eigen::MatrixXd& A) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(A).householderQ() * Eigen::MatrixXd::Identity(A.rows(), A.cols());
}

void factorQrInPlace(Eigen::MatrixXd& A) { Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(A); }

}  // namespace Haptos
