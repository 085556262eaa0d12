// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

namespace Teuchos {
class ParameterList;
}

namespace Haptos {

/// \brief Reads the text of a Teuchos parameter list strictly; nothing is checked against the valid
/// parameters.
///
/// Stricter than Teuchos' own reader: a number must be the whole value, names must not occur twice in one
/// list, only `ParameterList` and `Parameter` with `name`, `type` and `value` are read.  Commas inside
/// parentheses do not split the entries of an Array(string).
/// \param origin file name for messages
/// \throws InputError with the line where the XML is malformed, or with the path of the entry
Teuchos::ParameterList parameterListFromXml(const std::string& text, const std::string& origin);

/// \brief The whole file as text.
/// \throws InputError if it is missing, a folder or not readable
std::string readTextFile(const std::string& fileName);

}  // namespace Haptos
