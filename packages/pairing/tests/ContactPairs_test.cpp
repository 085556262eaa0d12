// SPDX-License-Identifier: BSD-3-Clause
#include <Teuchos_UnitTestHarness.hpp>
#include <set>

#include "ContactScenes.hpp"
#include "Haptos_ContactPairs.hpp"
#include "Haptos_ContactSurface.hpp"
#include "Haptos_FacetTree.hpp"

namespace {
using namespace Haptos;
using namespace Haptos::Scenes;

ContactInterface pairsOf(const Mesh& mesh, const ContactSpec& spec = contact()) {
  return buildContact(mesh, {spec}).at(0);
}

// Largest |x_primary - x_secondary - gap n|; 1 if a primary node serves twice.
double pairingError(const Mesh& mesh, const ContactInterface& interface) {
  double error = 0.0;
  std::set<std::int64_t> used;
  for (const ContactPair& pair : interface.pairs) {
    if (!used.insert(pair.primary.at(0).node).second) return 1.0;
    const auto& x = mesh.coordinates[std::size_t(pair.secondaryNode)];
    const Point opposite = Vec3::add(x, Vec3::scale(pair.gap, pair.frame.normal));
    error = std::max(error, distance(opposite, mesh.coordinates[std::size_t(pair.primary.at(0).node)]));
  }
  return error;
}

double totalArea(const ContactInterface& interface) {
  double area = 0.0;
  for (const ContactPair& pair : interface.pairs) area += pair.area;
  return area;
}

TEUCHOS_UNIT_TEST(ContactPairs, FlatSurfacesAtAnyGap) {
  for (const double gap : {0.0, 1e-12, 0.01, 0.3, 1e3, -0.02, -0.2})
    for (const auto topology : {Topology::Hex8, Topology::Tet4}) {
      Stack stack;
      stack.lowerTopology = stack.upperTopology = topology;
      stack.upperMap = shift({0, 0, gap});
      const Mesh mesh = makeStack(stack);
      const ContactInterface interface = pairsOf(mesh);
      TEST_EQUALITY(interface.pairs.size(), 20u);
      TEST_EQUALITY(interface.unpairedNodes, 0u);
      TEST_EQUALITY(interface.notes.size(), 0u);
      TEST_COMPARE(pairingError(mesh, interface), <, 1e-14 * (1 + std::abs(gap)));
      TEST_FLOATING_EQUALITY(totalArea(interface), 2.0, 1e-14);
      for (const ContactPair& pair : interface.pairs) {
        TEST_COMPARE(std::abs(pair.gap - gap), <=, 1e-15 * std::abs(gap));
        TEST_ASSERT(distance(pair.frame.normal, {0, 0, -1}) < 1e-15);
        TEST_ASSERT(distance(pair.frame.t1, {1, 0, 0}) < 1e-15);
        TEST_ASSERT(distance(pair.frame.t2, {0, -1, 0}) < 1e-15);
      }
    }
}

TEUCHOS_UNIT_TEST(ContactPairs, TurnedInSpace) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const double gap = seed % 2 ? 0.1 : 1e3;
    const auto r = randomRotation(seed);
    Stack stack;
    stack.lowerDivisions = stack.upperDivisions = {6, 5, 2};
    stack.upperMap = shift({0, 0, gap});
    const Mesh mesh = turned(makeStack(stack), r);
    ContactSpec spec = contact();
    spec.principalDirection = rotate(r, {1, 1, 0.3});
    const ContactInterface interface = pairsOf(mesh, spec);
    TEST_EQUALITY(interface.pairs.size(), 42u);
    // coordinates of size gap leave that much less of the normals
    const double tolerance = 1e-14 * (10 + gap);
    TEST_COMPARE(pairingError(mesh, interface), <, tolerance * (1 + gap));
    for (const ContactPair& pair : interface.pairs) {
      TEST_FLOATING_EQUALITY(pair.gap, gap, 1e-13);
      const double h = std::sqrt(0.5);
      TEST_COMPARE(distance(pair.frame.normal, rotate(r, {0, 0, -1})), <, tolerance);
      TEST_COMPARE(distance(pair.frame.t1, rotate(r, {h, h, 0})), <, tolerance);
      TEST_COMPARE(distance(pair.frame.t2, rotate(r, {h, -h, 0})), <, tolerance);
    }
  }
}

TEUCHOS_UNIT_TEST(ContactPairs, InclinedAndCurvedSurfacesThatTouch) {
  const auto incline = [](const Point& x) { return Point{x[0], x[1], x[2] + 0.4 * x[0] - 0.2 * x[1]}; };
  const auto wave = [](const Point& x) {
    return Point{x[0], x[1], x[2] + 0.1 * std::sin(3 * x[0]) * std::cos(2 * x[1])};
  };
  for (const std::function<Point(const Point&)>& map :
       {std::function<Point(const Point&)>(incline), {wave}}) {
    Stack stack;
    stack.lowerDivisions = stack.upperDivisions = {8, 6, 1};
    stack.lowerMap = stack.upperMap = map;
    const ContactInterface interface = pairsOf(makeStack(stack));
    TEST_EQUALITY(interface.pairs.size(), 63u);
    for (const ContactPair& pair : interface.pairs) TEST_EQUALITY(pair.gap, 0.0);
  }
}

TEUCHOS_UNIT_TEST(ContactPairs, ConcentricCylinders) {
  for (const double gap : {0.0, 1e-12, 0.01, -0.01, 0.1}) {
    Stack stack;  // element size 1/8 along the arc, gap up to 0.8 of it
    stack.lowerDivisions = stack.upperDivisions = {16, 4, 1};
    stack.lowerMap = bend(3.0);
    stack.upperMap = bend(3.0, gap);
    const Mesh mesh = makeStack(stack);
    const ContactInterface interface = pairsOf(mesh);
    TEST_EQUALITY(interface.pairs.size(), 85u);
    TEST_EQUALITY(interface.notes.size(), 0u);
    for (const ContactPair& pair : interface.pairs) {
      const auto& x = mesh.coordinates[std::size_t(pair.secondaryNode)];
      const auto& y = mesh.coordinates[std::size_t(pair.primary.at(0).node)];
      TEST_COMPARE(std::abs(std::atan2(x[0], x[2]) - std::atan2(y[0], y[2])), <, 1e-14);
      TEST_EQUALITY(x[1], y[1]);
      TEST_COMPARE(std::abs(pair.gap - gap), <=, 3e-4 * std::abs(gap) + 1e-15);  // cos of half a face's angle
    }
  }
}

// Upper body with a paraboloid below, lower body flat or its mirror image: nodes match along the vertical,
// far from the nodal normals.
TEUCHOS_UNIT_TEST(ContactPairs, SphereOverPlaneAndMirrorImage) {
  for (const double curvature : {0.0, 0.5})
    for (const bool quarter : {false, true}) {
      const auto bulge = [=](double c, double sign) {
        return [=](const Point& x) {
          const double a = x[0] - (quarter ? 0.0 : 1.0), b = x[1] - (quarter ? 0.0 : 0.5);
          return Point{x[0], x[1], x[2] + sign * 0.5 * c * (a * a + b * b)};
        };
      };
      Stack stack;
      stack.lowerDivisions = stack.upperDivisions = {16, 8, 1};
      stack.lowerTo = {quarter ? 1.0 : 2.0, 1, 0};
      stack.upperTo = {quarter ? 1.0 : 2.0, 1, 1};
      stack.upperMap = bulge(0.5, 1);
      stack.lowerMap = bulge(curvature, -1);
      const Mesh mesh = makeStack(stack);
      const ContactInterface interface = pairsOf(mesh);
      TEST_EQUALITY(interface.pairs.size(), 153u);
      double offNormal = 0.0;
      for (const ContactPair& pair : interface.pairs) {
        const auto& x = mesh.coordinates[std::size_t(pair.secondaryNode)];
        const auto& y = mesh.coordinates[std::size_t(pair.primary.at(0).node)];
        TEST_ASSERT(x[0] == y[0] && x[1] == y[1]);
        const auto offset = Vec3::subtract(y, x);
        TEST_COMPARE(std::abs(pair.gap - Vec3::dot(offset, pair.frame.normal)), <, 1e-15);
        offNormal = std::max(offNormal, Vec3::distanceFromLine(offset, pair.frame.normal));
      }
      TEST_COMPARE(offNormal, >, 0.04);  // of an element size 1/8 or 1/16: far beyond the tolerance
    }
}

TEUCHOS_UNIT_TEST(ContactPairs, DoNotDependOnNumbering) {
  Stack stack;
  stack.lowerDivisions = stack.upperDivisions = {9, 7, 1};
  stack.lowerMap = bend(3.0);
  stack.upperMap = bend(3.0, 0.01);
  const Mesh mesh = makeStack(stack);
  const auto permutation = randomPermutation(mesh.numNodes(), 11);
  const ContactInterface a = pairsOf(mesh), b = pairsOf(renumbered(mesh, permutation));
  TEST_EQUALITY(a.pairs.size(), 80u);
  TEST_EQUALITY(b.pairs.size(), 80u);
  std::size_t same = 0;
  for (const ContactPair& pair : a.pairs)
    for (const ContactPair& other : b.pairs) {
      if (other.secondaryNode != permutation[std::size_t(pair.secondaryNode)]) continue;
      ++same;
      TEST_EQUALITY(other.primary.at(0).node, permutation[std::size_t(pair.primary.at(0).node)]);
      TEST_COMPARE(std::abs(other.gap - pair.gap), <, 1e-15);
      TEST_COMPARE(distance(other.frame.normal, pair.frame.normal), <, 1e-14);
      TEST_COMPARE(distance(other.frame.t1, pair.frame.t1), <, 1e-14);
    }
  TEST_EQUALITY(same, 80u);
}

TEUCHOS_UNIT_TEST(ContactPairs, SecondarySmallerThanPrimary) {
  for (const double gap : {0.0, 0.5, 1e3}) {
    Stack stack;
    stack.upperFrom = {0.5, 0, 0};
    stack.upperTo = {1.5, 1, 1};
    stack.upperDivisions = {2, 3, 1};
    stack.upperMap = shift({0, 0, gap});
    const Mesh mesh = makeStack(stack);
    const ContactInterface interface = pairsOf(mesh);
    TEST_EQUALITY(interface.pairs.size(), 12u);
    TEST_EQUALITY(interface.unpairedNodes, 0u);
    TEST_COMPARE(pairingError(mesh, interface), <, 1e-14 * (1 + gap));
  }
}

TEUCHOS_UNIT_TEST(ContactPairs, SecondaryLargerThanPrimary) {
  for (const double gap : {0.0, 0.5, 1e3}) {
    Stack stack;
    stack.upperFrom = {0.5, 0, 0};
    stack.upperTo = {1.5, 1, 1};
    stack.upperDivisions = {2, 3, 1};
    stack.upperMap = shift({0, 0, gap});
    const ContactInterface interface = pairsOf(makeStack(stack), contact("lower_contact", "upper_contact"));
    TEST_EQUALITY(interface.pairs.size(), 12u);
    TEST_EQUALITY(interface.unpairedNodes, 8u);
    TEST_EQUALITY(interface.notes.size(), 1u);
    TEST_ASSERT(contains(interface.notes[0], "8 of 20 nodes"));
    TEST_FLOATING_EQUALITY(totalArea(interface), 1.0, 1e-13);  // of the faces that are covered
    for (const ContactPair& pair : interface.pairs)
      TEST_ASSERT(distance(pair.frame.normal, {0, 0, 1}) < 1e-15);
  }
}

// The primary set also holds the far side of its body and a face around the corner: neither may be taken.
TEUCHOS_UNIT_TEST(ContactPairs, TakesTheFaceThatLooksBack) {
  Stack stack;
  stack.upperMap =
      shift({0, 0, 0.7});  // nearer to the upper surface than to anything else by less than the body
  Mesh mesh = makeStack(stack);
  auto& primary = mesh.sideSets[std::size_t(findSideSet(mesh, "lower_contact"))].sides;
  for (const char* name : {"lower_bottom", "lower_end"}) {
    const auto& more = mesh.sideSets[std::size_t(findSideSet(mesh, name))].sides;
    primary.insert(primary.begin(), more.begin(), more.end());
  }
  const ContactInterface interface = pairsOf(mesh);
  TEST_EQUALITY(interface.pairs.size(), 20u);
  for (const ContactPair& pair : interface.pairs) TEST_FLOATING_EQUALITY(pair.gap, 0.7, 1e-14);
}

TEUCHOS_UNIT_TEST(ContactPairs, PrincipalDirectionAlongTheNormal) {
  ContactSpec spec = contact();
  spec.principalDirection = {0, 0, 1};
  for (const ContactPair& pair : pairsOf(makeStack({}), spec).pairs)
    TEST_ASSERT(distance(pair.frame.t1, {1, 0, 0}) < 1e-15);
}

TEUCHOS_UNIT_TEST(ContactPairs, NotesTrianglesOnQuadrilaterals) {
  Stack stack;
  stack.upperTopology = Topology::Tet4;
  const ContactInterface interface = pairsOf(makeStack(stack));
  TEST_EQUALITY(interface.pairs.size(), 20u);
  TEST_ASSERT(interface.notes.size() == 1 && contains(interface.notes[0], "24 faces"));
}

TEUCHOS_UNIT_TEST(ContactPairs, NotesADeepPenetration) {
  Stack stack;
  stack.upperMap = shift({0, 0, -0.5});
  const ContactInterface interface = pairsOf(makeStack(stack));
  TEST_EQUALITY(interface.pairs.size(), 20u);
  TEST_ASSERT(interface.notes.size() == 1 && contains(interface.notes[0], "initial penetration of 0.5"));
}

TEUCHOS_UNIT_TEST(ContactPairs, RigidPlane) {
  const auto r = randomRotation(4);
  for (const double gap : {0.0, 0.25, -0.01, 1e3}) {
    ContactSpec spec = contact("upper_contact", "");
    spec.rigidPlane = RigidPlane{rotate(r, {7, -3, -gap}), rotate(r, {0, 0, 4})};
    spec.principalDirection = rotate(r, {0, 2, 1});
    const ContactInterface interface = pairsOf(turned(makeStack({}), r), spec);
    TEST_EQUALITY(interface.pairs.size(), 20u);
    TEST_FLOATING_EQUALITY(totalArea(interface), 2.0, 1e-13);
    for (const ContactPair& pair : interface.pairs) {
      TEST_ASSERT(pair.primary.empty());
      TEST_COMPARE(std::abs(pair.gap - gap), <, 1e-14 * (1 + std::abs(gap)));
      TEST_COMPARE(distance(pair.frame.normal, rotate(r, {0, 0, -1})), <, 1e-14);
      TEST_COMPARE(distance(pair.frame.t1, rotate(r, {0, 1, 0})), <, 1e-14);
    }
  }
}

// A side set may have all faces of a body: those at its sides and back never touch the plane, and have no area there.
TEUCHOS_UNIT_TEST(ContactPairs, RigidPlaneTakesTheFacesThatLookAtIt) {
  for (const Topology element : {Topology::Hex8, Topology::Tet4}) {
    Stack stack;
    stack.lowerTopology = element;
    Mesh mesh = makeStack(stack);
    auto& set = mesh.sideSets[std::size_t(findSideSet(mesh, "lower_bottom"))].sides;
    const std::size_t facing = set.size();
    for (const char* name : {"lower_end", "lower_contact"}) {
      const auto& more = mesh.sideSets[std::size_t(findSideSet(mesh, name))].sides;
      set.insert(set.begin(), more.begin(), more.end());
    }
    ContactSpec spec = contact("lower_bottom", "");
    spec.rigidPlane = RigidPlane{{0, 0, -1}, {0, 0, 1}};
    const ContactInterface interface = pairsOf(mesh, spec);
    TEST_EQUALITY(interface.pairs.size(), 20u);
    TEST_FLOATING_EQUALITY(totalArea(interface), 2.0, 1e-13);
    for (const ContactPair& pair : interface.pairs) TEST_COMPARE(std::abs(pair.gap), <, 1e-14);
    const std::string told = std::to_string(set.size() - facing) + " of " + std::to_string(set.size()) + " faces";
    TEST_ASSERT(interface.notes.size() == 1 && contains(interface.notes[0], told));
    spec.rigidPlane->normal = {0, 1, 0};
    TEST_ASSERT(contains(refusal(mesh, spec), "looks towards the Rigid Plane"));
  }
}

TEUCHOS_UNIT_TEST(ContactPairs, ANodeMayBeSecondaryTwice) {
  ContactSpec ground = contact("lower_bottom", ""), wall = contact("lower_end", "");
  ground.rigidPlane = RigidPlane{{0, 0, -1}, {0, 0, 1}};
  wall.name = "wall";
  wall.rigidPlane = RigidPlane{{2.5, 0, 0}, {-1, 0, 0}};
  const auto interfaces = buildContact(makeStack({}), {ground, wall});
  TEST_EQUALITY(interfaces.size(), 2u);
  TEST_EQUALITY(interfaces[1].name, "wall");
  std::set<std::int64_t> nodes;
  for (const auto& interface : interfaces)
    for (const auto& pair : interface.pairs) {
      nodes.insert(pair.secondaryNode);
      TEST_FLOATING_EQUALITY(pair.gap + 1, interface.name == "wall" ? 1.5 : 1.0, 1e-15);
    }
  TEST_EQUALITY(interfaces[0].pairs.size() + interfaces[1].pairs.size() - nodes.size(),
                4u);  // the common edge
}

// A search that looked at all faces would compare 20000 boxes a node.
TEUCHOS_UNIT_TEST(ContactPairs, ALineThroughALargeSurfaceMeetsFewBoxes) {
  for (const bool curved : {false, true}) {
    Stack stack;
    stack.lowerDivisions = stack.upperDivisions = {199, 99, 1};
    stack.lowerMap = curved ? bend(3.0) : shift({0, 0, 0});
    stack.upperMap = curved ? bend(3.0, 0.001) : shift({0, 0, 10.0});
    const Mesh mesh = turned(makeStack(stack), randomRotation(8));
    TEST_EQUALITY(pairsOf(mesh).pairs.size(), 20000u);
    const ContactSurface secondary = makeContactSurface(mesh, "upper_contact"), primary = makeContactSurface(mesh, "lower_contact");
    const FacetTree tree(primary);
    std::vector<int> facets;
    int most = 0;
    for (std::size_t i = 0; i < secondary.numNodes(); ++i)
      most = std::max(most, tree.facetsNearLine(secondary.coordinates[i], secondary.normals[i], facets));
    out << "at most " << most << " of " << 2 * primary.numFacets() << " boxes\n";
    TEST_COMPARE(most, <, 300);
  }
}

}  // namespace
