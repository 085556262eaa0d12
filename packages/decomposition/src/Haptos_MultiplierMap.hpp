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

/// \brief Who owns which multiplier, and what this rank must know of its rows.
///
/// `map` is the one-to-one map of all dual unknowns; all rows at one node, and all three rows of a contact
/// pair, lie on one rank.  `overlapMap` holds the rank's own rows, in the order of `map`, then rows of others
/// that touch its subdomains.
class MultiplierMap {
 public:
  /// \brief Sends every rank its rows.  Collective.  `rows` and `rankOfSubdomain` are read on rank 0 only.
  MultiplierMap(const RCP<const Communicator>& comm, const ConstraintRows& rows, const std::vector<int>& rankOfSubdomain);

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

  /// Entries of the owned rows in CSR form, with weights (RowEntry::subdomain is global).
  const std::vector<std::size_t>& ownedOffsets() const { return ownedOffsets_; }
  const std::vector<RowEntry>& ownedEntries() const { return ownedEntries_; }

  /// \brief One nonzero of B of a subdomain of this rank; `row` is local to overlapMap.
  struct OverlapEntry {
    int row;
    int subdomain;  ///< global
    int dof;        ///< local in the subdomain
    double value;
    double weight;
  };
  /// Entries of this rank's subdomains, sorted by (subdomain, row, dof).
  const std::vector<OverlapEntry>& overlapEntries() const { return overlapEntries_; }

 private:
  RCP<const Map> map_, overlapMap_, contactMap_;
  std::unique_ptr<const RemoteRows> remote_;
  GlobalOrdinal numEquality_ = 0, numPairs_ = 0;
  std::vector<RowKind> kinds_;
  std::vector<char> pinned_;
  std::vector<double> c_;
  std::vector<std::int64_t> nodes_;
  std::vector<LocalPair> pairs_;
  std::vector<int> contactRows_;
  std::vector<std::size_t> ownedOffsets_;
  std::vector<RowEntry> ownedEntries_;
  std::vector<OverlapEntry> overlapEntries_;
};

}  // namespace Haptos
