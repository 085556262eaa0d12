// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "Haptos_CoarseBlocks.hpp"
#include "Haptos_CoarsePlacement.hpp"
#include "Haptos_LocalSolverFactor.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief The matrix A = sum over ranks of C^T diag(q) C, with C = G^T on this rank's rows, and its sparse factor.
///
/// Assembly is distributed (CoarseBlocks); all holders of a factor (CoarsePlacement) have the same digits.
class CoarseProblem {
 public:
  /// \brief Coarse vectors w [l x k]: w w^T, scaled to A, is added to hold motions that nothing else holds.
  using Holds = std::vector<Eigen::SparseVector<double>>;
  using Placement = std::shared_ptr<const CoarsePlacement>;

  /// \param q [owned rows] positive weights, or empty for 1.  Collective.
  CoarseProblem(Placement placement, const CoarseRows& C, const std::vector<double>& q, const Holds& holds);
  /// \brief With a factor on every rank.
  CoarseProblem(const Communicator& comm, const CoarseRows& C, const std::vector<double>& q, const Holds& holds);
  /// \brief A = C^T diag(q) C + X^T diag(q) X, where X may be `renew`ed within its subdomains.  Collective.
  CoarseProblem(Placement placement, const CoarseRows& C, const CoarseRows& X, const std::vector<double>& q, const Holds& holds);

  /// \brief Another X in A: its part alone is added up and sent, and the factor's analysis stays.  Collective.
  ///
  /// \param X rows that touch pairs of subdomains which a row of the first X or C touched as well.
  void renew(const CoarseRows& X, const std::vector<double>& q);

  /// \brief x := A^-1 b; b is the same on all ranks, so is x.  Collective where not every rank has the factor.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;

  /// \brief x := A^-1 (sum of the ranks' `mine` - `shift`), the same on all ranks.  Collective.
  ///
  /// \param mine [l x k] of this rank, \param shift the same on all ranks; empty: 0
  Eigen::MatrixXd solveSum(const Eigen::MatrixXd& mine, const Eigen::MatrixXd& shift = {}) const;

  long solves() const { return solves_; }
  const Placement& placement() const { return placement_; }  ///< for further matrices on the same ranks

 private:
  Eigen::MatrixXd solveOnHolders(const Eigen::MatrixXd& b, Eigen::Index rows, Eigen::Index columns) const;
  void factor(const CoarseBlocks& changing);

  Placement placement_;
  CoarseBlocks fixed_;   // on the holders, holds among them
  CoarseMatrix matrix_;
  std::unique_ptr<LocalSolverFactor> factor_;  // null where this rank holds none
  mutable long solves_ = 0;
};

}  // namespace Haptos
