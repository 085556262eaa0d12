// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "Haptos_LocalFrame.hpp"

namespace Haptos {

/// \brief One node on the secondary side and what it may touch.
///
/// [u] = u_secondary - u_primary obeys [u] . normal <= gap; u_primary = 0 on a rigid plane.
struct ContactPair {
  std::int64_t secondaryNode;  ///< mesh index
  std::int64_t primaryNode;    ///< mesh index; -1: rigid plane
  LocalFrame frame;            ///< normal: outward from the secondary surface; rigid plane: -Normal
  double gap;                  ///< initial distance along the normal; negative: initial penetration
  double area;                 ///< tributary area of the secondary node
};

struct ContactInterface {
  std::string name;
  std::vector<ContactPair> pairs;  ///< ascending secondary node
  bool tied = false;               ///< both sides are bonded: [u] = 0, whatever the gap
  std::size_t unpairedNodes = 0;   ///< secondary nodes that no primary face lies opposite
  std::vector<std::string> notes;  ///< full sentences for the report: what was left out, what looks odd
};

}  // namespace Haptos
