// SPDX-License-Identifier: BSD-3-Clause
#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_Error.hpp"
#include "MeshTestTools.hpp"

using namespace Haptos;
using namespace HaptosTest;

namespace {

double tetVolume(const Mesh& mesh, const std::vector<std::int64_t>& n) {
  const auto& o = mesh.coordinates[std::size_t(n[0])];
  const auto edge = [&](std::size_t i) { return minus(mesh.coordinates[std::size_t(n[i])], o); };
  return dot(edge(1), cross(edge(2), edge(3))) / 6.0;
}

/// How often each side (by its sorted nodes) occurs in the whole mesh: 1 on the boundary, 2 inside.
std::map<std::vector<std::int64_t>, int> countSides(const Mesh& mesh) {
  const auto offsets = blockOffsets(mesh);
  std::map<std::vector<std::int64_t>, int> count;
  for (std::int64_t e = 0; e < offsets.back(); ++e) {
    const auto topology = mesh.blocks[std::size_t(locateElement(offsets, e).block)].topology;
    for (int s = 0; s < sidesPerElement(topology); ++s) {
      auto nodes = nodesOfSide(mesh, offsets, {e, s});
      std::sort(nodes.begin(), nodes.end());
      ++count[nodes];
    }
  }
  return count;
}

BoxSpec unevenBox(Topology topology) {
  BoxSpec box;
  box.blockName = "box";
  box.lower = {-1, 0, 2};
  box.upper = {2, 0.1, 4};
  box.divisions = {3, 2, 4};
  box.topology = topology;
  box.sideSetNames = {"west", "east", "south", "north", "bottom", "top"};
  return box;
}

/// Every face of the box: where it lies, its outward normal, and its area.
void checkFaces(const Mesh& mesh, const BoxSpec& box, Teuchos::FancyOStream& out, bool& success) {
  const auto offsets = blockOffsets(mesh);
  for (int face = 0; face < 6; ++face) {
    const auto axis = std::size_t(face / 2);
    const bool upper = face % 2 == 1;
    const int found = findSideSet(mesh, box.sideSetNames[std::size_t(face)]);
    TEST_ASSERT(found >= 0);
    double area = 0.0, expected = 1.0;
    for (const auto& side : mesh.sideSets[std::size_t(found)].sides) {
      const auto nodes = nodesOfSide(mesh, offsets, side);
      for (const auto n : nodes)
        TEST_EQUALITY(mesh.coordinates[std::size_t(n)][axis], upper ? box.upper[axis] : box.lower[axis]);
      const auto outward = areaVector(mesh, nodes);
      TEST_COMPARE((upper ? 1.0 : -1.0) * outward[axis], >, 0.0);
      area += std::abs(outward[axis]);
    }
    for (std::size_t d = 0; d < 3; ++d)
      if (d != axis) expected *= box.upper[d] - box.lower[d];
    TEST_FLOATING_EQUALITY(area, expected, 1e-13);
  }
}

std::string messageOf(const std::vector<BoxSpec>& boxes) {
  try {
    makeBoxes(boxes);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

}  // namespace

TEUCHOS_UNIT_TEST(BoxMesh, FacesOfHexahedralBox) {
  const auto box = unevenBox(Topology::Hex8);
  const Mesh mesh = makeBoxes({box});
  TEST_EQUALITY(mesh.numNodes(), 60u);
  TEST_EQUALITY(mesh.numElements(), 24u);
  TEST_EQUALITY(mesh.sideSets.size(), 6u);
  checkFaces(mesh, box, out, success);
}

TEUCHOS_UNIT_TEST(BoxMesh, TetrahedraFillTheBoxAndAgreeOnTheirFaces) {
  const auto box = unevenBox(Topology::Tet4);
  const Mesh mesh = makeBoxes({box});
  TEST_EQUALITY(mesh.numNodes(), 60u);
  TEST_EQUALITY(mesh.numElements(), 144u);
  checkFaces(mesh, box, out, success);

  double volume = 0.0;
  for (std::int64_t e = 0; e < 144; ++e) {
    const double v = tetVolume(mesh, nodesOfElement(mesh, e));
    TEST_COMPARE(v, >, 0.0);
    volume += v;
  }
  TEST_FLOATING_EQUALITY(volume, 3 * 0.1 * 2, 1e-13);

  // 2 triangles on every outer cell face: 2 (3*2 + 2*4 + 3*4) * 2; all others shared by two tetrahedra.
  int outer = 0, inner = 0;
  for (const auto& [nodes, count] : countSides(mesh)) (count == 1 ? outer : inner) += count;
  TEST_EQUALITY(outer, 104);
  TEST_EQUALITY(inner, 144 * 4 - 104);
}

TEUCHOS_UNIT_TEST(BoxMesh, SeveralBoxesMapAndSharedSetName) {
  BoxSpec first = unevenBox(Topology::Hex8), second = unevenBox(Topology::Tet4);
  first.sideSetNames = {"clamp", "", "", "", "", ""};
  second.sideSetNames = {"clamp", "", "", "", "", "top"};
  second.blockId = 40;
  second.blockName = "skew";
  second.map = [](const std::array<double, 3>& x) {
    return std::array<double, 3>{x[0], x[1] + 10, x[2] + 0.1 * x[0]};
  };
  const Mesh mesh = makeBoxes({first, second});
  TEST_EQUALITY(mesh.numNodes(), 120u);
  TEST_EQUALITY(listBlocks(mesh), "box (1), skew (40)");
  TEST_EQUALITY(listSideSets(mesh), "clamp (1), top (2)");
  TEST_EQUALITY(mesh.sideSets[0].sides.size(), 8u + 16u);
  TEST_EQUALITY(mesh.sideSets[0].sides[8].element / 24, 1);  // tetrahedra count on after 24 hexahedra
  for (const auto n : mesh.blocks[1].connectivity) TEST_COMPARE(n, >=, 60);
  TEST_FLOATING_EQUALITY(mesh.coordinates[63][2], 2.0 + 0.2, 1e-14);
  TEST_FLOATING_EQUALITY(mesh.coordinates[63][1], 10.0, 1e-14);
  TEST_EQUALITY(mesh.nodeNumbers.back(), 120);
  TEST_EQUALITY(mesh.elementNumbers.back(), 24 + 144);
}

TEUCHOS_UNIT_TEST(BoxMesh, WrongBoxesAreRefused) {
  auto box = unevenBox(Topology::Hex8);
  TEST_EQUALITY(messageOf({box}), "");
  TEST_INEQUALITY(messageOf({}).find("at least one box"), std::string::npos);
  auto renumbered = box;
  renumbered.blockId = 2;
  TEST_INEQUALITY(messageOf({box, box, renumbered}).find("number 2 is used twice"), std::string::npos);
  auto flat = box;
  flat.upper[1] = flat.lower[1];
  TEST_INEQUALITY(messageOf({flat}).find("Box 'box': its upper corner must lie above the lower one in y"),
                  std::string::npos);
  auto none = box;
  none.divisions[2] = 0;
  TEST_INEQUALITY(messageOf({none}).find("divisions in z are 0"), std::string::npos);
  auto huge = box;
  huge.divisions = {100000, 100000, 100000};
  TEST_INEQUALITY(messageOf({huge}).find("at most 2147483647"), std::string::npos);
  TEST_THROW(makeTwoBeams({0, 4}), InputError);
  TEST_THROW(makeTwoBeams({2, -1}), InputError);
  TEST_THROW(makeTwoBeams({100000, 100000}), InputError);
}

TEUCHOS_UNIT_TEST(BoxMesh, TwoBeamsHaveTheirCountsAndPlaces) {
  const int k = 2, p = 4, n = k * p;
  const Mesh mesh = makeTwoBeams({k, p});
  TEST_EQUALITY(mesh.numNodes(), std::size_t(2 * (2 * n + 1) * (n + 1) * (n + 1)));
  TEST_EQUALITY(mesh.numElements(), std::size_t(4 * n * n * n));
  TEST_EQUALITY(listBlocks(mesh), "lower (1), upper (2)");
  const auto offsets = blockOffsets(mesh);

  struct Face {
    const char* name;
    int axis;
    double at;
    int block;
    int sides;
  };
  const std::vector<Face> faces = {
      {"lower_contact", 2, 0.0, 0, 2 * n * n}, {"upper_contact", 2, 0.0, 1, 2 * n * n},
      {"lower_clamp", 0, 0.0, 0, n * n},       {"upper_clamp", 0, 0.0, 1, n * n},
      {"upper_top", 2, 1.0, 1, 2 * n * n},     {"lower_bottom", 2, -1.0, 0, 2 * n * n},
      {"upper_end", 0, 2.0, 1, n * n}};
  TEST_EQUALITY(mesh.sideSets.size(), faces.size());
  for (const auto& face : faces) {
    const int s = findSideSet(mesh, face.name);
    TEST_ASSERT(s >= 0);
    TEST_EQUALITY(int(mesh.sideSets[std::size_t(s)].sides.size()), face.sides);
    for (const auto& side : mesh.sideSets[std::size_t(s)].sides) {
      TEST_EQUALITY(locateElement(offsets, side.element).block, face.block);
      for (const auto node : nodesOfSide(mesh, offsets, side))
        TEST_EQUALITY(mesh.coordinates[std::size_t(node)][std::size_t(face.axis)], face.at);
    }
  }
}

TEUCHOS_UNIT_TEST(BoxMesh, BricksAreCongruentAndCoverTheBodies) {
  const int k = 2, p = 3;
  const Mesh mesh = makeTwoBeams({k, p});
  const auto bricks = brickSubdomains({k, p});
  TEST_EQUALITY(bricks.size(), mesh.numElements());
  std::vector<std::vector<std::int64_t>> elements(4 * k * k * k);
  for (std::size_t e = 0; e < bricks.size(); ++e) elements[std::size_t(bricks[e])].push_back(std::int64_t(e));

  std::vector<std::size_t> firstLocal;  // connectivity of brick 0 in its local numbering
  for (std::size_t b = 0; b < elements.size(); ++b) {
    TEST_EQUALITY(int(elements[b].size()), p * p * p);
    std::set<std::int64_t> nodeSet;
    for (const auto e : elements[b])
      for (const auto n : nodesOfElement(mesh, e)) nodeSet.insert(n);
    const std::vector<std::int64_t> nodes(nodeSet.begin(), nodeSet.end());
    TEST_EQUALITY(int(nodes.size()), (p + 1) * (p + 1) * (p + 1));

    std::vector<std::size_t> local;
    for (const auto e : elements[b])
      for (const auto n : nodesOfElement(mesh, e))
        local.push_back(std::size_t(std::lower_bound(nodes.begin(), nodes.end(), n) - nodes.begin()));
    if (b == 0) firstLocal = local;
    TEST_ASSERT(local == firstLocal);

    // Where the brick must lie: body, then z, y, x with x fastest.
    const int in = int(b) % (2 * k * k * k), body = int(b) / (2 * k * k * k);
    const Vector3 expected{(in % (2 * k)) / double(k), (in / (2 * k) % k) / double(k),
                           (in / (2 * k * k)) / double(k) + body - 1.0};
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const auto x = mesh.coordinates[std::size_t(nodes[i])];
      const std::array<std::size_t, 3> at{i % (p + 1), i / (p + 1) % (p + 1), i / ((p + 1) * (p + 1))};
      for (std::size_t d = 0; d < 3; ++d)
        TEST_COMPARE(std::abs(x[d] - expected[d] - double(at[d]) / double(k * p)), <, 1e-14);
    }
  }
}
