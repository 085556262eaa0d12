// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_BalanceProjections.hpp"
#include "Haptos_SubspaceNewtonOptions.hpp"

namespace Haptos {

/// \brief Rigid bodies on a frictional elastic foundation: H^T P(x + r H a) = load, one equation per floating motion.
struct FoundationState {
  Eigen::VectorXd a;       ///< [k] amplitudes of the floating motions
  Eigen::VectorXd forces;  ///< [3 pairs] P(x + r H a), in balance with the load up to `residual`
  double residual = 0;     ///< relative
};

/// \brief Newton's method, damped; gives contact forces for floating bodies to start from.  Collective.
FoundationState solveFoundation(const std::vector<PairLaw>& pairs, const Eigen::VectorXd& x, const Eigen::VectorXd& r,
                                const GluingBalance& balance, const SubspaceNewtonOptions::Foundation& options = {});

}  // namespace Haptos
