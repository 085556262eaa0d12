// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <vector>

#include "Haptos_MeshShare.hpp"

namespace Haptos {

/// \brief A member of a set on its way to the rank in whose share it lies; plain data, to be sent.
struct SetMember {
  std::int64_t position;  ///< in the whole set
  std::int64_t index;     ///< of a node or an element, in the whole mesh
  int set, side;          ///< position of the set; side of the element, 0-based
};

/// \brief Fills the side sets of `share`, which has their ids, names and sizes, from what all ranks bring.  Collective.
void dealSides(const Communicator& comm, const std::vector<SetMember>& members, MeshShare& share);

/// \brief The same for node sets.  Collective.
void dealSetNodes(const Communicator& comm, const std::vector<SetMember>& members, MeshShare& share);

/// \brief All members of the side sets of `share` in their order, set after set, in even ranges.  Collective.
std::vector<SetMember> sidesInOrder(const Communicator& comm, const MeshShare& share);

/// \brief The same for node sets.  Collective.
std::vector<SetMember> setNodesInOrder(const Communicator& comm, const MeshShare& share);

}  // namespace Haptos
