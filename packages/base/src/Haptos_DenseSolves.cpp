// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

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

// P A P^T = L D L^T, x = P^T L^-T D^+ L^-1 P b: pivots that are round-off count as 0.
Eigen::VectorXd PivotedLdlt::solve(const Eigen::VectorXd& b, double least) const {
  Eigen::VectorXd x = factor_->transpositionsP() * b;
  factor_->matrixL().solveInPlace(x);
  const auto pivots = factor_->vectorD();
  for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = pivots[i] > least ? x[i] / pivots[i] : 0.0;
  factor_->matrixU().solveInPlace(x);
  return factor_->transpositionsP().transpose() * x;
}

Eigen::VectorXd solveByLdlt(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) { return A.ldlt().solve(b); }
Eigen::VectorXd solveByLu(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) { return A.partialPivLu().solve(b); }

Eigen::VectorXd solveLeastSquares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double threshold) {
  if (A.size() == 0) return Eigen::VectorXd::Zero(A.cols());  // the decomposition looks for a largest column
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> qr;
  if (threshold > 0) qr.setThreshold(threshold);
  return qr.compute(A).solve(b);
}

Eigen::MatrixXd orthonormalBasis(const Eigen::MatrixXd& A) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(A).householderQ() * Eigen::MatrixXd::Identity(A.rows(), A.cols());
}

void factorQrInPlace(Eigen::MatrixXd& A) { Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(A); }

}  // namespace Haptos
