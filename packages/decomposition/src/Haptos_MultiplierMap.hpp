// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "Haptos_ConstraintRows.hpp"
#include "Haptos_RemoteRows.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief A contact pair as the rank that owns its rows sees it; row indices local to MultiplierMap::map().
struct LocalPair {
  int interface;         ///< position in the list of interfaces
  int pair;              ///< position in the interface's pairs
  int normal;            ///< local row
  int tangential[2];     ///< local rows, -1 without friction
  ContactPair geometry;  ///< nodes, axes, gap [length], area [length^2]
};

/// \brief A pair without a law, as the rank that owns its rows sees it.
struct TiedPair {
  int interface, pair;      ///< as in LocalPair
  std::array<int, 3> rows;  ///< local, by global axis; -1 where both sides are prescribed
  ContactPair geometry;
};

/// \brief A node that rows of a pair act on; plain data, to be sent.
struct PairNode {
  std::int64_t node;  ///< mesh index
  double weight;      ///< > 0 on the secondary side
  double stiffness;   ///< sum of the weights of its copies
  int copies;
  int owner;          ///< rank of its gluing rows; -1: it has none
  std::array<char, 3> isPrescribed;
};

/// \brief The rows of a pair on the level of nodes: row a of it is  sum over nodes and components  axes[a][d] weight u_d.
struct Coupling {
  std::array<int, 3> rows;  ///< local; -1: none
  std::array<std::array<double, 3>, 3> axes;
  std::vector<PairNode> nodes;  ///< each once
  int holder;                   ///< lowest rank of all whose rows meet these at nodes; -1: this rank has all of them
  bool meetsContact;            ///< whether rows of contact pairs are among them
};

/// \brief A node's gluing and Dirichlet rows, all of them this rank's; local rows.
struct NodeRows {
  std::int64_t node;            ///< mesh index
  int gluing;                   ///< the first of 3 (copies - 1), component by component; -1: none
  std::array<int, 3> dirichlet; ///< by component; -1: none
  int holder;                   ///< as in Coupling, of the pairs' rows that act on it
  std::size_t first;            ///< of its copies in MultiplierMap::copyStiffness
  int copies;
};

/// \brief A node of one of this rank's subdomains that rows of pairs act on.
struct CoupledCopy {
  int subdomain;  ///< global
  int localNode;
  double meanStiffness;  ///< over all copies of the node
};

struct RowShare;

/// \brief Who owns which multiplier, and what this rank must know of its rows.
///
/// Rows of B u <= / = c of Total FETI in the paper's order: gluing, Dirichlet, (tied,) N, T1, T2; within these by node (and
/// component) or by interface and pair.  Gluing rows are non-redundant and orthonormal: a node with mu copies has mu - 1 rows
/// per component, (1, .., 1, -j, 0, ..) / sqrt(j (j+1)), the owner's copies first.  Dirichlet rows have the entries 1/sqrt(mu),
/// once per node and component, so c = sqrt(mu) value.  Rows of pairs act on the means of the copies of their nodes, so that B u
/// is the jump [length] and the multiplier the force [force]; prescribed components are eliminated from them, which keeps B
/// of full row rank.  A row that is left empty by this is `pinned`.  A tied pair has three equality rows, one per
/// global axis, with c = 0; one that is left empty is not there at all.
///
/// `map` is the one-to-one map of all dual unknowns; gluing and Dirichlet rows of a node lie on one rank, and all
/// rows of a pair do.  `overlapMap` holds the rank's own rows, in the order of `map`, then rows of others
/// that touch its subdomains.  Decision: 022-rows-on-ranks.
class MultiplierMap {
 public:
  /// \brief Rows are made by all ranks together, from what each brings.  Collective.
  /// \throws InsufficientModel where displacements prescribed on both sides part a tied pair; InputError for nodes without elements
  MultiplierMap(const RCP<const Communicator>& comm, const RowSources& sources);

  const RCP<const Map>& map() const { return map_; }
  const RCP<const Map>& overlapMap() const { return overlapMap_; }
  const RemoteRows& remote() const { return *remote_; }  ///< those of others in overlapMap

  GlobalOrdinal numEquality() const { return numEquality_; }  ///< m of the paper
  GlobalOrdinal numPairs() const { return numPairs_; }        ///< m_c, over all ranks
  const std::vector<RowKind>& kinds() const { return kinds_; }     ///< [owned rows]
  const std::vector<char>& pinned() const { return pinned_; }      ///< [owned rows]
  const std::vector<double>& c() const { return c_; }              ///< [owned rows]
  const std::vector<std::int64_t>& nodes() const { return nodes_; } ///< [owned rows] mesh node
  const std::vector<LocalPair>& pairs() const { return pairs_; }   ///< owned pairs

  const std::vector<int>& contactRows() const { return contactRows_; }  ///< owned rows of pairs, ascending
  const RCP<const Map>& contactMap() const { return contactMap_; }      ///< of those alone, in their order

  const std::vector<TiedPair>& tiedPairs() const { return tiedPairs_; }  ///< owned
  const std::vector<Coupling>& couplings() const { return couplings_; }  ///< of owned pairs, tied ones after the others
  const std::vector<NodeRows>& nodeRows() const { return nodeRows_; }    ///< owned, ascending in the node
  const std::vector<double>& copyStiffness() const { return copyStiffness_; }  ///< of the copies of nodeRows, in the rows' order
  const std::vector<CoupledCopy>& coupledCopies() const { return coupledCopies_; }  ///< of this rank's subdomains

  /// \brief One nonzero of B of a subdomain of this rank; `row` is local to overlapMap.
  struct OverlapEntry {
    int row;
    int subdomain;  ///< global
    int dof;        ///< local in the subdomain
    double value;
    double weight;  ///< stiffness weight of the node in the subdomain
  };
  /// Entries of this rank's subdomains, sorted by (subdomain, row, dof).
  const std::vector<OverlapEntry>& overlapEntries() const { return overlapEntries_; }

 private:
  void takeOwnRows(const RCP<const Communicator>& comm, const RowShare& share);
  void takeNodes(const RowShare& share);
  void takePairs(const RowShare& share);
  void takeEntries(const RowSources& sources, const RowShare& share);

  RCP<const Map> map_, overlapMap_, contactMap_;
  std::unique_ptr<const RemoteRows> remote_;
  GlobalOrdinal numEquality_ = 0, numPairs_ = 0;
  std::vector<RowKind> kinds_;
  std::vector<char> pinned_;
  std::vector<double> c_;
  std::vector<std::int64_t> nodes_;
  std::vector<LocalPair> pairs_;
  std::vector<TiedPair> tiedPairs_;
  std::vector<Coupling> couplings_;
  std::vector<NodeRows> nodeRows_;
  std::vector<double> copyStiffness_;
  std::vector<CoupledCopy> coupledCopies_;
  std::vector<int> contactRows_;
  std::vector<OverlapEntry> overlapEntries_;
};

}  // namespace Haptos
