// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <unordered_map>
#include <vector>

#include "Haptos_CoarseBlocks.hpp"
#include "Haptos_PlainTypes.hpp"

namespace Haptos {

/// \brief A block of a symmetric coarse matrix, in either triangle: rows 6 s .. 6 s + 5, columns 6 t .. 6 t + 5.
struct CoarseItem {
  int s, t;
  CoarseBlocks::Block block;  ///< by rows
};

/// \brief A dense symmetric matrix over some subdomains, of which a group of ranks eliminates the first together.
///
///   A = [ A_pp A_pu ; A_up A_uu ],   A_pp = L L^T,   W = L^-1:   (A^-1 b)_p = W^T (W b_p - L_up^T x_u),   A_uu := A_uu - L_up L_up^T
///
/// Columns go round the ranks in blocks.  A rank keeps its columns of L_up and the rows of W with the same numbers, so that
/// each half of a solve is one product of its own and one reduction in the group.  Vectors are coarse vectors [l x m] of all
/// unknowns, of which a front reads and writes its own.
class CoarseFront {
 public:
  /// \param pivots, rest subdomains, the same on all ranks of the group, each once
  CoarseFront(RCP<const Communicator> group, std::vector<int> pivots, std::vector<int> rest);

  /// \brief A += what all ranks of the group bring, added up in their order.  Collective in the group.
  void add(const std::vector<CoarseItem>& mine);
  /// \brief Eliminates p.  \return whether A_pp is positive definite, the same on all ranks.  Collective in the group.
  bool eliminate();
  /// \brief This rank's blocks of A_uu, after `eliminate`.
  std::vector<CoarseItem> schur() const;

  /// \brief b_p, summed over the group.  \param b this rank's part.  Collective in the group.
  Eigen::MatrixXd sumPivots(const Eigen::MatrixXd& b) const;
  /// \brief y = W b_p of own rows; b_u := b_u - L_up y, this rank's part of it.
  /// \param bp as from `sumPivots`
  Eigen::MatrixXd forward(const Eigen::MatrixXd& bp, Eigen::MatrixXd& b) const;
  /// \brief x_p := W^T (y - L_up^T x_u).  Collective in the group.
  void backward(const Eigen::MatrixXd& y, Eigen::MatrixXd& x) const;

  /// \brief A^-1 bp, of a front without rest, the same on all ranks.  Collective in the group.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& bp) const;

  const std::vector<int>& pivots() const { return pivots_; }
  const std::vector<int>& rest() const { return rest_; }
  std::size_t entries() const;   ///< on this rank, read in each half of a solve
  double flops() const { return flops_; }  ///< multiplications of `eliminate` on this rank

 private:
  struct Panel {
    int first, count;         // subdomains, by their place in the front
    Eigen::MatrixXd columns;  // of A from the diagonal on; of a pivot, after `eliminate`, L_up alone
    Eigen::MatrixXd W;        // rows of W up to the diagonal, of pivots
  };

  int size() const { return int(pivots_.size() + rest_.size()); }
  bool isPivot(const Panel& panel) const { return panel.first < int(pivots_.size()); }
  int ownerOf(int place) const;
  Eigen::MatrixXd applyW(const Eigen::MatrixXd& bp) const;
  Eigen::MatrixXd applyWTransposed(const Eigen::MatrixXd& z) const;
  Panel& panelOf(int place);
  void makePanels();
  int subdomain(int place) const { return place < int(pivots_.size()) ? pivots_[std::size_t(place)] : rest_[std::size_t(place) - pivots_.size()]; }
  bool factorPanel(Panel& panel, Eigen::MatrixXd& message);
  void update(Panel& panel, const Eigen::MatrixXd& message, int first, int end);

  RCP<const Communicator> group_;
  std::vector<int> pivots_, rest_;
  std::unordered_map<int, int> place_;  // of a subdomain
  std::vector<int> starts_;             // places of blocks of columns, none of which has pivots and others
  std::vector<Panel> panels_;           // of this rank, ascending
  double flops_ = 0;
};

}  // namespace Haptos
