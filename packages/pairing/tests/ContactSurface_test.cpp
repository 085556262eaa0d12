// SPDX-License-Identifier: BSD-3-Clause
#include <Teuchos_UnitTestHarness.hpp>

#include "ContactScenes.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_ContactSurface.hpp"
#include "Haptos_FacetTree.hpp"

namespace {
using namespace Haptos;
using namespace Haptos::Scenes;

double totalArea(const ContactSurface& s) { return std::accumulate(s.areas.begin(), s.areas.end(), 0.0); }

// Moves the nodes of z = 0 inside its plane, the edges along themselves: distorted faces, same area.
Point distort(const Point& x) {
  const double bubble = x[0] * (2 - x[0]) * x[1] * (1 - x[1]);
  return {x[0] + 0.4 * bubble, x[1] - 0.5 * bubble, x[2]};
}

TEUCHOS_UNIT_TEST(ContactSurface, TributaryAreasSumToTheSurface) {
  for (const auto topology : {Topology::Hex8, Topology::Tet4}) {
    Stack stack;
    stack.lowerTopology = topology;
    stack.lowerMap = distort;
    const ContactSurface s = makeContactSurface(makeStack(stack), "lower_contact");
    TEST_EQUALITY(s.numNodes(), 20u);
    TEST_EQUALITY(s.numFacets(), topology == Topology::Hex8 ? 12u : 24u);
    TEST_FLOATING_EQUALITY(totalArea(s), 2.0, 1e-14);
    for (const double area : s.areas) TEST_ASSERT(area > 0.0);
    for (const auto& n : s.normals) TEST_ASSERT(distance(n, {0, 0, 1}) < 1e-15);
    for (const double turn : s.turns) TEST_ASSERT(turn < 1e-15);
  }
}

TEUCHOS_UNIT_TEST(ContactSurface, AreasAreIntegralsOfShapeFunctions) {
  Stack stack;
  stack.lowerDivisions = {1, 1, 1};
  stack.lowerMap = [](const Point& x) { return Point{x[0] * (1 + x[1]), x[1], x[2]}; };  // trapezoid, area 3
  const Mesh mesh = makeStack(stack);
  const ContactSurface s = makeContactSurface(mesh, "lower_contact");
  TEST_EQUALITY(s.numNodes(), 4u);
  // x = 2 xi (1 + eta), y = eta: dA = 2 (1 + eta); integrals of (1 - eta)/2 and eta/2 times that: 2/3, 5/6
  for (std::size_t i = 0; i < 4; ++i)
    TEST_FLOATING_EQUALITY(s.areas[i], s.coordinates[i][1] == 0.0 ? 2.0 / 3 : 5.0 / 6, 1e-14);
}

TEUCHOS_UNIT_TEST(ContactSurface, NormalsOfACylinderAreRadial) {
  for (const auto topology : {Topology::Hex8, Topology::Tet4}) {
    Stack stack;
    stack.upperDivisions = {12, 3, 1};
    stack.upperTopology = topology;
    stack.upperMap = bend(2.0);
    const ContactSurface s = makeContactSurface(makeStack(stack), "upper_contact");
    int inner = 0;
    for (std::size_t i = 0; i < s.numNodes(); ++i) {
      const auto& x = s.coordinates[i];
      const double angle = std::atan2(x[0], x[2]);
      const bool atEnd = angle < 0.01 || angle > 0.99;
      const Point inward = {-std::sin(angle), 0.0, -std::cos(angle)};
      // at the two ends the normal is that of the last face, half a face's angle (1/24) off
      TEST_FLOATING_EQUALITY(distance(s.normals[i], inward) + 1.0,
                             (atEnd ? 2 * std::sin(1.0 / 48) : 0.0) + 1.0, 1e-12);
      inner += atEnd ? 0 : 1;
    }
    TEST_EQUALITY(inner, 11 * 4);
  }
}

TEUCHOS_UNIT_TEST(ContactSurface, DoesNotDependOnNumbering) {
  Stack stack;
  stack.upperDivisions = {7, 5, 1};
  stack.upperTopology = Topology::Tet4;
  stack.upperMap = bend(1.5);
  const Mesh mesh = makeStack(stack);
  const auto permutation = randomPermutation(mesh.numNodes(), 3);
  const ContactSurface a = makeContactSurface(mesh, "upper_contact");
  const ContactSurface b = makeContactSurface(renumbered(mesh, permutation), "upper_contact");
  TEST_EQUALITY(a.numNodes(), b.numNodes());
  bool moved = false;
  for (std::size_t i = 0; i < a.numNodes(); ++i) {
    const auto node = permutation[std::size_t(a.nodes[i])];
    const auto j = std::size_t(std::lower_bound(b.nodes.begin(), b.nodes.end(), node) - b.nodes.begin());
    moved = moved || i != j;
    TEST_ASSERT(b.nodes[j] == node);
    TEST_COMPARE(distance(a.normals[i], b.normals[j]), <, 1e-14);
    TEST_FLOATING_EQUALITY(a.areas[i], b.areas[j], 1e-14);
    TEST_FLOATING_EQUALITY(a.sizes[i], b.sizes[j], 1e-14);
  }
  TEST_ASSERT(moved);
}

TEUCHOS_UNIT_TEST(ContactSurface, SizeIsTheShortestEdgeAround) {
  const ContactSurface s = makeContactSurface(makeStack({}), "lower_contact");  // faces 0.5 x 1/3
  for (const double size : s.sizes) TEST_FLOATING_EQUALITY(size, 1.0 / 3, 1e-14);
}

TEUCHOS_UNIT_TEST(ContactSurface, ASideListedTwiceIsRefused) {
  Mesh mesh = makeStack({});
  auto& sides = mesh.sideSets[std::size_t(findSideSet(mesh, "lower_contact"))].sides;
  sides.push_back(sides.front());
  std::string message;
  try {
    makeContactSurface(mesh, "lower_contact");
  } catch (const InputError& e) {
    message = e.what();
  }
  TEST_ASSERT(contains(message, "'lower_contact'") && contains(message, "side 6 of element 1 is listed twice"));
}

TEUCHOS_UNIT_TEST(ContactSurface, ACollapsedBrickHasATriangularSide) {
  Mesh mesh;
  mesh.coordinates = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  mesh.blocks.push_back({1, "wedge", Topology::Hex8, {0, 1, 2, 2, 3, 4, 5, 5}});
  mesh.sideSets = {{1, "top", {{0, 5}}}, {2, "line", {{0, 2}}}};
  const ContactSurface s = makeContactSurface(mesh, "top");
  TEST_EQUALITY(s.facetSize(0), 3);
  TEST_FLOATING_EQUALITY(totalArea(s), 0.5, 1e-15);
  TEST_ASSERT(distance(s.normals[0], {0, 0, 1}) < 1e-15);
  TEST_THROW(makeContactSurface(mesh, "line"), InputError);
}

TEUCHOS_UNIT_TEST(ContactSurface, RefusesOpposedFaces) {
  Stack stack;  // the two sides of z = 0, with the same nodes: as on a sheet between two elements
  Mesh mesh = makeStack(stack);
  auto& lower = mesh.sideSets[std::size_t(findSideSet(mesh, "lower_contact"))];
  auto& upper = mesh.sideSets[std::size_t(findSideSet(mesh, "upper_contact"))];
  const auto a = makeContactSurface(mesh, "lower_contact"), b = makeContactSurface(mesh, "upper_contact");
  for (auto& block : mesh.blocks)
    for (auto& node : block.connectivity)
      for (std::size_t i = 0; i < b.numNodes(); ++i)
        if (node == b.nodes[i]) node = a.nodes[i];
  lower.sides.push_back(upper.sides.front());
  try {
    makeContactSurface(mesh, "lower_contact");
    TEST_ASSERT(false);
  } catch (const InputError& error) {
    out << error.what() << "\n";
    TEST_ASSERT(contains(error.what(), "opposite directions") && contains(error.what(), "node "));
  }
}

TEUCHOS_UNIT_TEST(ContactSurface, NamesWhatExistsForAMissingSet) {
  try {
    makeContactSurface(makeStack({}), "botom");
    TEST_ASSERT(false);
  } catch (const InputError& error) {
    TEST_ASSERT(contains(error.what(), "'botom'") && contains(error.what(), "lower_bottom"));
  }
  Mesh mesh = makeStack({});
  mesh.sideSets[0].sides.clear();
  TEST_THROW(makeContactSurface(mesh, mesh.sideSets[0].name), InputError);
}

// Every face that a line meets, by brute force over the corners' boxes, must be among those the tree returns.
TEUCHOS_UNIT_TEST(FacetTree, FindsWhatLiesOnALine) {
  Stack stack;
  stack.lowerDivisions = {23, 17, 1};
  stack.lowerMap = bend(3.0);
  const ContactSurface s = makeContactSurface(turned(makeStack(stack), randomRotation(5)), "lower_contact");
  const FacetTree tree(s);
  std::mt19937 generator(1);
  std::uniform_int_distribution<int> pick(0, int(s.numFacets()) - 1);
  std::size_t visited = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const int wanted = pick(generator);
    Point centre{};
    for (const int node : s.facets[std::size_t(wanted)])
      centre = Vec3::add(centre, Vec3::scale(0.25, s.coordinates[std::size_t(node)]));
    const Point direction = Vec3::scale(trial % 2 ? 1.0 : -7.0, randomRotation(unsigned(trial))[0]);
    std::vector<int> found = {-5};
    tree.facetsNearLine(Vec3::add(centre, Vec3::scale(100.0, direction)), direction, found);
    TEST_ASSERT(std::find(found.begin(), found.end(), wanted) != found.end());
    TEST_ASSERT(std::find(found.begin(), found.end(), -5) == found.end());
    visited += found.size();
  }
  out << "mean faces near a line: " << double(visited) / 200 << " of " << s.numFacets() << "\n";
  TEST_COMPARE(visited / 200, <, s.numFacets() / 8);
}

}  // namespace
