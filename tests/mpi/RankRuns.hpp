// SPDX-License-Identifier: BSD-3-Clause
// The same scene on all ranks together and on every rank alone (MPI_COMM_SELF).
#pragma once
#include <mpi.h>

#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <cmath>

#include "Haptos_DistributedModel.hpp"
#include "Haptos_ParameterXml.hpp"
#include "Haptos_Parameters.hpp"
#include "Haptos_Simulation.hpp"

namespace Haptos::Testing {

using Sets = std::vector<std::pair<std::string, std::string>>;

/// \brief A run in memory, with what the tests ask of it.
struct Run {
  std::unique_ptr<Simulation> simulation;
  SimulationResult result;
};

enum class Scene { Contact, ClampedBeamsAlone };

inline Run runBeams(const RCP<const Communicator>& comm, Sets sets, Scene scene = Scene::Contact) {
  const std::string origin = HAPTOS_TABLE31;
  const Sets common = {{"Mesh->Two Beams->Subdomains Per Edge", "2"},
                       {"Mesh->Two Beams->Elements Per Subdomain Edge", "3"},
                       {"Solver->Relative Tolerance", "1e-8"},
                       {"Output->File", ""},
                       {"Output->Summary", ""}};
  sets.insert(sets.begin(), common.begin(), common.end());
  std::vector<std::string> warnings;
  auto parameters = parametersFromXml(readTextFile(origin), origin, sets, warnings);
  if (scene == Scene::ClampedBeamsAlone) parameters.sublist("Contact") = Teuchos::ParameterList("Contact");
  Run run;
  run.simulation = std::make_unique<Simulation>(comm, parameters);
  run.simulation->prepare();
  run.result = run.simulation->solve();
  run.result.displacement = wholeOnRoot(*comm, run.result.displacement);
  return run;
}

/// Every method that takes contact.
constexpr const char* kMethods[] = {"SMALSE", "Subspace Newton"};

inline Sets metis(int subdomains, const char* method) {
  return {{"Solver->Method", method}, {"Decomposition->Method", "METIS"}, {"Decomposition->Subdomains", std::to_string(subdomains)}};
}

inline RCP<const Communicator> world() { return Tpetra::getDefaultComm(); }
inline RCP<const Communicator> self() { return Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF)); }

inline int sumOverRanks(int mine) {
  int sum = 0;
  Teuchos::reduceAll(*world(), Teuchos::REDUCE_SUM, mine, Teuchos::outArg(sum));
  return sum;
}

/// \brief Contact forces pair by pair, [3 x pairs].
inline std::vector<double> contactForces(const SimulationResult& result) {
  std::vector<double> forces;
  for (const auto& pair : result.pairs) forces.insert(forces.end(), pair.force.begin(), pair.force.end());
  return forces;
}

/// \brief Largest difference over the largest entry; infinite where sizes differ or all is zero, 0 for nothing.
inline double relativeDifference(const std::vector<double>& a, const std::vector<double>& b) {
  double difference = 0, largest = 0;
  if (a.size() != b.size()) return HUGE_VAL;
  if (a.empty()) return 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference = std::max(difference, std::abs(a[i] - b[i]));
    largest = std::max(largest, std::abs(b[i]));
  }
  return largest > 0 ? difference / largest : HUGE_VAL;
}

constexpr double kSameFields = 1e-6;

/// \brief Fields are on rank 0 of the run on all ranks, and on every rank of its own run.
inline void compareFields(const SimulationResult& together, const SimulationResult& alone, Teuchos::FancyOStream& out, bool& success) {
  if (world()->getRank() != 0) return;
  TEST_ASSERT(!alone.displacement.empty());
  TEST_EQUALITY(long(alone.pairs.size()), alone.report.model.contactPairs);
  const double u = relativeDifference(together.displacement, alone.displacement);
  const double force = relativeDifference(contactForces(together), contactForces(alone));
  out << "displacements differ by " << u << ", contact forces by " << force << "\n";
  TEST_ASSERT(u <= kSameFields);
  TEST_ASSERT(force <= kSameFields);
}

inline void compareCounts(const RunReport& together, const RunReport& alone, Teuchos::FancyOStream& out, bool& success) {
  const auto close = [](long a, long b) { return std::abs(double(a - b)) <= 0.02 * double(b) + 2; };
  out << together.solver.method << ": " << together.solver.hessianMultiplications << " multiplications together, "
      << alone.solver.hessianMultiplications << " alone\n";
  TEST_ASSERT(together.solver.hessianMultiplications > 10);
  TEST_ASSERT(close(together.solver.hessianMultiplications, alone.solver.hessianMultiplications));
  TEST_EQUALITY(together.solver.method, alone.solver.method);
  TEST_EQUALITY(together.model.subdomains, alone.model.subdomains);
  TEST_EQUALITY(together.model.dualUnknowns, alone.model.dualUnknowns);
  TEST_EQUALITY(together.model.contactPairs, alone.model.contactPairs);
  TEST_EQUALITY(together.ranks, world()->getSize());
  TEST_EQUALITY(alone.ranks, 1);
}

/// \brief Runs the scene together and alone, compares, and returns the run on all ranks.
inline Run compareWithOneRank(const Sets& sets, Teuchos::FancyOStream& out, bool& success, Scene scene = Scene::Contact) {
  const Run alone = runBeams(self(), sets, scene);
  Run together = runBeams(world(), sets, scene);
  TEST_ASSERT(alone.result.solved);
  TEST_ASSERT(together.result.solved);
  compareFields(together.result, alone.result, out, success);
  compareCounts(together.result.report, alone.result.report, out, success);
  return together;
}

}  // namespace Haptos::Testing
