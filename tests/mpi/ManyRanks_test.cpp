// SPDX-License-Identifier: BSD-3-Clause
// More ranks than processors, layers or subdomains: the same counts, and the same answer to round-off, as on one rank.
#include "RankRuns.hpp"

using namespace Haptos;
using namespace Haptos::Testing;

namespace {

// Of the largest value: far below the tolerances of the runs, so both took the same steps.  Hundreds of steps of SMALSE
// let round-off grow, the twenty to thirty of Subspace Newton do not.
constexpr double kRoundOff = 1e-11, kRoundOffOfSmalse = 1e-7;

Sets cell(int k, int p) {
  return {{"Mesh->Two Beams->Subdomains Per Edge", std::to_string(k)},
          {"Mesh->Two Beams->Elements Per Subdomain Edge", std::to_string(p)}};
}

Sets with(Sets sets, const Sets& more) {
  sets.insert(sets.end(), more.begin(), more.end());
  return sets;
}

bool ownsContact(const DistributedModel& model) { return !model.multipliers->pairs().empty(); }

Run requireSameRun(const Sets& sets, Teuchos::FancyOStream& out, bool& success) {
  const Run alone = runBeams(self(), sets);
  Run together = runBeams(world(), sets);
  const SolverReport &a = alone.result.report.solver, &t = together.result.report.solver;
  TEST_ASSERT(alone.result.solved && together.result.solved);
  TEST_ASSERT(a.hessianMultiplications > 5);
  TEST_EQUALITY(t.method, a.method);
  TEST_EQUALITY(t.hessianMultiplications, a.hessianMultiplications);
  TEST_EQUALITY(t.preconditionerApplications, a.preconditionerApplications);
  TEST_EQUALITY(t.coarseSolves, a.coarseSolves);
  TEST_ASSERT(t.localSolves >= a.localSolves);  // every rank forms the dense matrices of its own classes
  TEST_EQUALITY(t.history.size(), a.history.size());
  if (world()->getRank() == 0) {
    const double u = relativeDifference(together.result.displacement, alone.result.displacement);
    const double force = relativeDifference(contactForces(together.result), contactForces(alone.result));
    out << t.method << ", " << t.hessianMultiplications << " multiplications: displacements differ by " << u << ", forces by " << force << "\n";
    const double bound = t.method == "SMALSE" ? kRoundOffOfSmalse : kRoundOff;
    TEST_ASSERT(u <= bound);
    TEST_ASSERT(force <= bound);
  }
  return together;
}

}  // namespace

// 32 subdomains in four layers; two of the layers touch the contact surface.
TEUCHOS_UNIT_TEST(ManyRanks, SameAnswerAsOnOneRank) {
  const std::pair<const char*, const char*> methods[] = {{"Subspace Newton", "1e-8"}, {"SMALSE", "1e-4"}};
  for (const auto& [method, tolerance] : methods) {
    const Run run = requireSameRun(with(cell(2, 2), {{"Solver->Method", method}, {"Solver->Relative Tolerance", tolerance}}), out, success);
    const auto& model = run.simulation->model();
    TEST_ASSERT(!model.subdomains.empty());
    const int without = sumOverRanks(ownsContact(model) ? 0 : 1);
    out << without << " of " << world()->getSize() << " ranks own no contact pair\n";
    if (world()->getSize() >= 4) TEST_ASSERT(without > 0 && without < world()->getSize());
  }
}

// Four subdomains: all other ranks have none.
TEUCHOS_UNIT_TEST(ManyRanks, RanksWithoutSubdomains) {
  const Run run = requireSameRun(cell(1, 3), out, success);
  const int empty = sumOverRanks(run.simulation->model().subdomains.empty() ? 1 : 0);
  TEST_EQUALITY(empty, std::max(0, world()->getSize() - 4));
}

// Coarse factors shared by groups of ranks, the last group smaller than the others.
TEUCHOS_UNIT_TEST(ManyRanks, SharedCoarseFactors) {
  for (const char* ranksPerFactor : {"0", "3"}) {
    const Run run = requireSameRun(with(cell(2, 2), {{"Coarse Problem->Replicated Up To", "0"},
                                                     {"Coarse Problem->Ranks Per Factor", ranksPerFactor}}), out, success);
    const int factors = run.result.report.coarse.factors, ranks = world()->getSize();
    TEST_EQUALITY(factors, std::string(ranksPerFactor) == "0" ? 1 : (ranks + 2) / 3);
  }
}
