// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_BalanceProjections.hpp"
#include "Haptos_CondensedContact.hpp"
#include "Haptos_NewtonDirection.hpp"

namespace Haptos {

/// \brief Directions from the problem condensed to the contact rows: z = M_Z (s_E, sigma), sigma by the law.
///
/// G M_Z = 0 up to the holds and round-off of M_Z; contact rows take what is left of floating motions, gluing rows the rest.
class CondensedDirection final : public NewtonDirection {
 public:
  /// References are kept.  \param without [pairs] stiffness of pairs whose compliance is not felt.  Collective.
  /// \param diagonal [3 pairs] about M's between contact rows.
  CondensedDirection(const ContactOperators::Deflated& deflated, const ContactOperators& dual, const GluingBalance& balance,
                     const Eigen::VectorXd& diagonal, const Eigen::VectorXd& without, const SubspaceNewtonOptions::Condensed& options);

  Direction compute(const std::vector<PairLaw>& pairs, const LawLinearization& law, const DirectionPoint& point) override;

  /// \brief Where the full step goes too far for F, M is made smaller, so that the next ones do not.
  void learn(double vFv) override;

  /// \brief 1 / (normal compliance of the pair, the others open), where M is a dense matrix; else `Condensed::penalty` times that without this
  /// direction.
  const Eigen::VectorXd& pairStiffness() const override { return pairStiffness_; }

 private:
  void holdFloatingBodies(Eigen::VectorXd& v) const;
  void dropWhatSlidesFreely(const std::vector<PairLaw>& pairs, const Eigen::VectorXd& lambda, Eigen::VectorXd& v) const;

  const GluingBalance& balance_;
  ContactMatrix matrix_;
  CondensedContact contact_;
  Eigen::VectorXd pairStiffness_;
  SubspaceNewtonOptions::Condensed options_;
  double energy_ = 0;  // of the last direction: z^T M^-1 z = z . (s_E, sigma)
};

}  // namespace Haptos
