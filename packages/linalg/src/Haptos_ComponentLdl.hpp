// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_SparseLdl.hpp"

namespace Haptos {

/// \brief `SparseLdl` of a matrix of three unknowns a node, which needs one third of it where components are equal and do not meet.
///
/// Unknowns 3 i to 3 i + 2 are those of node i.  Any other matrix is factored as it is.
class ComponentLdl {
 public:
  ComponentLdl() = default;
  explicit ComponentLdl(const Eigen::SparseMatrix<double>& S);

  /// \brief S^-1 X [unknowns x any].
  Eigen::MatrixXd solve(const Eigen::MatrixXd& X) const;
  double entriesRead() const { return 2.0 * numComponents_ * factor_.numEntries(); }  ///< by a solve with a vector
  bool isShared() const { return numComponents_ > 1; }  ///< whether one factor is that of each component
  int numDropped() const { return numComponents_ * factor_.numDropped(); }  ///< as `SparseLdl`'s

 private:
  int numComponents_ = 1;
  SparseLdl factor_;
};

}  // namespace Haptos
