// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <vector>

#include "Haptos_DisjointSets.hpp"
#include "Haptos_DualGraph.hpp"

namespace Haptos {

/// \brief Connected components of elements of all ranks, numbered by their first element.
struct Components {
  std::vector<int> ofElement;        ///< [this rank's elements]
  std::vector<std::int64_t> first;   ///< [components] ascending, the same on all ranks
  std::vector<std::int64_t> sizes;   ///< [components] elements, the same on all ranks
  int count() const { return int(first.size()); }
};

/// \brief Components of the elements that are joined by an edge and alike in `colour`.  Collective.
///
/// Lowest indices spread over the edges between ranks, and along the way to those elements that they displace (hooking and
/// pointer jumping: shiloach-vishkin-1982), so that a handful of exchanges does.
/// \param graph rows of this rank's elements
/// \param colour [this rank's elements]; empty: all alike
Components connectedComponents(const Communicator& comm, const ElementRange& own, const DualGraph& graph, const std::vector<int>& colour);

/// \brief The same of a graph that is here as a whole: [elements] the component, numbered by its first element.  Serial.
std::vector<int> connectedComponents(const DualGraph& graph, const std::vector<int>& colour, int& count);

}  // namespace Haptos
