// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "Haptos_FrameTurn.hpp"
#include "Haptos_LocalFrame.hpp"

namespace Haptos {

/// \brief What the displacement of one node counts in a mean over nodes.
struct NodeWeight {
  std::int64_t node;  ///< mesh index
  double weight;
};

/// \brief One multiplier node on the secondary side and what it may touch.
///
/// [u] = sum of weight x u over `secondary` - the same over `primary` obeys [u] . normal <= gap.  Node to node is one node of
/// weight 1 on either side; nothing moves on a rigid obstacle, whose list is empty.
struct ContactPair {
  std::int64_t secondaryNode;  ///< mesh index of the node whose multiplier it is
  std::vector<NodeWeight> secondary, primary;
  LocalFrame frame;            ///< normal: outward from the secondary surface; rigid plane: -Normal
  double gap;                  ///< initial distance along the normal; negative: initial penetration
  double area;                 ///< tributary area of the secondary node
  std::array<char, 3> isPinned{};  ///< rows N, T1, T2 (x, y, z of a tied pair) that are left out whatever they reach
  std::optional<std::array<double, 2>> coefficients = std::nullopt;  ///< F1, F2 [-] of its own; else those of its interface
  double size = 0;             ///< shortest edge around the secondary node; 0 where no mesh is known
  std::optional<FrameTurn> turn = std::nullopt;  ///< none: t1 and t2 are the axes of friction

  auto parts() { return std::tie(secondaryNode, secondary, primary, frame, gap, area, isPinned, coefficients, size, turn); }  ///< see ByteWriter
};

/// \brief The deepest overlap of two surfaces before any load; depth 0: none.
struct InitialOverlap {
  double depth = 0;
  std::int64_t nodeNumber = 0;  ///< as the mesh counts them
  std::array<double, 3> place{};
};

struct NodeMove {
  std::int64_t node;  ///< mesh index
  std::array<double, 3> by;
};

class UnpairedNodes;  // Haptos_UnpairedNodes.hpp

struct ContactInterface {
  std::string name;
  std::vector<ContactPair> pairs;  ///< ascending secondary node
  bool tied = false;               ///< both sides are bonded: [u] = 0, whatever the gap
  std::size_t unpairedNodes = 0;   ///< secondary nodes that no primary face lies opposite
  std::shared_ptr<UnpairedNodes> unpaired;  ///< those of them that may get a row later; null: none
  bool isMortar = false;
  bool isExchanged = false;  ///< pairs have as secondary what the user calls the primary side
  InitialOverlap overlap;
  std::vector<NodeMove> moves;     ///< of nodes in the mesh that the stiffness is made with
  std::vector<std::string> notes;  ///< full sentences for the report: what was left out, what looks odd
  std::vector<std::string> remarks;  ///< the same, of what is as it should be
};

}  // namespace Haptos
