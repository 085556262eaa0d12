// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_LawLinearization.hpp"
#include "Haptos_RecycledSubspace.hpp"

namespace Haptos {

/// \brief The linearised law in the span of m pairs, min || M y - rhs || over their coefficients y; the same on all ranks.
///
///   M = [ R ; J ],  rhs = [ -Q^T s_E ; -phi ],  J = A V_c + B S_c compressed to a triangle over all ranks
///
/// Columns are scaled to length 1, so that a rank can be told from round-off.
class SmallSystem {
 public:
  /// \param gluing Q^T s_E [m] where it is linearised.  Collective: `stackedQr`.
  SmallSystem(const RecycledSubspace& subspace, const LawLinearization& law, const Eigen::VectorXd& gluing, const Communicator& comm);

  /// \brief y, of least length (scaled) where pairs are dependent; damped: min || M y - rhs ||^2 + damping || y ||^2, scaled.
  Eigen::VectorXd solve(double damping = 0) const;
  /// \brief || M y - rhs ||
  double residual(const Eigen::VectorXd& y) const;

 private:
  Eigen::MatrixXd M_;  // [2 m + 1 x m], columns of length 1
  Eigen::VectorXd rhs_, scale_;
};

}  // namespace Haptos
