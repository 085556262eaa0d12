// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Teuchos_RCP.hpp>
#include <functional>
#include <vector>

#include "Haptos_CoarseProblem.hpp"
#include "Haptos_ContactLaw.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

class CountedOperator;

/// \brief One of several groups of pairs that overlap: those of its pairs that this rank owns.
struct PairGroup {
  std::vector<int> pairs;
  std::vector<char> isOwn;  ///< [pairs] whether the pair is the group's own, as it is of one
};

/// \brief M between contact values of owned pairs [3 pairs] (N, T1, T2; 0: no such row), where M + D can be factored.
struct ExactContactMap {
  using Map = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;
  Map multiply;  ///< M x.  Collective
  /// y -> d with (M + D) d = y, D [pairs] symmetric and positive semidefinite; of the last D alone; NaN where there is none.  Collective, as is what it returns.
  std::function<Map(const std::vector<Eigen::Matrix3d>& D)> solverWith;
  bool isThere() const { return bool(solverWith); }
};

/// \brief What the subspace Newton method sees: operators, a coarse space and a law per pair; no mesh.
///
/// Find lambda [force] and a such that, with s = h - F lambda + G^T a [length],
///
///   G lambda = e,   s = 0 on gluing rows,   lambda = P(lambda + r s) on the rows of every pair (any r > 0).
///
/// Row indices are local to the map of F; all rows of a pair lie on one rank.
struct ContactOperators {
  RCP<const CountedOperator> F;       ///< symmetric, positive semidefinite [length/force]
  RCP<const Vector> h;                ///< [length]; may be null where `jumpsOf` is there
  /// h - F lambda where it is had cheaper than from h and F, counted with F's; empty: by these.  Collective.
  std::function<RCP<const Vector>(const Vector& lambda)> jumpsOf;
  RCP<const Operator> M;              ///< preconditioner, about F^-1 [force/length]
  RCP<const Operator> contactM;       ///< M between contact rows, on `mapOfRows` of F's map and `contactRows`; null: M itself is used
  RCP<const Operator> contactRowsOfM; ///< from all rows to the contact rows of M; null: M itself is used
  /// A better M with G M = 0 (DeflatedPreconditioner), and M between contact rows where that is cheaper than M; else null.
  struct Deflated {
    RCP<const Operator> M, contactM;
    double stiffness = 1;  ///< of pairs, in parts of what the diagonal of the other M says
    /// M between owned rows (-1: none, zero) of all ranks, as one matrix on every rank [rows of all]^2, rank after rank; empty: made by
    /// columns of M.  Collective.
    std::function<Eigen::MatrixXd(const std::vector<int>& rows)> between{};
    /// Makes jumps of pairs that vary slowly over the surfaces [3 x owned pairs x any], by (N, T1, T2), maybe dependent; empty: there are none.  Collective.
    std::function<Eigen::MatrixXd()> smoothJumps{};
    /// Makes groups of pairs that overlap and cover all, for `SchwarzPreconditioner`; empty: there are none.  Collective.
    std::function<std::vector<PairGroup>()> groups{};
    /// About contactM of groups of owned rows, each by itself: of all ranks' rows, rank after rank, the same on all.  Collective.
    std::function<std::vector<Eigen::MatrixXd>(const std::vector<std::vector<int>>& rows)> ofGroups{};
    ExactContactMap exact{};  ///< where M is F^-1 itself
    double entriesRead = 0;  ///< of matrices, in a product by contactM, over all ranks; 0: not known
  };
  enum class Price { Little, Usual, Any };
  /// Makes one, or none (M null): for little one that is hardly better than M, but for G M = 0, at the usual price where it is likely to pay for itself, at
  /// any where nothing else has led to an answer.  Empty: there is none.  Collective.
  std::function<Deflated(Price)> makeDeflatedM;
  bool needsDeflatedM = false;        ///< M is known to be poor: slender subdomains
  bool isDeflatedMDear = false;       ///< the usual price is some hundred F: one for little is tried first where only the law asks for it
  bool mayNeedDeflatedM = false;      ///< it is likely to be: a slow way is not followed to its end
  RCP<const Vector> diagonalOfM;      ///< [force/length], > 0 on contact rows
  RCP<const CoarseRows> GT;           ///< G^T on the owned rows
  RCP<const CoarseProblem> GGT;       ///< G G^T, with holds where it is singular
  bool contactChangesGGT = false;     ///< it was made with the contact rows, and no others, as changing ones: saves a factor
  Eigen::VectorXd e;                  ///< [l], the same on all ranks
  /// Coarse vectors that span the motions which the gluing rows do not feel [l x k] (of floating bodies,
  /// `findUnheldMotions`), independent; may be empty.  holds [k]: coarse vectors that act on them, `CoarseProblem::Holds`.
  Eigen::MatrixXd motions;
  CoarseProblem::Holds holds;
  std::vector<PairLaw> pairs;         ///< owned pairs
  std::vector<int> gluingRows;        ///< owned rows with s = 0
};

/// \brief M between contact rows, by M itself.  Collective.
RCP<const Operator> contactBlockOf(const RCP<const Operator>& M, const std::vector<PairLaw>& pairs);

}  // namespace Haptos
