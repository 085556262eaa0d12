// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <vector>

#include "Haptos_CoarseProblem.hpp"
#include "Haptos_DualOperator.hpp"
#include "Haptos_NaturalCoarseSpace.hpp"
#include "Haptos_Projector.hpp"

namespace Haptos {

/// \brief What changes from step to step while K and B stay.
struct StepData {
  RCP<const Vector> f;  ///< loads, primal map; the copies of a node share them
  RCP<const Vector> c;  ///< right-hand side of all rows of B, dual map: gaps, prescribed values and what these leave in other rows
  std::vector<PrescribedDisplacement> prescribed;  ///< what copies are compared with; each on the rank in whose range the node lies (NodalGather)
};

/// \brief The dual problem of Total FETI without its feasible set:
///
///   minimise  1/2 l^T F l - l^T h   subject to  G l = e        (and l in Omega, which friction adds)
///   F = B K^+ B^T,  h = B K^+ f - c,  G = R^T B^T,  e = R^T f
///
/// F, G and the projectors are made once; e and lambdaIm are those of a step.  All vectors live on the dual map.
struct DualProblem {
  RCP<const DualOperator> F;
  RCP<const NaturalCoarseSpace> G;
  RCP<const CoarseProblem> GGT;
  RCP<const Projector> P, Q;
  RCP<const ProjectedDualOperator> PFP;
  StepData step;
  Eigen::VectorXd e;           ///< [l], force
  RCP<const Vector> lambdaIm;  ///< G^T (G G^T)^-1 e [force]: the point of Im G^T with G l = e

  DualProblem() = default;
  /// \brief The operators; there is no step yet.
  DualProblem(RCP<const DualOperator> F, RCP<const NaturalCoarseSpace> G, RCP<const CoarseProblem> GGT);

  /// \brief e and lambdaIm of a step: one coarse solve.  Collective.
  void setStep(StepData data);

  /// \brief h - F l [length] by one local solve a subdomain, counted as a multiplication by F, without h; the displacements of the same l
  /// (recoverPrimal) are then had for nothing.  Collective.
  RCP<const Vector> jumpsOf(const Vector& lambda) const;

  const RCP<const Map> map() const { return F->getDomainMap(); }

 private:
  /// What a step's loads and l do to subdomains that nothing holds.
  struct Response {
    RCP<const Vector> lambda;  // a copy
    RCP<const Vector> u;       // K^+ (f - B^T l), primal map
    RCP<const Vector> jumps;   // B u - c = h - F l
  };
  Response respond(const RCP<const Vector>& lambda) const;
  bool isRecent(const Vector& lambda) const;
  friend RCP<Vector> recoverPrimal(const DualProblem& dual, const Vector& lambda, const Vector& s);

  mutable Response recent_;  // of the last l
};

/// \brief u = K^+ (f - B^T l) + R a on the primal map, with a such that B u - c is nearest to the jump s.
///
/// s [length] is what the dual method holds for B u - c (minus the gradient of its Lagrangian).  Collective; one
/// local solve a subdomain, or none where the last jumpsOf was for the same l.
RCP<Vector> recoverPrimal(const DualProblem& dual, const Vector& lambda, const Vector& s);

}  // namespace Haptos
