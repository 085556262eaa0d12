// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <vector>

#include "Haptos_CoarseBlocks.hpp"
#include "Haptos_DenseSymmetric.hpp"
#include "Haptos_SupernodalFactor.hpp"

namespace Haptos {

/// \brief Cholesky factor of a coarse matrix A + E whose changing part E lies in a few subdomains: they are ordered last.
///
/// The other unknowns are eliminated once, sparse, by CHOLMOD; what is left of A in the changing ones, the Schur
/// complement S, is kept dense.  `renew` adds E to it and factors that sum alone.  No function communicates.
class CondensedFactor {
 public:
  /// \brief Whether renewals are cheaper than those of a sparse factor, by size; false without CHOLMOD.
  ///
  /// \param unknowns of A, \param changing unknowns that E may touch.
  static bool pays(Eigen::Index unknowns, Eigen::Index changing);

  using Parts = std::vector<const CoarseBlocks*>;

  /// \param unknowns l; \param A the sum of these; semidefinite suffices, as `renew` adds to it.
  /// \param changing subdomains that E may touch, at least one, each once.
  /// \throws std::runtime_error if A is not positive definite in the other unknowns.
  CondensedFactor(Eigen::Index unknowns, const Parts& A, const std::vector<int>& changing);

  /// \brief Factors S + E; must be called before the first solve.
  /// \throws std::runtime_error if it is not positive definite.
  void renew(const CoarseBlocks& E);

  /// \brief (A + E)^-1 B [l x m]
  Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;

  /// \name The parts of a solve, for right-hand sides that differ in the changing unknowns only.
  /// @{
  /// \brief B in the order of elimination with the others eliminated; the last rows are the right-hand side of S + E.
  Eigen::MatrixXd eliminate(const Eigen::MatrixXd& B) const;
  /// \brief The last rows := (S + E)^-1 times them.
  void solveSchur(Eigen::Ref<Eigen::MatrixXd> last) const;
  /// \brief S X, both [changing unknowns x m]
  Eigen::MatrixXd multiplySchur(const Eigen::MatrixXd& X) const;
  /// \brief The solution [l x m] from what `eliminate` gave, its last rows solved for.
  Eigen::MatrixXd substituteBack(const Eigen::MatrixXd& Y) const;
  const std::vector<int>& order() const { return perm_; }  ///< [l] unknown of every row of `eliminate`
  Eigen::Index schurSize() const { return schur_.rows(); }
  /// @}

  std::size_t factorEntries() const { return others_.entries() + std::size_t(schur_.size()); }

 private:
  void eliminateOthers(const Parts& A, const std::vector<int>& changing);
  void startSchur(const Parts& A, const std::vector<int>& order);
  void subtractFromSchur(const SupernodeView& L);
  void addChanging(const CoarseBlocks& blocks, Eigen::MatrixXd& lower) const;

  Eigen::Index size_, numOthers_;    // unknowns, of which this many never change
  std::vector<int> place_;           // [subdomains] first row in the Schur complement, -1: none
  std::vector<int> perm_;
  SupernodalFactor<double> others_;  // L's columns of those that never change; nothing if there are none
  Eigen::MatrixXd schur_;            // S, lower triangle
  DenseCholesky changing_;           // of S + E
};

}  // namespace Haptos
