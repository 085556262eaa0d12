// SPDX-License-Identifier: BSD-3-Clause
// What the program's tree accepts, fills in and refuses.
#include <Teuchos_Array.hpp>
#include <Teuchos_UnitTestHarness.hpp>

#include "TestInput.hpp"

namespace {

using namespace HaptosTest;
using Doubles = Teuchos::Array<double>;
using Strings = Teuchos::Array<std::string>;

TEUCHOS_UNIT_TEST(Parameters, FullInputIsReadAndFilled) {
  const auto list = read(fullInput());
  TEST_EQUALITY(list.get<std::string>("Title"), "two beams");
  TEST_EQUALITY(list.sublist("Decomposition").get<int>("Subdomains"), 8);
  TEST_EQUALITY(list.sublist("Decomposition").get<int>("Seed"), 1);
  const auto& steel = list.sublist("Materials").sublist("steel");
  TEST_EQUALITY(steel.get<Strings>("Element Blocks")[1], "12");
  TEST_EQUALITY(steel.get<double>("Young's Modulus"), 2.119e5);
  const auto& contact = list.sublist("Contact").sublist("interface");
  TEST_EQUALITY(contact.get<std::string>("Discretization"), "Automatic");
  TEST_EQUALITY(contact.get<double>("Matching Tolerance"), 1e-3);
  TEST_EQUALITY(contact.sublist("Friction").get<Doubles>("Principal Direction")[0], 1.0);
  TEST_EQUALITY(contact.sublist("Friction").get<Doubles>("Coefficients")[1], 0.1);
  TEST_ASSERT(!contact.isSublist("Rigid Plane"));
  const auto& ground = list.sublist("Contact").sublist("ground");
  TEST_EQUALITY(ground.sublist("Friction").get<std::string>("Law"), "Frictionless");
  TEST_ASSERT(!ground.isParameter("Primary Side Set"));
  const auto& solver = list.sublist("Solver");
  TEST_EQUALITY(solver.get<double>("Relative Tolerance"), 1e-6);
  TEST_EQUALITY(solver.get<int>("Maximum Hessian Multiplications"), 5000);
  TEST_EQUALITY(solver.get<std::string>("Method"), "Automatic");
  TEST_EQUALITY(solver.sublist("SMALSE").get<double>("M Floor"), 0.1);
  TEST_EQUALITY(list.sublist("Local Solver").get<std::string>("Method"), "Automatic");
  TEST_EQUALITY(list.sublist("Preconditioner").get<std::string>("Type"), "Dirichlet");
}

TEUCHOS_UNIT_TEST(Parameters, ValuesOfBoundaryConditionsTakeOneForm) {
  const auto list = read(fullInput());
  const auto& conditions = list.sublist("Boundary Conditions");
  // Components xz, two values: x and z are prescribed.
  TEST_COMPARE_ARRAYS(conditions.sublist("clamp").get<Doubles>("Value"),
                      (std::vector<double>{1.5, 0.0, 2.5}));
  TEST_EQUALITY(conditions.sublist("press").get<std::string>("Value"), "100*min(1, max(0, 1.5 - x))");
  const auto& pull = conditions.sublist("pull").get<Strings>("Value");
  TEST_COMPARE_ARRAYS(pull, (std::vector<std::string>{"min(1, x)", "20", "x < 1 ? 0 : 1"}));
  TEST_COMPARE_ARRAYS(conditions.sublist("weight").get<Doubles>("Value"), (std::vector<double>{0, 0, -9.81}));
  TEST_ASSERT(!conditions.sublist("press").isParameter("Components"));

  const auto scalar = read(fullInput(), {{"Boundary Conditions->clamp->Value", "0.25"}});
  TEST_COMPARE_ARRAYS(scalar.sublist("Boundary Conditions").sublist("clamp").get<Doubles>("Value"),
                      Doubles(3, 0.25));
  const auto texts = read(fullInput(), {{"Boundary Conditions->clamp->Value", "{x, min(y, 2)}"}});
  TEST_COMPARE_ARRAYS(texts.sublist("Boundary Conditions").sublist("clamp").get<Strings>("Value"),
                      (std::vector<std::string>{"x", "0", "min(y, 2)"}));
  const auto none = read(replaced(
      fullInput(), R"xml(<Parameter name="Value" type="Array(double)" value="{1.5, 2.5}"/>)xml", ""));
  TEST_COMPARE_ARRAYS(none.sublist("Boundary Conditions").sublist("clamp").get<Doubles>("Value"),
                      Doubles(3, 0.0));
}

TEUCHOS_UNIT_TEST(Parameters, FileNamesAreRelativeToTheInput) {
  const auto list = read(fullInput(), {{"Output->Summary", "here.json"}});
  TEST_EQUALITY(list.sublist("Mesh").get<std::string>("File"), "folder/mesh/two_beams.exo");
  TEST_EQUALITY(list.sublist("Output").get<std::string>("File"), "/absolute/result.exo");
  TEST_EQUALITY(list.sublist("Output").get<std::string>("Summary"), "here.json");  // the current folder
}

TEUCHOS_UNIT_TEST(Parameters, IntsBecomeDoublesButNotTheOtherWay) {
  const auto list =
      read(replaced(fullInput(), R"(type="double" value="2.119e5")", R"(type="int" value="3")"));
  TEST_EQUALITY(list.sublist("Materials").sublist("steel").get<double>("Young's Modulus"), 3.0);
  const auto ints = read(replaced(fullInput(), R"xml("Array(double)" value="{0.3, 0.1}")xml",
                                  R"xml("Array(int)" value="{1, 0}")xml"));
  TEST_COMPARE_ARRAYS(
      ints.sublist("Contact").sublist("interface").sublist("Friction").get<Doubles>("Coefficients"),
      (std::vector<double>{1, 0}));
  TEST_CONTAINS(refusal(R"(type="int" value="8")", R"(type="double" value="8")"), "Decomposition->Subdomains",
                "has type double", "must be int");
  TEST_CONTAINS(refusal(R"(type="int" value="8")", R"(type="int" value="8.5")"), "Decomposition->Subdomains",
                "8.5", "not of type int");
}

TEUCHOS_UNIT_TEST(Parameters, UnknownNamesGetTheNearest) {
  TEST_CONTAINS(refusal(R"(name="Law")", R"(name="Lwa")"), "Contact->interface->Friction->Lwa",
                "unknown parameter", "did you mean 'Law'?");
  TEST_CONTAINS(refusal("Young's Modulus", "youngs modulus"), "Materials->steel->youngs modulus",
                "did you mean 'Young's Modulus'?");
  TEST_CONTAINS(refusal(R"(name="Contact")", R"(name="Kontact")"), "Kontact: unknown sublist", "'Contact'");
  TEST_CONTAINS(refusal(R"(value="Coulomb")", R"(value="coulomb")"), "Contact->interface->Friction->Law",
                "'coulomb'", "did you mean 'Coulomb'?", "Frictionless, Tresca, Coulomb");
  TEST_CONTAINS(refusal(R"(<ParameterList name="steel">)", R"(<Parameter name="E" type="int" value="1"/>
                        <ParameterList name="steel">)"),
                "Materials->E", "<material>");
  TEST_CONTAINS(refusal(R"(<Parameter name="Title" type="string" value="two beams"/>)",
                        R"(<Parameter name="Solver" type="string" value="SMALSE"/>)"),
                "Solver", "is a sublist");
  TEST_CONTAINS(refusal(R"(<Parameter name="Title" type="string" value="two beams"/>)",
                        R"(<ParameterList name="Title"/>)"),
                "Title", "is a parameter of type string");
}

TEUCHOS_UNIT_TEST(Parameters, NumbersOutOfRangeAreRefused) {
  const std::string ratio = "Materials->steel->Poisson's Ratio", young = "Materials->steel->Young's Modulus";
  for (const std::string bad : {"0.5", "-1", "0.6", "nan", "inf", "-inf", "1e999"})
    TEST_CONTAINS(setRefusal(ratio, bad), ratio, "-1 < value < 0.5");
  for (const std::string good : {"0", "0.4999", "-0.99"})
    TEST_EQUALITY(setRefusal(ratio, good), "(nothing thrown)");
  for (const std::string bad : {"0", "-1", "nan", "inf"})
    TEST_CONTAINS(setRefusal(young, bad), young, "value > 0");
  const std::string coefficients = "Contact->interface->Friction->Coefficients";
  for (const std::string bad : {"{-0.1, 0.3}", "{0.3, nan}", "inf, 0"})
    TEST_CONTAINS(setRefusal(coefficients, bad), coefficients, "value >= 0");
  for (const std::string bad : {"{0.3}", "{0.3, 0.3, 0.3}", "{}"})
    TEST_CONTAINS(setRefusal(coefficients, bad), coefficients, "2 entries");
  for (const std::string bad : {"1e-15", "0.2", "0"})
    TEST_CONTAINS(setRefusal("Solver->Relative Tolerance", bad), "Solver->Relative Tolerance",
                  "1e-14 <= value <= 0.1");
  TEST_CONTAINS(setRefusal("Solver->Maximum Hessian Multiplications", "0"), "value >= 1");
  TEST_CONTAINS(setRefusal("Contact->interface->Matching Tolerance", "0"), "0 < value <= 0.25");
  TEST_CONTAINS(setRefusal("Boundary Conditions->weight->Value", "{0, 0, inf}"),
                "Boundary Conditions->weight->Value", "inf is not a finite number");
  TEST_CONTAINS(setRefusal("Contact->ground->Rigid Plane->Normal", "{0, 0, 0}"),
                "Contact->ground->Rigid Plane->Normal", "zero vector");
  TEST_CONTAINS(setRefusal("Contact->interface->Friction->Principal Direction", "{0, 0, 0}"), "zero vector");
}

TEUCHOS_UNIT_TEST(Parameters, ContactsJoinDifferentSurfaces) {
  const auto refusalWith = [](const std::string& secondary, const std::string& primary) {
    return messageOf([&] { read(fullInput(), {{"Contact->second->Secondary Side Set", secondary}, {"Contact->second->Primary Side Set", primary}}); });
  };
  TEST_CONTAINS(refusalWith("lower_contact", "upper_contact"), "Contact->second", "same surfaces as contact 'interface'");
  TEST_CONTAINS(refusalWith("upper_contact", "lower_contact"), "Contact->second", "same surfaces as contact 'interface'");
  TEST_ASSERT(refusalWith("upper_contact", "other").find("same surfaces") == std::string::npos);
}

TEUCHOS_UNIT_TEST(Parameters, MissingParametersAndAlternatives) {
  TEST_CONTAINS(refusal(R"(<Parameter name="Young's Modulus" type="double" value="2.119e5"/>)", ""),
                "Materials->steel->Young's Modulus", "is missing", "value > 0");
  TEST_CONTAINS(refusal(R"(<Parameter name="File" type="string" value="mesh/two_beams.exo"/>)", ""), "Mesh",
                "'File' or 'Two Beams'");
  TEST_CONTAINS(messageOf([] { read("<ParameterList name=\"Haptos\"/>"); }), "Mesh", "'File' or 'Two Beams'");
  TEST_CONTAINS(setRefusal("Mesh->Two Beams->Subdomains Per Edge", "2"), "Mesh", "only one of",
                "'File' and 'Two Beams'");
  TEST_CONTAINS(setRefusal("Contact->ground->Primary Side Set", "top"), "Contact->ground", "only one of");
  TEST_CONTAINS(refusal(R"(<Parameter name="Primary Side Set" type="string" value="lower_contact"/>)", ""),
                "Contact->interface", "'Primary Side Set' or 'Rigid Plane'");
  TEST_CONTAINS(setRefusal("Contact->interface->Primary Side Set", "upper_contact"),
                "two different surfaces");
  TEST_CONTAINS(
      messageOf([] {
        read(R"(<ParameterList name="Haptos"><ParameterList name="Mesh"><Parameter name="File" type="string"
                          value="a.exo"/></ParameterList></ParameterList>)");
      }),
      "Materials: needs at least 1 sublist");
  TEST_CONTAINS(setRefusal("Mesh->File", " "), "Mesh->File", "must not be empty");
  TEST_CONTAINS(setRefusal("Materials->steel->Element Blocks", "{}"), "at least 1 entry");
}

TEUCHOS_UNIT_TEST(Parameters, LawsNeedTheirParameters) {
  const std::string law = "Contact->interface->Friction->Law",
                    bound = "Contact->interface->Friction->Slip Bound";
  TEST_CONTAINS(setRefusal(law, "Tresca"), bound, "is missing", "Law is Tresca");
  TEST_EQUALITY(messageOf([&] { read(fullInput(), {{law, "Tresca"}, {bound, "0"}}); }), "(nothing thrown)");
  TEST_CONTAINS(messageOf([&] { read(fullInput(), {{law, "Tresca"}, {bound, "-1"}}); }), bound, "value >= 0");
  TEST_CONTAINS(setRefusal(bound, "1"), bound, "valid only where Law is Tresca", "here Law is Coulomb");
  TEST_CONTAINS(setRefusal("Contact->ground->Friction->Law", "Coulomb"),
                "Contact->ground->Friction->Coefficients", "is missing", "Law is Coulomb");
  TEST_CONTAINS(setRefusal("Contact->ground->Friction->Coefficients", "{0.3, 0.3}"),
                "Contact->ground->Friction->Law", "is missing");
  TEST_EQUALITY(setRefusal(law, "Frictionless"), "(nothing thrown)");  // the coefficients may stay
}

TEUCHOS_UNIT_TEST(Parameters, BoundaryConditionsMustFitTheirType) {
  const std::string conditions = "Boundary Conditions->";
  TEST_CONTAINS(setRefusal(conditions + "press->Components", "x"), conditions + "press->Components",
                "valid only where Type is Displacement", "here Type is Pressure");
  TEST_CONTAINS(setRefusal(conditions + "press->Element Blocks", "{upper}"),
                "valid only where Type is Body Force");
  TEST_CONTAINS(setRefusal(conditions + "weight->Sets", "{a}"), "here Type is Body Force");
  TEST_CONTAINS(setRefusal(conditions + "press->Value", "{1, 2, 3}"), conditions + "press->Value",
                "3 entries", "takes one number");
  TEST_CONTAINS(setRefusal(conditions + "pull->Value", "1"), conditions + "pull->Value", "array of 3");
  TEST_CONTAINS(setRefusal(conditions + "clamp->Value", "{1}"), conditions + "clamp->Value", "1 entry",
                "Components xz", "array of 2");
  TEST_CONTAINS(setRefusal(conditions + "clamp->Components", "zx"), "'zx' is not valid");
  TEST_CONTAINS(setRefusal(conditions + "clamp->Type", "Displacment"), "did you mean 'Displacement'?");
  TEST_CONTAINS(setRefusal(conditions + "press->Value", "100*(1 - xx)"), conditions + "press->Value",
                "cannot be understood", "xx");
  TEST_CONTAINS(setRefusal(conditions + "new->Type", "Pressure"), conditions + "new->Sets", "is missing");
  TEST_CONTAINS(messageOf([&] {
                  read(fullInput(),
                       {{conditions + "new->Type", "Pressure"}, {conditions + "new->Sets", "{a}"}});
                }),
                conditions + "new->Value", "is missing");
}

TEUCHOS_UNIT_TEST(Parameters, BricksBelongToTheGeneratedMesh) {
  const std::string file = R"(<Parameter name="File" type="string" value="mesh/two_beams.exo"/>)";
  const std::string beams =
      R"(<ParameterList name="Two Beams"><Parameter name="Subdomains Per Edge" type="int" value="2"/>
      <Parameter name="Elements Per Subdomain Edge" type="int" value="4"/></ParameterList>)";
  const std::string method = R"(<Parameter name="Method" type="string" value="METIS"/>)";
  const std::string metis = replaced(fullInput(), file, beams);
  const std::string unnamed = replaced(metis, method, "");
  TEST_CONTAINS(setRefusal("Decomposition->Method", "Bricks"), "Decomposition->Method",
                "only for a generated mesh");
  TEST_EQUALITY(read(metis).sublist("Decomposition").get<std::string>("Method"), "METIS");
  TEST_CONTAINS(messageOf([&] { read(unnamed); }), "Decomposition->Subdomains", "is 8", "4 k^3 = 32");
  const auto list = read(unnamed, {{"Decomposition->Subdomains", "32"}});
  TEST_EQUALITY(list.sublist("Decomposition").get<std::string>("Method"), "Bricks");
  TEST_EQUALITY(read(replaced(fullInput(), method, "")).sublist("Decomposition").get<std::string>("Method"),
                "METIS");
}

TEUCHOS_UNIT_TEST(Parameters, ValidListsStayAsTheyAre) {
  const auto list = read(fullInput());
  const auto again = Haptos::validatedParameters(list);
  TEST_ASSERT(Teuchos::haveSameValues(list, again, true));
}

}  // namespace
