// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_Communication.hpp"

namespace Haptos {

/// \brief All subdomains of a body get the geometric mean of their values, to a hundredth; the same whatever the ranks.  Collective.
///
/// \param bodies [local subdomains] global, 0-based \param values [local subdomains] > 0
void takeMeansOfBodies(const Communicator& comm, const std::vector<int>& bodies, std::vector<double>& values);

}  // namespace Haptos
