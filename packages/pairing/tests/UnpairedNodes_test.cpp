// SPDX-License-Identifier: BSD-3-Clause
// Nodes that nothing lies opposite at the start, and what displacements carry them to.
#include <Teuchos_UnitTestHarness.hpp>

#include "ContactScenes.hpp"
#include "Haptos_UnpairedNodes.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Scenes;

// The upper body stands out by 0.5 to the right, 0.1 above the lower one.
Stack overhang(const std::array<int, 3>& upperDivisions = {8, 3, 1}) {
  Stack stack;
  stack.lowerDivisions = {6, 3, 1};
  stack.lowerTo = {1.5, 1, 0};
  stack.upperFrom = {0, 0, 0.1};
  stack.upperDivisions = upperDivisions;
  return stack;
}

// \param upper, lower how the bodies move
std::vector<ContactPair> carried(const Mesh& mesh, const ContactInterface& interface, const Point& upper, const Point& lower, double tolerance) {
  std::vector<Point> u;
  for (const auto node : interface.unpaired->meshNodes()) u.push_back(mesh.coordinates[std::size_t(node)][2] > 0.05 ? upper : lower);
  return interface.unpaired->pairsUnder(u, tolerance);
}

TEUCHOS_UNIT_TEST(UnpairedNodes, CarriedOverTheEdge) {
  for (const bool isMortar : {false, true}) {
    const Mesh mesh = makeStack(overhang(isMortar ? std::array<int, 3>{7, 4, 1} : std::array<int, 3>{8, 3, 1}));
    ContactSpec spec = contact();
    spec.discretization = isMortar ? Discretization::Mortar : Discretization::Automatic;
    spec.sides = ContactSides::AsGiven;
    const auto interface = buildContact(mesh, {spec})[0];
    TEST_EQUALITY(interface.isMortar, isMortar);
    TEST_ASSERT(interface.unpairedNodes > 0 && interface.unpaired);
    // downwards alone, sideways alone, and both without reaching the floor
    TEST_EQUALITY(carried(mesh, interface, {0, 0, -0.3}, {0, 0, 0}, 1e-9).size(), 0u);
    TEST_EQUALITY(carried(mesh, interface, {-0.3, 0, 0}, {0, 0, 0}, 1e-9).size(), 0u);
    TEST_EQUALITY(carried(mesh, interface, {-0.3, 0, -0.099}, {0, 0, 0}, 1e-9).size(), 0u);
    TEST_EQUALITY(carried(mesh, interface, {-0.3, 0, -0.12}, {0, 0, 0}, 0.03).size(), 0u);
    TEST_EQUALITY(carried(mesh, interface, {-0.3, 0, -0.5}, {0, 0, 0}, 1e-9).size(), 0u);  // deeper than elements are large
    // what counts is the motion against each other
    for (const double part : {0.0, 0.4, 1.0}) {
      const Point upper{-part * 0.3, 0, -part * 0.12}, lower{(1 - part) * 0.3, 0, (1 - part) * 0.12};
      const auto pairs = carried(mesh, interface, upper, lower, 1e-9);
      std::size_t expected = 0;
      for (const auto node : interface.unpaired->meshNodes())
        expected += mesh.coordinates[std::size_t(node)][2] > 0.05 && mesh.coordinates[std::size_t(node)][0] < 1.8;
      TEST_ASSERT(expected > 0);
      TEST_EQUALITY(pairs.size(), expected);
      for (const auto& pair : pairs) {
        Point met{0, 0, 0};
        double sum = 0;
        for (const auto& [node, weight] : pair.primary) {
          met = Vec3::add(met, Vec3::scale(weight, Vec3::add(mesh.coordinates[std::size_t(node)], lower)));
          sum += weight;
        }
        const Point own = Vec3::add(mesh.coordinates[std::size_t(pair.secondaryNode)], upper);
        TEST_FLOATING_EQUALITY(sum, 1.0, 1e-13);
        TEST_FLOATING_EQUALITY(pair.gap, 0.1, 1e-12);
        TEST_COMPARE(distance(met, {own[0], own[1], own[2] + 0.02}), <, 1e-13);
      }
    }
  }
}

// Beside the lower body stands a block of the upper side, whose foot is moved into the other's wall: faces that it starts behind do not count, nor
// does the bottom, which looks away.
TEUCHOS_UNIT_TEST(UnpairedNodes, OtherSidesAreNotMet) {
  for (const double foot : {0.1, -0.2}) {
    BoxSpec lower, upper, block;
    lower.upper = {1.5, 1, 0};
    lower.lower[2] = -0.5;
    lower.divisions = {6, 3, 1};
    lower.sideSetNames = {"", "", "", "", "lower_contact", "lower_contact"};
    upper.lower = {0, 0, 0.1};
    upper.upper = {1, 1, 1};
    upper.divisions = {4, 3, 1};
    upper.sideSetNames = block.sideSetNames = {"", "", "", "", "upper_contact", ""};
    block.lower = {1.625, 0, foot};
    block.upper = {2.125, 1, 1};
    block.divisions = {2, 3, 1};
    const Mesh mesh = makeBoxes({lower, upper, block});
    const auto interface = buildContact(mesh, {contact()})[0];
    TEST_EQUALITY(interface.unpairedNodes, 12u);
    std::vector<Point> u;
    for (const auto node : interface.unpaired->meshNodes()) u.push_back(node < 7 * 4 * 2 ? Point{0, 0, 0} : Point{-0.5, 0, -0.15});
    TEST_EQUALITY(interface.unpaired->pairsUnder(u, 1e-9).size(), foot < 0 ? 0u : 8u);
  }
}

TEUCHOS_UNIT_TEST(UnpairedNodes, GivenGapsCount) {
  const Mesh mesh = makeStack(overhang());
  ContactSpec spec = contact();
  spec.gapAt = [](std::int64_t) { return 0.15; };
  const auto given = buildContact(mesh, {spec})[0];
  TEST_EQUALITY(carried(mesh, given, {-0.3, 0, -0.14}, {0, 0, 0}, 1e-9).size(), 0u);
  const auto pairs = carried(mesh, given, {-0.3, 0, -0.2}, {0, 0, 0}, 1e-9);
  TEST_EQUALITY(pairs.size(), 4u);
  for (const auto& pair : pairs) TEST_FLOATING_EQUALITY(pair.gap, 0.15, 1e-15);
}

// Nodes that supports hold along n, or that another contact holds, never get a row.
TEUCHOS_UNIT_TEST(UnpairedNodes, HeldNodesAreLeftOut) {
  const Mesh mesh = makeStack(overhang());
  ContactSurroundings around;
  around.isPrescribed.assign(mesh.numNodes(), {});
  const auto free = buildContact(mesh, {contact()}, around)[0];
  const std::size_t all = carried(mesh, free, {-0.6, 0, -0.2}, {0, 0, 0}, 1e-9).size();
  TEST_EQUALITY(all, free.unpairedNodes);
  for (std::size_t i = 0; i < mesh.numNodes(); ++i)
    if (mesh.coordinates[i][1] < 1e-9) around.isPrescribed[i] = {0, 0, 1};
  const auto held = buildContact(mesh, {contact()}, around)[0];
  TEST_EQUALITY(held.unpairedNodes, all);
  TEST_EQUALITY(carried(mesh, held, {-0.6, 0, -0.2}, {0, 0, 0}, 1e-9).size(), all - all / 4);
}

}  // namespace
