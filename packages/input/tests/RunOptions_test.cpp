// SPDX-License-Identifier: BSD-3-Clause
// What a checked input says, typed.
#include "Haptos_RunOptions.hpp"

#include <Teuchos_UnitTestHarness.hpp>

#include "Haptos_OptionTable.hpp"
#include "TestInput.hpp"

namespace {

using namespace Haptos;
using namespace HaptosTest;

RunOptions optionsOf(const std::string& text, const std::vector<std::pair<std::string, std::string>>& sets = {}) {
  return runOptions(read(text, sets));
}

TEUCHOS_UNIT_TEST(RunOptions, CoefficientsAreNumbersExpressionsOrFields) {
  const auto o = optionsOf(fullInput(), {{"Contact->interface->Friction->Coefficients", "{0.1 + 0.05*x, MU_2}"}});
  const auto& [first, second] = o.contacts[0].friction.coefficients;
  TEST_ASSERT(o.contacts[0].friction.hasFields() && first.field.empty() && second.field == "MU_2");
  TEST_FLOATING_EQUALITY(first.expression(2, 0, 0), 0.2, 1e-14);
  const auto numbers = optionsOf(fullInput(), {{"Contact->interface->Friction->Coefficients", "{0.1 + 0.05, pi}"}});
  TEST_ASSERT(!numbers.contacts[0].friction.hasFields());
}

TEUCHOS_UNIT_TEST(RunOptions, FullInput) {
  const RunOptions o = optionsOf(fullInput());
  TEST_EQUALITY(o.title, "two beams");
  TEST_ASSERT(!o.mesh.twoBeams && !o.mesh.file.empty());
  TEST_ASSERT(o.decomposition.method == PartitionMethod::Metis);
  TEST_EQUALITY(o.decomposition.subdomains, 8);
  TEST_EQUALITY(o.materials.size(), 1u);
  TEST_EQUALITY(o.materials[0].name, "steel");
  TEST_COMPARE_ARRAYS(o.materials[0].blocks, (std::vector<std::string>{"upper", "12"}));
  TEST_EQUALITY(o.materials[0].youngsModulus, 2.119e5);
  TEST_EQUALITY(o.contacts.size(), 2u);
  TEST_EQUALITY(o.contacts[0].primarySideSet, "lower_contact");
  TEST_ASSERT(o.contacts[0].friction.law == FrictionLaw::Coulomb);
  TEST_ASSERT(!o.contacts[0].friction.hasFields());
  TEST_EQUALITY(o.contacts[0].friction.coefficients[0].expression(0, 0, 0), 0.3);
  TEST_EQUALITY(o.contacts[0].friction.coefficients[1].expression(0, 0, 0), 0.1);
  TEST_EQUALITY(o.contacts[1].name, "ground");
  TEST_ASSERT(o.contacts[1].rigidPlane && o.contacts[1].friction.law == FrictionLaw::Frictionless);
  TEST_EQUALITY(o.contacts[1].rigidPlane->normal[2], 1.0);
  TEST_EQUALITY(o.output.file, "/absolute/result.exo");
}

TEUCHOS_UNIT_TEST(RunOptions, ConditionsKeepTheirOrderAndForm) {
  const auto conditions = optionsOf(fullInput()).conditions;
  TEST_EQUALITY(conditions.size(), 4u);
  const ConditionType types[] = {ConditionType::Displacement, ConditionType::Pressure, ConditionType::Traction, ConditionType::BodyForce};
  for (std::size_t i = 0; i < 4; ++i) TEST_ASSERT(conditions[i].type == types[i]);
  TEST_EQUALITY(conditions[0].components, "xz");
  TEST_COMPARE_ARRAYS(conditions[0].value(7, 8, 9), (std::array<double, 3>{1.5, 0, 2.5}));
  TEST_EQUALITY(conditions[1].path, "Boundary Conditions->press");
  TEST_EQUALITY(conditions[1].pressure(1, 0, 0), 50.0);
  TEST_COMPARE_ARRAYS(conditions[2].value(0.5, 0, 0), (std::array<double, 3>{0.5, 20, 0}));
  TEST_COMPARE_ARRAYS(conditions[3].blocks, std::vector<std::string>{"upper"});
  TEST_ASSERT(conditions[3].sets.empty());
}

TEUCHOS_UNIT_TEST(RunOptions, EveryWordIsItsOwnValue) {
  for (const char* law : {"Frictionless", "Tied"}) {
    const auto o = optionsOf(replaced(fullInput(), R"(value="Coulomb")", std::string(R"(value=")") + law + "\""));
    TEST_EQUALITY(nameOf(o.contacts[0].friction.law), std::string(law));
  }
  for (const char* method : {"Automatic", "SMALSE", "Subspace Newton", "PCPG"})
    TEST_EQUALITY(nameOf(optionsOf(fullInput(), {{"Solver->Method", method}}).solver.method), std::string(method));
  for (const char* type : {"Dirichlet", "Lumped", "None"})
    TEST_EQUALITY(nameOf(optionsOf(fullInput(), {{"Preconditioner->Type", type}}).preconditioner.kind), std::string(type));
  for (const char* expansion : {"Automatic", "Projected CG", "Fixed Step"}) {
    const auto o = optionsOf(fullInput(), {{"Solver->SMALSE->Expansion", expansion}, {"Solver->SMALSE->Inner Reduction", "0"}});
    TEST_EQUALITY(nameOf(o.solver.smalse.expansion), std::string(expansion));
    TEST_EQUALITY(o.solver.smalse.innerReduction, 0.0);
  }
}

// Whatever table a parameter stands in, another value of it arrives in the member.
template <class Options>
void checkTable(const std::string& section, bool& success, Teuchos::FancyOStream& out) {
  const auto sectionOf = [&](const std::vector<std::pair<std::string, std::string>>& sets) {
    auto list = read(fullInput(), sets);
    for (const auto& name : splitPath(section)) list = Teuchos::ParameterList(list.sublist(name));
    return list;
  };
  const auto before = readOptions<Options>(sectionOf({}), section);
  for (const auto& option : Options::table()) {
    const auto& spec = option.spec;
    std::string other = spec.choices.empty() ? "name" : spec.choices.back();
    if (spec.types[0] == ParameterType::Int) other = valueText(std::get<int>(*spec.defaultValue) + 21);
    if (spec.types[0] == ParameterType::Double) other = valueText(0.5 * (std::get<double>(*spec.defaultValue) + std::min(spec.range.upper, 1e3)));
    const auto list = sectionOf({{section + "->" + spec.name, other}});
    const auto options = readOptions<Options>(list, section);
    TEST_ASSERT(option.get(options) != option.get(before));
    TEST_EQUALITY(valueText(option.get(options)), valueText(*valueOf(list.getEntry(spec.name))));
    for (const auto& unchanged : Options::table())
      if (unchanged.spec.name != spec.name) TEST_ASSERT(unchanged.get(options) == unchanged.get(before));
  }
}

TEUCHOS_UNIT_TEST(RunOptions, EveryParameterArrives) {
  checkTable<LocalSolverOptions>("Local Solver", success, out);
  checkTable<PreconditionerOptions>("Preconditioner", success, out);
  checkTable<CoarseOptions>("Coarse Problem", success, out);
  checkTable<DecompositionOptions>("Decomposition", success, out);
  checkTable<SolverOptions>("Solver", success, out);
  checkTable<SmalseOptions>("Solver->SMALSE", success, out);
  checkTable<OutputOptions>("Output", success, out);
}

}  // namespace
