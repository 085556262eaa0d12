// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ParameterSpec.hpp"

#include <Teuchos_ParameterList.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_Error.hpp"
#include "Haptos_NearestName.hpp"

namespace Haptos {

namespace {

using Teuchos::ParameterList;

[[noreturn]] void refuse(const std::string& path, const std::string& what) {
  throw InputError(path + ": " + what);
}

// Not finite before out of range, as no range says so; the absolute limit last, since it speaks of units.
void checkNumber(const ParameterSpec& spec, const std::string& path, double value) {
  if (!std::isfinite(value))
    refuse(path, numberText(value) + " is not a finite number; valid: " + spec.range.text());
  if (!spec.range.contains(value))
    refuse(path, numberText(value) + " is out of range; valid: " + spec.range.text());
  if (std::abs(value) > kLargestNumber)
    refuse(path, numberText(value) + " is too large to be computed with, the limit is " + numberText(kLargestNumber) + "; use other units");
}

void checkWord(const ParameterSpec& spec, const std::string& path, const std::string& value) {
  // An empty word mostly is a forgotten one: the meaning says what should stand there.
  if (!spec.mayBeEmpty && trimmed(value).empty()) refuse(path, "must not be empty: " + spec.meaning);
  if (spec.choices.empty()) return;
  if (std::find(spec.choices.begin(), spec.choices.end(), value) != spec.choices.end()) return;
  refuse(path, "'" + value + "' is not valid" + suggestion(value, spec.choices) + " Valid: " + joinNames(spec.choices));
}

/// Checks every entry of a value; overloads for the alternatives of ParameterValue.
struct ValueChecker {
  const ParameterSpec& spec;
  const std::string& path;

  void operator()(int value) const { checkNumber(spec, path, value); }
  void operator()(double value) const { checkNumber(spec, path, value); }
  void operator()(bool) const {}
  void operator()(const std::string& value) const { checkWord(spec, path, value); }
  template <class T>
  void operator()(const std::vector<T>& values) const {
    if (values.size() < spec.minEntries || values.size() > spec.maxEntries)
      refuse(path, "the array has " + std::to_string(values.size()) +
                       (values.size() == 1 ? " entry" : " entries") + "; valid: " + spec.rangeText());
    for (const auto& value : values) (*this)(value);
  }
};

// A type that fits as it is goes before one that it can be turned into: an int stays one where both are valid.
ParameterValue convertedValue(const ParameterSpec& spec, const std::string& path,
                              const Teuchos::ParameterEntry& entry) {
  const auto given = valueOf(entry);
  if (!given) refuse(path, "has a type that is not supported; it must be " + spec.typeText());
  for (const auto type : spec.types)
    if (typeOf(*given) == type) return *given;
  for (const auto type : spec.types)
    if (const auto value = convertValue(*given, type)) return *value;
  refuse(path, "has type " + typeName(typeOf(*given)) + " (value " + valueText(*given) + "); it must be " +
                   spec.typeText());
}

// A list is copied under its new name, a value keeps its type.
void renameEntry(ParameterList& list, const std::string& oldName, const std::string& newName) {
  if (list.isSublist(oldName)) {
    const ParameterList copy = list.sublist(oldName);
    list.remove(oldName);
    list.sublist(newName) = copy;
    list.sublist(newName).setName(newName);
  } else {
    const Teuchos::ParameterEntry copy = list.getEntry(oldName);
    list.remove(oldName);
    list.setEntry(newName, copy);
  }
}

}  // namespace

bool NumberRange::contains(double value) const {
  if (!std::isfinite(value)) return false;
  return (lowerExcluded ? value > lower : value >= lower) && (upperExcluded ? value < upper : value <= upper);
}

std::string NumberRange::text() const {
  const bool below = std::isfinite(lower), above = std::isfinite(upper);
  if (below && above)
    return numberText(lower) + (lowerExcluded ? " < value" : " <= value") + (upperExcluded ? " < " : " <= ") +
           numberText(upper);
  if (below) return (lowerExcluded ? "value > " : "value >= ") + numberText(lower);
  if (above) return (upperExcluded ? "value < " : "value <= ") + numberText(upper);
  return "finite";
}

std::string ParameterCondition::text() const { return parameter + " is " + joinNames(values, " or "); }

std::string ParameterSpec::typeText() const {
  std::vector<std::string> names;
  for (const auto type : types) names.push_back(typeName(type));
  return joinNames(names, " or ");
}

std::string ParameterSpec::defaultText() const {
  std::string text = required ? "required" : "none";
  if (defaultValue) {
    text = valueText(*defaultValue);
    if (text.empty()) text = "\"\"";
  }
  // Both may be true: a default that holds unless another parameter asks for a value.
  if (requiredWhen && !required) {
    const std::string needed = "required where " + requiredWhen->text();
    text = defaultValue ? text + "; " + needed : needed;
  }
  return text;
}

// Words exclude numbers: a parameter of words has no range.
std::string ParameterSpec::rangeText() const {
  if (!choices.empty()) return joinNames(choices, " | ");
  const auto isNumber = [](ParameterType t) {
    return t == ParameterType::Int || t == ParameterType::Double || t == ParameterType::IntArray ||
           t == ParameterType::DoubleArray;
  };
  std::vector<std::string> parts;
  if (std::any_of(types.begin(), types.end(), isNumber)) parts.push_back(range.text());
  if (!mayBeEmpty) parts.push_back("not empty");
  const std::string count = countText();
  if (!count.empty()) parts.push_back((types.size() > 1 ? "an array has " : "") + count);
  return joinNames(parts);
}

// Empty where any number of entries is good.
std::string ParameterSpec::countText() const {
  if (!std::any_of(types.begin(), types.end(), isArray)) return "";
  if (minEntries == maxEntries) return std::to_string(minEntries) + " entries";
  if (maxEntries != std::numeric_limits<std::size_t>::max())
    return std::to_string(minEntries) + " to " + std::to_string(maxEntries) + " entries";
  if (minEntries == 0) return "";
  return "at least " + std::to_string(minEntries) + (minEntries == 1 ? " entry" : " entries");
}

std::string joinPath(const std::string& list, const std::string& name) {
  return list.empty() ? name : list + pathSeparator + name;
}

ParameterValue checkedValue(const ParameterSpec& spec, const std::string& path, const Teuchos::ParameterEntry& entry) {
  const auto value = convertedValue(spec, path, entry);
  std::visit(ValueChecker{spec, path}, value);
  return value;
}

void requireKnownNames(const ParameterList& list, const std::vector<std::string>& names, const std::string& path) {
  for (auto it = list.begin(); it != list.end(); ++it)
    if (std::find(names.begin(), names.end(), list.name(it)) == names.end())
      refuse(joinPath(path, list.name(it)),
             "unknown parameter" + suggestion(list.name(it), names) + " Valid here: " + joinNames(names));
}

// Both names in one list would leave it open which counts.
std::vector<std::string> resolveAliases(const std::vector<ParameterAlias>& aliases, ParameterList& list, const std::string& path) {
  std::vector<std::string> warnings;
  for (const auto& alias : aliases) {
    if (!list.isParameter(alias.oldName)) continue;
    const std::string old = joinPath(path, alias.oldName);
    if (list.isParameter(alias.newName))
      refuse(old, "is the old name of '" + alias.newName + "', which is given too; keep only the new one");
    renameEntry(list, alias.oldName, alias.newName);
    warnings.push_back(old + ": this name is outdated; write '" + alias.newName + "'");
  }
  return warnings;
}

}  // namespace Haptos
