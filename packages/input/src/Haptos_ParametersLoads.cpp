// SPDX-License-Identifier: BSD-3-Clause
// Boundary Conditions: prescribed displacements, surface loads and body forces.
#include <Teuchos_Array.hpp>
#include <Teuchos_ParameterList.hpp>

#include "Haptos_Error.hpp"
#include "Haptos_Expression.hpp"
#include "Haptos_ParameterSections.hpp"

namespace Haptos {

namespace {

using Teuchos::ParameterList;
using Type = ParameterType;
using Numbers = std::vector<double>;
using Texts = std::vector<std::string>;

const std::string axes = "xyz";

const std::string displacement = nameOf(ConditionType::Displacement), pressure = nameOf(ConditionType::Pressure),
                  traction = nameOf(ConditionType::Traction), bodyForce = nameOf(ConditionType::BodyForce);

std::string wordOr(const ParameterList& list, const std::string& name, const std::string& otherwise) {
  return list.isType<std::string>(name) ? list.get<std::string>(name) : otherwise;
}

std::size_t numEntries(const ParameterValue& value) {
  if (const auto* numbers = std::get_if<Numbers>(&value)) return numbers->size();
  if (const auto* texts = std::get_if<Texts>(&value)) return texts->size();
  return 1;
}

// One entry means the same for all components; three are x, y, z even where fewer components are prescribed.
std::string wrongCount(const ParameterList& list) {
  if (!list.isParameter("Value")) return "";
  const auto value = *valueOf(list.getEntry("Value"));
  const std::size_t given = numEntries(value);
  const std::string type = wordOr(list, "Type", "");
  const std::string found = "Value: has " + std::to_string(given) + (given == 1 ? " entry" : " entries");
  if (type == pressure && given != 1) return found + "; a Pressure takes one number or expression";
  if ((type == traction || type == bodyForce) && given != 3)
    return found + "; a " + type + " takes an array of 3 (x, y, z)";
  const std::string components = wordOr(list, "Components", axes);
  const bool one = !isArray(typeOf(value));
  if (type == displacement && !one && given != 3 && given != components.size()) {
    const std::string each =
        components.size() == 3 ? "" : "an array of " + std::to_string(components.size()) + ", ";
    return found + "; for Components " + components + " give one value for all, " + each +
           "or an array of 3 (x, y, z)";
  }
  return "";
}

// Parsed here to be refused early, and once more where it is used.
std::string wrongExpression(const ParameterList& list) {
  if (!list.isParameter("Value")) return "";
  const auto value = *valueOf(list.getEntry("Value"));
  Texts texts;
  if (const auto* text = std::get_if<std::string>(&value)) texts = {*text};
  if (const auto* several = std::get_if<Texts>(&value)) texts = *several;
  try {
    for (const auto& text : texts) Expression(text, "Value");
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

/// Spreads the entries of the named components over (x, y, z); the others are zero.
template <class T>
std::vector<T> overAxes(const std::vector<T>& given, const std::string& components, const T& zero) {
  if (given.size() == 3) return given;
  std::vector<T> all(3, zero);
  for (std::size_t i = 0; i < components.size(); ++i) all[axes.find(components[i])] = given[i];
  return all;
}

// After it a Pressure has one entry and a Displacement three: nobody else needs to know of the other spellings.
void normaliseValue(ParameterList& list) {
  auto value = *valueOf(list.getEntry("Value"));
  if (list.get<std::string>("Type") == pressure) {  // {100} is 100
    if (const auto* numbers = std::get_if<Numbers>(&value)) list.set("Value", numbers->front());
    if (const auto* texts = std::get_if<Texts>(&value)) list.set("Value", texts->front());
    return;
  }
  if (list.get<std::string>("Type") != displacement) return;
  const std::string components = list.get<std::string>("Components");
  if (const auto* number = std::get_if<double>(&value)) value = Numbers(3, *number);
  if (const auto* text = std::get_if<std::string>(&value)) value = Texts(3, *text);
  if (const auto* numbers = std::get_if<Numbers>(&value)) value = overAxes(*numbers, components, 0.0);
  if (const auto* texts = std::get_if<Texts>(&value)) value = overAxes(*texts, components, std::string("0"));
  setValue(list, "Value", value);
}

ParameterSpec valueParameter() {
  return ParameterSpec(
             "Value", {Type::Double, Type::DoubleArray, Type::String, Type::StringArray},
             "Displacement [length], pressure (positive pushes into the body) or traction [force per "
             "area] in global axes, body force [force per volume]; a string is an expression of x, y, z")
      .defaultTo(Numbers(3, 0.0))
      .neededWhen("Type", {pressure, traction, bodyForce})
      .entries(1, 3)
      .notEmpty();
}

}  // namespace

ParameterTree boundaryConditionsSection() {
  constexpr auto any = std::numeric_limits<std::size_t>::max();
  ParameterTree condition("<condition>", "One boundary condition or load; the name is yours.");
  condition
      .add(ParameterSpec("Type", {Type::String}, "What is prescribed")
               .mustBeGiven()
               .oneOf(choiceNames<ConditionType>()))
      .add(ParameterSpec("Sets", {Type::StringArray},
                         "Names or numbers of side sets (a Displacement takes node sets too)")
               .onlyWhen("Type", {displacement, pressure, traction})
               .neededWhen("Type", {displacement, pressure, traction})
               .entries(1, any)
               .notEmpty())
      .add(ParameterSpec("Element Blocks", {Type::StringArray}, "Names or numbers of the element blocks")
               .onlyWhen("Type", {bodyForce})
               .neededWhen("Type", {bodyForce})
               .entries(1, any)
               .notEmpty())
      .add(ParameterSpec("Components", {Type::String}, "The displacement components that are prescribed")
               .defaultTo(axes)
               .onlyWhen("Type", {displacement})
               .oneOf({"x", "y", "z", "xy", "xz", "yz", "xyz"}))
      .add(valueParameter())
      .rule(
          "`Value` has one entry for a Pressure and three (x, y, z) for a Traction or Body Force; for a "
          "Displacement one for all Components, one for each of them, or three (x, y, z).",
          wrongCount)
      .rule(
          "An expression uses x, y, z, numbers, the operators and functions of muParser, `clip(v, low, "
          "high)` and "
          "the constant `pi`.",
          wrongExpression)
      .normalise(normaliseValue);
  ParameterTree section("Boundary Conditions", "One list for each prescribed displacement or load.");
  section.addUserNamed(std::move(condition), 0);
  return section;
}

ConditionOptions conditionOptions(const std::string& name, const ParameterList& list) {
  ConditionOptions condition;
  condition.path = "Boundary Conditions->" + name;
  condition.type = choiceNamed<ConditionType>(list.get<std::string>("Type"));
  const auto names = [&](const char* entry) {
    return list.isParameter(entry) ? list.get<Teuchos::Array<std::string>>(entry).toVector() : Texts{};
  };
  condition.sets = names("Sets");
  condition.blocks = names("Element Blocks");
  condition.components = wordOr(list, "Components", "");
  if (condition.type == ConditionType::Pressure) condition.pressure = expressionFromParameter(list, "Value", condition.path);
  else condition.value = vectorExpressionFromParameter(list, "Value", condition.path);
  return condition;
}

}  // namespace Haptos
