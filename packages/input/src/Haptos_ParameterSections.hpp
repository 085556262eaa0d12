// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_ParameterTree.hpp"

namespace Haptos {

// The sections of the input, each a branch of the one tree (private to core: use parameterTree()).
ParameterTree meshSection();
ParameterTree decompositionSection();
ParameterTree materialsSection();
ParameterTree boundaryConditionsSection();
ParameterTree contactSection();
ParameterTree localSolverSection();
ParameterTree preconditionerSection();
ParameterTree coarseProblemSection();
ParameterTree solverSection();
ParameterTree outputSection();

}  // namespace Haptos
