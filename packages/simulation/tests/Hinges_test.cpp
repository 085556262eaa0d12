// SPDX-License-Identifier: BSD-3-Clause
// Bodies in pieces that an edge alone joins, and that turn about it where nothing holds them.
#include <Teuchos_Array.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <cmath>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_FetiSystem.hpp"
#include "Haptos_LocalSolverFactor.hpp"
#include "Haptos_Parameters.hpp"
#include "Haptos_Simulation.hpp"

namespace {

using namespace Haptos;
using Teuchos::ParameterList;

Teuchos::Array<std::string> arrayOf(std::vector<std::string> list) { return Teuchos::Array<std::string>(list); }

BoxSpec box(const std::string& name, const std::array<double, 3>& lower, const std::array<double, 3>& upper, std::array<int, 3> divisions) {
  BoxSpec spec;
  spec.blockName = name;
  spec.lower = lower;
  spec.upper = upper;
  spec.divisions = divisions;
  spec.sideSetNames = {name + "_west", "", "", "", name + "_bottom", name + "_top"};
  return spec;
}

// A post, clamped at its foot, an arm that hangs at its edge y = 0, z = 1, and a clamped prop below the arm.
SourceMesh armAndProp() {
  SourceMesh source;
  source.mesh = makeBoxes({box("post", {0, -1, 0}, {1, 0, 1}, {2, 2, 2}), box("arm", {0, 0, 1}, {1, 1, 2}, {2, 3, 2}),
                           box("prop", {0, 0, 0.5}, {1, 1, 1}, {2, 3, 1})});
  Mesh& mesh = source.mesh;
  for (auto& node : mesh.blocks[1].connectivity)
    for (const auto other : mesh.blocks[0].connectivity)
      if (mesh.coordinates[std::size_t(other)] == mesh.coordinates[std::size_t(node)]) node = other;
  return source;
}

void addCondition(ParameterList& list, const std::string& set, const std::string& type) {
  auto& condition = list.sublist("Boundary Conditions").sublist(type + " of " + set);
  condition.set<std::string>("Type", type);
  condition.set("Sets", arrayOf({set}));
}

ParameterList parameters(int subdomains, double pressure) {
  ParameterList list("Haptos");
  list.sublist("Mesh").set<std::string>("File", "in_memory.exo");
  list.sublist("Decomposition").set("Subdomains", subdomains);
  auto& material = list.sublist("Materials").sublist("soft");
  material.set("Element Blocks", arrayOf({"post", "arm", "prop"}));
  material.set("Young's Modulus", 1000.0);
  material.set("Poisson's Ratio", 0.3);
  for (const char* foot : {"post_bottom", "prop_bottom"}) {
    addCondition(list, foot, "Displacement");
    list.sublist("Boundary Conditions").sublist(std::string("Displacement of ") + foot).set<std::string>("Components", "xyz");
  }
  addCondition(list, "arm_top", "Pressure");
  list.sublist("Boundary Conditions").sublist("Pressure of arm_top").set("Value", pressure);
  auto& contact = list.sublist("Contact").sublist("rest");
  contact.set<std::string>("Secondary Side Set", "arm_bottom");
  contact.set<std::string>("Primary Side Set", "prop_top");
  contact.sublist("Friction").set<std::string>("Law", "Frictionless");
  list.sublist("Solver").set("Relative Tolerance", 1e-8);
  return list;
}

// Two cubes; the middle nodes of the lower one are moved together along y, so that its upper half turns about z = 0.5 nearly freely.
SourceMesh folded(double width) {
  SourceMesh source;
  source.mesh = makeBoxes({box("prop", {0, 0, 0}, {1, 1, 1}, {2, 2, 2}), box("arm", {0, 0, 1}, {1, 1, 2}, {2, 2, 2})});
  for (auto& x : source.mesh.coordinates)
    if (x[2] == 0.5) x[1] *= width;
  return source;
}

ParameterList foldedParameters(const std::string& method) {
  ParameterList list = parameters(4, 1);
  list.sublist("Materials").sublist("soft").set("Element Blocks", arrayOf({"arm", "prop"}));
  auto& conditions = list.sublist("Boundary Conditions");
  conditions.remove("Displacement of post_bottom");
  addCondition(list, "arm_west", "Displacement");
  conditions.sublist("Displacement of arm_west").set<std::string>("Components", "xyz");
  auto& friction = list.sublist("Contact").sublist("rest").sublist("Friction");
  friction.set<std::string>("Law", "Coulomb");
  friction.set("Coefficients", Teuchos::Array<double>(2, 0.3));
  list.sublist("Solver").set("Method", method);
  return list;
}

std::string refusalOfHinges(const ParameterList& list) {
  const SourceMesh source = armAndProp();
  Simulation run(Tpetra::getDefaultComm(), validatedParameters(list), nullptr, &source);
  try {
    run.prepare();
  } catch (const InsufficientModel& e) {
    return e.what();
  }
  return "(nothing thrown)";
}

}  // namespace

// ANALYTIC: about the hinge the pressure p on the top, [0, 1] x [0, 1], has the moment p / 2, and contact alone answers it.
TEUCHOS_UNIT_TEST(Hinges, ContactHoldsAnArm) {
  const double pressure = 3;
  for (int subdomains : {3, 9}) {
    const SourceMesh source = armAndProp();
    Simulation run(Tpetra::getDefaultComm(), validatedParameters(parameters(subdomains, pressure)), nullptr, &source);
    run.prepare();
    const auto result = run.solve();
    TEST_ASSERT(result.solved);
    TEST_EQUALITY(result.report.model.bodies, 2);
    TEST_EQUALITY(run.system().floatingMotions().basis.cols(), 1);  // the rotation about the hinge
    TEST_EQUALITY(result.report.solver.method, "Subspace Newton");
    if (Tpetra::getDefaultComm()->getRank() != 0) continue;
    double moment = 0;
    for (const auto& pair : result.pairs) moment += pair.normalForce * source.mesh.coordinates[std::size_t(pair.secondaryNode)][1];
    out << subdomains << " subdomains: moment " << moment << " after " << result.report.solver.hessianMultiplications << " multiplications\n";
    TEST_FLOATING_EQUALITY(moment, pressure / 2, 1e-6);
  }
}

// Pulled up, the arm turns, about the axis that it hangs at.
TEUCHOS_UNIT_TEST(Hinges, AnArmThatNothingHoldsIsNamed) {
  ParameterList list = parameters(5, -1);
  const std::string pulledOff = refusalOfHinges(list);
  list.remove("Contact");
  const std::string unheld = refusalOfHinges(list);
  out << pulledOff << "\n" << unheld << "\n";
  for (const std::string& message : {pulledOff, unheld})
    for (const char* part : {"body 'post+arm (piece 2 of 2, joined by nodes or edges alone)'", "rotation"})
      TEST_ASSERT(message.find(part) != std::string::npos);
  TEST_ASSERT(pulledOff.find("contact and friction cannot carry the loads") != std::string::npos);
  TEST_ASSERT(unheld.find("held by nothing") != std::string::npos);
}

// ANALYTIC: what nearly nothing holds bears no moment about its axis.  Newton's coarse matrices are singular, and SMALSE has none of active rows.
TEUCHOS_UNIT_TEST(Hinges, WhereNewtonCannotBeginSmalseGoesOn) {
  const SourceMesh source = folded(1e-8);
  Simulation run(Tpetra::getDefaultComm(), validatedParameters(foldedParameters("Automatic")), nullptr, &source);
  run.prepare();
  const auto result = run.solve();
  out << result.report.solver.method << "\n";
  TEST_ASSERT(result.solved);
  TEST_INEQUALITY(result.report.solver.method.find("SMALSE"), std::string::npos);
  double moment = 0, forces = 0;
  for (const auto& pair : result.pairs) {
    moment += source.mesh.coordinates[std::size_t(pair.secondaryNode)][1] * pair.force[2] - 0.5 * pair.force[1];
    forces += pair.normalForce;
  }
  if (Tpetra::getDefaultComm()->getRank() != 0) return;
  TEST_COMPARE(forces, >, 0.01);
  TEST_COMPARE(std::abs(moment), <=, 1e-5 * forces);
}

TEUCHOS_UNIT_TEST(Hinges, NewtonAloneSaysThatNextToNothingHolds) {
  const SourceMesh source = folded(1e-8);
  Simulation run(Tpetra::getDefaultComm(), validatedParameters(foldedParameters("Subspace Newton")), nullptr, &source);
  run.prepare();
  if (hasCholmod()) TEST_THROW(run.solve(), InsufficientModel);
  if (!hasCholmod()) TEST_NOTHROW(run.solve());  // KLU2's L U sees no sign of a pivot
}
