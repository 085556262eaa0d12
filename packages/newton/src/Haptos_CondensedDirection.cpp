// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CondensedDirection.hpp"

#include <Tpetra_Operator.hpp>

namespace Haptos {
namespace {

RCP<const Operator> contactRowsOf(const ContactOperators::Deflated& deflated, const ContactOperators& dual) {
  return deflated.contactM.is_null() ? contactBlockOf(deflated.M, dual.pairs) : deflated.contactM;
}

}  // namespace

CondensedDirection::CondensedDirection(const ContactOperators::Deflated& deflated, const ContactOperators& dual,
                                       const GluingBalance& balance, const Eigen::VectorXd& without,
                                       const SubspaceNewtonOptions::Condensed& options)
    : balance_(balance), contact_(deflated.M, *contactRowsOf(deflated, dual), balance.vectors(), options) {
  // A pinned pair feels nothing; its r is free, but must be a number.
  const Eigen::VectorXd felt = contact_.normalStiffness();
  pairStiffness_ = (felt.array() > 0).select(felt, without);
}

Direction CondensedDirection::compute(const std::vector<PairLaw>& pairs, const LawLinearization& law, const DirectionPoint& point,
                                      Target target) {
  Direction direction;
  if (target == Target::Law) {
    // sigma solves the law at s_c - sigma, so v is a step as it stands
    CondensedContact::Step step = contact_.solveLaw(pairs, law.r, point.lambda, point.s);
    direction = {std::move(step.z), true, -step.sigma};
  } else {
    direction.v = contact_.solveLinearized(law, point.s, point.phi);
  }
  balance_.balance(direction.v);
  return direction;
}

}  // namespace Haptos
