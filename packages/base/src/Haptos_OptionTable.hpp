// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Teuchos_ParameterList.hpp>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "Haptos_Options.hpp"
#include "Haptos_ParameterSpec.hpp"

namespace Haptos {

/// \brief A valid parameter and the member of `Options` that it fills.
template <class Options>
struct Option {
  ParameterSpec spec;  ///< its default is the member's
  std::function<ParameterValue(const Options&)> get;
  std::function<void(Options&, const ParameterValue&)> set;
};

/// \brief The parameters that fill `Options`, one by one, in the order of the documentation.
template <class Options>
class OptionTable : public std::vector<Option<Options>> {
 public:
  OptionTable() = default;
  /// Of a base class: its parameters come first.
  template <class Base>
  explicit OptionTable(const OptionTable<Base>& base) {
    for (const auto& option : base) this->push_back({option.spec, option.get, option.set});
  }

  /// Types and default follow from the member, a chosen value's words from its `Choices`.
  template <class Owner, class T>
  OptionTable& add(const std::string& name, T Owner::*member, const std::string& meaning);
  template <class Owner, class T>
  OptionTable& add(const std::string& name, T Owner::*member, NumberRange range, const std::string& meaning) {
    add(name, member, meaning);
    this->back().spec.within(range);
    return *this;
  }
  /// `other`'s parameter of that name, for a member of this class.
  template <class Other, class Owner, class T>
  OptionTable& addFrom(const OptionTable<Other>& other, const std::string& name, T Owner::*member) {
    for (const auto& option : other)
      if (option.spec.name == name) add(name, member, option.spec.range, option.spec.meaning);
    return *this;
  }
};

template <class Options>
template <class Owner, class T>
OptionTable<Options>& OptionTable<Options>::add(const std::string& name, T Owner::*member, const std::string& meaning) {
  Option<Options> option{ParameterSpec(name, {}, meaning),
                         [member](const Options& o) -> ParameterValue {
                           if constexpr (HasChoices<T>::value) return std::string(nameOf(o.*member));
                           else return o.*member;
                         },
                         [member](Options& o, const ParameterValue& value) {
                           if constexpr (HasChoices<T>::value) o.*member = choiceNamed<T>(std::get<std::string>(value));
                           else o.*member = std::get<T>(value);
                         }};
  const ParameterValue standard = option.get(Options{});
  option.spec.types = {typeOf(standard)};
  option.spec.defaultTo(standard);
  if constexpr (HasChoices<T>::value) option.spec.oneOf(choiceNames<T>());
  if constexpr (std::is_same_v<T, double>) option.spec.measuredIn("-");
  this->push_back(std::move(option));
  return *this;
}

/// \brief Options as a list; what each means goes with it.
template <class Options>
Teuchos::ParameterList listOf(const Options& options, const std::string& name) {
  Teuchos::ParameterList list(name);
  for (const auto& option : Options::table()) {
    setValue(list, option.spec.name, option.get(options));
    list.getEntry(option.spec.name).setDocString(option.spec.meaning);
  }
  return list;
}

/// \brief The options that a list names, over `options`; checked.
///
/// \param path before every name, for messages
/// \throws InputError, see `checkedValue`
template <class Options>
Options readOptions(const Teuchos::ParameterList& list, const std::string& path, Options options = {}) {
  for (const auto& option : Options::table())
    if (list.isParameter(option.spec.name))
      option.set(options, checkedValue(option.spec, joinPath(path, option.spec.name), list.getEntry(option.spec.name)));
  return options;
}

/// \brief Refuses what `Options` does not have.  \throws InputError with the nearest name that there is
template <class Options>
void requireKnownNames(const Teuchos::ParameterList& list, const std::string& path) {
  std::vector<std::string> names;
  for (const auto& option : Options::table()) names.push_back(option.spec.name);
  requireKnownNames(list, names, path);
}
}  // namespace Haptos
