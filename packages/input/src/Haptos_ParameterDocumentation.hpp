// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "Haptos_ParameterTree.hpp"

namespace Haptos {

/// \brief Every valid parameter as plain text: the path in the first column, then indented lines
/// "type", "default", "valid", "only" (its condition), "meaning" with the unit and "note".
std::string parametersAsText(const ParameterTree& tree);

/// \brief The same as markdown: one section with a table for every list, then its rules.
/// \param headingLevel number of '#' of the outermost heading
std::string parametersAsMarkdown(const ParameterTree& tree, int headingLevel = 2);

}  // namespace Haptos
