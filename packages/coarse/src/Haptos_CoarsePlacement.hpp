// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "Haptos_Communication.hpp"
#include "Haptos_Options.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief What all coarse matrices of a run cost on this rank.
struct CoarseCosts {
  long setUps = 0, solves = 0;  ///< matrices made, right-hand sides solved
  double setUpSeconds = 0, solveSeconds = 0;
  CommunicationCounts setUpSent, solveSent;
  std::size_t blocks = 0;         ///< 6 x 6, lower triangle, of the first matrix: G G^T; 0 where not held
  std::size_t factorEntries = 0;  ///< the largest factor on this rank, 0 if it never held one
};

/// \brief The ranks in groups, one of each with a factor.  Made once, used by all coarse matrices of a run.
///
/// With groups of one rank every rank holds the factor, and only `sum` communicates.  Otherwise right-hand sides are
/// added up in the group, then among the holders, and solutions are broadcast in the group.
class CoarsePlacement {
 public:
  /// \brief By the size of the coarse matrix.  Collective.
  CoarsePlacement(RCP<const Communicator> comm, Eigen::Index unknowns, const CoarseOptions& options);

  const Communicator& comm() const { return *comm_; }
  /// \brief The same groups and costs with the factor on the next rank of each: who has one matrix need not have all.  Collective.
  std::shared_ptr<const CoarsePlacement> onNextRanks() const;

  bool isReplicated() const { return group_.is_null(); }
  bool holds() const { return isReplicated() || !holders_.is_null(); }  ///< whether this rank has a factor
  int numHolders() const { return numHolders_; }
  int firstHolder() const { return firstHolder_; }  ///< the lowest rank with a factor

  /// \brief Sum over all ranks, on the holders; empty elsewhere.  Collective.
  Eigen::MatrixXd sum(const Eigen::MatrixXd& mine) const;
  /// \brief From the holders to all.  Collective.
  void broadcast(Eigen::MatrixXd& x) const;
  /// \brief Every rank's message, group by group and in each by rank, on the holders; empty elsewhere.  Collective.
  std::vector<std::vector<char>> gather(const std::vector<char>& message) const;

  CoarseCosts& costs() const { return *costs_; }

 private:
  void placeFactors(const Communicator& group, int place);

  RCP<const Communicator> comm_, group_, holders_;  // group_ null: replicated; holders_ null: not a holder
  int numHolders_, firstHolder_ = 0;
  std::shared_ptr<CoarseCosts> costs_ = std::make_shared<CoarseCosts>();
};

}  // namespace Haptos
