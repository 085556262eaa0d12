// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <vector>

#include "Haptos_ContactNumbering.hpp"
#include "Haptos_ContactOperators.hpp"

namespace Haptos {

/// \brief Preconditioner of A M + B by groups g of pairs that overlap, each solved by itself:
///
///   Restricted:  P r = sum_g O_g (A M + B)_g^-1 R_g r            a group answers for its own pairs alone
///   Symmetric:   P r = sum_g R_g^T D_g (M + B)_g^-1 D_g R_g r    for A = 1 and B symmetric and positive semidefinite
///
/// with R_g the rows of the group, O_g those of its own pairs, and D_g^2 = 1 / the number of a pair's groups.  What pairs do to their neighbours is in
/// it, which one pair after the other does not know.  Every group is held by one rank.
/// Source: Cai, Sarkis, SIAM J. Sci. Comput. 21 (1999) 792 (restricted additive Schwarz).
class SchwarzPreconditioner {
 public:
  struct Groups {
    std::vector<PairGroup> members;  ///< this rank's pairs of each, every pair its own in one
    std::vector<Eigen::MatrixXd> M;  ///< about M between the contact values of a group, of all ranks' pairs, rank after rank
  };
  enum class Form { Restricted, Symmetric };
  /// \param numbering stays with the caller.  Collective.
  SchwarzPreconditioner(const ContactNumbering& numbering, Groups groups, Form form = Form::Restricted);
  /// \param M [all contact values]^2, of which groups take their parts
  SchwarzPreconditioner(const ContactNumbering& numbering, const std::vector<PairGroup>& members, const Eigen::MatrixXd& M);
  SchwarzPreconditioner withForm(Form form) const;  ///< of the same groups, to be renewed

  /// \brief For scaling M and the blocks of all ranks (`ContactNumbering::blocksOfAll`); groups of which no pair has changed keep what they have
  /// while the scaling is the same.
  /// \return whether any is new
  bool renew(double scaling, const Eigen::MatrixXd& blocks);

  double entriesRead() const;  ///< of matrices, by an application to a vector, over all ranks

  Eigen::MatrixXd apply(const Eigen::MatrixXd& r) const;  ///< [contact values of this rank x any].  Collective: two reductions.

 private:
  struct Group {
    std::vector<Eigen::Index> values{};    // of all ranks
    std::vector<Eigen::Index> own{};       // positions among them
    std::vector<Eigen::Index> ownValues{};
    Eigen::MatrixXd blocks{};              // [values x 6] of the factor
    Eigen::MatrixXd M{}, inverse{};        // where the group is held; [own x values], D G^-1 D [values x values] of the symmetric form
  };
  void findValues(const std::vector<PairGroup>& members);
  bool isHeld(std::size_t group) const;
  Eigen::MatrixXd inverseOf(const Group& group, const Eigen::MatrixXd& blocks) const;

  const ContactNumbering& numbering_;
  Form form_;
  std::vector<Group> groups_;
  Eigen::VectorXd shares_;  // [all contact values] D
  double scaling_ = 0;  // of the inverses
};

}  // namespace Haptos
