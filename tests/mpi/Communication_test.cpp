// SPDX-License-Identifier: BSD-3-Clause
// What is sent: the counter itself, and the reductions of a step of the Subspace Newton method.
#include <Tpetra_Import.hpp>
#include <algorithm>

#include "Haptos_Exchange.hpp"
#include "Haptos_FetiSystem.hpp"
#include "RankRuns.hpp"

using namespace Haptos;
using namespace Haptos::Testing;

namespace {

// Per multiplication by F at most: a tenth above what was counted, 24 to 31 on all cells, steps and ranks.  The loops of a
// step would allow 162 (theory.md): a direction, the steps of conjugate gradients on slip modes, and those of
// Gauss-Newton with their trial points.
constexpr long kMostReductions = 34;

template <class Work>
CommunicationCounts sentBy(Work&& work) {
  const CommunicationCounts before = communicationSoFar();
  work();
  return communicationSoFar() - before;
}

// Reductions between one entry of the history and the next, per multiplication by F.
std::vector<long> reductionsOfSteps(const SimulationResult& result) {
  std::vector<long> steps;
  const auto& history = result.report.solver.history;
  for (std::size_t i = 1; i < history.size(); ++i) {
    const long multiplications = history[i].hessianMultiplications - history[i - 1].hessianMultiplications;
    steps.push_back((history[i].sent.reductions - history[i - 1].sent.reductions) / std::max(1L, multiplications));
  }
  return steps;
}

Run runCell(const RCP<const Communicator>& comm, int k, int p) {
  return runBeams(comm, {{"Mesh->Two Beams->Subdomains Per Edge", std::to_string(k)},
                         {"Mesh->Two Beams->Elements Per Subdomain Edge", std::to_string(p)},
                         {"Solver->Method", "Subspace Newton"}});
}

}  // namespace

TEUCHOS_UNIT_TEST(MpiCounter, CountsCallsAndPayload) {
  const auto comm = world();
  const int ranks = comm->getSize(), rank = comm->getRank();
  double x[5] = {1, 2, 3, 4, 5}, y[5];
  const auto reduced = sentBy([&] { Teuchos::reduceAll(*comm, Teuchos::REDUCE_SUM, 5, x, y); });
  TEST_EQUALITY(y[1], 2.0 * ranks);
  TEST_EQUALITY(reduced.reductions, ranks > 1 ? 1L : 0L);
  TEST_EQUALITY(reduced.bytesSent(), ranks > 1 ? 40LL : 0LL);

  const auto told = sentBy([&] { Teuchos::broadcast(*comm, ranks - 1, 5, x); });
  TEST_EQUALITY(told.collectives, ranks > 1 ? 1L : 0L);
  TEST_EQUALITY(told.reductions, 0L);
  TEST_EQUALITY(told.bytesSent(), ranks > 1 && rank == ranks - 1 ? 40LL : 0LL);

  std::vector<Bytes> outgoing(ranks, Bytes(std::size_t(100 + rank)));
  const auto exchanged = sentBy([&] { exchangeAll(*comm, outgoing); });
  TEST_EQUALITY(exchanged.messages, long(ranks - 1));
  TEST_EQUALITY(exchanged.messageBytes, (long long)(ranks - 1) * (100 + rank));
  TEST_EQUALITY(exchanged.collectiveBytes, 8LL * (ranks - 1));  // their sizes

  const auto gathered = sentBy([&] { gatherOnAll(*comm, Bytes(std::size_t(7 + rank))); });
  TEST_EQUALITY(gathered.messages, 0L);
  TEST_EQUALITY(gathered.bytesSent(), ranks > 1 ? 8LL + 7 + rank : 0LL);

  const auto alone = sentBy([&] { Teuchos::reduceAll(*self(), Teuchos::REDUCE_SUM, 5, x, y); });
  TEST_EQUALITY(alone.reductions + alone.messages + alone.collectives, 0L);
}

// The bound holds whatever the subdomains, the elements and the number of the step.
TEUCHOS_UNIT_TEST(Communication, ReductionsOfAStepAreBounded) {
  if (world()->getSize() == 1) return;
  for (const auto& [k, p] : {std::pair{1, 3}, std::pair{2, 2}, std::pair{2, 3}, std::pair{3, 2}}) {
    const auto steps = reductionsOfSteps(runCell(world(), k, p).result);
    const auto middle = steps.begin() + std::ptrdiff_t(steps.size() / 2);
    out << 4 * k * k * k << " subdomains: " << steps.size() << " steps, at most " << *std::max_element(steps.begin(), middle)
        << " reductions in the first half, " << *std::max_element(middle, steps.end()) << " in the second\n";
    TEST_ASSERT(steps.size() > 10);
    for (long step : steps) TEST_ASSERT(step > 0 && step <= kMostReductions);
  }
}

// Step by step the same number on two ranks as on all.
TEUCHOS_UNIT_TEST(Communication, ReductionsOfAStepDoNotDependOnRanks) {
  if (world()->getSize() < 3) return;
  const auto pair = world()->split(world()->getRank() < 2 ? 0 : -1, world()->getRank());
  std::vector<long> onTwo;
  if (!pair.is_null()) onTwo = reductionsOfSteps(runCell(pair, 2, 3).result);
  const auto onAll = reductionsOfSteps(runCell(world(), 2, 3).result);
  TEST_ASSERT(onAll.size() > 10);
  if (!pair.is_null()) TEST_COMPARE_ARRAYS(onTwo, onAll);
}

// The bytes of B for one vector are always the same ones.
TEUCHOS_UNIT_TEST(Communication, BytesOfBAreThoseOfThePlan) {
  const Run run = runCell(world(), 2, 2);
  const JumpOperator& B = run.simulation->system().jump();
  const auto& importer = B.multipliers().remote().importer();
  const long long rowsOut = (long long)(importer.getNumExportIDs()), rowsIn = (long long)(importer.getNumRemoteIDs());
  TEST_ASSERT(B.transposed().vectors > 20);
  TEST_EQUALITY(B.transposed().sent.messageBytes, 8 * rowsOut * B.transposed().vectors);
  TEST_EQUALITY(B.forward().sent.messageBytes, 8 * rowsIn * B.forward().vectors);
  TEST_EQUALITY(sumOverRanks(rowsOut > 0) > 0, world()->getSize() > 1);
}
