// SPDX-License-Identifier: BSD-3-Clause
// What a rank touches to cut a mesh and to deal it falls with the number of ranks: by counting what operator new is asked for, on two and
// on four ranks.
#include <Teuchos_UnitTestHarness.hpp>

#include "../../mesh/tests/AskedMemory.hpp"
#include "Haptos_Subdomain.hpp"
#include "Haptos_SubdomainOrder.hpp"

using namespace Haptos;
using namespace HaptosTest;

TEUCHOS_UNIT_TEST(CutMemory, FallsWithTheRanks) {
  constexpr TwoBeamsSpec spec{2, 12};  // 55296 elements
  PartitionOptions options;
  options.wholeUpTo = 20000, options.blockSize = 3500;  // 16 blocks: METIS' share of four ranks is a quarter
  const auto asked = onTwoAndFour([&](const auto& comm) {
    const auto own = completeElements(*comm, shareTwoBeams(spec, comm->getRank(), comm->getSize()));
    const auto graph = buildDualGraph(*comm, own);
    auto partition = partitionMesh(*comm, own, graph, findBodies(*comm, own, graph), options);
    const auto nodes = orderSubdomains(*comm, own, {}, partition);
    const auto rankOf = dealToRanks({nodes.begin(), nodes.end()}, comm->getSize());
    dealSubdomains(*comm, own, partition, rankOf, {0, 1});
  });
  out << "largest " << asked[0].largest << " -> " << asked[1].largest << ", all " << asked[0].total << " -> " << asked[1].total << "\n";
  TEST_COMPARE(asked[0].total, >, 55296 / 2 * 8 * sizeof(std::int64_t));  // it was counted
  TEST_COMPARE(asked[1].total, <, 1.5 * asked[0].total / 2);
  TEST_COMPARE(asked[1].largest, <, 1.5 * asked[0].largest / 2);
}
