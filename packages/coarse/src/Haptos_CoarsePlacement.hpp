// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "Haptos_Options.hpp"
#include "Haptos_PlainTypes.hpp"

namespace Haptos {

/// \brief What all coarse matrices of a run cost on this rank.
struct CoarseCosts {
  long setUps = 0, solves = 0;  ///< matrices made, right-hand sides solved
  double setUpSeconds = 0, solveSeconds = 0;
  CommunicationCounts setUpSent, solveSent;
  std::size_t blocks = 0;         ///< 6 x 6, lower triangle, of the first matrix: G G^T; 0 where not held
  std::size_t factorEntries = 0;  ///< the largest factor, or share of one, on this rank; 0 if it never held one
  double flops = 0;               ///< multiplications in factors on this rank, where matrices are condensed
  double entriesRead = 0;         ///< of factors in all solves on this rank, each half counted
  long between = 0;               ///< unknowns that groups with this rank eliminate in the first shared matrix; 0 if none
  long last = 0;                  ///< and those that all eliminate last
};

/// \brief A range of ranks, halved as long as there are two.
struct RankRange {
  int begin, end;
  int size() const { return end - begin; }
  RankRange half(int rank) const {
    const int middle = begin + size() / 2;
    return rank < middle ? RankRange{begin, middle} : RankRange{middle, end};
  }
};

/// \brief Where the factors of coarse matrices lie.  Made once, used by all coarse matrices of a run.
///
/// Replicated: every rank holds the factor, and only `sum` communicates.  Shared: each rank holds a share of it (`CoarseTree`).  Else
/// the ranks are in groups, one of each with a factor: right-hand sides are added up in the group, then among the holders, and solutions are
/// broadcast in the group.
class CoarsePlacement {
 public:
  /// \brief By the size of the coarse matrix.  Collective.
  CoarsePlacement(RCP<const Communicator> comm, Eigen::Index unknowns, const CoarseOptions& options);

  const Communicator& comm() const { return *comm_; }
  /// \brief The same groups and costs with the factor on the next rank of each: who has one matrix need not have all.  Collective.
  std::shared_ptr<const CoarsePlacement> onNextRanks() const;

  bool isShared() const { return !groups_.empty(); }
  bool isReplicated() const { return group_.is_null() && !isShared(); }
  bool holds() const { return group_.is_null() || !holders_.is_null(); }  ///< whether this rank has a factor, or a share of it
  int numHolders() const { return numHolders_; }  ///< factors there are
  int firstHolder() const { return firstHolder_; }  ///< the lowest rank with a factor

  /// \brief Sum over all ranks, on the holders; empty elsewhere.  Collective.
  Eigen::MatrixXd sum(const Eigen::MatrixXd& mine) const;
  /// \brief From the holders to all.  Collective.
  void broadcast(Eigen::MatrixXd& x) const;
  /// \brief Every rank's message, group by group and in each by rank, on the holders; empty elsewhere.  Collective.
  std::vector<std::vector<char>> gather(const std::vector<char>& message) const;

  /// \brief Where a factor is shared: all ranks, the half of them that this rank is in, and so on while there are two ranks or more.
  const std::vector<RCP<const Communicator>>& groups() const { return groups_; }

  CoarseCosts& costs() const { return *costs_; }

 private:
  void halve();
  void placeFactors(const Communicator& group, int place);

  RCP<const Communicator> comm_, group_, holders_;  // group_ null: replicated or shared; holders_ null: not a holder
  std::vector<RCP<const Communicator>> groups_;
  int numHolders_, firstHolder_ = 0;
  std::shared_ptr<CoarseCosts> costs_ = std::make_shared<CoarseCosts>();
};

}  // namespace Haptos
