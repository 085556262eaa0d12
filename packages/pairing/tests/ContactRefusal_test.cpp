// SPDX-License-Identifier: BSD-3-Clause
// What buildContact must refuse, and what it must say then.
#include <Teuchos_UnitTestHarness.hpp>
#include <limits>

#include "ContactScenes.hpp"
#include "Haptos_ContactPairs.hpp"
#include "Haptos_ContactSurface.hpp"

namespace {
using namespace Haptos;
using namespace Haptos::Scenes;

std::string nonMatching(const Mesh& mesh, const ContactSpec& spec = contact()) {
  return refusal<NonMatchingError>(mesh, spec);
}

std::int64_t nodeAt(const Mesh& mesh, const Point& x, const std::string& sideSet) {
  for (const auto node : makeContactSurface(mesh, sideSet).nodes)
    if (distance(mesh.coordinates[std::size_t(node)], x) < 1e-12) return node;
  throw std::logic_error("no node there");
}

// Two boxes with one node of the upper surface moved aside.
Mesh withOneNodeMoved(const Point& by, double gap = 0.0) {
  Stack stack;
  stack.upperMap = shift({0, 0, gap});
  Mesh mesh = makeStack(stack);
  auto& x = mesh.coordinates[std::size_t(nodeAt(mesh, {1, 1.0 / 3, gap}, "upper_contact"))];
  x = Vec3::add(x, by);
  return mesh;
}

TEUCHOS_UNIT_TEST(ContactRefusal, TellsTheMismatchAndItsPlace) {
  for (const double gap : {0.0, 0.2, 1e3}) {
    Mesh mesh = withOneNodeMoved({0.03, 0.04, 0}, gap);
    const auto node = nodeAt(mesh, {1.03, 1.0 / 3 + 0.04, gap}, "upper_contact");
    mesh.nodeNumbers.resize(mesh.numNodes());
    for (std::size_t i = 0; i < mesh.numNodes(); ++i) mesh.nodeNumbers[i] = 1000 + 7 * std::int64_t(i);
    const std::string message = nonMatching(mesh);
    out << message << "\n";
    TEST_ASSERT(contains(message, "do not match") && contains(message, "1 of 20 nodes"));
    TEST_ASSERT(contains(message, "mismatch: 0.05,"));
    TEST_ASSERT(contains(message, "node " + std::to_string(1000 + 7 * node) + " (1.03, 0.373333, "));
    TEST_ASSERT(contains(message, "'upper_contact'") && contains(message, "'lower_contact'"));
  }
}

TEUCHOS_UNIT_TEST(ContactRefusal, TakesTheLargestMismatch) {
  Mesh mesh = withOneNodeMoved({0.03, 0.04, 0});
  auto& x = mesh.coordinates[std::size_t(nodeAt(mesh, {1.5, 2.0 / 3, 0}, "upper_contact"))];
  x = Vec3::add(x, {0.06, -0.08, 0});
  const std::string message = nonMatching(mesh);
  TEST_ASSERT(contains(message, "2 of 20 nodes") && contains(message, "mismatch: 0.1,"));
}

TEUCHOS_UNIT_TEST(ContactRefusal, ToleranceIsRelativeToTheElementSize) {
  const double h = 1.0 / 3;  // shortest edge
  for (const double unit : {1.0, 1e-3, 1e6}) {
    const auto scaled = [&](Mesh mesh) {
      for (auto& x : mesh.coordinates) x = Vec3::scale(unit, x);
      return mesh;
    };
    TEST_EQUALITY(nonMatching(scaled(withOneNodeMoved({0.98e-3 * h, 0, 0}))), "");
    TEST_ASSERT(nonMatching(scaled(withOneNodeMoved({1.02e-3 * h, 0, 0}))) != "");
    ContactSpec spec = contact();
    spec.matchingTolerance = 0.05;
    TEST_EQUALITY(nonMatching(scaled(withOneNodeMoved({0.04 * h, 0, 0})), spec), "");
  }
}

TEUCHOS_UNIT_TEST(ContactRefusal, OtherDivisions) {
  for (const auto& divisions :
       {std::array<int, 3>{5, 3, 1}, {4, 4, 1}, {7, 5, 1}, {1, 1, 1}, {8, 6, 1}, {2, 3, 1}})
    for (const double gap : {0.0, 0.1, 1e3})
      for (const bool swap : {false, true}) {
        Stack stack;  // 8 x 6 is nested: every coarse node has its partner, the fine nodes between have none
        stack.upperDivisions = divisions;
        stack.upperMap = shift({0, 0, gap});
        const ContactSpec spec = swap ? contact("lower_contact", "upper_contact") : contact();
        TEST_ASSERT(nonMatching(makeStack(stack), spec) != "");
        TEST_ASSERT(nonMatching(turned(makeStack(stack), randomRotation(2)), spec) != "");
      }
}

TEUCHOS_UNIT_TEST(ContactRefusal, ShiftedByPartOfAnElement) {
  for (const double part : {0.01, 0.1, 0.5}) {
    Stack stack;
    stack.upperMap = shift({0.5 * part, 0, 0});
    TEST_ASSERT(nonMatching(makeStack(stack)) != "");
  }
  Stack stack;
  stack.upperMap = shift({0.5, 0, 0});  // a whole element: matching, one column of nodes beyond the edge
  TEST_EQUALITY(buildContact(makeStack(stack), {contact()})[0].unpairedNodes, 4u);
}

TEUCHOS_UNIT_TEST(ContactRefusal, ACoarseFaceOverASmallBody) {
  Stack stack;  // no secondary node lies opposite a primary face, and yet the bodies touch
  stack.upperFrom = {-1, -1, 0};
  stack.upperTo = {3, 2, 1};
  stack.upperDivisions = {1, 1, 1};
  const std::string message = nonMatching(makeStack(stack));
  TEST_ASSERT(contains(message, "20 of 20 nodes of side set 'lower_contact'"));
}

TEUCHOS_UNIT_TEST(ContactRefusal, CurvedSurfacesThatDoNotMatch) {
  for (const double gap : {0.0, 0.01, -0.01}) {
    Stack stack;
    stack.lowerDivisions = {16, 4, 1};
    stack.upperDivisions = {15, 4, 1};
    stack.lowerMap = bend(3.0);
    stack.upperMap = bend(3.0, gap);
    TEST_ASSERT(nonMatching(makeStack(stack)) != "");
  }
}

TEUCHOS_UNIT_TEST(ContactRefusal, NodesAtOnePlaceThatCompete) {
  BoxSpec left, right, upper;  // two bodies side by side below one
  left.upper = {1, 1, 1};
  right.lower = {1, 0, 0};
  right.upper = {2, 1, 1};
  upper.lower = {0, 0, 1};
  upper.upper = {2, 1, 2};
  upper.divisions = {2, 1, 1};
  left.sideSetNames[5] = right.sideSetNames[5] = "lower_contact";
  upper.sideSetNames[4] = "upper_contact";
  left.blockName = "left", right.blockName = "right", upper.blockName = "upper";
  const Mesh mesh = makeBoxes({left, right, upper});
  TEST_ASSERT(contains(nonMatching(mesh), "one and the same node"));
  TEST_ASSERT(
      contains(nonMatching(mesh, contact("lower_contact", "upper_contact")), "one and the same node"));

  BoxSpec upperLeft = left, upperRight = right;  // and below two: each node has its own partner again
  upperLeft.map = upperRight.map = shift({0, 0, 1});
  upperLeft.sideSetNames = upperRight.sideSetNames = {"", "", "", "", "upper_contact", ""};
  upperLeft.blockName = "upper left", upperRight.blockName = "upper right";
  const auto interface = buildContact(makeBoxes({left, right, upperLeft, upperRight}), {contact()})[0];
  TEST_EQUALITY(interface.pairs.size(), 8u);
}

TEUCHOS_UNIT_TEST(ContactRefusal, SurfacesThatDoNotFaceEachOther) {
  for (const auto& names : {std::pair<const char*, const char*>{"upper_contact", "lower_bottom"},
                            {"upper_top", "lower_contact"}}) {
    const std::string message = refusal(makeStack({}), contact(names.first, names.second));
    out << message << "\n";
    TEST_ASSERT(contains(message, "do not face each other") && contains(message, "enclose 0 degrees"));
    TEST_ASSERT(contains(message, names.first) && contains(message, names.second));
  }
}

TEUCHOS_UNIT_TEST(ContactRefusal, NothingOppositeAndSurfacesThatLookAway) {
  Stack stack;
  stack.upperMap = shift({5, 0, 0});
  TEST_ASSERT(contains(refusal(makeStack(stack), contact()), "lies opposite"));
  const std::string message = refusal(makeStack({}), contact("upper_top", "lower_bottom"));
  TEST_ASSERT(contains(message, "'upper_top' lies behind 'lower_bottom'") && contains(message, "look away"));
}

TEUCHOS_UNIT_TEST(ContactRefusal, SharedNodes) {
  Mesh mesh = makeStack({});
  TEST_ASSERT(contains(refusal(mesh, contact("lower_contact", "lower_contact")), "in contact with itself"));
  const std::string message = refusal(mesh, contact("lower_contact", "lower_end"));
  TEST_ASSERT(contains(message, describeNode(mesh, nodeAt(mesh, {2, 0, 0}, "lower_contact"))));
  TEST_ASSERT(contains(message, "3 more"));
}

TEUCHOS_UNIT_TEST(ContactRefusal, MissingSideSets) {
  const Mesh mesh = makeStack({});
  for (const auto& spec : {contact("uper_contact"), contact("upper_contact", "uper_contact")}) {
    const std::string message = refusal(mesh, spec);
    TEST_ASSERT(contains(message, "'interface'") && contains(message, "'uper_contact'"));
    TEST_ASSERT(contains(message, listSideSets(mesh)));
  }
}

TEUCHOS_UNIT_TEST(ContactRefusal, WrongSpecs) {
  const Mesh mesh = makeStack({});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ContactSpec spec = contact();
  spec.principalDirection = {0, 0, 0};
  TEST_ASSERT(contains(refusal(mesh, spec), "Principal Direction"));
  spec.principalDirection = {nan, 0, 1};
  TEST_ASSERT(contains(refusal(mesh, spec), "Principal Direction"));
  for (const double tolerance : {0.0, -1.0, 0.3, nan}) {
    spec = contact();
    spec.matchingTolerance = tolerance;
    TEST_ASSERT(contains(refusal(mesh, spec), "tolerance"));
  }
  TEST_ASSERT(contains(refusal(mesh, contact("upper_contact", "")), "either"));
  spec = contact();
  spec.rigidPlane = RigidPlane{{0, 0, 0}, {0, 0, 1}};
  TEST_ASSERT(contains(refusal(mesh, spec), "only one"));
  spec.primarySideSet.clear();
  TEST_EQUALITY(refusal(mesh, spec), "");
  spec.rigidPlane->normal = {0, 0, 0};
  TEST_ASSERT(contains(refusal(mesh, spec), "Normal"));
  spec.rigidPlane->normal = {0, 0, -1};  // away from the body
  TEST_ASSERT(contains(refusal(mesh, spec), "must point to the body"));
  spec.rigidPlane = RigidPlane{{nan, 0, 0}, {0, 0, 1}};
  TEST_ASSERT(contains(refusal(mesh, spec), "Point"));
}

}  // namespace
