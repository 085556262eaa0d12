// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ParameterValue.hpp"

#include <Teuchos_Array.hpp>
#include <Teuchos_ParameterList.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>

namespace Haptos {

namespace {

/// std::from_chars does not take a leading '+'.
std::string withoutPlus(const std::string& text) {
  const std::string t = trimmed(text);
  const bool plus = t.size() > 1 && t[0] == '+' && t[1] != '+' && t[1] != '-';
  return plus ? t.substr(1) : t;
}

std::string textOf(int value) { return std::to_string(value); }
std::string textOf(double value) { return numberText(value); }
std::string textOf(bool value) { return value ? "true" : "false"; }
std::string textOf(const std::string& value) { return value; }
template <class T>
std::string textOf(const std::vector<T>& values) {
  std::string text;
  for (const auto& value : values) text += (text.empty() ? "" : ", ") + textOf(value);
  return "{" + text + "}";
}

/// Nothing if one entry is wrong.
template <class T, class Parse>
std::optional<ParameterValue> parseArray(const std::string& text, Parse&& parse) {
  std::vector<T> values;
  for (const auto& entry : splitArray(text)) {
    const std::optional<T> value = parse(entry);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

// Quotes are allowed around entries of arrays, as Teuchos writes them; one quote alone is part of the text.
std::string unquoted(const std::string& text) {
  const std::string t = trimmed(text);
  const bool quoted = t.size() >= 2 && t.front() == t.back() && (t.front() == '"' || t.front() == '\'');
  return quoted ? t.substr(1, t.size() - 2) : t;
}

// No conversion by the entry itself: Teuchos' own throws where the type differs, and what was given should be told.
template <class T>
std::optional<ParameterValue> scalarOf(const Teuchos::ParameterEntry& entry) {
  if (!entry.isType<T>()) return std::nullopt;
  return Teuchos::any_cast<T>(entry.getAny(false));
}

template <class T>
std::optional<ParameterValue> arrayOf(const Teuchos::ParameterEntry& entry) {
  if (!entry.isType<Teuchos::Array<T>>()) return std::nullopt;
  return Teuchos::any_cast<Teuchos::Array<T>>(entry.getAny(false)).toVector();
}

}  // namespace

// In the order of ParameterType and of the alternatives of ParameterValue.
const std::vector<std::string>& typeNames() {
  static const std::vector<std::string> names = {"int",        "double",        "bool",         "string",
                                                 "Array(int)", "Array(double)", "Array(string)"};
  return names;
}

ParameterType typeOf(const ParameterValue& value) { return ParameterType(value.index()); }

std::string typeName(ParameterType type) { return typeNames()[std::size_t(type)]; }

std::optional<ParameterType> typeFromName(const std::string& name) {
  const auto& names = typeNames();
  const auto found = std::find(names.begin(), names.end(), trimmed(name));
  if (found == names.end()) return std::nullopt;
  return ParameterType(found - names.begin());
}

bool isArray(ParameterType type) { return type >= ParameterType::IntArray; }

std::string numberText(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  char buffer[40];
  const auto end =
      std::to_chars(buffer, buffer + sizeof(buffer), value).ptr;  // shortest text that reads back
  return std::string(buffer, end);
}

std::string valueText(const ParameterValue& value) {
  return std::visit([](const auto& v) { return textOf(v); }, value);
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

// The whole text or nothing: "3 mm" is no 3, and no locale changes what a point is.
std::optional<int> parseInt(const std::string& text) {
  const std::string t = withoutPlus(text);
  int value = 0;
  const auto [end, error] = std::from_chars(t.data(), t.data() + t.size(), value);
  if (t.empty() || error != std::errc() || end != t.data() + t.size()) return std::nullopt;
  return value;
}

// Not std::stod, which obeys the locale and stops in silence where the number ends.
std::optional<double> parseDouble(const std::string& text) {
  const std::string t = withoutPlus(text);
  double value = 0;
  const auto [end, error] = std::from_chars(t.data(), t.data() + t.size(), value);
  if (t.empty() || end != t.data() + t.size()) return std::nullopt;
  if (error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc::result_out_of_range) {  // 1e999 is infinite, 1e-999 is zero
    const auto exponent = t.find_first_of("eE");
    const bool tiny = exponent != std::string::npos && t.find('-', exponent) != std::string::npos;
    return tiny ? 0.0 : (t[0] == '-' ? -HUGE_VAL : HUGE_VAL);
  }
  return value;
}

// At commas outside of quotes and parentheses, since entries may be expressions as clip(x, 0, 1); with braces or without.
std::vector<std::string> splitArray(const std::string& text) {
  std::string body = trimmed(text);
  if (body.size() >= 2 && body.front() == '{' && body.back() == '}') body = body.substr(1, body.size() - 2);
  std::vector<std::string> entries;
  if (trimmed(body).empty()) return entries;
  std::string entry;
  char quote = 0;
  int depth = 0;
  for (const char c : body) {
    if (quote != 0)
      quote = c == quote ? 0 : quote;
    else if (c == '"' || (c == '\'' && trimmed(entry).empty()))  // an apostrophe inside a word is no quote
      quote = c;
    else
      depth += (c == '(') - (c == ')');
    if (c == ',' && depth <= 0 && quote == 0) {
      entries.push_back(unquoted(entry));
      entry.clear();
    } else {
      entry += c;
    }
  }
  entries.push_back(unquoted(entry));
  return entries;
}

std::optional<ParameterValue> parseValue(const std::string& text, ParameterType type) {
  const auto asString = [](const std::string& s) { return std::optional<std::string>(s); };
  switch (type) {
    case ParameterType::Int:
      if (const auto value = parseInt(text)) return *value;
      return std::nullopt;
    case ParameterType::Double:
      if (const auto value = parseDouble(text)) return *value;
      return std::nullopt;
    case ParameterType::Bool:
      // What Teuchos reads as bool; "yes" and "on" are refused with the type's name.
      if (trimmed(text) == "true" || trimmed(text) == "1") return true;
      if (trimmed(text) == "false" || trimmed(text) == "0") return false;
      return std::nullopt;
    case ParameterType::String:
      return text;
    case ParameterType::IntArray:
      return parseArray<int>(text, parseInt);
    case ParameterType::DoubleArray:
      return parseArray<double>(text, parseDouble);
    case ParameterType::StringArray:
      return parseArray<std::string>(text, asString);
  }
  return std::nullopt;
}

// Whole numbers are good doubles; nothing else is converted, so that a mistake in the type is told.
std::optional<ParameterValue> convertValue(const ParameterValue& value, ParameterType type) {
  if (typeOf(value) == type) return value;
  if (type == ParameterType::Double && std::holds_alternative<int>(value))
    return double(std::get<int>(value));
  if (type == ParameterType::DoubleArray && std::holds_alternative<std::vector<int>>(value)) {
    const auto& ints = std::get<std::vector<int>>(value);
    return std::vector<double>(ints.begin(), ints.end());
  }
  return std::nullopt;
}

std::optional<ParameterValue> valueOf(const Teuchos::ParameterEntry& entry) {
  std::optional<ParameterValue> value;
  if ((value = scalarOf<int>(entry)) || (value = scalarOf<double>(entry)) ||
      (value = scalarOf<bool>(entry)) || (value = scalarOf<std::string>(entry)) ||
      (value = arrayOf<int>(entry)) || (value = arrayOf<double>(entry)) ||
      (value = arrayOf<std::string>(entry)))
    return value;
  return std::nullopt;
}

// Teuchos keeps arrays in a class of its own.
void setValue(Teuchos::ParameterList& list, const std::string& name, const ParameterValue& value) {
  if (const auto* ints = std::get_if<std::vector<int>>(&value))
    list.set(name, Teuchos::Array<int>(*ints));
  else if (const auto* doubles = std::get_if<std::vector<double>>(&value))
    list.set(name, Teuchos::Array<double>(*doubles));
  else if (const auto* strings = std::get_if<std::vector<std::string>>(&value))
    list.set(name, Teuchos::Array<std::string>(*strings));
  else if (const auto* text = std::get_if<std::string>(&value))
    list.set(name, *text);
  else if (const auto* flag = std::get_if<bool>(&value))
    list.set(name, *flag);
  else if (const auto* whole = std::get_if<int>(&value))
    list.set(name, *whole);
  else
    list.set(name, std::get<double>(value));
}

}  // namespace Haptos
