// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "Haptos_LocalSolverFactor.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// Rows: owned dual rows of this rank; columns: all coarse unknowns, 6 x subdomain + mode (global).
using CoarseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// \brief The matrix A = sum over ranks of C^T diag(q) C, with C = G^T on this rank's rows; factored on every rank.
///
/// Every rank adds the blocks of its own rows; the blocks are gathered and the sparse factor is replicated, so a
/// solve does not communicate.
class CoarseProblem {
 public:
  /// \brief Coarse vectors w [l x k]: w w^T, scaled to A, is added to hold motions that nothing else holds.
  using Holds = std::vector<Eigen::SparseVector<double>>;

  /// \param q [owned rows] positive weights, or empty for 1.  Collective.
  CoarseProblem(const Communicator& comm, const CoarseRows& C, const std::vector<double>& q, const Holds& holds);

  /// \brief x := A^-1 b; b is the same on all ranks, so is x.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;

  long solves() const { return solves_; }

 private:
  std::unique_ptr<LocalSolverFactor> factor_;
  mutable long solves_ = 0;
};

}  // namespace Haptos
