// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "Haptos_MultiplierMap.hpp"

namespace Haptos {

/// \brief Rows of pairs that depend on each other, exactly or nearly: Q projects onto their forces z with B^T z = 0, or |B^T z| below a thousandth of |z|.
///
/// A node in several contacts has more rows than displacements; nodes that supports hold leave multipliers of mortar to the other side alone, of which
/// there may be more than it has nodes.  Decision: 057-nodes-in-several-contacts.
struct DependentGroup {
  std::vector<GlobalOrdinal> rows;
  std::vector<char> isContact;  ///< of these rows
  Eigen::MatrixXd Q;            ///< [rows]^2
  int dimension;                ///< rank of Q

  /// \brief Of numbers of its rows, weighed by what they take part in Q.
  double mean(const std::vector<double>& ofRows) const;
};

/// \brief Those whose couplings `heldCouplings` brings to this rank.  Groups do not depend on the ranks.  Collective.
std::vector<DependentGroup> findDependentGroups(const MultiplierMap& multipliers);

/// \brief sum s_i Q_i between these rows, [rows]^2, of groups that are among them: s_i the mean of a matrix' diagonal over rows of Q_i.
/// A matrix that has nothing along Q_i, or next to nothing, of which an inverse would make much, is regular with it.  \param rows global.
Eigen::SparseMatrix<double> meanOnDependentRows(const std::vector<DependentGroup>& dependent, const std::vector<GlobalOrdinal>& rows,
                                                const Eigen::VectorXd& diagonal);

}  // namespace Haptos
