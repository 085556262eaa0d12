// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/SparseCore>
#include <cstddef>
#include <vector>

#include "Haptos_DenseSymmetric.hpp"

namespace Haptos {

/// \brief One subdomain condensed on its boundary unknowns b, all dense: S and the boundary block of K^+.
///
///   S = K_bb - K_bi K_ii^-1 K_ib,     P = (K^+)_bb,     K^+ the Moore-Penrose inverse
///
/// K_ii is factored once and serves both.  With any generalised inverse A of S, here (S + rho Q Q^T)^-1 where Q spans
/// R on b, u_b = A (f_b - K_bi K_ii^-1 f_i) gives a generalised inverse of K, and with W = that inverse times R,
///
///   P = A - R_b W_b^T - W_b R_b^T + R_b (R^T W) R_b^T.
///
/// No fixing nodes are needed and an application of F or of the Dirichlet preconditioner is one product with a dense
/// matrix: cheap where subdomains are small or many share the matrices.  Nothing communicates.
class DenseSurfaceMatrices {
 public:
  enum class Scope { SchurOnly, Both };

  /// \param K        n x n, both triangles stored; needed by the constructor only
  /// \param kernel   R, n x k, orthonormal columns; kept by reference, it must outlive this object
  /// \param boundary local unknowns, ascending
  /// \param members  how many subdomains share it: decides how the matrices are stored
  /// \throws std::runtime_error if K R is not zero, K_ii is singular or K has a zero-energy motion outside R
  DenseSurfaceMatrices(const Eigen::SparseMatrix<double>& K, const Eigen::MatrixXd& kernel, const std::vector<int>& boundary,
                    std::size_t members, Scope scope = Scope::Both);

  const std::vector<int>& boundary() const { return boundary_; }

  /// Y := S X, [nb x m]; S is kept in single precision, good enough for a preconditioner.
  void applySchur(const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::Ref<Eigen::MatrixXd> Y) const { schur_.apply(X, Y); }

  /// S(c, c), `c` positions in the boundary list.
  Eigen::MatrixXd schurBlock(const std::vector<int>& c) const { return schur_.block(c); }

  /// Y := (K^+)_bb X, [nb x m].
  void applyInverse(const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::Ref<Eigen::MatrixXd> Y) const { inverse_.apply(X, Y); }

  /// X := K^+ B, [n x m], for right-hand sides on all unknowns.
  void solve(const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::Ref<Eigen::MatrixXd> X) const;

  /// \brief Bytes: of one product with each of the two.
  struct Work {
    double flops, inverseBytes, schurBytes;
  };
  Work work() const;

  /// \brief Floating point operations of the construction and bytes kept, for n unknowns with nb on the boundary.
  struct Cost {
    double flops;
    double bytes;
  };
  static Cost cost(double n, double nb, std::size_t members);

 private:
  using SparseMatrix = Eigen::SparseMatrix<double>;
  Eigen::MatrixXd schurComplement(const SparseMatrix& K, Eigen::MatrixXd& Lii) const;
  void formInverse(const Eigen::MatrixXd& S);
  void requireKernel(const SparseMatrix& K) const;
  void requireAccuracy(const SparseMatrix& K) const;

  const Eigen::MatrixXd& kernel_;
  std::vector<int> boundary_, interior_;
  DenseSymmetric::Storage storage_;
  SparseMatrix Kib_;
  DenseCholesky interiorFactor_;
  DenseSymmetric schur_, inverse_;
};

}  // namespace Haptos
