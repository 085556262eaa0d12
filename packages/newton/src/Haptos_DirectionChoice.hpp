// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "Haptos_BalancedDirection.hpp"
#include "Haptos_CondensedDirection.hpp"

namespace Haptos {

/// \brief The strategy of the day: balanced directions, or condensed ones once they are asked for and can be had.
class DirectionChoice {
 public:
  /// References are kept.  \param diagonalOfM [rows].  Collective.
  DirectionChoice(const ContactOperators& dual, const Eigen::VectorXd& diagonalOfM, const DualVectors& vectors,
                  const GluingBalance& balance, const SubspaceNewtonOptions& options);

  NewtonDirection& current() { return condensed_ ? static_cast<NewtonDirection&>(*condensed_) : balanced_; }
  const Eigen::VectorXd& pairStiffness() const { return condensed_ ? condensed_->pairStiffness() : balanced_.pairStiffness(); }

  /// \brief Whether condensed directions were not asked for, or at little price alone, and could be had: there is a better M.
  bool mayCondense() const { return offer_ == Offer::Usual; }
  /// \brief Whether they were too dear, or were not asked for: still to be had where there is no other way.
  bool mayCondenseAtAnyPrice() const { return offer_ != Offer::None; }
  bool isCondensed() const { return condensed_ != nullptr; }

  /// \brief From now on directions are condensed, if they can be; then `pairStiffness` is theirs.  The second time at any price.
  ///
  /// \return whether they are.  Collective.
  bool condense();
  /// \brief The same for what the law asks for, not M: at little price, where the usual one is high.
  bool condenseForLaw();

 private:
  bool take(ContactOperators::Price price);

  const ContactOperators& dual_;
  const GluingBalance& balance_;
  Eigen::VectorXd diagonalOfMcc_;  // [3 pairs]
  SubspaceNewtonOptions::Condensed options_;
  BalancedDirection balanced_;
  std::unique_ptr<CondensedDirection> condensed_;
  enum class Offer { None, AnyPrice, Usual } offer_ = Offer::None;
};

}  // namespace Haptos
