// SPDX-License-Identifier: BSD-3-Clause
// Phases, memory, progress lines and the names that newer Trilinos changed.
#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_Map.hpp>
#include <algorithm>
#include <sstream>
#include <type_traits>

#include "Haptos_Machine.hpp"
#include "Haptos_Progress.hpp"
#include "Haptos_RunClock.hpp"
#include "Haptos_TpetraCompat.hpp"
#include "Haptos_Types_fwd.hpp"

namespace {

using namespace Haptos;

TEUCHOS_UNIT_TEST(RunClock, NestedPhasesAreNotCountedTwice) {
  double now = 100.0;
  RunClock clock([&] { return now; });
  {
    const auto solve = clock.time(Phase::Solve);
    now += 1.0;
    {
      const auto coarse = clock.time(Phase::Coarse);
      now += 2.0;
      TEST_EQUALITY(clock.seconds(Phase::Coarse), 2.0);  // still running
    }
    now += 4.0;
  }
  now += 8.0;
  try {
    const auto write = clock.time(Phase::Write);
    now += 16.0;
    throw 1;
  } catch (int) {
    now += 32.0;
  }
  TEST_EQUALITY(clock.seconds(Phase::Solve), 5.0);
  TEST_EQUALITY(clock.seconds(Phase::Coarse), 2.0);
  TEST_EQUALITY(clock.seconds(Phase::Write), 16.0);
  TEST_EQUALITY(clock.seconds(Phase::Read), 0.0);
  TEST_EQUALITY(clock.total(), 63.0);
}

TEUCHOS_UNIT_TEST(RunClock, SlowestRankCounts) {
  const auto comm = Tpetra::getDefaultComm();
  const int rank = comm->getRank(), last = comm->getSize() - 1;
  double now = 0.0;
  RunClock clock([&] { return now; });
  {
    const auto read = clock.time(Phase::Read);
    now += 1.0 + rank;  // slowest on the last rank
  }
  {
    const auto factor = clock.time(Phase::Factor);
    now += 10.0 - rank;  // slowest on rank 0
  }
  const auto times = clock.overRanks(*comm);
  TEST_EQUALITY(times.of(Phase::Read), 1.0 + last);
  TEST_EQUALITY(times.of(Phase::Factor), 10.0);
  TEST_EQUALITY(times.total.most, 11.0);
  const OverRanks& factor = times.seconds[std::size_t(Phase::Factor)];
  TEST_EQUALITY(factor.least, 10.0 - last);
  TEST_FLOATING_EQUALITY(factor.mean, 10.0 - 0.5 * last, 1e-14);
  TEST_EQUALITY(std::string(phaseName(Phase::Read)), "read");
  TEST_EQUALITY(std::string(phaseName(Phase::Write)), "write");
}

TEUCHOS_UNIT_TEST(RunClock, MemoryOfEveryRank) {
  const auto comm = Tpetra::getDefaultComm();
  const double before = peakMemoryMb();
  const std::size_t size = std::size_t(256) << 20;
  std::vector<char> ballast;
  if (comm->getRank() == comm->getSize() - 1) ballast.assign(size, 1);  // touched, so it is resident
  const auto memory = gatherPeakMemoryMb(*comm);
  TEST_EQUALITY(int(memory.ofRank.size()), comm->getSize());
  for (const double mb : memory.ofRank) TEST_ASSERT(mb > 1.0 && mb < 1e5);
  if (!ballast.empty()) TEST_COMPARE(memory.ofRank.back(), >=, before + 128.0);
  TEST_COMPARE(memory.ofRank.back(), >=, 256.0);
  TEST_EQUALITY(memory.peak.most, *std::max_element(memory.ofRank.begin(), memory.ofRank.end()));
  TEST_EQUALITY(memory.peak.least, *std::min_element(memory.ofRank.begin(), memory.ofRank.end()));
}

TEUCHOS_UNIT_TEST(RunClock, ManyRanksAreNotListed) {
  const auto comm = Tpetra::getDefaultComm();
  const int rank = comm->getRank(), size = comm->getSize();
  const CommunicationCounts mine{1 + rank, 2, 3, 10LL * (size - rank), 100LL * rank};
  const auto listed = gatherCommunication(*comm, mine, size), many = gatherCommunication(*comm, mine, size - 1);
  TEST_EQUALITY(int(listed.ofRank.size()), size);
  TEST_EQUALITY(listed.ofRank[std::size_t(size - 1)].collectiveBytes, 100LL * (size - 1));
  TEST_ASSERT(many.ofRank.empty());
  TEST_ASSERT(gatherPeakMemoryMb(*comm, size - 1).ofRank.empty());
  TEST_ASSERT(gatherPeakMemoryMb(*comm, size - 1).peak.least > 1.0);
  for (const auto& counts : {listed, many}) {
    TEST_EQUALITY(counts.numbers[0].least, 1.0);
    TEST_EQUALITY(counts.numbers[0].most, double(size));
    TEST_FLOATING_EQUALITY(counts.numbers[3].mean, 5.0 * (size + 1), 1e-14);
    TEST_EQUALITY(counts.numbers[5].most, 90.0 * (size - 1) + 10.0 * size);  // of one rank, not the sum of the largest of both kinds
  }
}

TEUCHOS_UNIT_TEST(Machine, TellsWhatSecondsDependOn) {
  const auto comm = Tpetra::getDefaultComm();
  const Machine machine = describeMachine(*comm);
  TEST_EQUALITY(machine.hosts, 1);
  const bool root = comm->getRank() == 0;
  for (const auto& text : {machine.host, machine.mpi, machine.blas, machine.trilinos, machine.compiler}) {
    TEST_EQUALITY(text.empty(), !root);
    TEST_EQUALITY(text.find('/'), std::string::npos);
  }
  if (root) TEST_COMPARE(machine.processors, >=, 1);
}

struct Printed {
  std::ostringstream out, err;
  double now = 0.0;
  Progress::Options options(bool terminal) {
    Progress::Options o;
    o.out = &out;
    o.err = &err;
    o.terminal = terminal;
    o.logInterval = 5.0;
    o.now = [this] { return now; };
    return o;
  }
};

TEUCHOS_UNIT_TEST(Progress, LogsAreRateLimitedAndKeepTheLastState) {
  const auto comm = Tpetra::getDefaultComm();
  Printed printed;
  {
    Progress progress(*comm, printed.options(false));
    for (int i = 0; i <= 12; ++i) {
      printed.now = i;
      progress.update("step " + std::to_string(i));
    }
    progress.warn("careful");
    progress.line("done");
  }
  const bool root = comm->getRank() == 0;
  const std::string expected =
      "[     0.0 s] step 0\n[     5.0 s] step 5\n[    10.0 s] step 10\n[    12.0 s] step 12\n[    12.0 s] "
      "done\n";
  TEST_EQUALITY(printed.out.str(), root ? expected : "");
  TEST_EQUALITY(printed.err.str(), root ? "haptos: warning: careful\n" : "");
}

TEUCHOS_UNIT_TEST(Progress, TerminalsRewriteOneLine) {
  const auto comm = Tpetra::getDefaultComm();
  Printed printed;
  {
    Progress progress(*comm, printed.options(true));
    progress.update("a long state");
    printed.now = 1.0;
    progress.update("short");
    printed.now = 1.01;
    progress.update("last");  // too soon, held back until the end
  }
  const bool root = comm->getRank() == 0;
  TEST_EQUALITY(printed.out.str(), root ? "\r[     0.0 s] a long state\r[     1.0 s] short       "
                                          "\r[     1.0 s] last \n"
                                        : "");
}

// What a declaration tells is what the class has.
static_assert(std::is_same_v<LocalOrdinal, Map::local_ordinal_type> && std::is_same_v<GlobalOrdinal, Map::global_ordinal_type>);

TEUCHOS_UNIT_TEST(TpetraCompat, CountsAndRows) {
  const auto comm = Tpetra::getDefaultComm();
  const auto map = Teuchos::rcp(new Map(3 * comm->getSize(), 3, 0, comm));
  TEST_EQUALITY(localNumElements(*map), 3);
  TEST_EQUALITY(localElementList(*map)[1], 3 * comm->getRank() + 1);
  CrsMatrix matrix(map, 2);
  for (const auto row : localElementList(*map)) {
    const GlobalOrdinal first = 3 * comm->getRank();
    matrix.insertGlobalValues(row, Teuchos::tuple<GlobalOrdinal>(row), Teuchos::tuple(2.0));
    if (row != first)
      matrix.insertGlobalValues(row, Teuchos::tuple<GlobalOrdinal>(first), Teuchos::tuple(0.5));
  }
  matrix.fillComplete();
  TEST_EQUALITY(localNumRows(matrix), 3);
  TEST_EQUALITY(localNumEntries(matrix), 5);
  TEST_EQUALITY(localMaxNumRowEntries(matrix), 2);
}

}  // namespace
