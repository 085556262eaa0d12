// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <vector>

#include "Haptos_LawLinearization.hpp"

namespace Haptos {

/// \brief Where a direction is taken.
struct DirectionPoint {
  const Eigen::VectorXd& lambda;  ///< [rows]
  const Eigen::VectorXd& s;       ///< [rows]
  const Eigen::VectorXd& phi;     ///< [3 pairs] residual of the law, possibly of its linearisation
};

/// \brief A direction for the multipliers, with G v = 0, not normalised.
struct Direction {
  Eigen::VectorXd v;            ///< [rows]
  bool isWhole = false;         ///< v itself is a step, not only a direction to search in
  Eigen::VectorXd jumpChange;   ///< [3 pairs] where it is whole: what v is to change the contact jumps by
  bool leadsOn = true;          ///< what it was made for is solved, at least in part
};

/// \brief How a pair of the subspace is made from the residual of the law: the strategy of the subspace Newton method.
class NewtonDirection {
 public:
  virtual ~NewtonDirection() = default;

  /// For the law itself, or for its linearisation at this r where a strategy can do no more.  \param pairs, law this rank's.  Collective.
  virtual Direction compute(const std::vector<PairLaw>& pairs, const LawLinearization& law, const DirectionPoint& point) = 0;

  /// \brief v^T F v [force x length] of the last direction, if that was whole: what it tells of a model of F.  The same on all ranks.
  virtual void learn(double vFv) { static_cast<void>(vFv); }

  /// \brief What r of the law is measured by [pairs], the stiffness that a pair feels [force/length].
  virtual const Eigen::VectorXd& pairStiffness() const = 0;
};

}  // namespace Haptos
