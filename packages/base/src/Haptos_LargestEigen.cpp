// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "Haptos_DenseDecompositions.hpp"

// Teuchos has none in a range.
extern "C" void dsygvx_(const int* type, const char* job, const char* range, const char* uplo, const int* n, double* A, const int* lda, double* B,
                        const int* ldb, const double* lower, const double* upper, const int* first, const int* last, const double* tolerance,
                        int* found, double* values, double* vectors, const int* ldz, double* work, const int* lwork, int* iwork, int* failed,
                        int* info);

namespace Haptos {
namespace {

// By LAPACK, from a tridiagonal matrix that takes about 4/3 n^3 operations, half of them bound by memory.
void decomposeWhole(Eigen::MatrixXd A, Eigen::MatrixXd B, double least, LargestEigen& result) {
  const int n = int(A.rows()), type = 1, one = 1, lwork = 40 * std::max(1, n);  // blocks of 32
  // theta <= |A| / (least eigenvalue of B), which is not known; the tolerance is what LAPACK advises
  const double most = std::numeric_limits<double>::max(), tolerance = 2 * std::numeric_limits<double>::min();
  Eigen::VectorXd all(n), work(lwork);
  Eigen::MatrixXd Z(n, n);
  std::vector<int> iwork(std::size_t(5 * n)), failed(static_cast<std::size_t>(n));
  int found = 0, info = 0;
  if (n > 0)
    dsygvx_(&type, "V", "V", "L", &n, A.data(), &n, B.data(), &n, &least, &most, &one, &n, &tolerance, &found, all.data(), Z.data(), &n, work.data(),
            &lwork, iwork.data(), failed.data(), &info);
  if (info != 0) found = 0;
  result.values = all.head(found);
  result.vectors = Z.leftCols(found);
}

// Block Krylov space of C = L^-1 A L^-T, B = L L^T, with its Ritz values.  The first block is the same every time.
class BlockKrylov {
 public:
  static constexpr Eigen::Index kBlock = 32;

  BlockKrylov(const Eigen::MatrixXd& A, const Eigen::MatrixXd& L) : A_(A), L_(L) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> between(-1, 1);
    Eigen::MatrixXd start(A.rows(), kBlock);
    for (double& value : start.reshaped()) value = between(random);
    V_ = orthonormalBasis(start);
  }

  Eigen::Index size() const { return V_.cols(); }

  // Adds a block; whether all Ritz pairs above `least` are good to `tolerance`, relative.
  bool grow(double least, double tolerance) {
    const Eigen::Index m = V_.cols(), before = m - kBlock;
    Eigen::MatrixXd W = multiply(V_.rightCols(kBlock)), H = Eigen::MatrixXd::Zero(m, kBlock);
    for (int pass = 0; pass < 2; ++pass) {  // classical Gram-Schmidt, twice
      const Eigen::MatrixXd h = V_.transpose() * W;
      W -= V_ * h;
      H += h;
    }
    T_.conservativeResize(m, m);
    T_.rightCols(kBlock) = H;
    T_.bottomLeftCorner(kBlock, before) = H.topRows(before).transpose();
    const Eigen::MatrixXd Q = orthonormalBasis(W), R = Q.transpose() * W;
    const SymmetricEigen ritz(T_);
    const Eigen::Index count = (ritz.values.array() > least).count();
    values_ = ritz.values.tail(count);
    coefficients_ = ritz.vectors.rightCols(count);
    const Eigen::VectorXd residuals = (R * ritz.vectors.bottomRightCorner(kBlock, count)).colwise().norm();
    V_.conservativeResize(Eigen::NoChange, m + kBlock);
    V_.rightCols(kBlock) = Q;
    return (residuals.array() <= tolerance * values_.array()).all();
  }

  const Eigen::VectorXd& values() const { return values_; }
  Eigen::MatrixXd vectors() const {
    Eigen::MatrixXd vectors = V_.leftCols(coefficients_.rows()) * coefficients_;
    if (vectors.cols() > 0) L_.triangularView<Eigen::Lower>().transpose().solveInPlace(vectors);  // of none Eigen would take the address of the first
    return vectors;
  }

 private:
  Eigen::MatrixXd multiply(Eigen::MatrixXd X) const {
    L_.triangularView<Eigen::Lower>().transpose().solveInPlace(X);
    Eigen::MatrixXd Y = A_.selfadjointView<Eigen::Lower>() * X;
    L_.triangularView<Eigen::Lower>().solveInPlace(Y);
    return Y;
  }

  const Eigen::MatrixXd &A_, &L_;
  Eigen::MatrixXd V_, T_, coefficients_;  // of the Ritz vectors in V
  Eigen::VectorXd values_;
};

// Whether B theta - A is positive definite: then all eigenvalues are below theta.  Of the eigenproblem it is a tenth.
bool areAllBelow(double theta, const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  Eigen::MatrixXd left = theta * B - A;
  return Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(left).info() == Eigen::Success;
}

}  // namespace

// Most matrices have none.  A few of many are found by a Krylov method: at 2000 rows in a fifth of the time.  Where they are not few all are.
LargestEigen::LargestEigen(Eigen::MatrixXd A, Eigen::MatrixXd B, double least) {
  constexpr Eigen::Index kSmall = 400;
  constexpr int kFirstLook = 3;       // blocks: before, large eigenvalues may not show
  constexpr double kTolerance = 0.03;  // what is deflated need not be an eigenvector
  const Eigen::Index n = A.rows();
  values.resize(0);
  vectors.resize(n, 0);
  if (areAllBelow(least, A, B)) return;
  if (n > kSmall) {
    const Eigen::LLT<Eigen::MatrixXd> cholesky(B);
    if (cholesky.info() != Eigen::Success) return;
    const Eigen::MatrixXd L = cholesky.matrixL();
    BlockKrylov space(A, L);
    for (int block = 1; 2 * space.size() < n; ++block) {
      if (!space.grow(least, kTolerance) || block < kFirstLook) continue;
      values = space.values();
      vectors = space.vectors();
      return;
    }
  }
  decomposeWhole(std::move(A), std::move(B), least, *this);
}

}  // namespace Haptos
