// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SubdomainOrder.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "DecomposedScene.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

constexpr int kFirst = 40, kScenes = 20;  // numbers of subdomains

// Two bodies that touch all along; a cut across both is much shorter than the surface between them.
Scene longBodies(int subdomains, bool ordered) {
  SceneOptions options;
  options.lower = {24, 4, 4};
  options.upper = {24, 4, 4};
  options.subdomains = subdomains;
  Scene scene = makeScene(options);
  if (!ordered) return scene;
  orderSubdomains(Teuchos::SerialComm<int>(), scene.own, scene.interfaces, scene.partition);
  scene.subdomains = extractSubdomains(scene.mesh, scene.partition, {0, 1});
  scene.rows = buildConstraintRows(scene.mesh, scene.subdomains, scene.prescribed, scene.interfaces, {1}, {7.0, 21.0});
  return scene;
}

std::vector<int> ranksOf(const Scene& scene, int ranks) {
  std::vector<double> work;
  for (const auto& sub : scene.subdomains) work.push_back(workOfSubdomain(sub.numNodes()));
  return dealToRanks(work, ranks);
}

struct Sent {
  int all = 0, contact = 0;
  void operator+=(const Sent& other) { all += other.all, contact += other.contact; }
};

// Rows that more than one rank has entries of.
Sent sharedRows(const Scene& scene, const std::vector<int>& rankOf) {
  Sent sent;
  for (GlobalOrdinal row = 0; row < scene.rows.numRows(); ++row) {
    std::set<int> ranks;
    for (auto k = scene.rows.offsets[row]; k < scene.rows.offsets[row + 1]; ++k) ranks.insert(rankOf[scene.rows.entries[k].subdomain]);
    if (ranks.size() < 2) continue;
    ++sent.all;
    sent.contact += !isEquality(scene.rows.kinds[row]);
  }
  return sent;
}

TEUCHOS_UNIT_TEST(SubdomainOrder, ChangesNumbersOnly) {
  const Scene before = longBodies(24, false), after = longBodies(24, true);
  TEST_EQUALITY(after.partition.count, before.partition.count);
  std::vector<std::set<int>> elements(24), same(24);
  for (std::size_t e = 0; e < before.partition.ofElement.size(); ++e) {
    elements[before.partition.ofElement[e]].insert(int(e));
    same[after.partition.ofElement[e]].insert(int(e));
    TEST_EQUALITY(after.partition.bodyOfSubdomain[after.partition.ofElement[e]], before.bodies.ofPiece[before.bodies.pieces.ofElement[e]]);
  }
  std::sort(elements.begin(), elements.end());
  std::sort(same.begin(), same.end());
  TEST_ASSERT(elements == same);
}

// One number of subdomains is a matter of luck: twenty are added up.  Three ranks do not divide what is halved.
TEUCHOS_UNIT_TEST(SubdomainOrder, BodiesInContactShareRanks) {
  std::map<int, Sent> apart, together;
  Sent allApart, allTogether;
  for (int subdomains = kFirst; subdomains < kFirst + kScenes; ++subdomains) {
    const Scene before = longBodies(subdomains, false), after = longBodies(subdomains, true);
    for (int ranks : {2, 3, 4}) {
      apart[ranks] += sharedRows(before, ranksOf(before, ranks));
      together[ranks] += sharedRows(after, ranksOf(after, ranks));
    }
  }
  for (int ranks : {2, 3, 4}) allApart += apart[ranks], allTogether += together[ranks];
  for (int ranks : {2, 4}) TEST_COMPARE(2 * together[ranks].contact, <, apart[ranks].contact);
  for (int ranks : {3, 4}) TEST_COMPARE(together[ranks].all, <, 1.3 * apart[ranks].all);
  TEST_COMPARE(2 * allTogether.contact, <, allApart.contact);
  TEST_COMPARE(allTogether.all, <, 1.3 * allApart.all);
}

// What the busiest rank has of a quantity, given for every rank, by the mean.
double largest(const std::vector<double>& share) {
  const double sum = std::accumulate(share.begin(), share.end(), 0.0);
  return *std::max_element(share.begin(), share.end()) * double(share.size()) / sum;
}

// A few subdomains have all pairs, so one number of them is a matter of luck: 1.1 to 1.5 of the mean with 40 to 59 on 4 ranks.
TEUCHOS_UNIT_TEST(SubdomainOrder, RanksShareWorkAndPairs) {
  std::map<int, double> meanOfPairs;
  for (int subdomains = kFirst; subdomains < kFirst + kScenes; ++subdomains) {
    const Scene scene = longBodies(subdomains, true);
    for (int ranks : {2, 4}) {
      const auto rankOf = ranksOf(scene, ranks);
      std::vector<double> work(ranks, 0), pairs(ranks, 0);
      for (const auto& sub : scene.subdomains) work[rankOf[sub.id]] += workOfSubdomain(sub.numNodes());
      for (const auto& pair : scene.rows.pairs) ++pairs[rankOf[scene.rows.owner[pair.normal]]];
      TEST_COMPARE(largest(work), <, 1.1);
      meanOfPairs[ranks] += largest(pairs) / kScenes;
    }
  }
  TEST_COMPARE(meanOfPairs[2], <, 1.4);
  TEST_COMPARE(meanOfPairs[4], <, 1.4);
}

// A body alone, a body per subdomain, and no contact at all.
TEUCHOS_UNIT_TEST(SubdomainOrder, TakesAnyModel) {
  for (int subdomains : {2, 3}) {
    SceneOptions options;
    options.subdomains = subdomains;
    options.contact = false;
    Scene scene = makeScene(options);
    orderSubdomains(Teuchos::SerialComm<int>(), scene.own, scene.interfaces, scene.partition);
    std::set<int> numbers(scene.partition.ofElement.begin(), scene.partition.ofElement.end());
    TEST_EQUALITY(int(numbers.size()), subdomains);
    TEST_EQUALITY(*numbers.begin(), 0);
    TEST_EQUALITY(*numbers.rbegin(), subdomains - 1);
  }
}

}  // namespace
