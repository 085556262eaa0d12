// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DenseDecompositions.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <Teuchos_Assert.hpp>
#include <Teuchos_LAPACK.hpp>
#include <vector>

namespace Haptos {
namespace {

// By LAPACK's QR iteration.
template <class Result>
void decomposeByLapack(Eigen::MatrixXd A, Result& result) {
  const int n = int(A.rows());
  Eigen::VectorXd values(n);
  std::vector<double> work(std::size_t(34 * n));  // blocks of 32
  int info = 0;
  Teuchos::LAPACK<int, double>().SYEV('V', 'U', n, A.data(), n, values.data(), work.data(), int(work.size()), &info);
  TEUCHOS_TEST_FOR_EXCEPTION(info != 0, std::runtime_error, "the eigenvalues of a symmetric matrix of size " << n << " were not found");
  result.values = values;
  result.vectors = A;
}

// Eigenvalues ascend.  Eigen's iteration, which is bounded, was seen to end before the last eigenvalue of a spectrum from 1e-5 to 540: without
// order, and no message.
template <class Result, class Matrix>
void decompose(const Matrix& A, Result& result) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(A);
  if (eigen.info() != Eigen::Success) return decomposeByLapack(A, result);
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
