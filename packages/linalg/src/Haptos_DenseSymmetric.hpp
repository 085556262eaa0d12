// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace Haptos {

/// \brief Dense linear algebra by the system's BLAS and LAPACK; only lower triangles are read and written.
namespace Lapack {

/// \brief A := L with A = L L^T.  \return whether A is positive definite
bool choleskyInPlace(Eigen::MatrixXd& A);
/// \brief L := (L L^T)^-1.
void invertFromCholesky(Eigen::MatrixXd& L);
/// \brief B := L^-1 B.
void solveLower(const Eigen::MatrixXd& L, Eigen::MatrixXd& B);
/// \brief C := C - A^T A.
void subtractGram(const Eigen::MatrixXd& A, Eigen::MatrixXd& C);
/// \brief C := C + alpha (A B^T + B A^T).
void addSymmetricProduct(double alpha, const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, Eigen::MatrixXd& C);

/// \brief The lower triangle by columns, [n (n + 1) / 2].
std::vector<double> packLower(const Eigen::MatrixXd& A);
/// \brief The lower triangle of A := what was packed.
void unpackLower(const std::vector<double>& packed, Eigen::MatrixXd& A);

}  // namespace Lapack

/// \brief A dense symmetric matrix, kept to be multiplied often.
///
/// Packed (one triangle) where vectors come one at a time and memory traffic decides; full where they come in blocks
/// and BLAS 3 decides, or where the matrix stays in the cache.  In single precision the entries are scaled by the
/// largest, so that the range does not depend on the units.
class DenseSymmetric {
 public:
  enum class Storage { Packed, Full };
  enum class Precision { Double, Single };

  DenseSymmetric() = default;
  /// \param lower [n x n], its lower triangle is read
  DenseSymmetric(const Eigen::MatrixXd& lower, Storage storage, Precision precision);

  Eigen::Index size() const { return n_; }
  /// \brief Y := A X, both [n x m], columns apart in memory as they like; they must not overlap.
  void apply(const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::Ref<Eigen::MatrixXd> Y) const;

  /// \brief A(c, c)
  Eigen::MatrixXd block(const std::vector<int>& c) const;

  static std::size_t bytes(Eigen::Index n, Storage storage, Precision precision);

 private:
  void applySingle(const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::Ref<Eigen::MatrixXd> Y) const;

  Eigen::Index n_ = 0;
  Storage storage_ = Storage::Packed;
  double scale_ = 1;  // of the single precision entries
  std::vector<double> doubles_;
  std::vector<float> singles_;
};

/// \brief A lower triangular factor L of A = L L^T, kept as a DenseSymmetric is: packed where solves are rare, full where they
/// are many or have many columns.
class DenseCholesky {
 public:
  DenseCholesky() = default;
  DenseCholesky(Eigen::MatrixXd L, DenseSymmetric::Storage storage);
  /// \brief B := A^-1 B
  void solve(Eigen::Ref<Eigen::MatrixXd> B) const;

 private:
  Eigen::Index n_ = 0;
  Eigen::MatrixXd full_;         // one of the two
  std::vector<double> packed_;
};

/// \brief A Cholesky factor in single precision of a matrix scaled to a unit diagonal: half of the time, for a few digits.
class SingleCholesky {
 public:
  /// \param A [n x n], its lower triangle is read
  /// \return whether a solution that is known came back to three digits; if not, this one is of no use
  bool factor(const Eigen::MatrixXd& A);
  /// \brief B := A^-1 B
  void solve(Eigen::Ref<Eigen::MatrixXd> B) const;

 private:
  Eigen::VectorXd scale_;  // [n] 1 / sqrt(A_ii)
  std::vector<float> L_;   // packed
};

}  // namespace Haptos
