// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "Haptos_BalanceProjections.hpp"
#include "Haptos_CompliantPreconditioner.hpp"
#include "Haptos_NewtonDirection.hpp"
#include "Haptos_SubspaceNewtonOptions.hpp"

namespace Haptos {

/// \brief The preconditioned Newton residual: one application of M and one of its contact rows, balanced by the active rows.
///
/// Gluing rows take their jump, closed normal rows theirs, tangential rows the law's residual in the eigenvectors of
/// P'; the active coarse projection stands on both sides of M.  What the law itself decides (open pairs, the slip
/// direction) is set afterwards.  Always for the linearisation.
class BalancedDirection final : public NewtonDirection {
 public:
  /// References are kept.  \param diagonalOfM [rows].  Collective.
  BalancedDirection(const ContactOperators& dual, const Eigen::VectorXd& diagonalOfM, const DualVectors& vectors,
                    const GluingBalance& balance, const SubspaceNewtonOptions::Balanced& options);

  Direction compute(const std::vector<PairLaw>& pairs, const LawLinearization& law, const DirectionPoint& point) override;

  /// \brief The preconditioner's nodal stiffness on normal rows, its median over all pairs, the same for each.
  const Eigen::VectorXd& pairStiffness() const override { return pairStiffness_; }

 private:
  bool coarseIsStale(const LawLinearization& law) const;
  void prepare(const std::vector<PairLaw>& pairs, const LawLinearization& law);
  Eigen::VectorXd residual(const std::vector<PairLaw>& pairs, const LawLinearization& law, const DirectionPoint& point) const;
  // Contact values [3 pairs] of a point.
  struct ContactPoint {
    Eigen::VectorXd lambda, s, phi;
  };
  Eigen::VectorXd followLaw(const std::vector<PairLaw>& pairs, const LawLinearization& law, const ContactPoint& point,
                            const Eigen::VectorXd& zc) const;
  Eigen::VectorXd balanceByLaw(const std::vector<PairLaw>& pairs, const LawLinearization& law, PrimalBalance& balance,
                               Eigen::VectorXd contact) const;
  void holdFloatingBodies(const LawLinearization& law, Eigen::VectorXd& contact) const;
  double tangentialStiffness(const PairLaw& pair) const;

  const ContactOperators& dual_;
  const DualVectors& vectors_;
  const GluingBalance& balance_;
  SubspaceNewtonOptions::Balanced options_;
  Eigen::VectorXd stiffness_;  // [rows] diag(M)
  Eigen::VectorXd weights_;    // [rows] D = diag(M) / its largest entry
  Eigen::VectorXd pairStiffness_;
  std::vector<Eigen::Matrix3d> preparedFor_;  // [pairs] P' that the coarse matrix was made for
  std::vector<TangentialModes> modes_;        // [pairs] of the law of the day
  std::unique_ptr<ActiveCoarseProjection> coarse_;
  CompliantPreconditioner preconditioner_;
};

}  // namespace Haptos
