// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <functional>
#include <memory>
#include <vector>

#include "Haptos_MultiplierMap.hpp"

namespace Haptos {

/// \brief V B^T between some rows and a compact vector of some unknowns of this rank's subdomains, V diagonal.
class CompactRows {
 public:
  /// \param isKept [overlap rows], the same on all ranks that have a row
  /// \param size of the compact vector
  /// \param place (global subdomain of this rank, local dof) -> position in it, negative: none
  /// \param scale V of an entry.  Collective.
  CompactRows(const MultiplierMap& multipliers, const std::vector<char>& isKept, Eigen::Index size,
              const std::function<Eigen::Index(int subdomain, int dof)>& place,
              const std::function<double(const MultiplierMap::OverlapEntry&)>& scale);

  /// \brief The rank's own kept rows, ascending.
  const std::vector<int>& rows() const { return rows_; }
  Eigen::Index size() const { return spreads_.rows(); }  ///< of the compact vector
  /// \brief T := V B^T X; X [rows() x any], T [size x any].  Collective: an Import for each column.
  Eigen::MatrixXd spread(const Eigen::MatrixXd& X) const;
  /// \brief V B^T of some rows of all ranks, [size x count].
  /// \param columns [rows()] where this rank's own are among them, -1: nowhere.  Collective: one Import.
  Eigen::SparseMatrix<double> spreads(const Eigen::VectorXd& columns, Eigen::Index count) const;
  /// \brief Y := B V T; T [size x any], Y [rows() x any].  Collective: an Export for each column.
  Eigen::MatrixXd collect(const Eigen::MatrixXd& T) const;

 private:
  std::vector<int> rows_;
  std::unique_ptr<const RemoteRows> remote_;
  using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  Matrix collects_, spreads_;  // B V [own rows, then those of others x size] and its transpose: sums of products, and no other writes
};

}  // namespace Haptos
