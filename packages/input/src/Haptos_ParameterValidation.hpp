// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "Haptos_ParameterTree.hpp"

namespace Teuchos {
class ParameterList;
}

namespace Haptos {

/// \brief The given list, checked against the tree, numbers converted, every default filled in.
///
/// An int becomes a double where a double is valid; a double never becomes an int.  Aliases are replaced by
/// their new names, with one warning each.
/// \param warnings what the user should know though the run goes on; appended to
/// \throws InputError that names the full path, what is wrong and what would be right: an unknown name
///   (with the nearest valid one), a wrong type, a value out of range, not finite or not among the choices,
///   a missing parameter, one that is not valid beside the others.
Teuchos::ParameterList validatedList(const ParameterTree& tree, Teuchos::ParameterList given,
                                     std::vector<std::string>& warnings);

/// \brief Replaces old names in the list (all levels) by the new ones.
/// \throws InputError where both names are given
void resolveAliases(const ParameterTree& tree, Teuchos::ParameterList& list,
                    std::vector<std::string>& warnings);

/// \brief Sets one parameter from text; the value takes the type of the valid parameter.
///
/// Where several types are valid the text decides: "{...}" or a comma outside parentheses gives an array, a
/// number a number, all else a string.  Sublists on the way are created, those named by the user too.
/// \param path "Solver->Relative Tolerance"
/// \throws InputError for an unknown path or a value of the wrong type
void setFromText(const ParameterTree& tree, Teuchos::ParameterList& list, const std::string& path,
                 const std::string& value, std::vector<std::string>& warnings);

/// \brief Puts `folder` before every relative file name that is given in the list.
void resolveFileNames(const ParameterTree& tree, Teuchos::ParameterList& list, const std::string& folder);

/// \brief `name` as seen from `folder`: unchanged if absolute, empty or `folder` is empty.
std::string resolvePath(const std::string& folder, const std::string& name);

/// \brief A file that will be written must not replace another one of the run, also not through links.  An empty name is no file.
/// \param what, otherWhat  whose names these are, as "Output->File"
/// \throws InputError naming both
void requireOtherFile(const std::string& what, const std::string& file, const std::string& otherWhat, const std::string& other);

}  // namespace Haptos
