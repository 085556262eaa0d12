// SPDX-License-Identifier: BSD-3-Clause
// Values that ranks send each other arrive whole, where they should and in the order that is promised.
#include "Haptos_Rendezvous.hpp"

#include <Eigen/Core>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <algorithm>
#include <array>
#include <numeric>

#include "Haptos_DisjointSets.hpp"
#include "Haptos_Reductions.hpp"

namespace {

using namespace Haptos;

// Plain members, text, and classes within vectors.
struct Branch {
  int number = 0;
  std::string name;
  std::vector<double> values;
  std::vector<Branch> twigs;

  auto parts() { return std::tie(number, name, values, twigs); }
  bool operator==(const Branch& other) const {
    return number == other.number && name == other.name && values == other.values && twigs == other.twigs;
  }
};

Branch branchOf(int from, int to) {
  return {from, "to " + std::to_string(to), std::vector<double>(std::size_t(from + 2 * to), 0.5 * from), {{to, "", {}, {}}, {-1, "leaf", {1.0}, {}}}};
}

const Communicator& world() { return *Tpetra::getDefaultComm(); }

}  // namespace

TEUCHOS_UNIT_TEST(Rendezvous, ClassesArriveAsTheyWere) {
  const int me = world().getRank(), ranks = world().getSize();
  std::vector<std::vector<Branch>> outgoing(static_cast<std::size_t>(ranks));
  for (int r = 0; r < ranks; ++r)
    for (int i = 0; i < (me + r) % 3; ++i) outgoing[std::size_t(r)].push_back(branchOf(me + i, r));
  const auto incoming = exchangeValues(world(), outgoing);
  TEST_EQUALITY(int(incoming.size()), ranks);
  for (int r = 0; r < ranks; ++r) {
    TEST_EQUALITY(int(incoming[std::size_t(r)].size()), (me + r) % 3);
    for (std::size_t i = 0; i < incoming[std::size_t(r)].size(); ++i) TEST_ASSERT(incoming[std::size_t(r)][i] == branchOf(r + int(i), me));
  }
  std::vector<Branch> each;
  for (int r = 0; r < ranks; ++r) each.push_back(branchOf(me, r));
  const auto received = exchangeEach(world(), each);
  for (int r = 0; r < ranks; ++r) TEST_ASSERT(received[std::size_t(r)] == branchOf(r, me));
  const int last = ranks - 1;
  TEST_ASSERT(broadcasted(world(), branchOf(me, 7), last) == branchOf(last, 7));
  TEST_ASSERT(scattered(world(), me == last ? each : std::vector<Branch>{}, last) == branchOf(last, me));
}

TEUCHOS_UNIT_TEST(Rendezvous, ItemsComeBySenderAndInItsOrder) {
  const int me = world().getRank(), ranks = world().getSize();
  std::vector<std::array<int, 2>> items;  // sender, number
  for (int i = 0; i < 4 * ranks + me; ++i) items.push_back({me, i});
  std::vector<std::size_t> countFrom;
  const auto rankOf = [&](const std::array<int, 2>& item) { return item[1] % ranks; };
  const auto received = sendItems(world(), items, rankOf, &countFrom);
  std::vector<std::array<int, 2>> expected;
  for (int r = 0; r < ranks; ++r)
    for (int i = me; i < 4 * ranks + r; i += ranks) expected.push_back({r, i});
  TEST_ASSERT(received == expected);
  TEST_EQUALITY(std::accumulate(countFrom.begin(), countFrom.end(), std::size_t(0)), received.size());
  const auto answers = sendAnswers(world(), received, countFrom);  // and back as they came
  std::size_t count = 0;
  for (int r = 0; r < ranks; ++r)
    for (std::size_t i = 0; i < answers[std::size_t(r)].size(); ++i, ++count)
      TEST_ASSERT(answers[std::size_t(r)][i] == (std::array<int, 2>{me, r + int(i) * ranks}));
  TEST_EQUALITY(count, items.size());
  const auto all = gatheredOnAll(world(), std::vector<int>(std::size_t(me), me));
  TEST_EQUALITY(int(all.size()), ranks * (ranks - 1) / 2);
  TEST_ASSERT(std::is_sorted(all.begin(), all.end()));
  TEST_EQUALITY(gatheredOnRoot(world(), std::vector<int>{me}).size(), std::size_t(me == 0 ? ranks : 0));
}

TEUCHOS_UNIT_TEST(Rendezvous, RemoteValuesAreInTheOrderOfTheQuestions) {
  const int me = world().getRank(), ranks = world().getSize();
  const EvenRanges ranges{5 * ranks + 2, ranks};
  std::vector<std::int64_t> wanted;  // neither ascending nor each once
  for (std::int64_t i = ranges.size - 1; i >= 0; i -= 1 + me) wanted.push_back(i);
  wanted.push_back(wanted.front());
  const RemoteValues remote(world(), ranges, wanted);
  const auto first = ranges.begin(me);
  for (int factor : {2, 3}) {  // as often as one likes
    const auto values = remote.fetch([&](std::int64_t place) { return std::vector<std::int64_t>(1, factor * (first + place)); });
    TEST_EQUALITY(values.size(), wanted.size());
    for (std::size_t i = 0; i < values.size(); ++i) TEST_EQUALITY(values[i].front(), factor * wanted[i]);
  }
  std::vector<std::int64_t> sums(std::size_t(ranges.count(me)), 0);
  remote.give(wanted, [&](std::int64_t place, std::int64_t value) {
    TEST_EQUALITY(value, first + place);
    ++sums[std::size_t(place)];
  });
  const auto asked = sumOfAll(world(), std::int64_t(wanted.size()));
  TEST_EQUALITY(sumOfAll(world(), std::accumulate(sums.begin(), sums.end(), std::int64_t(0))), asked);
}

TEUCHOS_UNIT_TEST(Reductions, NumbersArraysAndMatrices) {
  const int me = world().getRank(), ranks = world().getSize();
  TEST_EQUALITY(sumOfAll(world(), me + 1), ranks * (ranks + 1) / 2);
  TEST_EQUALITY(sumOfLower(world(), me + 1), me * (me + 1) / 2);
  TEST_EQUALITY(largestOfAll(world(), -me), 0);
  TEST_EQUALITY(leastOfAll(world(), double(-me)), double(1 - ranks));
  TEST_ASSERT(anyOfAll(world(), me == ranks - 1) && !anyOfAll(world(), false));
  const auto lower = sumOfLower(world(), std::vector<long>{1, 2L * me});
  TEST_ASSERT(lower == (std::vector<long>{me, long(me) * (me - 1)}));
  TEST_ASSERT(largestOfAll(world(), std::array<int, 2>{me, -me}) == (std::array<int, 2>{ranks - 1, 0}));
  TEST_ASSERT(sumOfAll(world(), std::vector<int>{}).empty());
  const std::vector<int> mine = {1, 2, 3, 4, 5, 6, 7};
  std::vector<int> all(mine.size());
  for (const int most : {1, 3, 7, 8}) {  // in parts of so many
    reduceParts(world(), Teuchos::REDUCE_SUM, std::int64_t(mine.size()), mine.data(), all.data(), most);
    for (int i = 0; i < 7; ++i) TEST_EQUALITY(all[std::size_t(i)], ranks * (i + 1));
  }
  TEST_ASSERT(sumOfAll(world(), Eigen::MatrixXd(Eigen::MatrixXd::Identity(2, 3))) == Eigen::MatrixXd(ranks * Eigen::MatrixXd::Identity(2, 3)));
}

TEUCHOS_UNIT_TEST(DisjointSets, AreKnownByTheirLowestMembers) {
  DisjointSets sets(7);
  for (const auto& [a, b] : {std::array<int, 2>{6, 4}, {4, 2}, {5, 3}, {6, 2}}) sets.join(a, b);
  TEST_EQUALITY(sets.lowest(6), 2);
  int count = 0;
  TEST_ASSERT(sets.numbered(count) == (std::vector<int>{0, 1, 2, 3, 2, 3, 2}));
  TEST_EQUALITY(count, 4);
}
