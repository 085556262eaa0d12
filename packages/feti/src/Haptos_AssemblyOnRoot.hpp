// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Haptos_AssembledStiffness.hpp"
#include "Haptos_JumpOperator.hpp"

namespace Haptos {

class LocalSystems;

/// \brief Joins the subdomains of all ranks by their gluing rows, on rank 0; elsewhere what it returns is empty.  Collective.
AssembledStiffness::Parts assembleOnRoot(const JumpOperator& jump, const LocalSystems& systems);

}  // namespace Haptos
