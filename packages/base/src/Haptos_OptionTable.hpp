// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Teuchos_ParameterList.hpp>
#include <Teuchos_VerboseObject.hpp>
#include <functional>
#include <string>
#include <type_traits>
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

  /// \param member a pointer to it, or a function of the options that returns a reference to it.  Types and default follow from it,
  /// a chosen value's words from its `Choices`.
  template <class Member>
  OptionTable& add(const std::string& name, Member member, const std::string& meaning);
  template <class Member>
  OptionTable& add(const std::string& name, Member member, NumberRange range, const std::string& meaning) {
    add(name, member, meaning);
    this->back().spec.within(range);
    return *this;
  }
  /// `other`'s parameter of that name, for a member of this class.
  template <class Other, class Member>
  OptionTable& addFrom(const OptionTable<Other>& other, const std::string& name, Member member) {
    for (const auto& option : other)
      if (option.spec.name == name) add(name, member, option.spec.range, option.spec.meaning);
    return *this;
  }
};

template <class Options>
template <class Member>
OptionTable<Options>& OptionTable<Options>::add(const std::string& name, Member member, const std::string& meaning) {
  using T = std::decay_t<std::invoke_result_t<Member, Options&>>;
  Option<Options> option{ParameterSpec(name, {}, meaning),
                         [member](const Options& o) -> ParameterValue {
                           if constexpr (HasChoices<T>::value) return std::string(nameOf(std::invoke(member, o)));
                           else return std::invoke(member, o);
                         },
                         [member](Options& o, const ParameterValue& value) {
                           if constexpr (HasChoices<T>::value) std::invoke(member, o) = choiceNamed<T>(std::get<std::string>(value));
                           else std::invoke(member, o) = std::get<T>(value);
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

/// \brief What a solver manager is told: old names become new ones, with a warning on Teuchos' default output, and all defaults are set.
///
/// \param manager its name, for messages
/// \throws InputError for a wrong type or value, or an unknown name, with the nearest valid one
template <class Options>
Options readManagerParameters(Teuchos::ParameterList& list, const std::string& manager, const std::vector<ParameterAlias>& aliases) {
  for (const auto& warning : resolveAliases(aliases, list, manager))
    *Teuchos::VerboseObjectBase::getDefaultOStream() << "warning: " << warning << std::endl;
  std::vector<std::string> names;
  for (const auto& option : Options::table()) names.push_back(option.spec.name);
  requireKnownNames(list, names, manager);
  const auto options = readOptions<Options>(list, manager);
  list.setParameters(listOf(options, manager));
  return options;
}

}  // namespace Haptos
