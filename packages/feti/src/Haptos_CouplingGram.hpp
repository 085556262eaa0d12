// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "Haptos_ComponentLdl.hpp"
#include "Haptos_DependentGroups.hpp"
#include "Haptos_HolderTransfer.hpp"
#include "Haptos_MultiplierMap.hpp"

namespace Haptos {

/// \brief S = C W C^T between the rows of pairs, contact and tied, and its inverse: B W B^T once gluing rows are eliminated.
///
/// C has the rows on the level of nodes (axis x weight, prescribed components left out), W = 1 / sum of the stiffness weights
/// of a node's copies.  Rows that meet at nodes and lie on one rank are solved by small dense inverses, scaled to unit diagonal
/// and cut below 1e-10; where they lie on several ranks, or are many, one rank holds a sparse factor of them, and an
/// application gathers and scatters once.  Three rows of a pair are turned to global axes there, in which S has a block a component,
/// the same where all components of a node or none are prescribed (`ComponentLdl`).
/// Where rows depend on others, or nearly (`DependentGroup`), S + sum s_i Q_i is inverted, s_i the mean of S's diagonal: S^-1 makes nothing much of them.
/// An empty (pinned) row gives zero.  Decision: 023-rows-of-pairs-on-nodes.
class CouplingGram {
 public:
  /// Collective.
  CouplingGram(const MultiplierMap& multipliers, bool stiffnessScaling);

  const std::vector<int>& rows() const { return rows_; }    ///< owned rows of pairs, ascending
  const std::vector<int>& nodes() const { return nodes_; }  ///< positions in MultiplierMap::nodeRows that pairs act on, with gluing rows

  struct Entry {
    int row, column;
    double value;
  };
  /// \brief Entries of S that this rank has, by other numbers.  \param numbers [rows()] of this rank's, -1: left out.  Collective.
  std::vector<Entry> entries(const Eigen::VectorXd& numbers) const;
  /// \brief S^-1 X, [rows() x any].  Collective where rows meet across ranks.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& X) const;
  /// \brief x := S^-1 (x + C z), z := C^T x then; x [rows() x any], z [3 nodes() x any].  Collective where rows meet across ranks.
  void solve(Eigen::MatrixXd& x, Eigen::MatrixXd& z) const;
  double entriesRead() const { return double(inverse_.nonZeros()) + factor_.entriesRead(); }  ///< by `solve` of a vector, on this rank
  /// \brief Whether it is so on any rank, if `solve` is Collective, else here.  Collective then.
  bool isWhereSolved(bool mine) const;

  /// \name Diagonals of S^-1 and of C^T S^-1 C with one over S's diagonal for S^-1: the same on any number of ranks.
  /// @{
  const Eigen::VectorXd& rowDiagonal() const { return rowDiagonal_; }
  const Eigen::VectorXd& nodeDiagonal() const { return nodeDiagonal_; }
  /// @}

  const std::vector<DependentGroup>& dependent() const { return dependent_; }  ///< as `findDependentGroups` found them
  bool hasFactors() const { return isAnyHeld_; }  ///< whether some rank solves with a sparse factor
  bool sharesFactor() const { return factor_.isShared(); }  ///< whether this rank's factor is that of each component of its pairs
  int numDropped() const { return factor_.numDropped(); }  ///< unknowns that depend on others, of this rank's factor

 private:
  using Matrix = Eigen::SparseMatrix<double>;
  struct Group;   // rows that meet
  struct Held;    // couplings at the rank that has their factor

  void findRowsAndNodes();
  std::vector<Group> findLocalGroups() const;
  std::vector<GlobalOrdinal> globalRows(const Group& group) const;
  void invertGroups(const std::vector<Group>& groups);
  void addDiagonals(const Coupling& coupling);
  std::vector<int> findHolders(const std::vector<Group>& groups) const;
  void holdFactors(const std::vector<int>& holders);
  Matrix onHeldDependentRows(const Held& held) const;
  void factorHeld(const Held& held);
  HolderTransfer::Ends endsOfRows(const std::vector<int>& holders, const Held& held) const;
  void addNodes(const std::vector<int>& holders, const Held& held, HolderTransfer::Ends& ends) const;
  void setHeldDiagonals();
  double weightOf(const PairNode& node) const { return 1.0 / (stiffnessScaling_ ? node.stiffness : double(node.copies)); }
  int positionOfRow(int row) const;
  int positionOfNode(std::int64_t node) const;

  const MultiplierMap& multipliers_;
  bool stiffnessScaling_;
  std::vector<DependentGroup> dependent_;
  std::vector<int> rows_, nodes_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> gram_, inverse_, C_;  // of the groups that are inverted
  bool isAnyHeld_ = false;                                    // on any rank
  HolderTransfer rowTransfer_, transfer_;
  Matrix turn_, heldC_;  // [unknowns x held rows], [unknowns x 3 held nodes]
  Matrix heldGram_;  // [unknowns]^2
  ComponentLdl factor_;
  Eigen::VectorXd rowDiagonal_, nodeDiagonal_;
};

}  // namespace Haptos
