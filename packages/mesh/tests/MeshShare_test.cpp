// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_MeshShare.hpp"

#include <Teuchos_UnitTestHarness.hpp>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_ExodusReader.hpp"
#include "Haptos_ExodusWriter.hpp"
#include "MeshTestTools.hpp"

using namespace Haptos;
using namespace HaptosTest;

TEUCHOS_UNIT_TEST(EvenRanges, EveryIndexHasOneOwner) {
  for (const int ranks : {1, 2, 3, 4, 7})
    for (std::int64_t size = 0; size < 30; ++size) {
      const EvenRanges ranges{size, ranks};
      TEST_EQUALITY(ranges.begin(0), 0);
      TEST_EQUALITY(ranges.begin(ranks), size);
      for (int r = 0; r < ranks; ++r) {
        TEST_ASSERT(ranges.count(r) == size / ranks || ranges.count(r) == size / ranks + 1);
        for (auto i = ranges.begin(r); i < ranges.begin(r + 1); ++i) TEST_EQUALITY(ranges.owner(i), r);
      }
    }
}

TEUCHOS_UNIT_TEST(MeshShare, BoxesAreMadeInShares) {
  const auto boxes = mixedBoxes();
  const Mesh whole = makeBoxes(boxes);
  for (const int ranks : {1, 2, 3, 4, 7, 40})
    for (int r = 0; r < ranks; ++r) TEST_EQUALITY(difference(shareBoxes(boxes, r, ranks), sliceOfMesh(whole, r, ranks)), "");
}

TEUCHOS_UNIT_TEST(MeshShare, SlicesMakeUpTheWhole) {
  const Mesh whole = makeRichMesh();
  const auto offsets = blockOffsets(whole);
  for (const int ranks : {1, 2, 3, 50}) {
    std::vector<std::array<double, 3>> coordinates;
    std::vector<std::int64_t> nodes(offsets.size() - 1, 0);
    std::vector<SideSet> sides = whole.sideSets;
    for (auto& set : sides) set.sides.assign(set.sides.size(), {-1, -1});
    for (int r = 0; r < ranks; ++r) {
      const MeshShare share = sliceOfMesh(whole, r, ranks);
      coordinates.insert(coordinates.end(), share.part.coordinates.begin(), share.part.coordinates.end());
      TEST_EQUALITY(listBlocks(share.part), listBlocks(whole));
      TEST_EQUALITY(std::int64_t(share.part.numElements()), share.endElement() - share.firstElement());
      for (std::size_t b = 0; b < whole.blocks.size(); ++b) {
        const auto& mine = share.part.blocks[b];
        TEST_EQUALITY(std::int64_t(mine.numElements()), share.numElementsOf(b));
        const auto n = std::size_t(nodesPerElement(mine.topology));
        for (std::size_t i = 0; i < mine.connectivity.size(); ++i)
          TEST_EQUALITY(mine.connectivity[i],
                        whole.blocks[b].connectivity[n * std::size_t(share.firstElementOf(b) - share.blockStarts[b]) + i]);
        nodes[b] += std::int64_t(mine.connectivity.size());
      }
      for (std::size_t s = 0; s < sides.size(); ++s)
        for (std::size_t i = 0; i < share.sidePositions[s].size(); ++i)
          sides[s].sides[std::size_t(share.sidePositions[s][i])] = share.part.sideSets[s].sides[i];
    }
    TEST_ASSERT(coordinates == whole.coordinates);
    for (std::size_t b = 0; b < whole.blocks.size(); ++b)
      TEST_EQUALITY(nodes[b], std::int64_t(whole.blocks[b].connectivity.size()));
    for (std::size_t s = 0; s < sides.size(); ++s)
      for (std::size_t i = 0; i < sides[s].sides.size(); ++i) {
        TEST_EQUALITY(sides[s].sides[i].element, whole.sideSets[s].sides[i].element);
        TEST_EQUALITY(sides[s].sides[i].side, whole.sideSets[s].sides[i].side);
      }
  }
}

TEUCHOS_UNIT_TEST(MeshShare, RankZeroDealsItsMesh) {
  const Mesh whole = makeRichMesh();
  const MeshShare share = scatterMesh(world(), world().getRank() == 0 ? whole : Mesh());
  TEST_EQUALITY(difference(share, sliceOfMesh(whole, world().getRank(), world().getSize())), "");
}

TEUCHOS_UNIT_TEST(MeshShare, FilesAreReadInShares) {
  const TestFolder folder;
  Mesh single = makeBoxes({BoxSpec()});  // one element: most ranks have none
  for (const Mesh& mesh : {makeRichMesh(), makeWideMesh(), makeTwoBeams({1, 3}), single}) {
    onRoot([&] { writeMesh(folder.file("m.exo"), mesh); });
    const MeshShare share = readExodusShare(world(), folder.file("m.exo"));
    TEST_EQUALITY(difference(share, sliceOfMesh(mesh, world().getRank(), world().getSize())), "");
  }
}
