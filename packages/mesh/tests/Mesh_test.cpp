// SPDX-License-Identifier: BSD-3-Clause
#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <cmath>
#include <set>

#include "Haptos_Error.hpp"
#include "Haptos_Mesh.hpp"
#include "MeshTestTools.hpp"

using namespace Haptos;
using namespace HaptosTest;

namespace {

/// An oblique hexahedron and, apart from it, an oblique tetrahedron, typed here by hand in Exodus' order.
Mesh makeHexAndTet() {
  Mesh mesh;
  mesh.coordinates = {{0, 0, 0},   {2, 0, 0.3},   {2.2, 1, 0},   {0.1, 1, 0.1},
                      {0.5, 0, 3}, {2.4, 0.2, 3}, {2.5, 1.3, 3}, {0.5, 1.2, 3.2},
                      {5, 0, 0},   {6, 0.2, 0},   {5.3, 1, 0.1}, {5.4, 0.3, 2}};
  mesh.blocks = {{7, "hex", Topology::Hex8, {0, 1, 2, 3, 4, 5, 6, 7}},
                 {8, "", Topology::Hex8, {}},
                 {9, "tet", Topology::Tet4, {8, 9, 10, 11}}};
  return mesh;
}

}  // namespace

TEUCHOS_UNIT_TEST(Mesh, SidesOfBothTopologiesPointOutward) {
  const Mesh mesh = makeHexAndTet();
  const auto offsets = blockOffsets(mesh);
  int checked = 0;
  for (std::int64_t element = 0; element < 2; ++element) {
    const auto topology = element == 0 ? Topology::Hex8 : Topology::Tet4;
    const auto all = nodesOfElement(mesh, element);
    std::set<std::vector<std::int64_t>> different;
    Vector3 sum{0, 0, 0};
    for (int s = 0; s < sidesPerElement(topology); ++s, ++checked) {
      const auto nodes = nodesOfSide(mesh, offsets, {element, s});
      TEST_EQUALITY(int(nodes.size()), topology == Topology::Hex8 ? 4 : 3);
      const auto area = areaVector(mesh, nodes);
      TEST_COMPARE(dot(area, minus(centre(mesh, nodes), centre(mesh, all))), >, 0.1);
      for (std::size_t d = 0; d < 3; ++d) sum[d] += area[d];
      auto sorted = nodes;
      std::sort(sorted.begin(), sorted.end());
      different.insert(sorted);
    }
    TEST_EQUALITY(int(different.size()), sidesPerElement(topology));
    // A closed surface: the area vectors cancel, which a wrong or repeated side would spoil.
    for (std::size_t d = 0; d < 3; ++d) TEST_COMPARE(std::abs(sum[d]), <, 1e-12);
  }
  TEST_EQUALITY(checked, 10);
}

TEUCHOS_UNIT_TEST(Mesh, ElementsAreLocatedPastEmptyBlocks) {
  const Mesh mesh = makeHexAndTet();
  const auto offsets = blockOffsets(mesh);
  TEST_COMPARE_ARRAYS(offsets, (std::vector<std::int64_t>{0, 1, 1, 2}));
  TEST_EQUALITY(mesh.numElements(), 2u);
  TEST_EQUALITY(locateElement(offsets, 0).block, 0);
  TEST_EQUALITY(locateElement(offsets, 1).block, 2);
  TEST_EQUALITY(locateElement(offsets, 1).position, 0);
  TEST_THROW(locateElement(offsets, 2), std::logic_error);
}

TEUCHOS_UNIT_TEST(Mesh, EntitiesAreFoundByNameAndByNumber) {
  Mesh mesh = makeHexAndTet();
  TEST_EQUALITY(findBlock(mesh, "tet"), 2);
  TEST_EQUALITY(findBlock(mesh, "8"), 1);
  TEST_EQUALITY(findBlock(mesh, ""), -1);
  TEST_EQUALITY(findBlock(mesh, "wedge"), -1);
  TEST_EQUALITY(listBlocks(mesh), "hex (7), 8, tet (9)");
  TEST_EQUALITY(listSideSets(mesh), "none");

  mesh.sideSets = {{12, "top", {}}, {5, "12", {}}, {6, "top", {}}};
  TEST_EQUALITY(findSideSet(mesh, "12"), 1);  // the name goes before the number
  TEST_EQUALITY(findSideSet(mesh, "6"), 2);
  try {
    findSideSet(mesh, "top");
    TEST_ASSERT(false);
  } catch (const InputError& e) {
    const std::string message = e.what();
    TEST_INEQUALITY(message.find("'top'"), std::string::npos);
    TEST_INEQUALITY(message.find("12 and 6"), std::string::npos);
  }
  mesh.nodeSets = {{3, "corner", {0}}};
  TEST_EQUALITY(findNodeSet(mesh, "3"), 0);
  TEST_EQUALITY(listNodeSets(mesh), "corner (3)");
}
