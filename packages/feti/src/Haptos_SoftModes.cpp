// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SoftModes.hpp"

#include <cmath>

#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {

// By the eigenvalues of sum d d^T, d from the mean: squares of the extents along the principal axes.
bool isSlender(const Coordinates& coordinates) {
  constexpr double kRatio = 10;    // extents; ordinary meshes are to pay nothing (decisions/016)
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& x : coordinates) mean += Eigen::Vector3d(x.data());
  mean /= double(coordinates.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& x : coordinates) {
    const Eigen::Vector3d d = Eigen::Vector3d(x.data()) - mean;
    spread += d * d.transpose();
  }
  const Eigen::Vector3d squares = SymmetricEigen3(spread).values;
  return squares[2] > kRatio * kRatio * squares[0];
}

// S w = mu D w, D = diag S, as A = D^-1/2 S D^-1/2 with eigenvectors V = D^1/2 W.  Rigid motions have mu = 0 up to round-off, which
// would mix them with soft ones: they are shifted beyond the spectrum, by 2 tr A, and their mu is set to 0.  S = L^T L with
// L = mu^1/2 V^T D^1/2.
SoftSpectrum softSpectrum(const Eigen::MatrixXd& S, const Eigen::MatrixXd& rigid, double softest) {
  const Eigen::VectorXd root = S.diagonal().cwiseSqrt(), inverse = root.cwiseInverse();
  Eigen::MatrixXd A = inverse.asDiagonal() * S * inverse.asDiagonal();
  const Eigen::MatrixXd scaledRigid = root.asDiagonal() * rigid;
  const Eigen::MatrixXd Q = orthonormalBasis(scaledRigid);
  A += 2 * A.trace() * Q * Q.transpose();  // rigid motions go to the other end of the spectrum
  const SymmetricEigen eigen(A);
  const Eigen::Index elastic = A.rows() - rigid.cols();
  Eigen::Index count = 0;
  while (count < elastic && eigen.values[count] < softest) ++count;
  Eigen::VectorXd mu = eigen.values.cwiseMax(0.0);
  mu.tail(rigid.cols()).setZero();
  return {mu.cwiseSqrt().asDiagonal() * eigen.vectors.transpose() * root.asDiagonal(),
          inverse.asDiagonal() * eigen.vectors.leftCols(count)};
}

}  // namespace Haptos
