// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>

#include "Haptos_DualVectors.hpp"

namespace Haptos {

/// \brief The contact values of all ranks as one vector on each, rank after rank.
class ContactNumbering {
 public:
  explicit ContactNumbering(const DualVectors& vectors);  ///< Collective

  Eigen::Index first() const { return first_; }  ///< of this rank's among all
  Eigen::Index mine() const { return mine_; }
  Eigen::Index size() const { return size_; }
  const DualVectors& vectors() const { return vectors_; }

  /// \brief [mine x any] becomes [size x any], the same on all.  Collective.
  Eigen::MatrixXd onAllRanks(const Eigen::MatrixXd& mine) const;
  /// \brief Row by row the blocks of the row's pair side by side, [size x 6].  Collective.
  Eigen::MatrixXd blocksOfAll(const std::vector<Eigen::Matrix3d>& A, const std::vector<Eigen::Matrix3d>& B) const;

 private:
  const DualVectors& vectors_;
  Eigen::Index first_ = 0, mine_ = 0, size_ = 0;
};

/// \brief Whether a row of `blocksOfAll` says d = b / B by itself, without A and with B on the diagonal: normal components of closed pairs, all of those that stick.
bool isKnown(const Eigen::MatrixXd& blocks, Eigen::Index row);

/// \brief Whether the block of a pair differs by more than a tenth: a factor with the one before is not much of one with this.
bool hasBlockChanged(const Eigen::Matrix3d& before, const Eigen::Matrix3d& now);
/// \brief The same of either block in three rows of `blocksOfAll`.
bool hasChanged(const Eigen::Ref<const Eigen::MatrixXd>& before, const Eigen::Ref<const Eigen::MatrixXd>& now);

}  // namespace Haptos
