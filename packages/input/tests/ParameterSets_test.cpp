// SPDX-License-Identifier: BSD-3-Clause
// --set, --print-parameters, doc/input.md, aliases, texts and names.
#include <Teuchos_Array.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>
#include <sstream>

#include "Haptos_NearestName.hpp"
#include "Haptos_ParameterValidation.hpp"
#include "TestInput.hpp"

namespace {

using namespace HaptosTest;
using namespace Haptos;
using Teuchos::ParameterList;
using Doubles = Teuchos::Array<double>;
using Strings = Teuchos::Array<std::string>;

TEUCHOS_UNIT_TEST(ParameterSets, ValuesTakeTheValidType) {
  const std::string coefficients = "Contact->interface->Friction->Coefficients";
  const auto list = read(fullInput(), {{"Solver->Relative Tolerance", "1"},
                                       {"Solver -> Relative Tolerance", "1e-8"},
                                       {coefficients, "0.5,0"},
                                       {"Decomposition->Seed", "7"},
                                       {"Title", "2024"},
                                       {"Boundary Conditions->pull->Value", "{1, 2, 3}"},
                                       {"Boundary Conditions->press->Value", "7"},
                                       {"Materials->brass->Element Blocks", "lower"},
                                       {"Materials->brass->Young's Modulus", "1e5"},
                                       {"Materials->brass->Poisson's Ratio", "0"}});
  TEST_EQUALITY(list.sublist("Solver").get<double>("Relative Tolerance"), 1e-8);  // the last one counts
  TEST_COMPARE_ARRAYS(
      list.sublist("Contact").sublist("interface").sublist("Friction").get<Doubles>("Coefficients"),
      (std::vector<double>{0.5, 0.0}));
  TEST_EQUALITY(list.sublist("Decomposition").get<int>("Seed"), 7);
  TEST_EQUALITY(list.get<std::string>("Title"), "2024");
  TEST_COMPARE_ARRAYS(list.sublist("Boundary Conditions").sublist("pull").get<Doubles>("Value"),
                      (std::vector<double>{1, 2, 3}));
  TEST_EQUALITY(list.sublist("Boundary Conditions").sublist("press").get<double>("Value"), 7.0);
  TEST_COMPARE_ARRAYS(list.sublist("Materials").sublist("brass").get<Strings>("Element Blocks"),
                      (std::vector<std::string>{"lower"}));
  TEST_EQUALITY(list.sublist("Materials").sublist("brass").get<double>("Poisson's Ratio"), 0.0);
}

TEUCHOS_UNIT_TEST(ParameterSets, WrongPathsAndValuesAreRefused) {
  TEST_CONTAINS(setRefusal("Solver->Tolerance", "1"), "Solver->Tolerance",
                "did you mean 'Relative Tolerance'?");
  TEST_CONTAINS(setRefusal("Solvr->Relative Tolerance", "1"), "Solvr", "unknown sublist", "'Solver'");
  TEST_CONTAINS(setRefusal("Solver", "1"), "Solver: is a sublist", "Relative Tolerance");
  TEST_CONTAINS(setRefusal("Title->a", "1"), "Title", "is a parameter");
  TEST_CONTAINS(setRefusal("Materials->steel", "1"), "Materials->steel", "is a sublist");
  TEST_CONTAINS(setRefusal("Materials->brass", "1"), "Materials->brass", "<material>");
  TEST_CONTAINS(setRefusal("Solver->->x", "1"), "empty name");
  TEST_CONTAINS(setRefusal("Decomposition->Seed", "1.5"), "Decomposition->Seed", "'1.5'", "int");
  TEST_CONTAINS(setRefusal("Decomposition->Seed", "99999999999"), "Decomposition->Seed", "int");
  TEST_CONTAINS(setRefusal("Solver->Relative Tolerance", "small"), "'small'", "double");
  TEST_CONTAINS(setRefusal("Contact->interface->Friction->Principal Direction", "{0.3, 0, b}"), "Array(double)");
}

/// Replaces the placeholders of a printed path by names that the input has.
std::string realPath(std::string path) {
  const std::vector<std::pair<std::string, std::string>> names = {
      {"<material>", "steel"}, {"<condition>", "clamp"}, {"<contact>", "interface"}};
  for (const auto& [placeholder, name] : names)
    if (path.find(placeholder) != std::string::npos) path = replaced(path, placeholder, name);
  return path;
}

int countParameters(const ParameterTree& tree) {
  int count = int(tree.parameters.size());
  for (const auto& sublist : tree.sublists) count += countParameters(sublist);
  for (const auto& child : tree.userNamed) count += countParameters(child);
  return count;
}

TEUCHOS_UNIT_TEST(ParameterSets, EveryPrintedDefaultIsAccepted) {
  const std::string input = replaced(fullInput(), "{1.5, 2.5}", "{1.5, 0, 2.5}");  // fits any Components
  std::istringstream printed(printedParameters());
  std::string line, path;
  int numPaths = 0, numDefaults = 0;
  while (std::getline(printed, line)) {
    if (line[0] != ' ') {
      path = line;
      ++numPaths;
    }
    const std::string marker = "    default  ";
    if (line.compare(0, marker.size(), marker) != 0) continue;
    std::string value = line.substr(marker.size());
    if (value.compare(0, 8, "required") == 0 || value == "none") continue;
    value = value.substr(0, value.find("; required"));
    if (value == "\"\"") value = "";
    ++numDefaults;
    TEST_EQUALITY(messageOf([&] { read(input, {{realPath(path), value}}); }), "(nothing thrown)");
  }
  TEST_EQUALITY(numPaths, countParameters(parameterTree()));
  TEST_COMPARE(numPaths, >=, 39);
  TEST_COMPARE(numDefaults, >=, 22);
}

TEUCHOS_UNIT_TEST(ParameterSets, DocumentationNamesEveryParameter) {
  const std::string doc = inputDocumentation();
  TEST_CONTAINS(doc, "# Input", "### Contact", "##### Contact->&lt;contact>->Friction",
                "| Law | string | Frictionless | Frictionless \\| Tresca \\| Coulomb \\| Tied |",
                "| Poisson's Ratio | double | required | -1 &lt; value &lt; 0.5 |", "force per area",
                "Exactly one of `File`, `Two Beams` is given.");
  TEST_CONTAINS(printedParameters(), "Solver->Relative Tolerance\n    type     double\n    default  1e-06\n",
                "valid    1e-14 <= value <= 0.1", "only     where Law is Tresca",
                "note     exactly one of 'Primary Side Set', 'Rigid Plane' is given");
  for (const auto& section : parameterTree().sublists)
    for (const auto& spec : section.parameters) TEST_CONTAINS(doc, "| " + spec.name + " |");
}

ParameterTree smallTree() {
  ParameterTree options("Options", "a sublist");
  options
      .add(ParameterSpec("Level", {ParameterType::Int}, "a level")
               .defaultTo(2)
               .within(NumberRange::closed(0, 3)))
      .add(ParameterSpec("Fast", {ParameterType::Bool}, "a flag").defaultTo(true))
      .alias("Depth", "Level");
  ParameterTree tree("Small", "a tree for tests");
  tree.add(options).alias("Settings", "Options");
  return tree;
}

TEUCHOS_UNIT_TEST(ParameterTree, AliasesWarnAndWork) {
  ParameterList given("Small");
  given.sublist("Settings").set("Depth", 3);
  std::vector<std::string> warnings;
  const auto list = validatedList(smallTree(), given, warnings);
  TEST_EQUALITY(list.sublist("Options").get<int>("Level"), 3);
  TEST_ASSERT(!list.isParameter("Settings") && !list.sublist("Options").isParameter("Depth"));
  TEST_EQUALITY(warnings.size(), 2);
  TEST_CONTAINS(warnings[0], "Settings", "write 'Options'");
  TEST_CONTAINS(warnings[1], "Options->Depth", "write 'Level'");

  given.sublist("Options").set("Level", 1);
  TEST_CONTAINS(messageOf([&] { validatedList(smallTree(), given, warnings); }), "Settings", "'Options'",
                "keep only the new one");
}

TEUCHOS_UNIT_TEST(ParameterTree, AliasesWorkInSets) {
  ParameterList list("Small");
  std::vector<std::string> warnings;
  setFromText(smallTree(), list, "Settings->Depth", "1", warnings);
  setFromText(smallTree(), list, "Options->Fast", "false", warnings);
  TEST_EQUALITY(list.sublist("Options").get<int>("Level"), 1);
  TEST_EQUALITY(list.sublist("Options").get<bool>("Fast"), false);
  TEST_EQUALITY(warnings.size(), 2);
}

TEUCHOS_UNIT_TEST(ParameterTree, TypesThatNobodyKnowsAreRefused) {
  ParameterList given("Small");
  given.sublist("Options").set("Level", 1.0f);
  std::vector<std::string> warnings;
  TEST_CONTAINS(messageOf([&] { validatedList(smallTree(), given, warnings); }), "Options->Level",
                "must be int");
  given.sublist("Options").set("Level", 4);
  TEST_CONTAINS(messageOf([&] { validatedList(smallTree(), given, warnings); }),
                "Options->Level: 4 is out of range", "0 <= value <= 3");
}

TEUCHOS_UNIT_TEST(ParameterValue, TextsAreReadWhole) {
  TEST_EQUALITY(*parseDouble(" +1e-3 "), 1e-3);
  TEST_EQUALITY(*parseDouble("1e-999"), 0.0);
  TEST_ASSERT(std::isinf(*parseDouble("-1e999")) && std::isnan(*parseDouble("nan")));
  for (const std::string bad : {"", "1.0x", "0x10", "1,5", "--1", "+-1"}) TEST_ASSERT(!parseDouble(bad));
  for (const std::string bad : {"", "1.0", "1e3", "2147483648"}) TEST_ASSERT(!parseInt(bad));
  TEST_EQUALITY(*parseInt("-12"), -12);
  const std::vector<std::string> entries = {"min(1, x)", "a, b", "driver's seat", "c"};
  TEST_COMPARE_ARRAYS(splitArray("{min(1, x), \"a, b\", driver's seat, c}"), entries);
  for (const double value : {0.1, 1e-6, 2.119e5, 1.0 / 3.0})
    TEST_EQUALITY(*parseDouble(numberText(value)), value);
}

TEUCHOS_UNIT_TEST(NearestName, CountsEditsOfThePlainNames) {
  TEST_EQUALITY(nameDistance("youngs_modulus", "Young's Modulus"), 0);
  TEST_EQUALITY(nameDistance("Lwa", "Law"), 1);  // one swap
  TEST_EQUALITY(nameDistance("kitten", "sitting"), 3);
  TEST_EQUALITY(nameDistance("", "abc"), 3);
  TEST_EQUALITY(nearestName("--ouput", {"--summary", "--output"}), "--output");
  TEST_EQUALITY(nearestName("Tolerance", {"Method", "SMALSE", "Relative Tolerance"}), "Relative Tolerance");
  TEST_EQUALITY(nearestName("x", {}), "");
  TEST_EQUALITY(suggestion("--ouput", {"--summary", "--output"}), "; did you mean '--output'?");
  TEST_EQUALITY(suggestion("Tolerance", {"Method", "SMALSE", "Relative Tolerance"}), "; did you mean 'Relative Tolerance'?");
  TEST_EQUALITY(suggestion("Density", {"Element Blocks", "Poisson's Ratio"}), ".");
  TEST_EQUALITY(suggestion("Load History", {"Local Solver", "Solver"}), ".");
  TEST_EQUALITY(suggestion("float", {"int", "double"}), ".");
  TEST_EQUALITY(suggestion("x", {}), ".");
}

}  // namespace
