// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "Haptos_CoarseBlocks.hpp"
#include "Haptos_LocalSolverFactor.hpp"

namespace Haptos {

/// \brief The coarse matrix A = A_0 + Delta, A_0 = C^T diag(q) C fixed, Delta changing on few subdomains.
///
/// The unknowns o of subdomains that Delta never touches are eliminated once; each change costs one dense Cholesky
/// factor of  S = A_cc - A_co A_oo^-1 A_oc + Delta_cc.  Where the changing unknowns c are too many for that, or A_oo is
/// singular, the whole A is factored anew.  Replicated: a solve does not communicate.
class ChangingCoarseProblem {
 public:
  /// \param changing subdomains of Delta on this rank; those of all ranks are united.
  /// \param holds    coarse vectors w: scale w w^T belongs to A_0, scale its largest diagonal entry.  Collective.
  ChangingCoarseProblem(const Communicator& comm, const CoarseRows& C, const std::vector<double>& q,
                        const CoarseProblem::Holds& holds, std::vector<int> changing);

  /// \brief Takes the sum over the ranks of `delta`, with blocks of changing subdomains only.  Collective.
  void update(const CoarseBlocks& delta);

  /// \brief A^-1 b, the same on all ranks as b is.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

 private:
  bool eliminateFixed();
  void formSchur(const Eigen::SparseMatrix<double>& Aoc, const Eigen::SparseMatrix<double>& Acc);

  const Communicator& comm_;
  Eigen::Index size_;
  CoarseProblem::Holds holds_;
  double holdScale_;
  CoarseBlocks base_;
  std::vector<int> fixed_, changing_;  ///< coarse unknowns o and c, ascending
  std::vector<int> place_;             ///< [size] position in c, or -1
  std::unique_ptr<LocalSolverFactor> fixedFactor_, wholeFactor_;
  Eigen::SparseMatrix<double> Aoc_;
  Eigen::MatrixXd Z_;       ///< A_oo^-1 A_oc, empty if it would be large
  Eigen::MatrixXd schur_;   ///< lower triangle, without Delta
  Eigen::MatrixXd factor_;  ///< Cholesky factor with Delta
};

}  // namespace Haptos
