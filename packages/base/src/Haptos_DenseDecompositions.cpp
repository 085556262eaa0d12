// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DenseDecompositions.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace Haptos {
namespace {

// Eigenvalues ascend.
template <class Result, class Matrix>
void decompose(const Matrix& A, Result& result) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(A);
  result.values = eigen.eigenvalues();
  result.vectors = eigen.eigenvectors();
}

}  // namespace

SymmetricEigen::SymmetricEigen(const Eigen::MatrixXd& A) { decompose(A, *this); }
SymmetricEigen2::SymmetricEigen2(const Eigen::Matrix2d& A) { decompose(A, *this); }
SymmetricEigen3::SymmetricEigen3(const Eigen::Matrix3d& A) { decompose(A, *this); }

RightSvd::RightSvd(const Eigen::MatrixXd& A) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullV);
  values = svd.singularValues();
  V = svd.matrixV();
}

}  // namespace Haptos
