// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "Haptos_CoarseSchur.hpp"
#include "Haptos_DenseSymmetric.hpp"
#include "Haptos_LocalSolverFactor.hpp"

namespace Haptos {

/// \brief Cholesky factor of a coarse matrix A + E whose changing part E lies in a few subdomains.
///
/// A is eliminated to those once, by whoever wants to, for any number of E.  `renew` adds E to what is left and factors
/// that sum alone.  No function communicates.
class CoarseSchurFactor {
 public:
  /// \param precision of the factor of S + E; single as long as that gives three digits
  CoarseSchurFactor(std::shared_ptr<const CoarseSchur> A, FactorPrecision precision) : A_(std::move(A)), precision_(precision) {}

  /// \brief Factors S + E; must be called before the first solve.  \param E in subdomains that A was eliminated to.
  /// \throws std::runtime_error if it is not positive definite.
  void renew(const CoarseBlocks& E);

  /// \brief (A + E)^-1 B [l x m]
  Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;
  /// \brief The last rows of what `eliminate` gave := (S + E)^-1 times them.
  void solveSchur(Eigen::Ref<Eigen::MatrixXd> last) const;

  const std::shared_ptr<const CoarseSchur>& schur() const { return A_; }
  Eigen::Index schurSize() const { return A_->numLast(); }
  std::size_t factorEntries() const { return A_->entries(); }

 private:
  std::shared_ptr<const CoarseSchur> A_;
  FactorPrecision precision_;
  bool isSingle_ = false;
  DenseCholesky double_;  // of S + E, one of the two
  SingleCholesky single_;
};

}  // namespace Haptos
