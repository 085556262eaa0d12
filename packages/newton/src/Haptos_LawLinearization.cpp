// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_LawLinearization.hpp"

#include <algorithm>

#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {

LawLinearization linearizeLaw(const std::vector<PairLaw>& pairs, const Eigen::VectorXd& lambda, const Eigen::VectorXd& s,
                              const Eigen::VectorXd& r) {
  LawLinearization result;
  result.r = r;
  result.phi.resize(lambda.size());
  result.dP.resize(pairs.size());
  result.closed.resize(pairs.size());
  result.tangential.resize(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Index at = 3 * Eigen::Index(i);
    // phi = (lambda - P(x)) / r with x = lambda + r s; dP = P'(x)
    const Eigen::Vector3d x = lambda.segment<3>(at) + r[Eigen::Index(i)] * s.segment<3>(at);
    const PairProjection P = pairs[i].project({x[0], x[1], x[2]});
    for (int a = 0; a < 3; ++a) {
      result.phi[at + a] = (lambda[at + a] - P.point[a]) / r[Eigen::Index(i)];
      for (int b = 0; b < 3; ++b) result.dP[i](a, b) = P.dPdx[a][b];
    }
    result.closed[i] = P.status != ContactStatus::Open;
    result.tangential[i] = pairs[i].frictional() && (result.closed[i] || pairs[i].law == FrictionLaw::Tresca);
  }
  return result;
}

// (I - P') / r V - P' S = V / r - P' (V / r + S): one product with P' a pair
Eigen::MatrixXd LawLinearization::multiply(const Eigen::Ref<const Eigen::MatrixXd>& V, const Eigen::Ref<const Eigen::MatrixXd>& S) const {
  Eigen::MatrixXd J = V;
  for (Eigen::Index i = 0; i < r.size(); ++i) J.middleRows<3>(3 * i) /= r[i];
  Eigen::MatrixXd X = J + S;
  for (std::size_t i = 0; i < dP.size(); ++i)
    J.middleRows<3>(3 * Eigen::Index(i)).noalias() -= dP[i] * X.middleRows<3>(3 * Eigen::Index(i));
  return J;
}

// P'_TT = E diag(sigma) E^T is symmetric: the derivative of a projection, also where g moves with lambda_N, which is P'_TN.
TangentialModes TangentialModes::of(const Eigen::Matrix3d& dP, double r, double stiffness) {
  TangentialModes modes;
  const SymmetricEigen2 eigen(dP.bottomRightCorner<2, 2>());
  modes.E = eigen.vectors;
  modes.stiffness = stiffness;
  for (int m = 0; m < 2; ++m) {
    // the law's compliance C in series with the body's, about 1 / k: theta is the part of a force that the body gets
    modes.sigma[m] = std::clamp(eigen.values[m], 0.0, 1.0);
    const double compliance = (1 - modes.sigma[m]) / (r * std::max(modes.sigma[m], 1e-14));
    modes.theta[m] = modes.isHeld(m) || stiffness <= 0 ? 0.0 : (1 / stiffness) / (compliance + 1 / stiffness);
  }
  return modes;
}

}  // namespace Haptos
