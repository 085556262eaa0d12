// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_ContactOperators.hpp"

namespace Haptos {

class DualPreconditioner;

/// \brief M + E in the place of M in all that Newton's method has of it, E that of `DependentRows`; nothing changes where there is none.  Collective.
void addForcesOfDependentRows(const DualPreconditioner& M, ContactOperators& operators);

}  // namespace Haptos
