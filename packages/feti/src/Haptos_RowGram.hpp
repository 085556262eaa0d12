// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/SparseCore>
#include <vector>

#include "Haptos_MultiplierMap.hpp"

namespace Haptos {

/// \brief (B W B^T)^+ on the owned rows, with W = 1 / (stiffness weight of the node in the subdomain).
///
/// B W B^T is block diagonal: rows couple only where they share a degree of freedom, and such rows lie on one
/// rank.  Blocks are scaled to unit diagonal and inverted on the part of their spectrum above 1e-10, so dependent
/// rows do no harm; an empty (pinned) row gives zero.  Nothing communicates.
class RowGram {
 public:
  explicit RowGram(const MultiplierMap& multipliers, bool stiffnessScaling = true);

  /// \brief y := (B W B^T)^+ x; may be done in place.
  void apply(const MultiVector& x, MultiVector& y) const;

  const Eigen::SparseMatrix<double, Eigen::RowMajor>& inverse() const { return inverse_; }

 private:
  Eigen::SparseMatrix<double, Eigen::RowMajor> inverse_;
};

}  // namespace Haptos
