// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_PieceCut.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <set>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Partition.hpp"

namespace {

using namespace Haptos;

// Bodies of different sizes, more than there are ranks.
Mesh severalBodies() {
  std::vector<BoxSpec> boxes;
  for (int b = 0; b < 5; ++b) {
    BoxSpec box;
    box.blockName = "body" + std::to_string(b);
    box.lower = {2.0 * b, 0, 0};
    box.upper = {2.0 * b + 1, 1, 1};
    box.divisions = {2 + b, 3, 7 - b};
    boxes.push_back(box);
  }
  return makeBoxes(boxes);
}

PartitionPlan planOf(const Mesh& mesh, const DualGraph& graph, int subdomains) {
  PartitionOptions options;
  options.subdomains = subdomains;
  return planPartition(mesh, graph, options);
}

}  // namespace

TEUCHOS_UNIT_TEST(PieceCut, RanksCutAsOneDoes) {
  const auto comm = Tpetra::getDefaultComm();
  const bool isRoot = comm->getRank() == 0;
  const Mesh mesh = severalBodies();
  const PartitionPlan plan = planOf(mesh, buildDualGraph(mesh), 23);
  TEST_EQUALITY(plan.cuts.size(), std::size_t(5));
  const auto shared = cutOnRanks(*comm, isRoot ? plan.cuts : std::vector<PieceToCut>{});
  TEST_EQUALITY(shared.size(), isRoot ? plan.cuts.size() : 0);
  for (std::size_t p = 0; p < shared.size(); ++p) {
    TEST_COMPARE_ARRAYS(shared[p], cutPiece(plan.cuts[p]));
    const std::set<int> parts(shared[p].begin(), shared[p].end());
    TEST_EQUALITY(int(parts.size()), plan.cuts[p].parts);
    TEST_EQUALITY(*parts.rbegin(), plan.cuts[p].parts - 1);
  }
}

TEUCHOS_UNIT_TEST(PieceCut, NothingToCut) {
  TEST_ASSERT(cutOnRanks(*Tpetra::getDefaultComm(), {}).empty());
}

// METIS takes no empty graph; the last one, which is the smallest, is not cut by rank 0 if there are others.
TEUCHOS_UNIT_TEST(PieceCut, FailureIsThrownOnAllRanks) {
  const auto comm = Tpetra::getDefaultComm();
  const Mesh mesh = severalBodies();
  std::vector<PieceToCut> pieces = planOf(mesh, buildDualGraph(mesh), 10).cuts;
  PieceToCut empty;
  empty.graph.offsets = {0};
  empty.parts = 2;
  pieces.push_back(empty);
  if (comm->getRank() != 0) pieces.clear();
  TEST_THROW(cutOnRanks(*comm, pieces), CollectiveError);
}
