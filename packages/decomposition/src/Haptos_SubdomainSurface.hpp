// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_Subdomain.hpp"

namespace Haptos {

/// \brief Local nodes on sides that belong to one element of the subdomain only, ascending.
std::vector<int> surfaceNodes(const Subdomain& subdomain);

/// \brief The three degrees of freedom of every surface node, ascending.
std::vector<int> surfaceDofs(const Subdomain& subdomain);

}  // namespace Haptos
