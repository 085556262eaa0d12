// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_ElementGroup.hpp"
#include "Haptos_IndexLists.hpp"

namespace Haptos {

/// \brief Nodes that share an element with a node, itself included, ascending; local [numNodes].
IndexLists nodeNeighbours(int numNodes, const std::vector<ElementGroup>& groups);

}  // namespace Haptos
