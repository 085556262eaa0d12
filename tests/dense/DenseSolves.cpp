// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

#include "DenseAlgebra.hpp"

namespace Haptos::Testing {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd inverse(const MatrixXd& A) { return A.inverse(); }
VectorXd luSolve(const MatrixXd& A, const VectorXd& b) { return A.partialPivLu().solve(b); }
MatrixXd choleskySolve(const MatrixXd& A, const MatrixXd& B) { return A.llt().solve(B); }
MatrixXd ldltSolve(const MatrixXd& A, const MatrixXd& B) { return A.ldlt().solve(B); }

double choleskyRcond(const MatrixXd& A) {
  const Eigen::LLT<MatrixXd> factor(A);
  return factor.info() == Eigen::Success ? factor.rcond() : 0.0;
}

VectorXd qrSolve(const MatrixXd& A, const VectorXd& b) { return A.colPivHouseholderQr().solve(b); }
MatrixXd leastNormSolve(const MatrixXd& A, const MatrixXd& B) { return A.completeOrthogonalDecomposition().solve(B); }
MatrixXd pseudoInverse(const MatrixXd& A) { return A.completeOrthogonalDecomposition().pseudoInverse(); }

Solve luFactor(const MatrixXd& A) {
  return [factor = Eigen::PartialPivLU<MatrixXd>(A)](const VectorXd& b) { return VectorXd(factor.solve(b)); };
}

Solve ldltFactor(const MatrixXd& A) {
  return [factor = Eigen::LDLT<MatrixXd>(A)](const VectorXd& b) { return VectorXd(factor.solve(b)); };
}

MatrixXd squareQ(const MatrixXd& A) { return Eigen::HouseholderQR<MatrixXd>(A).householderQ(); }
MatrixXd thinQ(const MatrixXd& A) { return Eigen::HouseholderQR<MatrixXd>(A).householderQ() * MatrixXd::Identity(A.rows(), A.cols()); }

std::vector<int> pivotedColumns(const MatrixXd& A) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(A);
  const auto& indices = qr.colsPermutation().indices();
  return {indices.data(), indices.data() + indices.size()};
}

MatrixXd nullSpace(const MatrixXd& A, double threshold) {
  Eigen::FullPivLU<MatrixXd> lu(A);
  lu.setThreshold(threshold);
  return lu.kernel();
}

}  // namespace Haptos::Testing
