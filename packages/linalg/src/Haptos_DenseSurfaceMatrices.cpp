// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DenseSurfaceMatrices.hpp"

#include <Teuchos_Assert.hpp>
#include <cmath>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_SparseBlocks.hpp"

namespace Haptos {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using SparseMatrix = Eigen::SparseMatrix<double>;
using Storage = DenseSymmetric::Storage;
using Precision = DenseSymmetric::Precision;

// From three members on products of matrices pay, which want both triangles.
Storage storageFor(std::size_t members) { return members > 2 ? Storage::Full : Storage::Packed; }

}  // namespace

// One factor of K_ii for S, P and right-hand sides inside.  Without one, where a surface does not hold its interior, callers
// take solves.
DenseSurfaceMatrices::DenseSurfaceMatrices(const SparseMatrix& K, const MatrixXd& kernel, const std::vector<int>& boundary,
                                     std::size_t members, Scope scope)
    : kernel_(kernel), boundary_(boundary), interior_(complement(K.rows(), boundary)), storage_(storageFor(members)) {
  TEUCHOS_ASSERT(K.rows() == K.cols() && K.rows() == kernel.rows());
  Kib_ = blockOf(K, interior_, boundary_);
  MatrixXd Lii = blockOf(K, interior_, interior_);
  TEUCHOS_TEST_FOR_EXCEPTION(!Lapack::choleskyInPlace(Lii), std::runtime_error,
                             "DenseSurfaceMatrices: the interior of a subdomain of " << K.rows() << " unknowns is not held by its boundary");
  const MatrixXd S = schurComplement(K, Lii);
  schur_ = DenseSymmetric(S, storage_, Precision::Single);
  if (scope == Scope::SchurOnly) return;
  requireKernel(K);
  interiorFactor_ = DenseCholesky(std::move(Lii), storage_);
  formInverse(S);
  requireAccuracy(K);
}

// S = K_bb - (L_ii^-1 K_ib)^T (L_ii^-1 K_ib): half a product, and symmetric by construction
MatrixXd DenseSurfaceMatrices::schurComplement(const SparseMatrix& K, MatrixXd& Lii) const {
  MatrixXd S = blockOf(K, boundary_, boundary_), Kib = Kib_;
  Lapack::solveLower(Lii, Kib);
  Lapack::subtractGram(Kib, S);
  return S;
}

// A = (S + rho Q Q^T)^-1, Q an orthonormal basis of R_b, rho the mean of diag S so that the kernel is held as stiffly as the rest:
// S A S = S.  G = [ A , -A K_bi K_ii^-1 ; . , . ] is then a generalised inverse of K, (K^+)_bb that of P = (1 - R R^T) G (1 - R R^T):
//
//   W = G R:   t = K_ii^-1 R_i,   W_b = A (R_b - K_bi t),   W_i = t - K_ii^-1 K_ib W_b
//   P_bb = A - R_b W_b^T - W_b R_b^T + R_b (R^T W) R_b^T = A - (R_b V^T + V R_b^T),   V = W_b - R_b (R^T W) / 2
void DenseSurfaceMatrices::formInverse(const MatrixXd& S) {
  const MatrixXd Rb = rowsOf(kernel_, boundary_), Ri = rowsOf(kernel_, interior_);
  const Index k = Rb.cols();
  MatrixXd A = S;
  if (k > 0) {
    const MatrixXd Q = orthonormalBasis(Rb);
    const double rho = S.diagonal().mean();
    Lapack::addSymmetricProduct(0.5 * rho, Q, Q, A);
  }
  TEUCHOS_TEST_FOR_EXCEPTION(!Lapack::choleskyInPlace(A), std::runtime_error,
                             "DenseSurfaceMatrices: a subdomain of " << kernel_.rows() << " unknowns has a motion without energy outside its kernel");
  Lapack::invertFromCholesky(A);
  if (k > 0) {
    MatrixXd t = Ri;
    interiorFactor_.solve(t);
    const MatrixXd g = Rb - Kib_.transpose() * t;
    const MatrixXd Wb = A.selfadjointView<Eigen::Lower>() * g;
    MatrixXd Wi = Kib_ * Wb;
    interiorFactor_.solve(Wi);
    const MatrixXd RW = Rb.transpose() * Wb + Ri.transpose() * (t - Wi);
    Lapack::addSymmetricProduct(-1.0, Rb, Wb - 0.5 * Rb * RW, A);
  }
  inverse_ = DenseSymmetric(A, storage_, Precision::Double);
}

// f := (1 - R R^T) f,   u_b = P_bb (f_b - K_bi K_ii^-1 f_i),   u_i = K_ii^-1 (f_i - K_ib u_b),   u := (1 - R R^T) u
void DenseSurfaceMatrices::solve(const Eigen::Ref<const MatrixXd>& B, Eigen::Ref<MatrixXd> X) const {
  TEUCHOS_ASSERT(B.rows() == kernel_.rows() && X.rows() == B.rows() && X.cols() == B.cols());
  MatrixXd balanced = B;
  balanced -= kernel_ * MatrixXd(kernel_.transpose() * B);
  MatrixXd t = rowsOf(balanced, interior_);
  interiorFactor_.solve(t);
  MatrixXd ub(Index(boundary_.size()), B.cols());
  inverse_.apply(rowsOf(balanced, boundary_) - Kib_.transpose() * t, ub);
  MatrixXd coupled = Kib_ * ub;
  interiorFactor_.solve(coupled);
  t -= coupled;
  for (std::size_t i = 0; i < boundary_.size(); ++i) X.row(boundary_[i]) = ub.row(Index(i));
  for (std::size_t i = 0; i < interior_.size(); ++i) X.row(interior_[i]) = t.row(Index(i));
  const MatrixXd rigid = kernel_.transpose() * X;
  X -= kernel_ * rigid;
}

// || K R || <= 1e-8 || K ||, R orthonormal: round-off leaves 1e-14, what is no motion of K far more
void DenseSurfaceMatrices::requireKernel(const SparseMatrix& K) const {
  const double error = (K * kernel_).norm() / K.norm();
  TEUCHOS_TEST_FOR_EXCEPTION(!(error <= 1e-8), std::runtime_error,
                             "DenseSurfaceMatrices: the kernel given with a subdomain of " << K.rows()
                                 << " unknowns is not in the kernel of its stiffness, |K R| / |K| = " << error);
}

// K K^+ K = K on one vector: a motion without energy that R lacks would show.
void DenseSurfaceMatrices::requireAccuracy(const SparseMatrix& K) const {
  MatrixXd probe(K.rows(), 1), answer(K.rows(), 1);
  for (Index i = 0; i < probe.size(); ++i) probe(i, 0) = std::sin(1.0 + 7.0 * double(i) + 0.3 * double(i % 11));
  solve(probe, answer);
  probe -= kernel_ * MatrixXd(kernel_.transpose() * probe);
  const double residual = (probe - K * answer).norm() / probe.norm();
  TEUCHOS_TEST_FOR_EXCEPTION(!(residual <= 1e-4), std::runtime_error,
                             "DenseSurfaceMatrices: the inverse of a subdomain of " << K.rows() << " unknowns is useless (relative residual "
                                 << residual << ")");
}

// Factor of K_ii, L_ii^-1 K_ib, its products, the inverse on b; S in single, P in double precision, L_ii for right-hand sides inside.
DenseSurfaceMatrices::Work DenseSurfaceMatrices::work() const {
  const Index nb = Index(boundary_.size());
  return {cost(double(boundary_.size() + interior_.size()), double(nb), 1).flops,
          double(DenseSymmetric::bytes(nb, storage_, Precision::Double)), double(DenseSymmetric::bytes(nb, storage_, Precision::Single))};
}

DenseSurfaceMatrices::Cost DenseSurfaceMatrices::cost(double n, double nb, std::size_t members) {
  const double ni = n - nb;
  const Storage storage = storageFor(members);
  return {ni * ni * ni / 3 + ni * ni * nb + ni * nb * nb + nb * nb * nb,
          double(DenseSymmetric::bytes(Index(nb), storage, Precision::Double) + DenseSymmetric::bytes(Index(nb), storage, Precision::Single)) +
              (storage == Storage::Packed ? 4 : 8) * ni * ni};
}

}  // namespace Haptos
