// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
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

  ParameterSpec& defaultTo(ParameterValue value);
  ParameterSpec& mustBeGiven();
  ParameterSpec& measuredIn(std::string unitText);
  ParameterSpec& within(NumberRange numbers);                   ///< every entry, for an array
  ParameterSpec& oneOf(std::vector<std::string> words);         ///< strings only
  ParameterSpec& entries(std::size_t least, std::size_t most);  ///< length of an array
  ParameterSpec& notEmpty();                                    ///< strings, and the strings of an array
  ParameterSpec& isFileName();                                  ///< relative to the folder of the XML file
  ParameterSpec& onlyWhen(std::string parameter, std::vector<std::string> values);
  ParameterSpec& neededWhen(std::string parameter, std::vector<std::string> values);

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
};

/// \brief The valid parameters of one list: parameters, sublists, sublists named by the user, rules.
///
/// The whole program has one tree (`parameterTree()`); validation, default filling, `--set`,
/// `--print-parameters` and doc/input.md are made from it.
class ParameterTree {
 public:
  /// A rule over several parameters: `broken` gets the converted list before defaults are filled in and
  /// returns what is wrong ("Name: what, what would be right", relative to this list), or nothing.
  struct Rule {
    std::string text;
    std::function<std::string(const Teuchos::ParameterList&)> broken;
  };
  struct Alias {
    std::string oldName, newName;
  };
  using Normaliser = std::function<void(Teuchos::ParameterList&)>;

  ParameterTree(std::string name, std::string meaning) : name(std::move(name)), meaning(std::move(meaning)) {}

  ParameterTree& add(ParameterSpec spec);
  ParameterTree& add(ParameterTree sublist);
  /// Sublists with any name; `child.name` is a placeholder as "<material>".
  ParameterTree& addUserNamed(ParameterTree child, std::size_t atLeast);
  /// Exactly one of these parameters or sublists is given; sublists among them are not created by default.
  ParameterTree& exactlyOneOf(std::vector<std::string> names);
  /// `oldName` is still read, with a warning, as `newName` (both parameters or both sublists).
  ParameterTree& alias(std::string oldName, std::string newName);
  ParameterTree& rule(std::string text, std::function<std::string(const Teuchos::ParameterList&)> broken);
  /// Called on the list with all defaults filled in: brings equivalent spellings to one form.
  ParameterTree& normalise(Normaliser change);
  /// Called on the checked list before defaults are filled in (its sublists exist): defaults that depend on
  /// others.
  ParameterTree& prepare(Normaliser change);

  const ParameterSpec* findParameter(const std::string& parameter) const;
  /// The sublist of that name, or what a sublist named by the user may hold; null if none is allowed.
  const ParameterTree* findSublist(const std::string& sublist) const;
  bool isAlternative(const std::string& entry) const;
  std::vector<std::string> parameterNames() const;
  std::vector<std::string> sublistNames() const;  ///< without those named by the user
  std::vector<std::string> validNames() const;    ///< parameters, then sublists

  std::string name, meaning;
  std::vector<ParameterSpec> parameters;
  std::vector<ParameterTree> sublists;
  std::vector<ParameterTree> userNamed;  ///< none or one
  std::size_t minUserNamed = 0;
  std::vector<std::vector<std::string>> alternatives;
  std::vector<Alias> aliases;
  std::vector<Rule> rules;
  std::vector<Normaliser> preparers, normalisers;
};

/// \brief Separator of parameter paths: "Contact->interface->Friction->Law".
inline const std::string pathSeparator = "->";

/// \brief `list` and `name` joined; the outermost list has the empty path.
std::string joinPath(const std::string& list, const std::string& name);

/// \brief The names of a path, trimmed.
std::vector<std::string> splitPath(const std::string& path);

}  // namespace Haptos
