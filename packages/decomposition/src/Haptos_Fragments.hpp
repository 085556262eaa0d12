// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "Haptos_Components.hpp"

namespace Haptos {

/// \brief The connected fragments of the parts of a partition, numbered by their first elements.
struct Fragments {
  std::vector<int> part;            ///< [fragments]
  std::vector<std::int64_t> sizes;  ///< [fragments] elements
  std::vector<std::map<int, std::int64_t>> sides;  ///< [fragments] sides shared with others; only of those that are not their
                                                   ///< part's largest
};

/// \brief Gives every part one fragment; serial.
///
/// A part in several fragments keeps its largest one.  Each other fragment goes to the part with whose main fragment it shares most
/// sides; only to main fragments, or two could change places for ever.  A fragment that reaches none becomes a part of its own.
/// \return number of fragments moved
int mendFragments(Fragments& fragments);

/// \brief Mends a partition of a graph that is here as a whole; serial.  \return number of fragments moved.
int mendParts(const DualGraph& graph, std::vector<int>& part);

/// \brief Mends a partition of the elements of all ranks, and numbers its parts anew so that none is empty.  Collective.
struct MendedParts {
  std::vector<int> firstPiece;  ///< [parts] piece of the part's first element; the same on all ranks
  int moved = 0;
};
MendedParts mendParts(const Communicator& comm, const ElementRange& own, const DualGraph& graph, const Components& pieces,
                      std::vector<int>& part);

}  // namespace Haptos
