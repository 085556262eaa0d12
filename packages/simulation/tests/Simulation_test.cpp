// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Simulation.hpp"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Teuchos_Array.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_Vector.hpp>

#include "ContactScene.hpp"
#include "Haptos_BoxMesh.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_FetiSystem.hpp"
#include "Haptos_Parameters.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_StiffnessAssembler.hpp"

namespace {

using namespace Haptos;
using Testing::contains;
using Teuchos::ParameterList;

Teuchos::Array<std::string> names(std::vector<std::string> list) { return Teuchos::Array<std::string>(list); }
Teuchos::Array<double> numbers(std::vector<double> list) { return Teuchos::Array<double>(list); }

// One bar, clamped at x = 0 and pulled at x = 3; nodes moved so that METIS' parts are all different.
SourceMesh bar() {
  BoxSpec box;
  box.blockName = "bar";
  box.blockId = 7;
  box.upper = {3, 1, 1};
  box.divisions = {9, 3, 3};
  box.sideSetNames = {"left", "right", "", "", "", "top"};
  box.map = [](const std::array<double, 3>& x) {
    return std::array<double, 3>{x[0] + 0.02 * std::sin(5 * x[0] + 3 * x[1]), x[1] * (1 + 0.1 * x[0]), x[2]};
  };
  SourceMesh source;
  source.mesh = makeBoxes({box});
  return source;
}

ParameterList barParameters() {
  ParameterList list("Haptos");
  list.sublist("Mesh").set<std::string>("File", "in_memory.exo");
  list.sublist("Decomposition").set("Subdomains", 7);
  auto& steel = list.sublist("Materials").sublist("steel");
  steel.set("Element Blocks", names({"bar"}));
  steel.set("Young's Modulus", 210.0);
  steel.set("Poisson's Ratio", 0.3);
  auto& clamp = list.sublist("Boundary Conditions").sublist("clamp");
  clamp.set<std::string>("Type", "Displacement");
  clamp.set("Sets", names({"left"}));
  clamp.set<std::string>("Components", "xyz");
  clamp.set("Value", numbers({0.0, 0.0, 0.01}));
  auto& pull = list.sublist("Boundary Conditions").sublist("pull");
  pull.set<std::string>("Type", "Traction");
  pull.set("Sets", names({"right"}));
  pull.set("Value", numbers({1.0, 0.5, -0.25}));
  auto& press = list.sublist("Boundary Conditions").sublist("press");
  press.set<std::string>("Type", "Pressure");
  press.set("Sets", names({"top"}));
  press.set<std::string>("Value", "0.3*x");
  auto& weight = list.sublist("Boundary Conditions").sublist("weight");
  weight.set<std::string>("Type", "Body Force");
  weight.set("Element Blocks", names({"bar"}));
  weight.set("Value", numbers({0.0, 0.0, -0.1}));
  list.sublist("Solver").set("Relative Tolerance", 1e-10);
  return list;
}

struct Run {
  SourceMesh source;
  std::unique_ptr<Simulation> simulation;

  Run(const ParameterList& list, SourceMesh mesh, RCP<const Communicator> comm = Tpetra::getDefaultComm())
      : source(std::move(mesh)),
        simulation(std::make_unique<Simulation>(std::move(comm), validatedParameters(list), nullptr, &source)) {}
};

template <class Error = InputError>
std::string refusalOfRun(const ParameterList& list, const SourceMesh& mesh = bar()) {
  try {
    Run(list, mesh).simulation->prepare();
  } catch (const Error& e) {
    return e.what();
  }
  return "(nothing thrown)";
}

// The whole bar as one matrix, its loads summed from the subdomains, its conditions eliminated.
Eigen::VectorXd directSolution(const Mesh& mesh, const Eigen::VectorXd& f, const std::vector<PrescribedDisplacement>& given) {
  ElementGroup group;
  for (auto node : mesh.blocks[0].connectivity) group.connectivity.push_back(int(node));
  const Eigen::SparseMatrix<double> K = assembleStiffness(mesh.coordinates, {group}, {{"steel", 210.0, 0.3}}, Formulation::Standard);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(K.rows());
  std::vector<char> held(K.rows(), 0);
  for (const auto& p : given) u[3 * p.node + p.component] = p.value, held[3 * p.node + p.component] = 1;
  std::vector<int> free, number(K.rows(), -1);
  for (int i = 0; i < int(K.rows()); ++i)
    if (!held[i]) number[i] = int(free.size()), free.push_back(i);
  const Eigen::VectorXd r = f - K * u;
  std::vector<Eigen::Triplet<double>> triplets;
  for (int column : free)
    for (Eigen::SparseMatrix<double>::InnerIterator it(K, column); it; ++it)
      if (!held[it.row()]) triplets.emplace_back(number[it.row()], number[column], it.value());
  Eigen::SparseMatrix<double> Kff(Eigen::Index(free.size()), Eigen::Index(free.size()));
  Kff.setFromTriplets(triplets.begin(), triplets.end());
  Eigen::VectorXd b(Kff.rows());
  for (std::size_t i = 0; i < free.size(); ++i) b[Eigen::Index(i)] = r[free[i]];
  const Eigen::VectorXd x = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(Kff).solve(b);
  for (std::size_t i = 0; i < free.size(); ++i) u[free[i]] = x[Eigen::Index(i)];
  return u;
}

}  // namespace

TEUCHOS_UNIT_TEST(Simulation, PcpgEqualsADirectSolve) {
  for (const char* preconditioner : {"Dirichlet", "Lumped", "None"}) {
    ParameterList list = barParameters();
    list.sublist("Preconditioner").set<std::string>("Type", preconditioner);
    Run run(list, bar());
    run.simulation->prepare();
    SimulationResult result = run.simulation->solve();
    result.displacement = wholeOnRoot(*Tpetra::getDefaultComm(), result.displacement);
    TEST_ASSERT(result.solved);
    TEST_EQUALITY(result.report.solver.method, "PCPG");
    TEST_EQUALITY(result.report.model.subdomains, 7);
    TEST_ASSERT(result.report.solver.hessianMultiplications > 5);
    const NodalGather gather(Tpetra::getDefaultComm(), nodesOf(run.simulation->model().subdomains), run.simulation->mesh().nodes.size);
    const auto f = wholeOnRoot(*Tpetra::getDefaultComm(), gather.sum(run.simulation->system().f()));
    const auto prescribed = gatheredOnAll(*Tpetra::getDefaultComm(), run.simulation->model().prescribed);
    if (Tpetra::getDefaultComm()->getRank() != 0) continue;
    const Eigen::VectorXd u = directSolution(run.source.mesh, Eigen::Map<const Eigen::VectorXd>(f.data(), Eigen::Index(f.size())),
                                             prescribed);
    const Eigen::Map<const Eigen::VectorXd> ours(result.displacement.data(), Eigen::Index(result.displacement.size()));
    out << preconditioner << ": " << result.report.solver.hessianMultiplications << " multiplications, difference "
        << (u - ours).lpNorm<Eigen::Infinity>() / u.lpNorm<Eigen::Infinity>() << "\n";
    TEST_ASSERT((u - ours).lpNorm<Eigen::Infinity>() < 1e-8 * u.lpNorm<Eigen::Infinity>());
  }
}

TEUCHOS_UNIT_TEST(Simulation, ContradictingDisplacementsAreRefused) {
  ParameterList list = barParameters();
  auto& other = list.sublist("Boundary Conditions").sublist("other");
  other.set<std::string>("Type", "Displacement");
  other.set("Sets", names({"top"}));  // shares the edge x = 0, z = 1 with "left"
  other.set<std::string>("Components", "z");
  other.set("Value", numbers({0.0, 0.0, 0.02}));
  const std::string message = refusalOfRun(list);
  out << message << "\n";
  TEST_ASSERT(contains(message, "Boundary Conditions->other->Value") && contains(message, "Boundary Conditions->clamp") &&
              contains(message, "node "));
  other.set("Value", numbers({0.0, 0.0, 0.01}));  // the same value twice is no contradiction
  Run same(list, bar());
  TEST_NOTHROW(same.simulation->prepare());
}

// Where one is 0 and the other nearly so, round-off is that of what the other is elsewhere, in any units.
TEUCHOS_UNIT_TEST(Simulation, DisplacementsMayDifferByRoundOff) {
  SourceMesh straight = bar();
  for (auto& x : straight.mesh.coordinates)
    if (x[0] < 0.1) x[0] = 0;
  for (const std::string unit : {"1e-2", "1e-12"}) {
    ParameterList list = barParameters();
    list.sublist("Boundary Conditions").sublist("clamp").set("Value", numbers({0.0, 0.0, 0.0}));
    auto& other = list.sublist("Boundary Conditions").sublist("other");
    other.set<std::string>("Type", "Displacement");
    other.set("Sets", names({"top"}));  // shares the edge x = 0, z = 1 with "left"
    other.set<std::string>("Components", "z");
    const std::string value = unit + "*sin(3.14159265358979*(1 - x))";  // 3e-15 of the unit at the edge
    other.set("Value", names({"0", "0", value}));
    TEST_EQUALITY(refusalOfRun(list, straight), "(nothing thrown)");
    other.set("Value", names({"0", "0", value + " + 1e-10*" + unit}));
    TEST_ASSERT(contains(refusalOfRun(list, straight), "Boundary Conditions->other->Value"));
  }
}

TEUCHOS_UNIT_TEST(Simulation, SetsAndBlocksByNumber) {
  const SourceMesh source = bar();
  const auto number = [&](const std::string& name) { return std::to_string(source.mesh.sideSets[findSideSet(source.mesh, name)].id); };
  ParameterList list = barParameters();
  list.sublist("Materials").sublist("steel").set("Element Blocks", names({"7"}));
  list.sublist("Boundary Conditions").sublist("clamp").set("Sets", names({number("left")}));
  list.sublist("Boundary Conditions").sublist("pull").set("Sets", names({number("right")}));
  Run byNumber(list, source), byName(barParameters(), source);
  byNumber.simulation->prepare();
  byName.simulation->prepare();
  Vector difference(byName.simulation->system().f(), Teuchos::Copy);
  TEST_ASSERT(difference.norm2() > 0.1);
  difference.update(-1.0, byNumber.simulation->system().f(), 1.0);
  TEST_EQUALITY(difference.norm2(), 0.0);
  TEST_EQUALITY(byNumber.simulation->report().model.dualUnknowns, byName.simulation->report().model.dualUnknowns);
}

TEUCHOS_UNIT_TEST(Simulation, MissingNamesAreListed) {
  ParameterList list = barParameters();
  list.sublist("Boundary Conditions").sublist("pull").set("Sets", names({"rigth"}));
  const std::string set = refusalOfRun(list);
  TEST_ASSERT(contains(set, "'rigth'") && contains(set, "right") && contains(set, "Boundary Conditions->pull->Sets"));
  list = barParameters();
  list.sublist("Materials").sublist("steel").set("Element Blocks", names({"beam"}));
  const std::string block = refusalOfRun(list);
  TEST_ASSERT(contains(block, "'beam'") && contains(block, "bar (7)"));
}

// A mesh in memory may bring the name of a field alone.
TEUCHOS_UNIT_TEST(Simulation, FrictionFieldsWithoutValuesAreRefused) {
  SourceMesh source = bar();
  source.mesh.nodalFields = {{"AXIS", std::vector<double>(source.mesh.numNodes(), 1.0)}, {"EMPTY", {}}};
  ParameterList list = barParameters();
  auto& wall = list.sublist("Contact").sublist("wall");
  wall.set<std::string>("Secondary Side Set", "right");
  wall.sublist("Rigid Plane").set("Point", numbers({3.1, 0.0, 0.0})).set("Normal", numbers({-1.0, 0.0, 0.0}));
  auto& friction = wall.sublist("Friction");
  friction.set<std::string>("Law", "Coulomb");
  friction.set("Coefficients", names({"EMPTY", "0.2"}));
  const std::string coefficient = refusalOfRun(list, source);
  out << coefficient << "\n";
  TEST_ASSERT(contains(coefficient, "Contact->wall->Friction->Coefficients") && contains(coefficient, "'EMPTY' has no values"));
  friction.set("Coefficients", numbers({0.3, 0.2}));
  friction.set("Principal Field", names({"AXIS", "EMPTY", "AXIS"}));
  const std::string axis = refusalOfRun(list, source);
  TEST_ASSERT(contains(axis, "Contact->wall->Friction->Principal Field") && contains(axis, "'EMPTY' has no values"));
}

TEUCHOS_UNIT_TEST(Simulation, UnheldBodyIsNamed) {
  ParameterList list = barParameters();
  list.sublist("Boundary Conditions").remove("clamp");
  const std::string message = refusalOfRun<InsufficientModel>(list);
  out << message << "\n";
  TEST_ASSERT(contains(message, "body 'bar'") && contains(message, "held by nothing"));
}

// A sheet whose bending stiffness is lost beside that of its plane: told where it is, on all ranks.
TEUCHOS_UNIT_TEST(Simulation, WhatDoublePrecisionCannotHoldIsRefused) {
  for (const double thickness : {1e-5, 1e-8}) {
    SourceMesh sheet = bar();
    for (auto& x : sheet.mesh.coordinates) x[2] *= thickness;
    Run run(barParameters(), sheet);
    run.simulation->prepare();
    std::string message;
    try {
      run.simulation->solve();
    } catch (const InsufficientModel& e) {
      message = e.what();
    }
    out << message << "\n";
    TEST_ASSERT(contains(message, "cannot be solved with 16 digits") && contains(message, "of the part from ("));
  }
}

// The cut and the rows are made once, on the reader: they do not know the number of ranks.
TEUCHOS_UNIT_TEST(Simulation, ModelIsTheSameOnOneRank) {
  const RCP<const Communicator> self = Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF));
  Run many(barParameters(), bar()), one(barParameters(), bar(), self);
  many.simulation->prepare();
  one.simulation->prepare();
  const ModelReport &a = many.simulation->report().model, &b = one.simulation->report().model;
  TEST_EQUALITY(a.subdomains, b.subdomains);
  TEST_EQUALITY(a.primalUnknowns, b.primalUnknowns);
  TEST_EQUALITY(a.dualUnknowns, b.dualUnknowns);
  for (const auto& sub : many.simulation->model().subdomains) {
    const Subdomain& same = one.simulation->model().subdomains.at(std::size_t(sub.id));
    TEST_ASSERT(same.nodes == sub.nodes && same.elements == sub.elements);
  }
  TEST_FLOATING_EQUALITY(many.simulation->system().f().norm2(), one.simulation->system().f().norm2(), 1e-13);
}
