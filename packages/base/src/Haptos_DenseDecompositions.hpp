// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <utility>
#include <vector>

namespace Haptos {

// Decompositions of small dense matrices.  Eigen's templates cost 3 to 8 seconds of compilation wherever one of them is
// used, so they stand in one place; the digits are Eigen's.  No function communicates.

/// \brief Eigenvalues in ascending order and orthonormal eigenvectors of a symmetric matrix (its lower triangle).
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;  ///< columns
  explicit SymmetricEigen(const Eigen::MatrixXd& A);
};

/// \brief Eigenvalues below `most`, ascending, and orthonormal eigenvectors of a symmetric matrix (its lower triangle) without any below -1.
struct EigenBelow {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;  ///< columns
  EigenBelow(Eigen::MatrixXd A, double most);
};

/// \brief Eigenvalues above `least`, ascending, and their vectors of A v = theta B v, v^T B v = 1; none where B is not positive definite.
///
/// Of large matrices to a few per cent of an eigenvalue: of those near `least` some may be missing.
struct LargestEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;  ///< columns
  LargestEigen(Eigen::MatrixXd A, Eigen::MatrixXd B, double least);
};

struct SymmetricEigen2 {
  Eigen::Vector2d values;
  Eigen::Matrix2d vectors;
  explicit SymmetricEigen2(const Eigen::Matrix2d& A);
};

struct SymmetricEigen3 {
  Eigen::Vector3d values;
  Eigen::Matrix3d vectors;
  explicit SymmetricEigen3(const Eigen::Matrix3d& A);
};

/// \brief Eigenvalues in ascending order of A v = theta B v, both symmetric, B positive definite; v^T B v = 1.
struct SymmetricPencil {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;  ///< columns
  SymmetricPencil(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
};

/// \brief Singular values in descending order and all right singular vectors.
struct RightSvd {
  Eigen::VectorXd values;
  Eigen::MatrixXd V;  ///< [columns of A x columns of A]
  explicit RightSvd(const Eigen::MatrixXd& A);
};

/// \brief QR with column pivoting, Householder.
struct PivotedQr {
  std::vector<int> columns;  ///< the independent ones, as many as the rank
  Eigen::MatrixXd Q;         ///< orthonormal basis of the image, all columns of A if it has full rank
  explicit PivotedQr(const Eigen::MatrixXd& A);
};

/// \brief Cholesky's factor with pivoting of a symmetric matrix that is positive semidefinite.
class PivotedCholesky {
 public:
  /// \param least pivots at or below it are left out, with their rows and columns
  PivotedCholesky(Eigen::MatrixXd A, double least);
  /// \brief A x = b for b in the image of A, x = 0 where pivots were left out.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;
  /// \brief X [rank x columns] with X^T X = B^T A^+ B, for B in the image of A.
  Eigen::MatrixXd solveHalf(const Eigen::MatrixXd& B) const;
  Eigen::Index rank() const { return Eigen::Index(pivots_.size()); }
  const std::vector<int>& pivots() const { return pivots_; }  ///< [rank] rows of A, in their order

 private:
  Eigen::MatrixXd L_;        // [rank x rank]
  Eigen::Index size_;
  std::vector<int> pivots_;  // [rank] rows of A
};

/// \brief LU with partial pivoting, or Cholesky's factor of a symmetric matrix, of which the lower triangle is read.
class DenseFactor {
 public:
  enum class Kind { Lu, Cholesky };
  DenseFactor() = default;  ///< of no rows
  DenseFactor(Eigen::MatrixXd A, Kind kind);
  /// \brief A^-1 B; NaN where A is singular, or not positive definite.
  Eigen::MatrixXd solve(Eigen::MatrixXd B) const { return solve(std::move(B), 'N'); }
  Eigen::MatrixXd solveTransposed(Eigen::MatrixXd B) const { return solve(std::move(B), 'T'); }

 private:
  Eigen::MatrixXd solve(Eigen::MatrixXd B, char transposed) const;

  Kind kind_ = Kind::Lu;
  Eigen::MatrixXd factor_;
  std::vector<int> pivots_;
  bool isRegular_ = true;
};

Eigen::VectorXd solveByLdlt(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);  ///< A symmetric
/// \brief By partial pivoting; NaN where A is singular.
Eigen::MatrixXd solveByLu(Eigen::MatrixXd A, Eigen::MatrixXd B);

Eigen::MatrixXd inverseByCholesky(Eigen::MatrixXd A);  ///< of no rows where A is not positive definite; its lower triangle is read

/// \brief A^+, A symmetric and positive semidefinite, eigenvalues up to `least` of the largest being none.
/// \param kernel orthonormal, A does not feel it.  Where it is all of the kernel a factor is enough, else all eigenvectors are made.
Eigen::MatrixXd pseudoInverse(const Eigen::MatrixXd& A, const Eigen::MatrixXd& kernel, double least);

/// \brief A x by BLAS, A symmetric, its lower triangle read: half of what a product reads, where Eigen's own takes four times as long.
Eigen::VectorXd symmetricTimes(const Eigen::MatrixXd& A, const Eigen::VectorXd& x);

/// \brief y := y + alpha A x, y := y + alpha A^T x.  Eigen's own products with vectors have SSE2 in a build for any x86-64.
void addProduct(double alpha, const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::Ref<Eigen::VectorXd> y);
void addTransposedProduct(double alpha, const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::VectorXd>& x,
                          Eigen::Ref<Eigen::VectorXd> y);
/// \brief A X, A^T X, where X may have one column.
Eigen::MatrixXd product(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::MatrixXd>& X);
Eigen::MatrixXd transposedProduct(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::MatrixXd>& X);

/// \brief The shortest x of least |A x - b|, by a complete orthogonal decomposition.
/// \param threshold pivots below this part of the largest are zero; 0: round-off
Eigen::VectorXd solveLeastSquares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double threshold = 0);

/// \brief The same of a square matrix that is singular by a few vectors of its kernel alone: by LU, at three times its price.
/// \param most vectors of the kernel; with more, and where they stand out by no gap, by the other
Eigen::VectorXd solveNearlySingular(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, Eigen::Index most);

/// \brief Adds T^T T to the lower triangle of A; what is above the diagonal is not defined.
void addGram(const Eigen::MatrixXd& T, Eigen::MatrixXd& A);

/// \brief x of least |A x - b|, A of full rank, by QR with column pivoting.
Eigen::VectorXd solveByPivotedQr(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// \brief Orthonormal basis of the image of A, whose columns are independent; Householder.
Eigen::MatrixXd orthonormalBasis(const Eigen::MatrixXd& A);

/// \brief Overwrites A by the triangle R of A = Q R and, below it, by what makes Q.
void factorQrInPlace(Eigen::MatrixXd& A);

}  // namespace Haptos
