// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DenseDecompositions.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <Teuchos_Assert.hpp>
#include <Teuchos_LAPACK.hpp>
#include <algorithm>
#include <cmath>
#include <vector>

// Teuchos has none by divide and conquer.
extern "C" void dsyevd_(const char* job, const char* uplo, const int* n, double* A, const int* lda, double* values, double* work, const int* lwork,
                        int* iwork, const int* liwork, int* info);

namespace Haptos {
namespace {

// By LAPACK's QR iteration.
template <class Result>
void decomposeByLapack(Eigen::MatrixXd A, Result& result) {
  const int n = int(A.rows());
  Eigen::VectorXd values(n);
  std::vector<double> work(std::size_t(34 * n));  // blocks of 32
  int info = 0;
  Teuchos::LAPACK<int, double>().SYEV('V', 'L', n, A.data(), n, values.data(), work.data(), int(work.size()), &info);
  TEUCHOS_TEST_FOR_EXCEPTION(info != 0, std::runtime_error, "the eigenvalues of a symmetric matrix of size " << n << " were not found");
  result.values = values;
  result.vectors = A;
}

// By LAPACK's divide and conquer: false where it fails.
bool decomposeByHalves(Eigen::MatrixXd A, SymmetricEigen& result) {
  const int n = int(A.rows()), lwork = 1 + n * (6 + 2 * n), liwork = 3 + 5 * n;
  Eigen::VectorXd values(n);
  std::vector<double> work(static_cast<std::size_t>(lwork));
  std::vector<int> iwork(static_cast<std::size_t>(liwork));
  int info = 0;
  dsyevd_("V", "L", &n, A.data(), &n, values.data(), work.data(), &lwork, iwork.data(), &liwork, &info);
  result.values = std::move(values);
  result.vectors = std::move(A);
  return info == 0;
}

// Eigenvalues ascend.  Eigen's iteration, which is bounded, was seen to end before the last eigenvalue of a spectrum from 1e-5 to 540: without
// order, and no message.
template <class Result, class Matrix>
void take(const Eigen::SelfAdjointEigenSolver<Matrix>& eigen, const Matrix& A, double scale, Result& result) {
  if (eigen.info() != Eigen::Success) return decomposeByLapack(A, result);
  result.values = eigen.eigenvalues() * scale;
  result.vectors = eigen.eigenvectors();
}

}  // namespace

// Eigen's rotations of vectors are bound by memory: five times the time of LAPACK's from some hundred rows on.
SymmetricEigen::SymmetricEigen(const Eigen::MatrixXd& A) {
  constexpr Eigen::Index kLarge = 100;
  if (A.rows() < kLarge || !decomposeByHalves(A, *this)) take(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A), A, 1.0, *this);
}
SymmetricEigen3::SymmetricEigen3(const Eigen::Matrix3d& A) { take(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(A), A, 1.0, *this); }

// Two rows are tridiagonal as they come.  Eigen does not know, and compiles reflections of 2 x 2 for four seconds; its digits are these.
SymmetricEigen2::SymmetricEigen2(const Eigen::Matrix2d& A) {
  const double largest = std::max({std::abs(A(0, 0)), std::abs(A(1, 0)), std::abs(A(1, 1))}), scale = largest == 0 ? 1.0 : largest;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
  eigen.computeFromTridiagonal(A.diagonal() / scale, Eigen::Matrix<double, 1, 1>(A(1, 0) / scale));
  take(eigen, A, scale, *this);
}

SymmetricPencil::SymmetricPencil(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A, B);
  values = eigen.eigenvalues();
  vectors = eigen.eigenvectors();
}

RightSvd::RightSvd(const Eigen::MatrixXd& A) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullV);
  values = svd.singularValues();
  V = svd.matrixV();
}

}  // namespace Haptos
