// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "Haptos_OptionTable.hpp"

namespace Haptos {

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
  using Normaliser = std::function<void(Teuchos::ParameterList&)>;

  ParameterTree(std::string name, std::string meaning) : name(std::move(name)), meaning(std::move(meaning)) {}

  ParameterTree& add(ParameterSpec spec) { return append(parameters, std::move(spec)); }
  ParameterTree& add(ParameterTree sublist) { return append(sublists, std::move(sublist)); }
  /// All parameters that fill `Options`.
  template <class Options>
  ParameterTree& addOptions() {
    for (const auto& option : Options::table()) add(option.spec);
    return *this;
  }
  /// Sublists with any name; `child.name` is a placeholder as "<material>".
  ParameterTree& addUserNamed(ParameterTree child, std::size_t atLeast) {
    minUserNamed = atLeast;
    return append(userNamed, std::move(child));
  }
  /// Exactly one of these parameters or sublists is given; sublists among them are not created by default.
  ParameterTree& exactlyOneOf(std::vector<std::string> names) { return append(alternatives, std::move(names)); }
  /// At most one of these; sublists among them are not created by default.
  ParameterTree& atMostOneOf(std::vector<std::string> names) { return append(exclusive, std::move(names)); }
  /// `oldName` is still read, with a warning, as `newName` (both parameters or both sublists).
  ParameterTree& alias(std::string oldName, std::string newName) { return append(aliases, {std::move(oldName), std::move(newName)}); }
  ParameterTree& rule(std::string text, std::function<std::string(const Teuchos::ParameterList&)> broken) {
    return append(rules, {std::move(text), std::move(broken)});
  }
  /// Called on the list with all defaults filled in: brings equivalent spellings to one form.
  ParameterTree& normalise(Normaliser change) { return append(normalisers, std::move(change)); }
  /// Called on the checked list before defaults are filled in (its sublists exist): defaults that depend on
  /// others.
  ParameterTree& prepare(Normaliser change) { return append(preparers, std::move(change)); }

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
  std::vector<std::vector<std::string>> alternatives, exclusive;
  std::vector<ParameterAlias> aliases;
  std::vector<Rule> rules;
  std::vector<Normaliser> preparers, normalisers;

 private:
  template <class T>
  ParameterTree& append(std::vector<T>& list, typename std::vector<T>::value_type item) {
    list.push_back(std::move(item));
    return *this;
  }
};

/// \brief The names of a path, trimmed.
std::vector<std::string> splitPath(const std::string& path);

}  // namespace Haptos
