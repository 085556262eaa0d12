// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Operator.hpp>

#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief Any operator, with a count of the vectors it was applied to.
class CountedOperator final : public Operator {
 public:
  explicit CountedOperator(RCP<const Operator> op) : op_(std::move(op)) {}

  RCP<const Map> getDomainMap() const override { return op_->getDomainMap(); }
  RCP<const Map> getRangeMap() const override { return op_->getRangeMap(); }
  bool hasTransposeApply() const override { return op_->hasTransposeApply(); }
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode = Teuchos::NO_TRANS, double alpha = 1.0,
             double beta = 0.0) const override {
    applications_ += long(x.getNumVectors());
    op_->apply(x, y, mode, alpha, beta);
  }

  long applications() const { return applications_; }
  /// \brief Counts what others did in the place of `applications` of them.
  void count(long applications) const { applications_ += applications; }

 private:
  RCP<const Operator> op_;
  mutable long applications_ = 0;
};

}  // namespace Haptos
