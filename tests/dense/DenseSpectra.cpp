// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include "DenseAlgebra.hpp"

namespace Haptos::Testing {

using Eigen::MatrixXd;
using Eigen::VectorXd;

SymmetricSpectrum::SymmetricSpectrum(const MatrixXd& A) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(A);
  values = eigen.eigenvalues();
  vectors = eigen.eigenvectors();
}

VectorXd symmetricEigenvalues(const MatrixXd& A) { return Eigen::SelfAdjointEigenSolver<MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues(); }

VectorXd generalizedEigenvalues(const MatrixXd& A, const MatrixXd& B) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(A, B).eigenvalues();
}

VectorXd realEigenvalues(const MatrixXd& A) { return Eigen::EigenSolver<MatrixXd>(A, false).eigenvalues().real(); }

VectorXd singularValues(const MatrixXd& A) { return Eigen::JacobiSVD<MatrixXd>(A).singularValues(); }

}  // namespace Haptos::Testing
