// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

#include "Haptos_MultiplierMap.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief What one rank gets of the rows of B; all row numbers are global here.
struct RowShare {
  /// A node whose gluing and Dirichlet rows this rank owns.
  struct Node {
    std::int64_t node;
    GlobalOrdinal gluing;                    ///< the first of 3 (copies - 1); -1: none
    std::array<GlobalOrdinal, 3> dirichlet;  ///< by component; -1: none
    std::array<double, 3> prescribed;
    int holder;                              ///< see NodeRows
    std::vector<double> stiffness;           ///< [copies] the owner's first

    auto parts() { return std::tie(node, gluing, dirichlet, prescribed, holder, stiffness); }  ///< see ByteWriter
  };
  /// A copy of a node in one of this rank's subdomains.
  struct Copy {
    int subdomain, localNode;
    int copies, position;  ///< of this one in the order of `stiffness`
    GlobalOrdinal gluing;
    std::array<GlobalOrdinal, 3> dirichlet;
  };
  /// A pair whose rows this rank owns.
  struct Pair {
    int interface, position;
    bool isTied;
    std::array<GlobalOrdinal, 3> rows{-1, -1, -1};
    std::array<double, 3> c{0, 0, 0};
    std::array<char, 3> pinned{0, 0, 0};
    int holder;
    bool meetsContact;
    ContactPair geometry;
    std::vector<PairNode> nodes;

    auto parts() { return std::tie(interface, position, isTied, rows, c, pinned, holder, meetsContact, geometry, nodes); }
  };
  /// An entry of a row of a pair in one of this rank's subdomains.
  struct Entry {
    GlobalOrdinal row;
    int subdomain, dof;
    double value;
  };

  GlobalOrdinal numRows = 0, numEquality = 0, numPairs = 0;
  std::vector<Node> nodes;
  std::vector<Copy> copies;
  std::vector<Pair> pairs;
  std::vector<Entry> entries;
  std::vector<CoupledCopy> coupled;

  auto parts() { return std::tie(numRows, numEquality, numPairs, nodes, copies, pairs, entries, coupled); }
};

}  // namespace Haptos
