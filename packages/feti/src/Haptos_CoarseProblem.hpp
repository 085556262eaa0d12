// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "Haptos_CoarsePlacement.hpp"
#include "Haptos_LocalSolverFactor.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// Rows: owned dual rows of this rank; columns: all coarse unknowns, 6 x subdomain + mode (global).
using CoarseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// \brief The 6 x 6 blocks of a coarse matrix, on the holders of its factor.
class CoarseBlocks;

/// \brief The matrix A = sum over ranks of C^T diag(q) C, with C = G^T on this rank's rows, and its sparse factor.
///
/// Assembly is distributed: every 6 x 6 block has an owner, who adds up what the ranks have of it in the order of the
/// ranks; the holders of a factor (CoarsePlacement) then gather every block once.  All holders have the same digits.
class CoarseProblem {
 public:
  /// \brief Coarse vectors w [l x k]: w w^T, scaled to A, is added to hold motions that nothing else holds.
  using Holds = std::vector<Eigen::SparseVector<double>>;
  using Placement = std::shared_ptr<const CoarsePlacement>;
  using Blocks = std::shared_ptr<const CoarseBlocks>;

  /// \brief The blocks of sum over ranks of C^T diag(q) C, for matrices that have this part in common.  Collective.
  static Blocks assemble(const CoarsePlacement& placement, const CoarseRows& C, const std::vector<double>& q);

  /// \param q [owned rows] positive weights, or empty for 1
  /// \param common blocks that are added to those of C and need not be sent again; may be null.  Collective.
  CoarseProblem(Placement placement, const CoarseRows& C, const std::vector<double>& q, const Holds& holds,
                const Blocks& common = nullptr);
  /// \brief With a factor on every rank.
  CoarseProblem(const Communicator& comm, const CoarseRows& C, const std::vector<double>& q, const Holds& holds);

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

  Placement placement_;
  std::unique_ptr<LocalSolverFactor> factor_;  // null where this rank holds none
  mutable long solves_ = 0;
};

}  // namespace Haptos
