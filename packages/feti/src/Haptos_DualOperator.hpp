// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Tpetra_Operator.hpp>

#include "Haptos_JumpOperator.hpp"

namespace Haptos {

class LocalSystems;

/// \brief F = B K^+ B^T on the dual map [length/force]: jump, local solves, jump.
///
/// Symmetric and positive semidefinite.  Every application to a vector is counted, whoever asks for it.
/// apply is Collective.  One object must not be applied in two threads at once.
class DualOperator final : public Operator {
 public:
  DualOperator(RCP<const JumpOperator> jump, RCP<const LocalSystems> systems);

  RCP<const Map> getDomainMap() const override { return jump_->getRangeMap(); }
  RCP<const Map> getRangeMap() const override { return jump_->getRangeMap(); }
  bool hasTransposeApply() const override { return true; }
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode = Teuchos::NO_TRANS, double alpha = 1.0,
             double beta = 0.0) const override;

  long applications() const { return applications_; }
  /// \brief Counts what others did in the place of `multiplications` of them.
  void count(long multiplications) const { applications_ += multiplications; }
  const JumpOperator& jump() const { return *jump_; }
  const LocalSystems& systems() const { return *systems_; }

 private:
  RCP<const JumpOperator> jump_;
  RCP<const LocalSystems> systems_;
  mutable RCP<MultiVector> f_, u_;  // of the last application: other memory would be other pages each time
  mutable long applications_ = 0;
};

}  // namespace Haptos
