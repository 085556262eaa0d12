// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>

#include "Haptos_DualPreconditioner.hpp"

namespace Haptos {

/// \brief M_cc: the block of the Dirichlet preconditioner between contact rows, far cheaper than M.
///
/// Only subdomains with contact nodes take part, each with the dense part S_cc of its Schur complement, shared by
/// congruent ones.  Contact nodes beyond `kLargestDense` unknowns a subdomain are not worth a dense S_cc: such a
/// subdomain applies all of S.  Entries of x on other rows are taken as zero, those of y are set to zero.
class ContactBlock final : public Operator {
 public:
  static constexpr int kLargestDense = 1500;

  /// Collective.  `preconditioner` must stay alive.
  explicit ContactBlock(RCP<const DualPreconditioner> preconditioner);

  RCP<const Map> getDomainMap() const override { return preconditioner_->getDomainMap(); }
  RCP<const Map> getRangeMap() const override { return preconditioner_->getRangeMap(); }
  bool hasTransposeApply() const override { return true; }

  /// Collective: one Import, one Export.
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode = Teuchos::NO_TRANS, double alpha = 1.0,
             double beta = 0.0) const override;

 private:
  void findContactUnknowns();
  void applyLocal(MultiVector& t) const;

  RCP<const DualPreconditioner> preconditioner_;
  std::vector<char> isContactRow_;            // [owned rows]
  std::vector<int> active_;                   // local subdomains with contact nodes
  std::vector<std::vector<int>> unknowns_;    // [classes] positions in the boundary list, union over the members
  std::vector<Eigen::MatrixXd> dense_;        // [classes] S_cc; empty where all of S is applied
};

}  // namespace Haptos
