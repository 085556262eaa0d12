// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <utility>
#include <vector>

#include "Haptos_CoarseBlocks.hpp"
#include "Haptos_SupernodalFactor.hpp"

namespace Haptos {

/// \brief A coarse matrix A with all unknowns eliminated but those of a few subdomains, which are ordered last.
///
/// What is left of A in those, the Schur complement S, is dense.  CHOLMOD eliminates, sparse.  No function communicates.
class CoarseSchur {
 public:
  static bool isPossible();  ///< CHOLMOD is there
  /// \brief Whether dense factors of what is left are cheaper than sparse ones of all, by size; false without CHOLMOD.
  ///
  /// Few enough of them, or fewer entries than a sparse factor has.  \param unknowns of A, \param last that are not eliminated.
  static bool pays(Eigen::Index unknowns, Eigen::Index last);

  using Parts = std::vector<const CoarseBlocks*>;

  /// \param unknowns l; \param A the sum of these, semidefinite suffices; \param last subdomains, at least one, each once.
  /// \throws std::runtime_error if A is not positive definite in the other unknowns.
  CoarseSchur(Eigen::Index unknowns, const Parts& A, const std::vector<int>& last);

  /// \brief B [l x m] in the order of elimination with the others eliminated; the last rows are the right-hand side for S.
  Eigen::MatrixXd eliminate(const Eigen::MatrixXd& B) const;
  /// \brief The solution [l x m] from what `eliminate` gave, its last rows solved for.
  Eigen::MatrixXd substituteBack(const Eigen::MatrixXd& Y) const;

  Eigen::Index numLast() const { return size_ - numOthers_; }   ///< unknowns that are not eliminated
  const std::vector<double>& packedSchur() const { return schur_; }  ///< S, lower triangle, packed (Lapack::packLower)
  std::vector<double> takeSchur() { return std::move(schur_); }      ///< the same, for who keeps it elsewhere
  /// \brief Adds blocks of the last subdomains to the lower triangle of a matrix like S; others are left out.
  void addLast(const CoarseBlocks& blocks, Eigen::MatrixXd& lower) const;
  bool isLast(int subdomain) const { return place_[std::size_t(subdomain)] >= 0; }

  const std::vector<int>& order() const { return perm_; }  ///< [l] unknown of every row of `eliminate`
  std::size_t entries() const { return others_.entries() + std::size_t(schur_.size()); }
  double flops() const { return flops_; }  ///< multiplications of the elimination

 private:
  void eliminateOthers(const Parts& A, const std::vector<int>& last);
  Eigen::MatrixXd startSchur(const Parts& A, const std::vector<int>& order);
  void subtractFromSchur(const SupernodeView& L, Eigen::MatrixXd& schur) const;

  Eigen::Index size_, numOthers_;    // unknowns, of which this many are eliminated
  std::vector<int> place_;           // [subdomains] first row in the Schur complement, -1: none
  std::vector<int> perm_;
  SupernodalFactor<double> others_;  // L's columns of the others; nothing if there are none
  std::vector<double> schur_;
  double flops_ = 0;
};

}  // namespace Haptos
