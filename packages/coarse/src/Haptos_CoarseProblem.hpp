// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "Haptos_CoarseBlocks.hpp"
#include "Haptos_CoarsePlacement.hpp"
#include "Haptos_Communication.hpp"
#include "Haptos_LocalSolverFactor.hpp"

namespace Haptos {

class CoarseSchurFactor;
class CoarseTreeFactor;

/// \brief The matrix A = sum over ranks of C^T diag(q) C, with C = G^T on this rank's rows, and its sparse factor.
///
/// Unknowns are taken in sixes, the motions of most subdomains; any l will do.  Assembly is distributed (CoarseBlocks); all holders of a factor
/// (CoarsePlacement) have the same digits, or all ranks share one (CoarseTree).
class CoarseProblem {
 public:
  /// \brief Coarse vectors w [l x k]: w w^T, scaled to A, is added to hold motions that nothing else holds.
  using Holds = std::vector<Eigen::SparseVector<double>>;
  using Placement = std::shared_ptr<const CoarsePlacement>;

  /// \param q [owned rows] weights >= 0, or empty for 1; rows of weight 0 are left out.  Collective.
  CoarseProblem(Placement placement, const CoarseRows& C, const std::vector<double>& q, const Holds& holds);
  /// \brief With a factor on every rank.
  CoarseProblem(const Communicator& comm, const CoarseRows& C, const std::vector<double>& q, const Holds& holds);
  /// \brief Rows [m x l] with weights [m] >= 0, or none for 1.
  struct Weighted {
    const CoarseRows& rows;
    const std::vector<double>& q;
  };
  /// \brief With the changing rows of the construction, or with those that `renew` brings before any solve.
  ///
  /// `Rough`, for preconditioners: what changes is factored in single precision as long as that gives three digits.
  enum class Factor { Now, WithRenewal, WithRoughRenewal };
  /// \brief A = C^T diag(q) C of the fixed rows and of those that change.
  ///
  /// \param changing all pairs of subdomains that changing rows may touch.  Collective.
  CoarseProblem(Placement placement, const Weighted& fixed, const Weighted& changing, const Holds& holds, Factor when = Factor::WithRenewal);

  /// \brief The matrix of the fixed rows of `whole` alone, which was factored before; `holds` of its own.  Collective.
  CoarseProblem(const CoarseProblem& whole, const Holds& holds);
  ~CoarseProblem();

  /// \brief Factors A with these changing rows: their part alone is added up and sent, and the analysis stays.  Collective.
  ///
  /// Where changing rows touch few subdomains the others are eliminated once (CoarseSchur).
  /// \throws std::runtime_error on all ranks if A is not positive definite.
  void renew(const Weighted& changing);

  /// \brief x := A^-1 b; b is the same on all ranks, so is x.  Collective where not every rank has the factor.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;

  /// \brief x := A^-1 (sum of the ranks' `mine` - `shift`), the same on all ranks.  Collective.
  ///
  /// \param mine [l x k] of this rank, \param shift the same on all ranks; empty: 0
  Eigen::MatrixXd solveSum(const Eigen::MatrixXd& mine, const Eigen::MatrixXd& shift = {}) const;

  /// \brief Solutions a_k of A a_k = b_k - A_fixed (a_1 + ... + a_k-1), b_k given one after the other.
  ///
  /// A_fixed, A without its changing rows, is not needed: A_fixed a = A a - C^T diag(q) C a of the changing rows, and A a
  /// is known.  All b_k are the first one up to what changing rows add: a condensed factor eliminates the others for the
  /// first only, which saves most of the following solves.
  class Series {
    struct SharedElimination;

   public:
    /// \param problem is kept by reference and must not be renewed.
    /// \param mine [l] this rank's part of b_k that stays the same
    Series(const CoarseProblem& problem, Eigen::VectorXd mine);
    /// \brief a_k [l], right where changing rows may touch.  \param changing [l] this rank's other part of b_k.  Collective.
    Eigen::VectorXd next(const Eigen::VectorXd& changing);
    /// \brief The solution [l] for the fixed rows alone, right everywhere; nothing must be called after it.
    ///
    /// \param fixedAlone was made from the problem.  \param changing as above.  Collective.
    Eigen::VectorXd last(const CoarseProblem& fixedAlone, const Eigen::VectorXd& changing);

   private:
    Eigen::VectorXd addChanging(Eigen::VectorXd changing) const;
    void eliminate(const Eigen::MatrixXd& b);
    int unknown(Eigen::Index row) const;
    double entriesOfNext(bool isFirst) const;
    Eigen::VectorXd solveForRest(const Eigen::VectorXd& more);
    Eigen::MatrixXd substituteBack(const CoarseProblem& fixedAlone, const Eigen::MatrixXd& more);

    const CoarseProblem& problem_;
    Eigen::VectorXd mine_, first_;  // b_k that stays; the first b_k's other part
    // On the holders, where the problem is condensed in the changing unknowns (places), else in all:
    Eigen::MatrixXd eliminated_;    // of the first b_k, or that itself [l]; where ranks share a factor, in places alone
    std::shared_ptr<const SharedElimination> shared_;  // the rest of it then
    Eigen::VectorXd solvedFor_;     // sum of the right-hand sides so far [places]
    Eigen::VectorXd total_;         // of the a_k [l]
  };

  long solves() const { return solves_; }
  const Placement& placement() const { return placement_; }  ///< for further matrices on the same ranks

 private:
  Eigen::MatrixXd solveOnHolders(const Eigen::MatrixXd& b, Eigen::Index rows, Eigen::Index columns) const;
  void count(Eigen::Index columns, double entries) const;
  std::size_t factorEntries() const;
  double largestDiagonalWith(const CoarseBlocks& first) const;
  void countBlocks(const CoarseBlocks& first) const;
  CoarseBlocks sumUp(const Weighted& part) const;
  Eigen::Index paddedSize() const;
  Eigen::MatrixXd padded(Eigen::MatrixXd b) const;
  void addHolds(const Holds& holds, double scale);
  void factor(CoarseBlocks changing);
  void factorWhole();
  void factorCondensed();
  void factorShared();

  Placement placement_;
  Eigen::Index size_;  // l
  std::shared_ptr<const CoarseBlocks> fixed_;  // on the holders, as is held_; or parts of both on all ranks
  CoarseBlocks held_;
  CoarseBlocks changingBlocks_;  // of today, on the holders
  CoarseMatrix matrix_;          // where nothing is condensed
  bool isHeld_ = false;          // on all ranks: there are holds
  bool condenses_ = false;       // on all ranks
  FactorPrecision precision_ = FactorPrecision::Double;  // of what changes
  std::vector<int> changing_;    // subdomains to condense to, on the holders
  std::unique_ptr<LocalSolverFactor> factor_;  // one of the three, null where this rank holds none
  std::unique_ptr<CoarseSchurFactor> condensed_;
  std::unique_ptr<CoarseTreeFactor> shared_;
  mutable long solves_ = 0;
};

}  // namespace Haptos
