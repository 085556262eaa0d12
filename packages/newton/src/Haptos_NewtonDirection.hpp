// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "Haptos_BalanceProjections.hpp"
#include "Haptos_CompliantPreconditioner.hpp"
#include "Haptos_CondensedNewton.hpp"

namespace Haptos {

/// \brief The preconditioned Newton residual: one direction for the multipliers, one application of M and one of its contact rows.
///
/// Gluing rows take their jump, closed normal rows theirs, tangential rows the law's residual in the eigenvectors of
/// P'; the active coarse projection stands on both sides of M.  What the law itself decides (open pairs, the slip
/// direction) is set afterwards.
class NewtonDirection {
 public:
  NewtonDirection(const ContactOperators& dual, const Eigen::VectorXd& diagonalOfM, const DualVectors& vectors,
                  const GluingBalance& balance);

  /// \brief Where the direction is taken.
  struct Point {
    const Eigen::VectorXd& lambda;  ///< [rows]
    const Eigen::VectorXd& s;       ///< [rows]
    const Eigen::VectorXd& phi;     ///< [3 pairs] residual of the law, possibly of its linearisation
  };

  /// \brief v with G v = 0, not normalised.  Collective.
  Eigen::VectorXd compute(const std::vector<PairLaw>& pairs, const LawLinearization& law, const Point& point);

  /// \brief From now on directions come from `CondensedNewton`, if there is a better M and contact is small enough; changes
  /// `pairStiffness`.  \return whether it is so.  Collective.
  bool useModel();
  bool mayHaveModel() const { return mayHaveModel_; }  ///< useModel was not called and could help
  bool hasModel() const { return condensed_ != nullptr; }

  /// \brief With a model: the direction for the law itself, not for its linearisation.  Collective.
  CondensedNewton::Step computeNonlinear(const std::vector<PairLaw>& pairs, const LawLinearization& law, const Point& point) const;

  /// \brief What r of the law is measured by [pairs]: the preconditioner's nodal stiffness on normal rows, its median over
  /// all pairs; with a model the stiffness that each pair feels.
  const Eigen::VectorXd& pairStiffness() const { return pairStiffness_; }

 private:
  bool coarseIsStale(const LawLinearization& law) const;
  void prepare(const std::vector<PairLaw>& pairs, const LawLinearization& law);
  Eigen::VectorXd residual(const std::vector<PairLaw>& pairs, const LawLinearization& law, const Point& point) const;
  // Contact values [3 pairs] of a Point.
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
  Eigen::VectorXd stiffness_;  ///< [rows] diag(M)
  Eigen::VectorXd weights_;    ///< [rows] diag(M) / its largest entry
  Eigen::VectorXd pairStiffness_;
  std::vector<Eigen::Matrix3d> preparedFor_;
  std::vector<TangentialModes> modes_;
  std::unique_ptr<ActiveCoarseProjection> coarse_;
  CompliantPreconditioner preconditioner_;
  std::unique_ptr<CondensedNewton> condensed_;
  bool mayHaveModel_ = false;
};

/// \brief Median of this rank's and all other ranks' values.  Collective.
double globalMedian(const Communicator& comm, const std::vector<double>& values);

}  // namespace Haptos
