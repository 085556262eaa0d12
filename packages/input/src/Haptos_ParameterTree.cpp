// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ParameterTree.hpp"

#include <algorithm>
#include <cmath>

#include "Haptos_NearestName.hpp"

namespace Haptos {

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

ParameterSpec& ParameterSpec::defaultTo(ParameterValue value) {
  defaultValue = std::move(value);
  return *this;
}

ParameterSpec& ParameterSpec::mustBeGiven() {
  required = true;
  return *this;
}

ParameterSpec& ParameterSpec::measuredIn(std::string unitText) {
  unit = std::move(unitText);
  return *this;
}

ParameterSpec& ParameterSpec::within(NumberRange numbers) {
  range = numbers;
  return *this;
}

ParameterSpec& ParameterSpec::oneOf(std::vector<std::string> words) {
  choices = std::move(words);
  return *this;
}

ParameterSpec& ParameterSpec::entries(std::size_t least, std::size_t most) {
  minEntries = least;
  maxEntries = most;
  return *this;
}

ParameterSpec& ParameterSpec::notEmpty() {
  mayBeEmpty = false;
  return *this;
}

ParameterSpec& ParameterSpec::isFileName() {
  fileName = true;
  return *this;
}

ParameterSpec& ParameterSpec::onlyWhen(std::string parameter, std::vector<std::string> values) {
  validWhen = ParameterCondition{std::move(parameter), std::move(values)};
  return *this;
}

ParameterSpec& ParameterSpec::neededWhen(std::string parameter, std::vector<std::string> values) {
  requiredWhen = ParameterCondition{std::move(parameter), std::move(values)};
  return *this;
}

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
  if (requiredWhen && !required) {
    const std::string needed = "required where " + requiredWhen->text();
    text = defaultValue ? text + "; " + needed : needed;
  }
  return text;
}

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

std::string ParameterSpec::countText() const {
  if (!std::any_of(types.begin(), types.end(), isArray)) return "";
  if (minEntries == maxEntries) return std::to_string(minEntries) + " entries";
  if (maxEntries != std::numeric_limits<std::size_t>::max())
    return std::to_string(minEntries) + " to " + std::to_string(maxEntries) + " entries";
  if (minEntries == 0) return "";
  return "at least " + std::to_string(minEntries) + (minEntries == 1 ? " entry" : " entries");
}

ParameterTree& ParameterTree::add(ParameterSpec spec) {
  parameters.push_back(std::move(spec));
  return *this;
}

ParameterTree& ParameterTree::add(ParameterTree sublist) {
  sublists.push_back(std::move(sublist));
  return *this;
}

ParameterTree& ParameterTree::addUserNamed(ParameterTree child, std::size_t atLeast) {
  userNamed.assign(1, std::move(child));
  minUserNamed = atLeast;
  return *this;
}

ParameterTree& ParameterTree::exactlyOneOf(std::vector<std::string> names) {
  alternatives.push_back(std::move(names));
  return *this;
}

ParameterTree& ParameterTree::alias(std::string oldName, std::string newName) {
  aliases.push_back({std::move(oldName), std::move(newName)});
  return *this;
}

ParameterTree& ParameterTree::rule(std::string text,
                                   std::function<std::string(const Teuchos::ParameterList&)> broken) {
  rules.push_back({std::move(text), std::move(broken)});
  return *this;
}

ParameterTree& ParameterTree::normalise(Normaliser change) {
  normalisers.push_back(std::move(change));
  return *this;
}

ParameterTree& ParameterTree::prepare(Normaliser change) {
  preparers.push_back(std::move(change));
  return *this;
}

const ParameterSpec* ParameterTree::findParameter(const std::string& parameter) const {
  for (const auto& spec : parameters)
    if (spec.name == parameter) return &spec;
  return nullptr;
}

const ParameterTree* ParameterTree::findSublist(const std::string& sublist) const {
  for (const auto& tree : sublists)
    if (tree.name == sublist) return &tree;
  return userNamed.empty() || findParameter(sublist) ? nullptr : &userNamed.front();
}

bool ParameterTree::isAlternative(const std::string& entry) const {
  for (const auto& group : alternatives)
    if (std::find(group.begin(), group.end(), entry) != group.end()) return true;
  return false;
}

std::vector<std::string> ParameterTree::parameterNames() const {
  std::vector<std::string> names;
  for (const auto& spec : parameters) names.push_back(spec.name);
  return names;
}

std::vector<std::string> ParameterTree::sublistNames() const {
  std::vector<std::string> names;
  for (const auto& tree : sublists) names.push_back(tree.name);
  return names;
}

std::vector<std::string> ParameterTree::validNames() const {
  auto names = parameterNames();
  const auto more = sublistNames();
  names.insert(names.end(), more.begin(), more.end());
  return names;
}

std::string joinPath(const std::string& list, const std::string& name) {
  return list.empty() ? name : list + pathSeparator + name;
}

std::vector<std::string> splitPath(const std::string& path) {
  std::vector<std::string> names;
  std::size_t start = 0;
  while (true) {
    const auto end = path.find(pathSeparator, start);
    names.push_back(trimmed(path.substr(start, end == std::string::npos ? end : end - start)));
    if (end == std::string::npos) return names;
    start = end + pathSeparator.size();
  }
}

}  // namespace Haptos
