// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/SparseCore>
#include <memory>

#include "Haptos_DenseSymmetric.hpp"
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

  /// [classes] local subdomains with contact nodes: all that contact rows of M meet.
  const std::vector<std::vector<int>>& activeMembers() const { return active_; }

 private:
  // One nonzero of B_D^T: near row, the rank's own ones first, position in the compact vector of the active subdomains' unknowns.
  struct Entry {
    int row;
    int position;
    double value;
  };

  void findNearRows();
  void findUnknowns(const std::vector<char>& isNear);
  DenseSymmetric denseBlock(int congruenceClass) const;
  void applyLocal(Eigen::VectorXd& t) const;
  void applyBetween(Eigen::VectorXd& part) const;

  RCP<const DualPreconditioner> preconditioner_;
  // "Near" rows share a node with a contact row: B_D couples those and no others.
  std::vector<int> near_;                     // [near] owned rows
  std::vector<char> isContact_;               // [near]
  Eigen::SparseMatrix<double, Eigen::RowMajor> gram_;  // [near x near] (B W B^T)^+
  RCP<const Map> nearMap_;
  std::unique_ptr<const RemoteRows> remote_;  // near rows of others
  std::vector<Entry> entries_;
  std::vector<std::vector<int>> active_;      // [classes] local subdomains with contact nodes
  std::vector<std::vector<int>> unknowns_;    // [classes] positions in the boundary list, union over the members
  std::vector<DenseSymmetric> dense_;         // [classes] S_cc; empty where all of S is applied
  std::vector<Eigen::Index> first_;           // [classes] of their part of the compact vector
  Eigen::Index size_ = 0;
};

/// \brief M x on the contact rows, all rows of x counted; the other rows of the result are of no use.
///
/// Subdomains without contact nodes take no part.
class ContactRows final : public Operator {
 public:
  ContactRows(RCP<const DualPreconditioner> preconditioner, RCP<const ContactBlock> block)
      : preconditioner_(std::move(preconditioner)), block_(std::move(block)) {}

  RCP<const Map> getDomainMap() const override { return preconditioner_->getDomainMap(); }
  RCP<const Map> getRangeMap() const override { return preconditioner_->getRangeMap(); }

  /// Collective: one Import, one Export.
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode = Teuchos::NO_TRANS, double alpha = 1.0,
             double beta = 0.0) const override;

 private:
  RCP<const DualPreconditioner> preconditioner_;
  RCP<const ContactBlock> block_;
};

}  // namespace Haptos
