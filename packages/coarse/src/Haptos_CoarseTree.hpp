// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "Haptos_CoarseFront.hpp"
#include "Haptos_CoarsePlacement.hpp"
#include "Haptos_CoarseSchur.hpp"

namespace Haptos {

/// \brief When the subdomains of a coarse matrix are eliminated: by one rank, by a group of ranks, or last.
///
/// Ranks are halved again and again, a binary tree.  A subdomain is at home on a rank (in the order of both).  Where the homes of two coupled subdomains
/// part, at a group of ranks, one of them stays for this group; what is left at home is coupled to no other rank's.  Of the couplings that part
/// at a group the subdomain with most of those that are left is taken, again and again, so that few stay.
class EliminationOrder {
 public:
  static constexpr int kLast = -1;  ///< depth of those that are eliminated last, and by all

  /// \param couplings this rank's blocks; \param last subdomains, the same on all ranks.  Collective.
  EliminationOrder(const CoarsePlacement& placement, int subdomains, const CoarseSchur::Parts& couplings, const std::vector<int>& last);

  int homeOf(int subdomain) const { return int((long long)(subdomain)*ranks_ / int(depth_.size())); }
  /// \brief Of the group, 0: all ranks; kLast; beyond all groups: at home.
  int depthOf(int subdomain) const { return depth_[std::size_t(subdomain)]; }
  bool staysHome(int subdomain) const { return depthOf(subdomain) == kHome; }
  /// \brief Where a block is first added to what a rank eliminates: at home of the subdomain that goes first.
  int rankOfBlock(int s, int t) const { return homeOf(depthOf(t) > depthOf(s) ? t : s); }

 private:
  static constexpr int kHome = 1 << 20;
  using Pair = std::array<int, 2>;
  std::vector<Pair> crossing(const Communicator& comm, const CoarseSchur::Parts& couplings) const;
  int parting(const Pair& pair) const;
  void cover(std::vector<Pair> pairs, int depth);

  int ranks_;
  std::vector<int> depth_;  // [subdomains]
};

/// \brief A coarse matrix A with all unknowns eliminated but the last, each rank's own ones by that rank (`CoarseSchur`), those
/// between ranks by groups of ranks, dense (`CoarseFront`), from the smallest group to all: multifrontal, with the ranks as its tree.
///
/// What is left, S over the last subdomains, is spread over all ranks.  Vectors are [l x m], l in sixes.
class CoarseTree {
 public:
  /// \param A the sum over all ranks of all these; \param last may be empty
  /// \throws std::runtime_error on all ranks if A is not positive definite in the others.  Collective.
  CoarseTree(const CoarsePlacement& placement, Eigen::Index unknowns, const CoarseSchur::Parts& A, std::vector<int> last);

  /// \brief What a solve keeps between its halves.
  struct Eliminated {
    Eigen::MatrixXd own;                  // of this rank, as CoarseSchur::eliminate gives it
    std::vector<Eigen::MatrixXd> fronts;  // by depth
    Eigen::MatrixXd last;                 // right-hand side for S [6 last x m], the same on all ranks
  };
  /// \param b the same on all ranks.  Collective.
  Eliminated eliminate(const Eigen::MatrixXd& b) const;
  /// \param last x of the last subdomains; \return x, the same on all ranks.  Collective.
  Eigen::MatrixXd substituteBack(const Eliminated& b, const Eigen::MatrixXd& last) const;

  const CoarseFront& last() const { return last_; }  ///< S, not factored
  std::size_t entries() const;                       ///< on this rank
  long between() const;                              ///< unknowns that groups with this rank eliminate
  double flops() const;                              ///< multiplications on this rank

 private:
  std::vector<CoarseItem> eliminateOwn(const Communicator& comm, const EliminationOrder& order, const CoarseSchur::Parts& A);
  void eliminateShared(const CoarsePlacement& placement, const EliminationOrder& order, std::vector<CoarseItem> left);

  const Communicator& comm_;
  Eigen::Index size_;
  std::vector<int> home_;             // subdomains at home here, whatever their depth
  std::vector<int> inner_, outer_;    // eliminated by this rank alone; coupled to those
  std::unique_ptr<CoarseSchur> own_;  // of the inner ones, the outer ones and one more that is coupled to nothing
  std::vector<CoarseFront> fronts_;   // by depth, of the groups that this rank is in
  CoarseFront last_;
};

/// \brief Factor of A + E, E in the last subdomains of a tree.
class CoarseTreeFactor {
 public:
  explicit CoarseTreeFactor(std::shared_ptr<const CoarseTree> tree) : tree_(std::move(tree)), last_(tree_->last()) {}

  /// \brief Factors S + E.  \param E its sum over all ranks counts.
  /// \throws std::runtime_error on all ranks if it is not positive definite.  Collective.
  void renew(const CoarseBlocks& E);
  /// \brief (A + E)^-1 b, the same on all ranks, as is b [l x m].  Collective.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;
  /// \brief (S + E)^-1 b [6 last x m].  Collective.
  Eigen::MatrixXd solveLast(const Eigen::MatrixXd& b) const;

  const std::shared_ptr<const CoarseTree>& tree() const { return tree_; }
  std::size_t entries() const { return tree_->entries() + last_.entries(); }
  double flops() const { return last_.flops(); }  ///< of the last `renew`, on this rank

 private:
  std::shared_ptr<const CoarseTree> tree_;
  CoarseFront last_;
};

}  // namespace Haptos
