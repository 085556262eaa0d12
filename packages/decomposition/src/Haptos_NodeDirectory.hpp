// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "Haptos_Communication.hpp"
#include "Haptos_ConstraintRows.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {

/// \brief A node in one of its subdomains.
struct NodeCopy {
  int subdomain;  ///< global
  int localNode;
  double stiffness;
};

/// \brief What is known of a node: copies ascending in the subdomain, and prescribed components.
struct NodeRecord {
  std::int64_t node = -1;
  std::size_t firstCopy = 0;
  int numCopies = 0;
  std::array<char, 3> isPrescribed{0, 0, 0};
  std::array<double, 3> prescribed{0, 0, 0};

  bool isHeld() const { return isPrescribed[0] && isPrescribed[1] && isPrescribed[2]; }
};

/// \brief Where ranks meet to learn about nodes: every rank keeps a contiguous range of node indices, whoever solves with them.
///
/// Records of the rank's own range come first, ascending; those of others that it asked for follow.
class NodeDirectory {
 public:
  /// Collective.
  NodeDirectory(const Communicator& comm, const RowSources& sources);

  int rankOf(std::int64_t node) const { return ranges_.owner(node); }
  /// \brief Makes nodes of others known here; once.  Collective.
  void fetch(const std::vector<std::int64_t>& nodes);

  std::size_t numOwn() const { return std::size_t(ranges_.count(comm_.getRank())); }
  const std::vector<NodeRecord>& records() const { return records_; }
  const NodeCopy* copies(const NodeRecord& record) const { return copies_.data() + record.firstCopy; }
  int find(std::int64_t node) const;  ///< its record; it must be known here

  using Labels = std::array<int, 3>;
  /// \brief Gives all nodes that are joined, through groups of any rank, the least of their labels, number by number.  Collective.
  ///
  /// \param groups records that are joined, \param labels [records]
  void spreadMinimum(const std::vector<std::vector<int>>& groups, std::vector<Labels>& labels) const;

 private:
  struct SentCopy {
    std::int64_t node;
    NodeCopy copy;
  };
  void takeCopies(const std::vector<SentCopy>& received);
  void exchangeLabels(std::vector<Labels>& labels) const;

  const Communicator& comm_;
  EvenRanges ranges_;
  std::int64_t first_;
  std::vector<NodeRecord> records_;
  std::vector<NodeCopy> copies_;
  std::optional<RemoteValues> remote_;  // of records behind the own ones
};

}  // namespace Haptos
