// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/SparseCore>
#include <memory>

#include "Haptos_CompactRows.hpp"
#include "Haptos_DenseSymmetric.hpp"
#include "Haptos_DualPreconditioner.hpp"
#include "Haptos_RowGram.hpp"

namespace Haptos {

/// \brief M_cc: the block of the Dirichlet preconditioner between contact rows, far cheaper than M.
///
/// B_D^T of a vector on contact rows alone needs no gluing rows: it gives all copies of a node the same, (C^T S^-1 x)_n / (sum of
/// their stiffness weights), S and C as in `CouplingGram`.  Only subdomains with contact nodes take part, each with the dense part S_cc of its Schur complement, shared by
/// congruent ones.  Contact nodes beyond `kLargestDense` unknowns a subdomain are not worth a dense S_cc: such a
/// subdomain applies all of S.  Its map is that of the contact rows, `MultiplierMap::contactMap`.
class ContactBlock final : public Operator {
 public:
  static constexpr int kLargestDense = 1500;

  /// Collective.  `preconditioner` must stay alive.
  explicit ContactBlock(RCP<const DualPreconditioner> preconditioner);

  RCP<const Map> getDomainMap() const override { return getRangeMap(); }
  RCP<const Map> getRangeMap() const override { return preconditioner_->jump().multipliers().contactMap(); }
  bool hasTransposeApply() const override { return true; }

  /// Collective: one Import, one Export, and two of S where its rows lie on several ranks.
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode = Teuchos::NO_TRANS, double alpha = 1.0,
             double beta = 0.0) const override;

  /// \brief Entries of matrices that a product reads on this rank, which is what it costs.
  double entriesRead() const;

  /// \name As matrices.  Contact rows of all ranks are numbered rank after rank.
  /// @{
  /// \brief M_cc [contact rows of all]^2, the same on all ranks: the energies of rows, and two solves with their Gram matrix.  Collective.
  Eigen::MatrixXd matrix() const;
  /// \brief [contact rows of this rank x any] becomes that of all, the same on all ranks.  Collective.
  Eigen::MatrixXd onAllRanks(const Eigen::MatrixXd& mine) const;
  using Columns = Eigen::SparseMatrix<double>;
  Columns spreads() const;  ///< V B^T [unknowns of this rank's active subdomains x contact rows of all].  Collective.
  Columns gram() const;     ///< [contact rows of all]^2, their part of `CouplingGram`, the same on all.  Collective.
  /// \brief M += T^T S T of this rank's subdomains, T some columns of `spreads`, in their order.
  void addEnergies(const Columns& spreads, const std::vector<int>& columns, Eigen::MatrixXd& M) const;
  /// @}

  /// \name What contact rows of M meet of the primal side.
  /// @{
  const std::vector<std::vector<int>>& activeMembers() const { return active_; }  ///< [classes] local subdomains with contact nodes
  /// \brief [classes] positions in the boundary list, those of all contact nodes among them.
  const std::vector<std::vector<int>>& unknowns() const { return unknowns_; }
  /// \brief B_D t on contact rows.
  ///
  /// \param t the classes' [unknowns x active members] one after another.  \return [owned contact rows].  Collective.
  Eigen::VectorXd collect(const Eigen::VectorXd& t) const;
  /// @}

 private:
  std::vector<char> findNearRows();
  void findUnknowns(const std::vector<char>& isNear);
  const CouplingGram& pairs() const { return preconditioner_->gram().pairs(); }
  DenseSymmetric denseBlock(int congruenceClass) const;
  void applyLocal(Eigen::MatrixXd& T) const;
  Eigen::MatrixXd spread(const Eigen::MatrixXd& X) const;
  Eigen::MatrixXd energiesOfNearRows() const;
  Eigen::MatrixXd betweenContactRows(const Eigen::MatrixXd& X) const;
  Eigen::MatrixXd stiffnessBetween(std::size_t congruenceClass, const std::vector<int>& positions) const;
  void addEnergiesOf(std::size_t congruenceClass, Eigen::Index first, const Columns& T, Eigen::MatrixXd& M) const;

  RCP<const DualPreconditioner> preconditioner_;
  std::unique_ptr<const CompactRows> near_;   // contact rows, and tied ones that S couples with them
  std::vector<int> contact_, nearPairs_;      // positions of contact rows, and of near ones, among the rows of CouplingGram
  std::vector<std::vector<int>> active_;      // [classes] local subdomains with contact nodes
  std::vector<std::vector<int>> unknowns_;    // [classes] positions in the boundary list, union over the members
  std::vector<DenseSymmetric> dense_;         // [classes] S_cc; empty where all of S is applied
  std::vector<Eigen::Index> first_;           // [classes] of their part of the compact vector
};

/// \brief The contact rows of M: from all rows to `MultiplierMap::contactMap`.
///
/// Only subdomains with contact nodes take part, and the rows that touch them.
class ContactRows final : public Operator {
 public:
  /// Collective.
  ContactRows(RCP<const DualPreconditioner> preconditioner, RCP<const ContactBlock> block);

  RCP<const Map> getDomainMap() const override { return preconditioner_->getDomainMap(); }
  RCP<const Map> getRangeMap() const override { return block_->getRangeMap(); }

  /// Collective: one Import, one Export.
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode = Teuchos::NO_TRANS, double alpha = 1.0,
             double beta = 0.0) const override;

 private:
  void findTouchingRows();
  Eigen::VectorXd multiplyActive(const Eigen::VectorXd& t) const;

  RCP<const DualPreconditioner> preconditioner_;
  RCP<const ContactBlock> block_;
  std::unique_ptr<const CompactRows> touching_;  // rows with unknowns of active subdomains, all of their boundaries
};

}  // namespace Haptos
