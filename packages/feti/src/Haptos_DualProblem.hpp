// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>

#include "Haptos_CoarseProblem.hpp"
#include "Haptos_DualOperator.hpp"
#include "Haptos_NaturalCoarseSpace.hpp"
#include "Haptos_Projector.hpp"

namespace Haptos {

/// \brief The dual problem of Total FETI without its feasible set:
///
///   minimise  1/2 l^T F l - l^T h   subject to  G l = e        (and l in Omega, which friction adds)
///   F = B K^+ B^T,  h = B K^+ f - c,  G = R^T B^T,  e = R^T f
///
/// All vectors live on the dual map.  An application that has its own F, G may fill the members itself.
struct DualProblem {
  RCP<const DualOperator> F;
  RCP<const NaturalCoarseSpace> G;
  RCP<const CoarseProblem> GGT;
  RCP<const Projector> P, Q;
  RCP<const ProjectedDualOperator> PFP;
  RCP<const Vector> h;         ///< [length]
  Eigen::VectorXd e;           ///< [l], force
  RCP<const Vector> lambdaIm;  ///< G^T (G G^T)^-1 e [force]: the point of Im G^T with G l = e

  const RCP<const Map> map() const { return F->getDomainMap(); }
};

/// \param f loads on the primal map, \param c right-hand side on the dual map.  Collective.
DualProblem makeDualProblem(RCP<const DualOperator> F, RCP<const NaturalCoarseSpace> G, RCP<const CoarseProblem> GGT,
                            const MultiVector& f, const Vector& c);

/// \brief u = K^+ (f - B^T l) + R a on the primal map, with a such that B u - c is nearest to the jump s.
///
/// s [length] is what the dual method holds for B u - c (minus the gradient of its Lagrangian).  Collective; one
/// local solve a subdomain.
RCP<Vector> recoverPrimal(const DualProblem& dual, const MultiVector& f, const Vector& c, const Vector& lambda, const Vector& s);

}  // namespace Haptos
