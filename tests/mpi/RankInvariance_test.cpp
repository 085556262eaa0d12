// SPDX-License-Identifier: BSD-3-Clause
// The same scene on all ranks together and on every rank alone (MPI_COMM_SELF): the same displacements,
// the same contact forces, the same work.
#include "RankRuns.hpp"

using namespace Haptos;
using namespace Haptos::Testing;

namespace {

/// \brief All three states of contact occur, so that the answer depends on the friction law everywhere.
void requireMixedContact(const RunReport& report, Teuchos::FancyOStream& out, bool& success) {
  const auto& interface = report.interfaces.at(0);
  TEST_ASSERT(interface.stick > 0 && interface.slip > 0 && interface.open > 0);
}

TEUCHOS_UNIT_TEST(RankInvariance, BricksBySmalse) {
  const Run run = compareWithOneRank({{"Solver->Method", "SMALSE"}}, out, success);
  TEST_EQUALITY(run.result.report.model.subdomains, 32);
  if (world()->getRank() == 0) requireMixedContact(run.result.report, out, success);
}

TEUCHOS_UNIT_TEST(RankInvariance, BricksByTheDefaultMethod) {
  const Run run = compareWithOneRank({}, out, success);
  if (world()->getRank() == 0) requireMixedContact(run.result.report, out, success);
}

TEUCHOS_UNIT_TEST(RankInvariance, MetisParts) {
  for (const char* method : kMethods)
    for (int subdomains : {4, 16, 50}) {
      out << subdomains << " subdomains\n";
      const Run run = compareWithOneRank(metis(subdomains, method), out, success);
      TEST_EQUALITY(run.result.report.solver.method, std::string(method));
      TEST_EQUALITY(run.result.report.model.subdomains, subdomains);
    }
}

// The cut is not part of the answer.  The fields of different cuts agree as far as kkt allows.
TEUCHOS_UNIT_TEST(RankInvariance, CutDoesNotMatter) {
  const Run bricks = runBeams(world(), {{"Solver->Method", "SMALSE"}});
  for (const char* method : kMethods)
    for (int subdomains : {4, 16, 50}) {
      const Run parts = runBeams(world(), metis(subdomains, method));
      TEST_INEQUALITY(parts.result.report.model.dualUnknowns, bricks.result.report.model.dualUnknowns);
      compareFields(parts.result, bricks.result, out, success);
    }
}

// Two subdomains: from three ranks on, some ranks have none.
TEUCHOS_UNIT_TEST(RankInvariance, RanksWithoutSubdomains) {
  const Run run = compareWithOneRank({{"Decomposition->Method", "Block"}}, out, success);
  TEST_EQUALITY(run.result.report.model.subdomains, 2);
  const int empty = sumOverRanks(run.simulation->model().subdomains.empty() ? 1 : 0);
  TEST_EQUALITY(empty, std::max(0, world()->getSize() - 2));
}

bool touchesContact(const DistributedModel& model) {
  for (const auto& subdomain : model.subdomains)
    for (const auto& x : subdomain.coordinates)
      if (x[2] == 0.0) return true;
  return false;
}

// On four ranks the bricks are dealt in layers: the first rank has the lowest one, the last rank the top one.
TEUCHOS_UNIT_TEST(RankInvariance, RanksWithoutContact) {
  const Run run = compareWithOneRank({{"Solver->Method", "Subspace Newton"}}, out, success);
  const auto& model = run.simulation->model();
  TEST_ASSERT(!model.subdomains.empty());
  const int away = sumOverRanks(touchesContact(model) ? 0 : 1);
  const int withoutPairs = sumOverRanks(model.multipliers->pairs().empty() ? 1 : 0);
  out << away << " ranks away from the contact, " << withoutPairs << " own no pair\n";
  if (world()->getSize() == 4) {
    TEST_EQUALITY(away, 2);
    TEST_ASSERT(withoutPairs >= 2);
  }
}

TEUCHOS_UNIT_TEST(RankInvariance, WithoutFriction) {
  const Run run = compareWithOneRank({{"Contact->interface->Friction->Law", "Frictionless"}}, out, success);
  TEST_EQUALITY(run.result.report.model.law, "Frictionless");
}

TEUCHOS_UNIT_TEST(RankInvariance, OrthotropicTresca) {
  const Run run = compareWithOneRank({{"Contact->interface->Friction->Law", "Tresca"},
                                      {"Contact->interface->Friction->Slip Bound", "20"},
                                      {"Contact->interface->Friction->Coefficients", "{0.6, 0.2}"}}, out, success);
  TEST_EQUALITY(run.result.report.model.law, "Tresca");
}

TEUCHOS_UNIT_TEST(RankInvariance, NoContactAtAll) {
  for (const char* preconditioner : {"Dirichlet", "Lumped", "None"}) {
    const Run run = compareWithOneRank({{"Preconditioner->Type", preconditioner}}, out, success, Scene::ClampedBeamsAlone);
    TEST_EQUALITY(run.result.report.model.contactPairs, 0);
    TEST_EQUALITY(run.result.report.solver.method, "PCPG");
    TEST_EQUALITY(run.result.report.solver.preconditionerApplications > 0, std::string(preconditioner) != "None");
  }
}

}  // namespace
