// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <vector>

#include "Haptos_ContactBlock.hpp"

namespace Haptos {

/// \brief M_cc - W W^T, on `MultiplierMap::contactMap`: M_Z between contact rows, where nothing is slender.
///
/// Pi is a projection, so Pi^T S Pi = S - S Z K^+ Z^T S, and W W^T = Y_c K^+ Y_c^T with Y = B_D S Z.  W lies with its contact rows; W^T x is
/// summed over the ranks.  On large surfaces most of Y is zero, and W = Y C^T is kept by its factors.
class DeflatedContactBlock final : public Operator {
 public:
  /// \param W [owned contact rows x any]
  DeflatedContactBlock(const RCP<const DualPreconditioner>& base, Eigen::MatrixXd W) : block_(base), W_(std::move(W)) {}
  /// \param Y [owned contact rows x motions], \param C [any x motions], the same on all ranks, with K^+ = C^T C: W = Y C^T.  Collective.
  DeflatedContactBlock(const RCP<const DualPreconditioner>& base, Eigen::SparseMatrix<double> Y, Eigen::MatrixXd C);

  RCP<const Map> getDomainMap() const override { return block_.getDomainMap(); }
  RCP<const Map> getRangeMap() const override { return block_.getRangeMap(); }
  bool hasTransposeApply() const override { return true; }
  double entriesRead() const;  ///< of this rank; of what all ranks have its part
  /// Collective: as `ContactBlock`, and one sum.
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode = Teuchos::NO_TRANS, double alpha = 1.0, double beta = 0.0) const override;

  /// \brief Between some rows, by the energies of all: far cheaper than by columns.
  /// \param rows positions of this rank's rows among `contactMap`, -1: none, with a row and column of zeros
  /// \return of all ranks' rows given, rank after rank, the same on all.  Collective.
  Eigen::MatrixXd between(std::vector<int> rows) const;

  /// \brief What M_Z would be if the contact rows of a group were all there are, for one group after another.
  ///
  /// Their Gram matrix is that of the group: between all rows its inverse has entries everywhere, and M_Z of a group would cost its products.
  /// \param groups [groups] positions of this rank's rows among `contactMap`, -1: none, with a row and column of zeros
  /// \return [groups] of all ranks' rows, rank after rank, the same on all.  Collective.
  std::vector<Eigen::MatrixXd> ofGroups(const std::vector<std::vector<int>>& groups) const;

 private:
  struct RowsOfAll {
    std::vector<int> rows, places;  // among contact rows of all, among those given
    Eigen::Index count;             // of those given
  };
  RowsOfAll rowsOfAll(std::vector<int> rows) const;
  bool isSparse() const { return C_.size() > 0; }
  Eigen::MatrixXd rootOfAll() const;
  void subtract(double alpha, const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::Ref<Eigen::MatrixXd> result) const;
  Eigen::MatrixXd transposedTimes(const Eigen::Ref<const Eigen::MatrixXd>& X) const;

  ContactBlock block_;
  Eigen::MatrixXd W_;  // or W = Y C^T:
  Eigen::SparseMatrix<double> Y_;
  Eigen::MatrixXd C_;
};

}  // namespace Haptos
