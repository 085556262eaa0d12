// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <vector>

#include "Haptos_ContactNumbering.hpp"
#include "Haptos_ContactOperators.hpp"

namespace Haptos {

/// \brief Preconditioner of A M + B by groups g of pairs that overlap, each solved by itself and answering for its own pairs alone:
///
///   P r = sum_g O_g (A M + B)_g^-1 R_g r
///
/// with R_g the rows of the group and O_g those of its own pairs.  What pairs do to their neighbours is in it, which one pair after the other does not
/// know.  Every group is held by one rank.  Source: Cai, Sarkis, SIAM J. Sci. Comput. 21 (1999) 792 (restricted additive Schwarz).
class SchwarzPreconditioner {
 public:
  struct Groups {
    std::vector<PairGroup> members;  ///< this rank's pairs of each, every pair its own in one
    std::vector<Eigen::MatrixXd> M;  ///< about M between the contact values of a group, of all ranks' pairs, rank after rank
  };
  /// \param numbering stays with the caller.  Collective.
  SchwarzPreconditioner(const ContactNumbering& numbering, Groups groups);

  /// \brief For scaling M and the blocks of all ranks (`ContactNumbering::blocksOfAll`); groups of which no pair has changed keep what they have
  /// while the scaling is the same.
  /// \return whether any is new
  bool renew(double scaling, const Eigen::MatrixXd& blocks);

  Eigen::MatrixXd apply(const Eigen::MatrixXd& r) const;  ///< [contact values of this rank x any].  Collective: two reductions.

 private:
  struct Group {
    std::vector<Eigen::Index> values{};    // of all ranks
    std::vector<Eigen::Index> own{};       // positions among them
    std::vector<Eigen::Index> ownValues{};
    Eigen::MatrixXd blocks{};              // [values x 6] of the factor
    Eigen::MatrixXd M{}, inverse{};        // where the group is held; [own x values]
  };
  bool isHeld(std::size_t group) const;

  const ContactNumbering& numbering_;
  std::vector<Group> groups_;
  double scaling_ = 0;  // of the inverses
};

}  // namespace Haptos
