// SPDX-License-Identifier: BSD-3-Clause
#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>
#include <map>
#include <set>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_CellMesh.hpp"
#include "MeshTestTools.hpp"

using namespace Haptos;
using namespace HaptosTest;

namespace {

using Lists = std::vector<std::vector<int>>;

// Exodus II manual (Schoof and Yarberry, SAND92-2137), tables of side set nodes, counted from 1.
const std::map<Topology, Lists> manual{
    {Topology::Hex8, {{1, 2, 6, 5}, {2, 3, 7, 6}, {3, 4, 8, 7}, {1, 5, 8, 4}, {1, 4, 3, 2}, {5, 6, 7, 8}}},
    {Topology::Tet4, {{1, 2, 4}, {2, 3, 4}, {1, 4, 3}, {1, 3, 2}}},
    {Topology::Wedge6, {{1, 2, 5, 4}, {2, 3, 6, 5}, {1, 4, 6, 3}, {1, 3, 2}, {4, 5, 6}}},
    {Topology::Pyramid5, {{1, 2, 5}, {2, 3, 5}, {3, 4, 5}, {1, 5, 4}, {1, 4, 3, 2}}},
    {Topology::Hex20,
     {{1, 2, 6, 5, 9, 14, 17, 13},
      {2, 3, 7, 6, 10, 15, 18, 14},
      {3, 4, 8, 7, 11, 16, 19, 15},
      {1, 5, 8, 4, 13, 20, 16, 12},
      {1, 4, 3, 2, 12, 11, 10, 9},
      {5, 6, 7, 8, 17, 18, 19, 20}}},
    {Topology::Hex27,
     {{1, 2, 6, 5, 9, 14, 17, 13, 26},
      {2, 3, 7, 6, 10, 15, 18, 14, 25},
      {3, 4, 8, 7, 11, 16, 19, 15, 27},
      {1, 5, 8, 4, 13, 20, 16, 12, 24},
      {1, 4, 3, 2, 12, 11, 10, 9, 22},
      {5, 6, 7, 8, 17, 18, 19, 20, 23}}},
    {Topology::Tet10, {{1, 2, 4, 5, 9, 8}, {2, 3, 4, 6, 10, 9}, {1, 4, 3, 8, 10, 7}, {1, 3, 2, 7, 6, 5}}},
    {Topology::Wedge15,
     {{1, 2, 5, 4, 7, 11, 13, 10}, {2, 3, 6, 5, 8, 12, 14, 11}, {1, 4, 6, 3, 10, 15, 12, 9}, {1, 3, 2, 9, 8, 7}, {4, 5, 6, 13, 14, 15}}},
    {Topology::Pyramid13,
     {{1, 2, 5, 6, 11, 10}, {2, 3, 5, 7, 12, 11}, {3, 4, 5, 8, 13, 12}, {1, 5, 4, 10, 13, 9}, {1, 4, 3, 2, 9, 8, 7, 6}}},
};

Mesh distortedBox(std::array<int, 3> divisions) {
  BoxSpec box;
  box.blockName = "box";
  box.divisions = divisions;
  box.sideSetNames = {"west", "", "", "", "", "top"};
  box.map = [](const Vector3& x) { return Vector3{x[0] + 0.1 * x[1] * x[2], x[1] + 0.07 * x[0] * x[0], x[2] + 0.2 * x[0] * x[1]}; };
  return makeBoxes({box});
}

bool isMean(const Mesh& mesh, std::int64_t node, const std::vector<std::int64_t>& of) {
  const Vector3 apart = minus(centre(mesh, of), mesh.coordinates[std::size_t(node)]);
  return dot(apart, apart) < 1e-28;
}

// Every middle and centre lies where the table says.
void checkSide(const Mesh& mesh, const SideNodes& shape, const std::vector<std::int64_t>& nodes, Teuchos::FancyOStream& out, bool& success) {
  const auto n = std::size_t(shape.numCorners);
  const std::vector<std::int64_t> corners(nodes.begin(), nodes.begin() + long(n));
  if (nodes.size() > n)
    for (std::size_t i = 0; i < n; ++i) TEST_ASSERT(isMean(mesh, nodes[n + i], {corners[i], corners[(i + 1) % n]}));
  if (nodes.size() == 9) TEST_ASSERT(isMean(mesh, nodes[8], corners));
}

}  // namespace

TEUCHOS_UNIT_TEST(ElementShape, SidesAreThoseOfExodusManual) {
  TEST_EQUALITY(int(manual.size()), kNumTopologies);
  for (const auto& [topology, sides] : manual) {
    TEST_EQUALITY(sidesPerElement(topology), int(sides.size()));
    for (int s = 0; s < int(sides.size()); ++s) {
      std::vector<int> nodes;
      for (const int node : sideNodes(topology, s)) nodes.push_back(node + 1);
      TEST_COMPARE_ARRAYS(nodes, sides[std::size_t(s)]);
    }
  }
  TEST_THROW(sideNodes(Topology::Tet4, 4), std::logic_error);
}

TEUCHOS_UNIT_TEST(ElementShape, ShapesOfSides) {
  const std::map<int, SideShape> triangles{{3, SideShape::Triangle3}, {6, SideShape::Triangle6}};
  const std::map<int, SideShape> quads{{4, SideShape::Quad4}, {8, SideShape::Quad8}, {9, SideShape::Quad9}};
  for (const auto& [topology, sides] : manual)
    for (int s = 0; s < int(sides.size()); ++s) {
      const SideNodes& side = sideNodes(topology, s);
      TEST_ASSERT(side.shape == (side.numCorners == 3 ? triangles : quads).at(side.numNodes));
    }
}

// Of meshes with edges between the manual's nodes: outward, closed, middles in the middle.
TEUCHOS_UNIT_TEST(ElementShape, SidesOfMeshesPointOutwardAndClose) {
  for (const auto& entry : manual) {
    const Mesh mesh = withElements(distortedBox({2, 2, 2}), entry.first);
    const auto offsets = blockOffsets(mesh);
    TEST_ASSERT(mesh.blocks.size() == 1 && mesh.blocks[0].topology == entry.first && mesh.blocks[0].name == "box");
    std::set<std::int64_t> used(mesh.blocks[0].connectivity.begin(), mesh.blocks[0].connectivity.end());
    TEST_EQUALITY(used.size(), mesh.numNodes());
    std::map<std::set<std::int64_t>, int> faces;
    for (std::int64_t e = 0; e < std::int64_t(mesh.numElements()); ++e) {
      auto corners = nodesOfElement(mesh, e);
      corners.resize(std::size_t(elementShape(entry.first).numCorners));
      Vector3 sum{0, 0, 0};
      for (int s = 0; s < sidesPerElement(entry.first); ++s) {
        const SideNodes& shape = sideNodes(entry.first, s);
        auto nodes = nodesOfSide(mesh, offsets, {e, s});
        checkSide(mesh, shape, nodes, out, success);
        ++faces[{nodes.begin(), nodes.end()}];
        nodes.resize(std::size_t(shape.numCorners));
        const auto area = areaVector(mesh, nodes);
        TEST_COMPARE(dot(area, minus(centre(mesh, nodes), centre(mesh, corners))), >, 1e-4);
        for (std::size_t d = 0; d < 3; ++d) sum[d] += area[d];
      }
      for (std::size_t d = 0; d < 3; ++d) TEST_COMPARE(std::abs(sum[d]), <, 1e-13);
    }
    std::size_t outer = 0;  // neighbours agree in all nodes of their common side
    for (const auto& face : faces) outer += face.second == 1;
    const int corners = elementShape(entry.first).numCorners;
    TEST_EQUALITY(outer, corners == 4 ? 48u : corners == 6 ? 32u : 24u);
  }
}

TEUCHOS_UNIT_TEST(ElementShape, CellsOfAllKindsFit) {
  const Mesh hexahedra = distortedBox({2, 2, 3});
  std::vector<Cell> cells;
  for (std::size_t e = 0; e < hexahedra.numElements(); ++e)
    cells.push_back(e < 4 ? Cell::Hexahedron : e < 8 ? Cell::Pyramids : Cell::Wedges);
  for (const auto order : {ElementOrder::Linear, ElementOrder::Quadratic}) {
    const Mesh mesh = withCells(hexahedra, cells, order);
    TEST_EQUALITY(listBlocks(mesh), "box (1), box_wedge (2), box_pyramid (3), box_tet (4)");
    TEST_EQUALITY(mesh.blocks[0].numElements(), 4u);
    TEST_EQUALITY(mesh.blocks[1].numElements(), 8u);
    TEST_EQUALITY(mesh.blocks[2].numElements(), 20u);
    TEST_EQUALITY(mesh.blocks[3].numElements(), 8u);
    TEST_EQUALITY(mesh.sideSets[0].sides.size(), 6u);  // west
    TEST_EQUALITY(mesh.sideSets[1].sides.size(), 8u);  // top: of wedges
    const auto offsets = blockOffsets(mesh);
    std::map<std::set<std::int64_t>, int> faces;
    for (std::int64_t e = 0; e < std::int64_t(mesh.numElements()); ++e)
      for (int s = 0; s < sidesPerElement(mesh.blocks[std::size_t(locateElement(offsets, e).block)].topology); ++s) {
        const auto nodes = nodesOfSide(mesh, offsets, {e, s});
        ++faces[{nodes.begin(), nodes.end()}];
      }
    std::size_t outer = 0;
    for (const auto& face : faces) outer += face.second == 1;
    TEST_EQUALITY(outer, 4u + 8u + 4u * 6u);  // bottom, top, sides
  }
}

TEUCHOS_UNIT_TEST(ElementShape, NamesThatFilesUse) {
  TEST_ASSERT(isNameOf(Topology::Hex20, "HEX", 20) && isNameOf(Topology::Hex20, "hex20 ", 20) && isNameOf(Topology::Hex27, "HEXAHEDRON27", 27));
  TEST_ASSERT(isNameOf(Topology::Tet10, "TETRA", 10) && isNameOf(Topology::Tet10, "tet10", 10));
  TEST_ASSERT(isNameOf(Topology::Wedge6, "WEDGE", 6) && isNameOf(Topology::Wedge15, "PENTA15", 15));
  TEST_ASSERT(isNameOf(Topology::Pyramid5, "PYRAMID", 5) && isNameOf(Topology::Pyramid13, "pyra13", 13));
  TEST_ASSERT(!isNameOf(Topology::Hex20, "HEX8", 20) && !isNameOf(Topology::Hex20, "HEX20", 27) && !isNameOf(Topology::Hex8, "TETRA", 8));
  TEST_ASSERT(!isNameOf(Topology::Tet4, "", 4) && !isNameOf(Topology::Tet4, "4", 4));
  TEST_EQUALITY(listTopologies(), "HEX8, TETRA4, HEX20, HEX27, TETRA10, WEDGE6, WEDGE15, PYRAMID5, PYRAMID13");
}
