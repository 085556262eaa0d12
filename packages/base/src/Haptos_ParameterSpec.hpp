// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Haptos_ParameterValue.hpp"

namespace Haptos {

/// \brief Numbers of the input are at most this, up or down: their fourth powers must not leave the range of double precision.
constexpr double kLargestNumber = 1e100;

/// \brief An interval of numbers; infinite ends by default.  NaN and infinities are never inside.
struct NumberRange {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool lowerExcluded = false;
  bool upperExcluded = false;

  static NumberRange atLeast(double lower) { return {lower, std::numeric_limits<double>::infinity()}; }
  static NumberRange above(double lower) { return {lower, std::numeric_limits<double>::infinity(), true}; }
  static NumberRange closed(double lower, double upper) { return {lower, upper}; }
  static NumberRange open(double lower, double upper) { return {lower, upper, true, true}; }

  bool contains(double value) const;
  std::string text() const;  ///< "0 < value <= 1", "value >= 0", "finite"
};

/// \brief "The parameter beside this one has one of these values."
struct ParameterCondition {
  std::string parameter;
  std::vector<std::string> values;
  std::string text() const;  ///< "Type is Pressure or Traction"
};

/// \brief One valid parameter: name, types, default, range or choices, meaning, unit.
///
/// Built by chained calls: `ParameterSpec("Seed", {ParameterType::Int}, "...").defaultTo(1).within(...)`.
/// Without a default and without `mustBeGiven` the parameter may be absent.
class ParameterSpec {
 public:
  ParameterSpec(std::string name, std::vector<ParameterType> types, std::string meaning)
      : name(std::move(name)), meaning(std::move(meaning)), types(std::move(types)) {}

  ParameterSpec& defaultTo(ParameterValue value) { return set(defaultValue, std::move(value)); }
  ParameterSpec& mustBeGiven() { return set(required, true); }
  ParameterSpec& measuredIn(std::string unitText) { return set(unit, std::move(unitText)); }
  ParameterSpec& within(NumberRange numbers) { return set(range, numbers); }                              ///< every entry, for an array
  ParameterSpec& oneOf(std::vector<std::string> words) { return set(choices, std::move(words)); }         ///< strings only
  ParameterSpec& entries(std::size_t least, std::size_t most) { return set(minEntries, least).set(maxEntries, most); }  ///< of an array
  ParameterSpec& notEmpty() { return set(mayBeEmpty, false); }                                            ///< strings, and those of an array
  ParameterSpec& isFileName() { return set(fileName, true); }                                             ///< relative to the XML file's folder
  ParameterSpec& onlyWhen(std::string parameter, std::vector<std::string> values) {
    return set(validWhen, ParameterCondition{std::move(parameter), std::move(values)});
  }
  ParameterSpec& neededWhen(std::string parameter, std::vector<std::string> values) {
    return set(requiredWhen, ParameterCondition{std::move(parameter), std::move(values)});
  }

  std::string typeText() const;     ///< "double or Array(double)"
  std::string defaultText() const;  ///< the default, "required", "required where ..." or "none"
  std::string rangeText() const;    ///< range, choices and array length in words; may be empty
  std::string countText() const;    ///< "2 entries", "at least 1 entry"; empty without a bound

  std::string name, meaning, unit;
  std::vector<ParameterType> types;
  std::optional<ParameterValue> defaultValue;
  bool required = false, fileName = false, mayBeEmpty = true;
  NumberRange range;
  std::vector<std::string> choices;
  std::size_t minEntries = 0, maxEntries = std::numeric_limits<std::size_t>::max();
  std::optional<ParameterCondition> validWhen, requiredWhen;

 private:
  template <class Member, class Value>
  ParameterSpec& set(Member& member, Value&& value) {
    member = std::forward<Value>(value);
    return *this;
  }
};

/// \brief Separator of parameter paths: "Contact->interface->Friction->Law".
inline const std::string pathSeparator = "->";

/// \brief `list` and `name` joined; the outermost list has the empty path.
std::string joinPath(const std::string& list, const std::string& name);

/// \brief Whether a given value is one: converted without loss to a type of `spec`, in range, among the choices.
///
/// \param path of the parameter, for messages: "Solver->Relative Tolerance"
/// \throws InputError that says what would be right, with the nearest choice where there are some
ParameterValue checkedValue(const ParameterSpec& spec, const std::string& path, const Teuchos::ParameterEntry& entry);

/// \brief Refuses what is not among `names`.  \throws InputError with the nearest of them
void requireKnownNames(const Teuchos::ParameterList& list, const std::vector<std::string>& names, const std::string& path);

/// \brief A name that is still read, with a warning, as another one.
struct ParameterAlias {
  std::string oldName, newName;
};

/// \brief Old names in `list` become the new ones.
/// \return a warning for each
/// \throws InputError where both names are given
std::vector<std::string> resolveAliases(const std::vector<ParameterAlias>& aliases, Teuchos::ParameterList& list, const std::string& path);

}  // namespace Haptos
