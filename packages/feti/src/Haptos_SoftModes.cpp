// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SoftModes.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace Haptos {

bool isSlender(const Subdomain& subdomain) {
  constexpr double kRatio = 10;
  constexpr int kLargest = 400;
  if (subdomain.numNodes() > kLargest) return false;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& x : subdomain.coordinates) mean += Eigen::Vector3d(x.data());
  mean /= double(subdomain.numNodes());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& x : subdomain.coordinates) {
    const Eigen::Vector3d d = Eigen::Vector3d(x.data()) - mean;
    spread += d * d.transpose();
  }
  const Eigen::Vector3d squares = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread, Eigen::EigenvaluesOnly).eigenvalues();
  return squares[2] > kRatio * kRatio * squares[0];
}

SoftSpectrum softSpectrum(const Eigen::MatrixXd& S, const Eigen::MatrixXd& rigid, double softest) {
  const Eigen::VectorXd root = S.diagonal().cwiseSqrt(), inverse = root.cwiseInverse();
  Eigen::MatrixXd A = inverse.asDiagonal() * S * inverse.asDiagonal();
  const Eigen::MatrixXd scaledRigid = root.asDiagonal() * rigid;
  const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(scaledRigid).householderQ() *
                            Eigen::MatrixXd::Identity(rigid.rows(), rigid.cols());
  A += 2 * A.trace() * Q * Q.transpose();  // rigid motions go to the other end of the spectrum
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A);
  const Eigen::Index elastic = A.rows() - rigid.cols();
  Eigen::Index count = 0;
  while (count < elastic && eigen.eigenvalues()[count] < softest) ++count;
  Eigen::VectorXd mu = eigen.eigenvalues().cwiseMax(0.0);
  mu.tail(rigid.cols()).setZero();
  return {mu.cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose() * root.asDiagonal(),
          inverse.asDiagonal() * eigen.eigenvectors().leftCols(count)};
}

}  // namespace Haptos
