// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <BelosLinearProblem.hpp>
#include <BelosTpetraAdapter.hpp>  // the traits of MultiVector and Operator, before any use of them

#include "Haptos_ContactOperators.hpp"
#include "Haptos_CountedOperator.hpp"

namespace Haptos {

/// \brief A dual contact problem as a Belos linear problem: operator, left and right side are F, lambda and h.
///
/// lambda is start (made to obey G lambda = e) and result.
class ContactProblem : public Belos::LinearProblem<double, MultiVector, Operator> {
 public:
  /// \throws std::logic_error if operators are missing, or their sizes or contact rows do not agree.
  ContactProblem(ContactOperators operators, const RCP<MultiVector>& lambda);

  const ContactOperators& operators() const { return operators_; }

  /// \brief Other loads or laws for the same operators; who solves goes on by SubspaceNewtonSolMgr::goOn.
  /// \param h may be null where `ContactOperators::jumpsOf` tells of the new loads
  /// \param pairs the same rows in the same order
  void setStep(const RCP<const Vector>& h, const Eigen::VectorXd& e, const std::vector<PairLaw>& pairs);

 private:
  ContactOperators operators_;
};

}  // namespace Haptos
