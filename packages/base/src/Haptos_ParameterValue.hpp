// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace Teuchos {
class ParameterEntry;
class ParameterList;
}  // namespace Teuchos

namespace Haptos {

/// \brief The types that a parameter may have; the order is that of the alternatives of `ParameterValue`.
enum class ParameterType { Int, Double, Bool, String, IntArray, DoubleArray, StringArray };

using ParameterValue = std::variant<int, double, bool, std::string, std::vector<int>, std::vector<double>,
                                    std::vector<std::string>>;

ParameterType typeOf(const ParameterValue& value);

/// \brief Name in the XML: "int", "double", "bool", "string", "Array(int)", ...
const std::vector<std::string>& typeNames();  ///< [ParameterType]
std::string typeName(ParameterType type);
std::optional<ParameterType> typeFromName(const std::string& name);
bool isArray(ParameterType type);

/// \brief The value as one would write it in the XML; doubles so that reading them gives the same number.
std::string valueText(const ParameterValue& value);
std::string numberText(double value);

/// \brief Reads the whole of `text` as one int (no fraction, no overflow); nothing if it is none.
std::optional<int> parseInt(const std::string& text);

/// \brief Reads the whole of `text` as one number in the C locale ("1", "1e-6", "inf", "nan"); nothing if it
/// is none.
std::optional<double> parseDouble(const std::string& text);

/// \brief Splits "{a, b, c}" (braces optional) at commas outside parentheses and quotes; blanks trimmed.
///
/// "{min(1, x), 0}" has two entries; quotes around an entry are taken off.
std::vector<std::string> splitArray(const std::string& text);

std::string trimmed(const std::string& text);

/// \brief Reads `text` as a value of `type`.
/// \return nothing if the text is not of that type
std::optional<ParameterValue> parseValue(const std::string& text, ParameterType type);

/// \brief Converts without loss: int to double, Array(int) to Array(double), equal types; nothing otherwise.
std::optional<ParameterValue> convertValue(const ParameterValue& value, ParameterType type);

/// \brief Value of a Teuchos entry; nothing if its type is none of `ParameterType` (a float, a sublist, ...).
std::optional<ParameterValue> valueOf(const Teuchos::ParameterEntry& entry);

/// \brief Sets `list.name` to the value (vectors become `Teuchos::Array`s).
void setValue(Teuchos::ParameterList& list, const std::string& name, const ParameterValue& value);

}  // namespace Haptos
