// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_ParameterTree.hpp"
#include "Haptos_RunOptions.hpp"

namespace Haptos {

// The sections of the input, each a branch of the one tree (private to input: use parameterTree()).
ParameterTree meshSection();
ParameterTree materialsSection();
ParameterTree boundaryConditionsSection();
ParameterTree contactSection();

// What a checked list of these sections says (private to input: use runOptions()).
MeshOptions meshOptions(const Teuchos::ParameterList& list);
MaterialOptions materialOptions(const std::string& name, const Teuchos::ParameterList& list);
ConditionOptions conditionOptions(const std::string& name, const Teuchos::ParameterList& list);
ContactOptions contactOptions(const std::string& name, const Teuchos::ParameterList& list);

}  // namespace Haptos
