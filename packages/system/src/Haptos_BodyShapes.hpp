// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_Communication.hpp"
#include "Haptos_PartShape.hpp"

namespace Haptos {

/// \brief All subdomains of a body get the geometric mean of their `nodeStiffness`: bodies are weighed against each other, gluing rows as they were.
///
/// The same whatever the ranks.  Collective.
/// \param bodies [local subdomains] global, 0-based \param shapes [local subdomains]
void averageNodeStiffness(const Communicator& comm, const std::vector<int>& bodies, std::vector<PartShape>& shapes);

}  // namespace Haptos
