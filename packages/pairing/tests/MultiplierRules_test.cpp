// SPDX-License-Identifier: BSD-3-Clause
// Which nodes of mortar interfaces carry multipliers: rows stay independent, forces stay complete.
#include <Eigen/Core>
#include <Teuchos_UnitTestHarness.hpp>
#include <map>
#include <set>

#include "ContactScenes.hpp"
#include "DenseAlgebra.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Scenes;

ContactSpec mortar(const std::string& secondary = "upper_contact", const std::string& primary = "lower_contact") {
  ContactSpec spec = contact(secondary, primary);
  spec.name = secondary + " on " + primary;
  spec.discretization = Discretization::Mortar;
  spec.sides = ContactSides::AsGiven;
  return spec;
}

BoxSpec box(const std::string& name, const Point& from, const Point& to, const std::array<int, 3>& divisions) {
  BoxSpec spec;
  spec.blockName = name;
  spec.lower = from;
  spec.upper = to;
  spec.divisions = divisions;
  spec.sideSetNames = {name + "_x0", name + "_x1", name + "_y0", name + "_y1", name + "_z0", name + "_z1"};
  return spec;
}

double areaOf(const ContactInterface& interface) {
  double area = 0;
  for (const auto& pair : interface.pairs) area += pair.area;
  return area;
}

std::set<std::int64_t> nodesOf(const ContactInterface& interface) {
  std::set<std::int64_t> nodes;
  for (const auto& pair : interface.pairs) nodes.insert(pair.secondaryNode);
  return nodes;
}

bool notes(const ContactInterface& interface, const std::string& text) {
  const auto has = [&](const std::vector<std::string>& told) {
    return std::any_of(told.begin(), told.end(), [&](const std::string& note) { return contains(note, text); });
  };
  return has(interface.notes) || has(interface.remarks);
}

// Smallest singular value of the rows of these interfaces, unit vectors of nodes as unknowns; prescribed ones left out.
// \param directions [interfaces] 1: normal rows only, else 3; empty: all 1
double smallestSingularValue(const Mesh& mesh, const std::vector<ContactInterface>& interfaces, const ContactSurroundings& around = {},
                             const std::vector<int>& directions = {}) {
  const auto directionsOf = [&](const ContactInterface& interface) { return directions.empty() ? 1 : directions[std::size_t(&interface - interfaces.data())]; };
  std::size_t rows = 0, row = 0;
  for (const auto& interface : interfaces) rows += interface.pairs.size() * std::size_t(directionsOf(interface));
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(Eigen::Index(rows), 3 * Eigen::Index(mesh.numNodes()));
  for (const auto& interface : interfaces)
    for (const auto& pair : interface.pairs)
      for (int k = 0; k < directionsOf(interface); ++k) {
        const auto& direction = k == 0 ? pair.frame.normal : k == 1 ? pair.frame.t1 : pair.frame.t2;
        for (const auto* side : {&pair.secondary, &pair.primary})
          for (const auto& [node, weight] : *side)
            for (std::size_t d = 0; d < 3; ++d)
              if (around.isPrescribed.empty() || !around.isPrescribed[std::size_t(node)][d])
                B(Eigen::Index(row), 3 * node + Eigen::Index(d)) += (side == &pair.secondary ? weight : -weight) * direction[d];
        ++row;
      }
  return Testing::singularValues(B).tail(1)[0];
}

// Two bodies side by side below one: the nodes over the joint belong to the one that covers more.
TEUCHOS_UNIT_TEST(MultiplierRules, a_surface_over_two_bodies) {
  const double joint = 6.0 / 7;  // at nodes of the upper body
  for (const bool isTied : {false, true}) {
    const Mesh mesh = makeBoxes({box("left", {0, 0, -1}, {joint, 1, 0}, {3, 2, 1}), box("right", {joint, 0, -1}, {2, 1, 0}, {4, 3, 1}),
                                 box("upper", {0, 0, 0}, {2, 1, 1}, {7, 4, 1})});
    auto first = mortar("upper_z0", "left_z1"), second = mortar("upper_z0", "right_z1");
    first.tied = isTied;
    const auto interfaces = buildContact(mesh, {first, second});
    TEST_FLOATING_EQUALITY(areaOf(interfaces[0]), joint, 1e-12);
    TEST_FLOATING_EQUALITY(areaOf(interfaces[1]), 2 - joint, 1e-12);
    std::vector<std::int64_t> both;
    const auto a = nodesOf(interfaces[0]), b = nodesOf(interfaces[1]);
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
    TEST_ASSERT(both.empty());
    TEST_EQUALITY(a.size() + b.size(), 40u);
    TEST_ASSERT(notes(interfaces[isTied ? 1 : 0], "secondary in another contact") != notes(interfaces[isTied ? 0 : 1], "secondary in another contact"));
    TEST_COMPARE(smallestSingularValue(mesh, interfaces), >, 0.3);
  }
}

// A beam in a groove: without friction, nodes along its edge touch both faces.
TEUCHOS_UNIT_TEST(MultiplierRules, faces_that_meet_at_an_edge) {
  const Mesh mesh = makeBoxes({box("floor", {0, 0, -1}, {1, 1, 0}, {3, 2, 1}), box("wall", {-1, 0, 0}, {0, 1, 1}, {1, 2, 4}),
                               box("block", {0, 0, 0}, {1, 1, 1}, {4, 3, 3})});
  for (const bool isFrictionless : {true, false}) {
    auto floor = mortar("block_z0", "floor_z1"), wall = mortar("block_x0", "wall_x1");
    floor.isFrictionless = wall.isFrictionless = isFrictionless;
    const auto interfaces = buildContact(mesh, {floor, wall});
    TEST_EQUALITY(interfaces[0].pairs.size() + interfaces[1].pairs.size(), isFrictionless ? 20u + 16u : 20u + 16u - 4u);
    TEST_EQUALITY(notes(interfaces[0], "another contact") || notes(interfaces[1], "another contact"), !isFrictionless);
    TEST_FLOATING_EQUALITY(areaOf(interfaces[0]) + areaOf(interfaces[1]), 2.0, 1e-12);
    TEST_COMPARE(smallestSingularValue(mesh, interfaces), >, 0.3);
  }
}

// The same with one side set for both faces, on either side: what two contacts would give, with the normals of the faces along the edge.
TEUCHOS_UNIT_TEST(MultiplierRules, a_crease_in_a_side_set_parts_it) {
  Mesh mesh = makeBoxes({box("floor", {0, 0, -1}, {1, 1, 0}, {3, 2, 1}), box("wall", {-1, 0, 0}, {0, 1, 1}, {1, 2, 4}),
                         box("block", {0, 0, 0}, {1, 1, 1}, {4, 3, 3})});
  const auto unite = [&](const std::string& name, const std::string& a, const std::string& b) {
    SideSet set{std::int64_t(mesh.sideSets.size()) + 1, name, mesh.sideSets[std::size_t(findSideSet(mesh, a))].sides};
    const auto& more = mesh.sideSets[std::size_t(findSideSet(mesh, b))].sides;
    set.sides.insert(set.sides.end(), more.begin(), more.end());
    mesh.sideSets.push_back(set);
  };
  unite("edge", "block_z0", "block_x0");
  unite("groove", "floor_z1", "wall_x1");
  for (const bool isFrictionless : {true, false}) {
    auto floor = mortar("block_z0", "floor_z1"), wall = mortar("block_x0", "wall_x1"), both = mortar("edge", "groove");
    floor.isFrictionless = wall.isFrictionless = both.isFrictionless = isFrictionless;
    const auto apart = buildContact(mesh, {floor, wall}), one = buildContact(mesh, {both});
    TEST_EQUALITY(one[0].pairs.size(), isFrictionless ? 20u + 16u : 20u + 16u - 4u);
    TEST_EQUALITY(notes(one[0], "lie on a crease"), !isFrictionless);
    TEST_ASSERT(notes(one[0], "creases into 2"));
    TEST_EQUALITY(one[0].unpairedNodes, 0u);
    for (const auto& pair : one[0].pairs) {
      const auto& n = pair.frame.normal;
      const auto& same = apart[n[2] < -0.5 ? 0 : 1].pairs;
      const auto found = std::find_if(same.begin(), same.end(), [&](const ContactPair& p) { return p.secondaryNode == pair.secondaryNode; });
      TEST_ASSERT(found != same.end());
      if (found == same.end()) continue;
      TEST_COMPARE(Vec3::norm(Vec3::subtract(n, found->frame.normal)), <, 1e-14);
      TEST_FLOATING_EQUALITY(pair.area, found->area, 1e-13);
      TEST_EQUALITY(pair.primary.size(), found->primary.size());
    }
    TEST_COMPARE(smallestSingularValue(mesh, one), >, 0.3);
  }
}

// Also where the meshes match, as a node on a crease has one pair node to node, with a normal of neither face; but for ties, which have none.
TEUCHOS_UNIT_TEST(MultiplierRules, surfaces_with_creases_are_joined_by_mortar) {
  Mesh mesh = makeBoxes({box("floor", {0, 0, -1}, {1, 1, 0}, {3, 2, 1}), box("wall", {-1, 0, 0}, {0, 1, 1}, {1, 2, 3}),
                         box("block", {0, 0, 0}, {1, 1, 1}, {3, 2, 3})});
  for (const auto& [name, a, b] : {std::array<std::string, 3>{"edge", "block_z0", "block_x0"}, {"groove", "floor_z1", "wall_x1"}}) {
    SideSet set{std::int64_t(mesh.sideSets.size()) + 1, name, mesh.sideSets[std::size_t(findSideSet(mesh, a))].sides};
    const auto& more = mesh.sideSets[std::size_t(findSideSet(mesh, b))].sides;
    set.sides.insert(set.sides.end(), more.begin(), more.end());
    mesh.sideSets.push_back(set);
  }
  auto both = mortar("edge", "groove"), floor = mortar("block_z0", "floor_z1");
  both.discretization = floor.discretization = Discretization::Automatic;
  both.isFrictionless = true;
  const auto creased = buildContact(mesh, {both})[0];
  TEST_ASSERT(creased.isMortar && notes(creased, "has creases"));
  TEST_EQUALITY(creased.pairs.size(), 12u + 12u);  // nodes along the edge have a pair for either face
  for (const auto& pair : creased.pairs) TEST_ASSERT(std::max(-pair.frame.normal[0], -pair.frame.normal[2]) > 1 - 1e-12);
  TEST_ASSERT(!buildContact(mesh, {floor})[0].isMortar);
  both.tied = true;
  TEST_ASSERT(!notes(buildContact(mesh, {both})[0], "has creases"));
}

// Meshes that match: pairs of three bodies that meet along a line go round in a circle there, unless their normals hold different directions.
TEUCHOS_UNIT_TEST(MultiplierRules, three_bodies_that_meet) {
  const Mesh mesh = makeBoxes({box("left", {0, 0, -1}, {1, 1, 0}, {2, 2, 2}), box("right", {1, 0, -1}, {2, 1, 0}, {2, 2, 2}),
                               box("bridge", {0, 0, 0}, {2, 1, 1}, {4, 2, 1})});
  std::vector<ContactSpec> specs = {mortar("left_x1", "right_x0"), mortar("left_z1", "bridge_z0"), mortar("right_z1", "bridge_z0")};
  for (auto& spec : specs) spec.discretization = Discretization::Automatic;
  // without friction: none, the sides, the feet, all
  for (const auto& [side, feet] : {std::array<bool, 2>{false, false}, {true, false}, {false, true}, {true, true}}) {
    specs[0].isFrictionless = side;
    specs[1].isFrictionless = specs[2].isFrictionless = feet;
    const auto interfaces = buildContact(mesh, specs);
    const bool isFree = side && feet;
    std::size_t pairs = 0;
    for (const auto& interface : interfaces) {
      pairs += interface.pairs.size();
      TEST_EQUALITY(interface.isMortar, notes(interface, "close circles with pairs of other contacts"));
      TEST_EQUALITY(interface.isMortar, notes(interface, "joined by mortar (pairs of single nodes close circles"));
    }
    TEST_EQUALITY(pairs, isFree ? 27u : 24u);
    TEST_COMPARE(smallestSingularValue(mesh, interfaces, {}, {side ? 1 : 3, feet ? 1 : 3, feet ? 1 : 3}), >, 0.1);
  }
  for (auto& spec : specs) {
    spec.discretization = Discretization::NodeToNode;
    spec.isFrictionless = false;
  }
  const auto asked = buildContact(mesh, specs);
  TEST_ASSERT(notes(asked[2], "forces there are not unique"));
  TEST_COMPARE(smallestSingularValue(mesh, asked, {}, {3, 3, 3}), <, 1e-12);
}

// Three plates in a row need no rule; both surfaces of one interface as secondary ones do.
TEUCHOS_UNIT_TEST(MultiplierRules, circles_are_cut_and_chains_are_not) {
  const Mesh chain = makeBoxes({box("a", {0, 0, 0}, {1, 1, 1}, {2, 2, 1}), box("b", {0, 0, 1}, {1, 1, 2}, {3, 3, 1}), box("c", {0, 0, 2}, {1, 1, 3}, {4, 4, 1})});
  const auto three = buildContact(chain, {mortar("b_z0", "a_z1"), mortar("c_z0", "b_z1")});
  TEST_ASSERT(three[0].notes.empty() && three[1].notes.empty());
  TEST_EQUALITY(three[0].pairs.size() + three[1].pairs.size(), 16u + 25u);
  const auto circle = buildContact(chain, {mortar("b_z0", "a_z1"), mortar("a_z1", "b_z0")});
  TEST_EQUALITY(circle[0].pairs.size(), 16u);
  TEST_EQUALITY(circle[1].pairs.size(), 0u);
  TEST_ASSERT(notes(circle[1], "are primary in"));
}

// The edge is clamped on both sides: its nodes have no multiplier, those beside them take their part of the force.
TEUCHOS_UNIT_TEST(MultiplierRules, held_nodes) {
  const Mesh mesh = makeBoxes({box("lower", {0, 0, -1}, {2, 1, 0}, {5, 3, 1}), box("upper", {0, 0, 0}, {2, 1, 1}, {7, 4, 1})});
  ContactSurroundings around;
  around.isPrescribed.assign(mesh.numNodes(), {});
  for (std::size_t i = 0; i < mesh.numNodes(); ++i)
    if (mesh.coordinates[i][0] < 1e-9) around.isPrescribed[i] = {1, 1, 1};
  const auto clamped = buildContact(mesh, {mortar("upper_z0", "lower_z1")}, around);
  TEST_EQUALITY(clamped[0].pairs.size(), 35u);
  TEST_FLOATING_EQUALITY(areaOf(clamped[0]), 2.0, 1e-12);
  TEST_ASSERT(notes(clamped[0], "5 nodes of 'upper_z0' are held"));
  TEST_COMPARE(smallestSingularValue(mesh, clamped, around), >, 0.3);
  // a roller along the axis t1: the normal row stays, T1 is pinned
  for (auto& held : around.isPrescribed) held = {held[0], 0, 0};
  const auto roller = buildContact(mesh, {mortar("upper_z0", "lower_z1")}, around);
  TEST_EQUALITY(roller[0].pairs.size(), 40u);
  for (const auto& pair : roller[0].pairs) {
    const bool isAtRoller = mesh.coordinates[std::size_t(pair.secondaryNode)][0] < 1e-9;
    TEST_EQUALITY(bool(pair.isPinned[1]), isAtRoller);
    TEST_ASSERT(!pair.isPinned[0] && !pair.isPinned[2]);
  }
}

// A secondary surface that is driven: what is below must not pass, so every face keeps a multiplier; sides are exchanged where that is allowed.
TEUCHOS_UNIT_TEST(MultiplierRules, a_driven_secondary_surface) {
  const Mesh mesh = makeBoxes({box("lower", {0, 0, -1}, {2, 1, 0}, {9, 5, 1}), box("upper", {0, 0, 0}, {2, 1, 1}, {3, 2, 1})});
  ContactSurroundings around;
  around.isPrescribed.assign(mesh.numNodes(), {});
  for (std::size_t i = 0; i < mesh.numNodes(); ++i)
    if (mesh.coordinates[i][2] > 0.5 || i >= 60 * 2) around.isPrescribed[i] = {0, 0, 1};
  auto spec = mortar("upper_z0", "lower_z1");
  const auto given = buildContact(mesh, {spec}, around)[0];
  TEST_FLOATING_EQUALITY(areaOf(given), 2.0, 1e-12);
  TEST_ASSERT(!given.pairs.empty() && notes(given, "held by prescribed"));
  TEST_COMPARE(smallestSingularValue(mesh, {given}, around), >, 0.05);
  spec.sides = ContactSides::Automatic;
  const auto exchanged = buildContact(mesh, {spec}, around)[0];
  TEST_EQUALITY(exchanged.pairs.size(), 60u);
  TEST_FLOATING_EQUALITY(areaOf(exchanged), 2.0, 1e-12);
}

// A slit: nodes at its tip are on both sides.
TEUCHOS_UNIT_TEST(MultiplierRules, crack_tips) {
  for (const auto& divisions : {std::array<int, 3>{4, 2, 1}, std::array<int, 3>{6, 3, 1}}) {
    Mesh mesh = makeBoxes({box("lower", {0, 0, -1}, {2, 1, 0}, {4, 2, 1}), box("upper", {0, 0, 0}, {2, 1, 1}, divisions)});
    const auto at = [&](std::int64_t node) { return mesh.coordinates[std::size_t(node)]; };
    std::size_t joined = 0;  // the front at x = 2 is one, where both have nodes
    for (auto& node : mesh.blocks[1].connectivity)
      for (std::int64_t other = 0; other < 5 * 3 * 2 && at(node)[0] > 2 - 1e-9; ++other)
        if (node != other && distance(at(node), at(other)) < 1e-9) node = other, ++joined;
    TEST_ASSERT(joined > 0);
    auto spec = mortar("upper_z0", "lower_z1");
    spec.discretization = Discretization::Automatic;
    const auto interface = buildContact(mesh, {spec})[0];
    TEST_EQUALITY(interface.isMortar, divisions[0] != 4);
    for (const auto& pair : interface.pairs)
      for (const auto& item : pair.primary) TEST_ASSERT(item.node != pair.secondaryNode);
    if (!interface.isMortar) TEST_EQUALITY(interface.pairs.size(), 12u);
    if (interface.isMortar) TEST_FLOATING_EQUALITY(areaOf(interface), 2.0, 1e-12);
    TEST_ASSERT(notes(interface, interface.isMortar ? "are on both sides" : "take no part"));
    TEST_COMPARE(smallestSingularValue(mesh, {interface}), >, 0.3);
  }
}

TEUCHOS_UNIT_TEST(MultiplierRules, surfaces_that_look_away_are_refused) {
  const Mesh mesh = makeBoxes({box("lower", {0, 0, -1}, {2, 1, 0}, {5, 3, 1}), box("upper", {0, 0, 0}, {2, 1, 1}, {7, 4, 1}),
                               box("far", {5, 5, 0}, {6, 6, 1}, {2, 2, 2})});
  TEST_ASSERT(contains(refusal(mesh, mortar("upper_z1", "lower_z0")), "look away"));
  TEST_ASSERT(contains(refusal(mesh, mortar("upper_z1", "lower_z1")), "lies opposite"));
  TEST_ASSERT(contains(refusal(mesh, mortar("far_z0", "lower_z1")), "lies opposite"));
  TEST_EQUALITY(refusal(mesh, mortar("upper_z0", "lower_z1")), "");
}

}  // namespace
