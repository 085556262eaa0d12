// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_ElementGroup.hpp"

namespace Haptos {

/// \brief Local nodes on sides that belong to one element of a subdomain only, ascending.
std::vector<int> surfaceNodes(const std::vector<ElementGroup>& groups, int numNodes);

/// \brief The three degrees of freedom of every surface node, ascending.
std::vector<int> surfaceDofs(const std::vector<ElementGroup>& groups, int numNodes);

}  // namespace Haptos
