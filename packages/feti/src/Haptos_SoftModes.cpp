// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SoftModes.hpp"

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_DenseSymmetric.hpp"

namespace Haptos {

namespace {

// L = C^T (1 - Q Q^T) with A + Q Q^T = C C^T, or by all eigenvectors, mu^1/2 V^T, where round-off leaves A + Q Q^T indefinite. Either root has the
// energies that A has, as sums of squares, and none of rigid motions.
Eigen::MatrixXd rootOf(const Eigen::MatrixXd& A, const Eigen::MatrixXd& Q) {
  Eigen::MatrixXd C = A + Q * Q.transpose();
  if (Lapack::choleskyInPlace(C)) {
    C.triangularView<Eigen::StrictlyUpper>().setZero();
    C -= Q * (Q.transpose() * C).eval();
    return C.transpose();
  }
  const SymmetricEigen eigen(A + 2 * A.trace() * Q * Q.transpose());
  Eigen::VectorXd mu = eigen.values.cwiseMax(0.0);
  mu.tail(Q.cols()).setZero();
  return mu.cwiseSqrt().asDiagonal() * eigen.vectors.transpose();
}

}  // namespace

// S w = mu D w, D = diag S, as A = D^-1/2 S D^-1/2 with eigenvectors V = D^1/2 W.  Rigid motions have mu = 0 up to round-off, which
// would mix them with soft ones: they are shifted beyond the spectrum, by 2 tr A.
SoftSpectrum softSpectrum(const Eigen::MatrixXd& S, const Eigen::MatrixXd& rigid, double softest) {
  const Eigen::VectorXd root = S.diagonal().cwiseSqrt(), inverse = root.cwiseInverse();
  const Eigen::MatrixXd A = inverse.asDiagonal() * S * inverse.asDiagonal(), scaledRigid = root.asDiagonal() * rigid;
  const Eigen::MatrixXd Q = orthonormalBasis(scaledRigid);
  const EigenBelow soft(A + 2 * A.trace() * Q * Q.transpose(), softest);
  return {rootOf(A, Q) * root.asDiagonal(), inverse.asDiagonal() * soft.vectors, soft.values};
}

}  // namespace Haptos
