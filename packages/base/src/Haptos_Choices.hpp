// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Teuchos_Assert.hpp>
#include <string>
#include <type_traits>
#include <vector>

namespace Haptos {

/// \brief A value that is chosen by a word.
template <class T>
struct Choice {
  T value;
  const char* name;
};

/// \brief The words of an enum, specialised beside it: `static constexpr Choice<T> all[]`.  Words are compared here alone.
template <class T>
struct Choices;

template <class T, class = void>
struct HasChoices : std::false_type {};
template <class T>
struct HasChoices<T, std::void_t<decltype(Choices<T>::all)>> : std::true_type {};

template <class T>
const char* nameOf(const T& value) {
  for (const auto& choice : Choices<T>::all)
    if (choice.value == value) return choice.name;
  TEUCHOS_TEST_FOR_EXCEPTION(true, std::logic_error, "a value without a name");
}

/// \brief The value of a word that was checked before.
template <class T>
T choiceNamed(const std::string& name) {
  for (const auto& choice : Choices<T>::all)
    if (choice.name == name) return choice.value;
  TEUCHOS_TEST_FOR_EXCEPTION(true, std::logic_error, "no choice is named '" << name << "'");
}

template <class T>
std::vector<std::string> choiceNames() {
  std::vector<std::string> names;
  for (const auto& choice : Choices<T>::all) names.push_back(choice.name);
  return names;
}

}  // namespace Haptos
