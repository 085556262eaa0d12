// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_KktEstimator.hpp"

#include <Teuchos_Array.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_Vector.hpp>

#include "Haptos_Parameters.hpp"
#include "Haptos_Simulation.hpp"

namespace {

using namespace Haptos;
using Teuchos::Array;
using Teuchos::ParameterList;

// Two beams in contact, solved to `tolerance` by some method.
struct Solved {
  std::unique_ptr<Simulation> simulation;
  SimulationResult result;
  LoadScales loads;

  Solved(double tolerance, const std::string& method) {
    ParameterList list("Haptos");
    auto& beams = list.sublist("Mesh").sublist("Two Beams");
    beams.set("Subdomains Per Edge", 1);
    beams.set("Elements Per Subdomain Edge", 4);
    list.sublist("Decomposition").set<std::string>("Method", "METIS");
    list.sublist("Decomposition").set("Subdomains", 6);
    const auto material = [&](const char* name, const char* block, double E) {
      auto& m = list.sublist("Materials").sublist(name);
      m.set("Element Blocks", Array<std::string>(1, block));
      m.set("Young's Modulus", E);
      m.set("Poisson's Ratio", 0.3);
    };
    material("steel", "upper", 211900.0);
    material("aluminium", "lower", 69000.0);
    const auto condition = [&](const char* name, const char* type, std::vector<std::string> sets) -> ParameterList& {
      auto& c = list.sublist("Boundary Conditions").sublist(name);
      c.set<std::string>("Type", type);
      c.set("Sets", Array<std::string>(sets));
      return c;
    };
    condition("clamp", "Displacement", {"lower_clamp", "upper_clamp"}).set("Value", Array<double>(3, 0.0));
    condition("press", "Pressure", {"upper_top"}).set("Value", 100.0);
    condition("pull", "Traction", {"upper_end"}).set("Value", Array<double>(std::vector<double>{20.0, 20.0, 0.0}));
    auto& interface = list.sublist("Contact").sublist("interface");
    interface.set<std::string>("Secondary Side Set", "upper_contact");
    interface.set<std::string>("Primary Side Set", "lower_contact");
    interface.sublist("Friction").set<std::string>("Law", "Coulomb");
    interface.sublist("Friction").set("Coefficients", Array<double>(2, 0.3));
    list.sublist("Solver").set<std::string>("Method", method);
    list.sublist("Solver").set("Relative Tolerance", tolerance);
    list.sublist("Output").set<std::string>("File", "");
    simulation = std::make_unique<Simulation>(Tpetra::getDefaultComm(), validatedParameters(list));
    simulation->prepare();
    result = simulation->solve();
    const NodalGather gather(Tpetra::getDefaultComm(), nodesOf(simulation->model().subdomains), simulation->mesh().nodes.size);
    loads = measureLoads(gather, simulation->system().f(), *Tpetra::getDefaultComm());
  }
  KktEstimator estimator(KktEstimator::Balance balance) const { return {simulation->system(), loads, balance}; }
  // But what gluing jumps cost in force, which no method looks at.
  double measured() const {
    KktErrors errors = result.report.accuracy.errors;
    errors.fieldEquilibrium = 0;
    return errors.kkt();
  }
};

// Without element matrices the same is seen, whatever the answer is worth.
TEUCHOS_UNIT_TEST(KktEstimator, SeesWhatTheElementsSay) {
  for (const char* method : {"Subspace Newton", "SMALSE"})
    for (double tolerance : {1e-1, 1e-3, 1e-5, 1e-8}) {
      const Solved run(tolerance, method);
      TEST_ASSERT(run.result.solved);
      for (auto balance : {KktEstimator::Balance::Kept, KktEstimator::Balance::Sought}) {
        auto estimator = run.estimator(balance);
        const double estimate = estimator.estimate(*run.result.dual.lambda, *run.result.dual.s, 0.0);
        if (balance == KktEstimator::Balance::Kept && method[1] == 'M') continue;  // SMALSE seeks it
        TEST_COMPARE(estimate, <, 1.5 * run.measured());
        TEST_COMPARE(estimate, >, 0.5 * run.measured());
        TEST_ASSERT(!estimator.isRoundOff());
      }
    }
}

// What bodies moved before contact held them says nothing about today's errors.
TEUCHOS_UNIT_TEST(KktEstimator, ADoubtedScaleIsRecovered) {
  const Solved run(1e-8, "Subspace Newton");
  const Vector& lambda = *run.result.dual.lambda;
  Vector torn(*run.result.dual.s, Teuchos::Copy), far(lambda, Teuchos::Copy);
  far.scale(1e8);
  const auto& kinds = run.simulation->system().jump().multipliers().kinds();
  const auto rows = torn.getDataNonConst(0);
  for (std::size_t row = 0; row < kinds.size(); ++row)
    if (isEquality(kinds[row])) rows[int(row)] += 1e-4;
  for (auto balance : {KktEstimator::Balance::Kept, KktEstimator::Balance::Sought}) {
    const double truth = run.estimator(balance).estimate(lambda, torn, 1e-6);
    TEST_COMPARE(truth, >, 1e-3);
    auto estimator = run.estimator(balance);
    estimator.estimate(far, torn, 1e-6);
    TEST_COMPARE(estimator.estimate(lambda, torn, 1e-6), <=, 1e-6);  // by the scale of the first look
    TEST_FLOATING_EQUALITY(estimator.estimate(lambda, torn, 1e-6, KktEstimator::Scale::Doubted), truth, 1e-6);
  }
}

// The other end of it: the first test's answers are not hidden.
TEUCHOS_UNIT_TEST(KktEstimator, KnowsRoundOff) {
  const Solved run(1e-13, "Subspace Newton");
  auto estimator = run.estimator(KktEstimator::Balance::Sought);
  estimator.estimate(*run.result.dual.lambda, *run.result.dual.s, 0.0);
  out << "kkt " << estimator.kkt() << ", measured " << run.measured() << ", floor " << run.result.report.accuracy.floor << "\n";
  TEST_COMPARE(run.measured(), <, 3 * run.result.report.accuracy.floor);
  TEST_ASSERT(estimator.isRoundOff());
}

}  // namespace
