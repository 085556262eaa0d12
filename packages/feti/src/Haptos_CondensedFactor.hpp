// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "Haptos_CoarseBlocks.hpp"
#include "Haptos_SupernodalFactor.hpp"

namespace Haptos {

/// \brief Cholesky factor of a coarse matrix A + E whose changing part E lies in a few subdomains: they are ordered last.
///
/// The other unknowns are eliminated once, sparse, by CHOLMOD; what is left of A in the changing ones, the Schur
/// complement, is kept dense.  `renew` adds E to it and factors that sum alone.  No function communicates.
class CondensedFactor {
 public:
  /// \brief Whether renewals are cheaper than those of a sparse factor, by size; false without CHOLMOD.
  ///
  /// \param unknowns of A, \param changing unknowns that E may touch.
  static bool pays(Eigen::Index unknowns, Eigen::Index changing);

  /// \param A [l x l] in 6 x 6 blocks, both triangles stored; semidefinite suffices, as `renew` adds to it.
  /// \param changing subdomains that E may touch, at least one, each once.
  /// \throws std::runtime_error if A is not positive definite in the other unknowns.
  CondensedFactor(Eigen::SparseMatrix<double> A, const std::vector<int>& changing);

  /// \brief Factors A + E; must be called before the first solve.
  /// \throws std::runtime_error if it is not positive definite.
  void renew(const CoarseBlocks& E);

  /// \brief X := (A + E)^-1 B, both [l x m].  They must not overlap.
  void solve(const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::Ref<Eigen::MatrixXd> X) const { factor_.solve(B, X); }

  std::size_t factorEntries() const { return factor_.entries(); }

 private:
  // A factor as SupernodeView wants it; the last supernode is that of the changing unknowns.
  struct Nodes {
    std::vector<int> super{0}, pi{0}, px, s, perm;
    std::vector<double> x;
    void append(int columns, const int* rows, int numRows, const double* values);
  };
  void eliminate(Eigen::SparseMatrix<double> A, const std::vector<int>& changing);
  void formSchur(const Eigen::SparseMatrix<double>& A);
  void add(const CoarseBlocks& E, Eigen::Ref<Eigen::MatrixXd> S) const;

  Eigen::Index size_, fixed_;  // unknowns, of which this many come first and never change
  std::vector<int> place_;     // [subdomains] first row in the Schur complement, -1: none
  Nodes nodes_;
  Eigen::MatrixXd schur_;  // lower triangle
  SupernodalFactor<double> factor_;
};

}  // namespace Haptos
