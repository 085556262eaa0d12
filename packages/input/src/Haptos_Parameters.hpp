// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "Haptos_Communication.hpp"
#include "Haptos_ParameterTree.hpp"

namespace Haptos {

struct CommandLine;

/// \brief All valid parameters of the program: the one place where a parameter is defined.
const ParameterTree& parameterTree();

/// \brief What `readParameters` is made of, for a text at hand: XML, overrides, checks, defaults.  Not
/// collective.
///
/// File names in the text become relative to the current folder; those in `sets` are so already.
/// \param text XML; \param origin its file name, for messages and for relative file names
/// \param sets pairs of path and value, applied in order after the XML
/// \param warnings appended to
/// \throws InputError, see `validatedList` and `parameterListFromXml`
Teuchos::ParameterList parametersFromXml(const std::string& text, const std::string& origin,
                                         const std::vector<std::pair<std::string, std::string>>& sets,
                                         std::vector<std::string>& warnings);

/// \brief A list made in code, checked and with all defaults filled in.  Not collective.
Teuchos::ParameterList validatedParameters(const Teuchos::ParameterList& given);

/// \brief Reads `line.input`, applies --set, --output and --summary, checks, fills in all defaults.
/// Collective.
///
/// Rank 0 reads and checks and prints warnings to stderr; all ranks return the same list to the last bit, or
/// all throw.  After it every parameter with a default is there, file names are relative to the current
/// folder (or absolute), the `Value` of a Displacement is an array of three, that of a Pressure a scalar.
/// \throws InputError on all ranks
Teuchos::ParameterList readParameters(const Communicator& comm, const CommandLine& line);

std::string printedParameters();   ///< for --print-parameters
std::string inputDocumentation();  ///< doc/input.md

}  // namespace Haptos
