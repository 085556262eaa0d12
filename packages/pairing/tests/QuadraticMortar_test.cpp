// SPDX-License-Identifier: BSD-3-Clause
// Dual mortar on faces with middle nodes, alone and against linear ones; ties that are moved together.
#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <map>

#include "ContactScenes.hpp"
#include "Haptos_CellMesh.hpp"
#include "Haptos_DualMortar.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Scenes;

const std::vector<Topology> kQuadratic = {Topology::Hex20, Topology::Hex27, Topology::Tet10};

std::function<Point(const Point&)> distort(double by, double phase) {
  return [=](const Point& x) {
    const double bubble = by * x[0] * (2 - x[0]) * x[1] * (1 - x[1]) * 4;
    return Point{x[0] + bubble * std::sin(9 * x[1] + phase), x[1] + bubble * std::cos(7 * x[0] + phase), x[2]};
  };
}

// A stack of bodies of these elements; `curve` moves all nodes, middles too.
Mesh stackOf(Topology lower, Topology upper, Stack stack, const std::function<Point(const Point&)>& curve = nullptr) {
  const auto box = [](const std::string& name, const Point& from, const Point& to, const std::array<int, 3>& divisions, const auto& map) {
    BoxSpec spec;
    spec.blockName = name;
    spec.lower = from;
    spec.upper = to;
    spec.divisions = divisions;
    spec.map = map;
    return spec;
  };
  BoxSpec a = box("lower", stack.lowerFrom, stack.lowerTo, stack.lowerDivisions, stack.lowerMap);
  BoxSpec b = box("upper", stack.upperFrom, stack.upperTo, stack.upperDivisions, stack.upperMap);
  a.sideSetNames[5] = "lower_contact";
  b.sideSetNames[4] = "upper_contact";
  Mesh mesh = withElements(makeBoxes({a}), lower);
  const Mesh other = withElements(makeBoxes({b}), upper);
  const auto nodes = std::int64_t(mesh.numNodes()), elements = std::int64_t(mesh.numElements());
  mesh.coordinates.insert(mesh.coordinates.end(), other.coordinates.begin(), other.coordinates.end());
  mesh.nodeNumbers.clear();
  mesh.elementNumbers.clear();
  for (auto block : other.blocks) {
    for (auto& node : block.connectivity) node += nodes;
    block.id += 100;
    mesh.blocks.push_back(block);
  }
  for (auto set : other.sideSets) {
    for (auto& side : set.sides) side.element += elements;
    set.id += 100;
    mesh.sideSets.push_back(set);
  }
  if (curve)
    for (auto& x : mesh.coordinates) x = curve(x);
  return mesh;
}

Stack apart() {
  Stack stack;
  stack.lowerDivisions = {5, 3, 1};
  stack.upperDivisions = {7, 4, 1};
  stack.lowerMap = distort(0.1, 0.3);
  stack.upperMap = distort(0.08, 1.1);
  return stack;
}

double sumOf(const std::vector<NodeWeight>& weights) {
  double sum = 0;
  for (const auto& item : weights) sum += item.weight;
  return sum;
}

Point placeOf(const Mesh& mesh, const std::vector<NodeWeight>& weights) {
  Point sum{};
  for (const auto& [node, weight] : weights) sum = Vec3::add(sum, Vec3::scale(weight, mesh.coordinates[std::size_t(node)]));
  return sum;
}

ContactInterface mortarBetween(const Mesh& mesh, bool tied = false, MultiplierSpace space = MultiplierSpace::Automatic) {
  ContactSpec spec = contact();
  spec.discretization = Discretization::Mortar;
  spec.sides = ContactSides::AsGiven;
  spec.multiplierSpace = space;
  spec.tied = tied;
  return buildContact(mesh, {spec})[0];
}

// Finer faces of which supports hold all nodes but one row: multipliers on a line would let the upper body tilt.  Of faces that are held
// whole one node keeps its multiplier, and resists.
TEUCHOS_UNIT_TEST(QuadraticMortar, sides_that_would_leave_one_row_are_not_exchanged) {
  struct Case {
    int across;
    double heldTo;
    bool isUpper;
  };
  for (const Topology element : {Topology::Hex8, Topology::Hex20, Topology::Hex27})
    for (const auto& [across, heldTo, isUpper] : {Case{1, 0.1, true}, Case{2, 0.1, false}, Case{3, 0.7, false}})
      for (const bool isTied : {false, true}) {
        Stack stack;
        stack.lowerDivisions = {9, across, 1};
        stack.upperDivisions = {4, across, 1};
        const Mesh mesh = stackOf(element, element, stack);
        ContactSpec spec = contact();
        spec.discretization = Discretization::Mortar;
        spec.tied = isTied;
        const std::int64_t firstUpper = *std::min_element(mesh.blocks[1].connectivity.begin(), mesh.blocks[1].connectivity.end());
        ContactSurroundings around;
        for (std::int64_t i = 0; i < std::int64_t(mesh.numNodes()); ++i) {
          const char held = i < firstUpper && mesh.coordinates[std::size_t(i)][1] < heldTo;
          around.isPrescribed.push_back({held, held, held});
        }
        const auto secondaryIsUpper = [&] {
          const auto interface = buildContact(mesh, {spec}, around)[0];
          TEST_ASSERT(!interface.pairs.empty());
          return std::all_of(interface.pairs.begin(), interface.pairs.end(), [&](const auto& pair) { return pair.secondaryNode >= firstUpper; });
        };
        TEST_EQUALITY(secondaryIsUpper(), isUpper);
        std::swap(spec.secondarySideSet, spec.primarySideSet);  // whichever is named so
        TEST_EQUALITY(secondaryIsUpper(), isUpper);
      }
}

// A stiff punch on few faces of a soft block: the softer side has one node under it, about which the punch could tilt.
TEUCHOS_UNIT_TEST(QuadraticMortar, sides_that_have_a_node_under_the_other_body_are_not_exchanged) {
  for (const Topology element : {Topology::Hex8, Topology::Hex20}) {
    Stack stack;
    stack.lowerFrom = {-1, -1, -1};
    stack.lowerTo = {1, 1, 0};
    stack.lowerDivisions = {4, 4, 2};
    stack.upperFrom = {-0.3, -0.3, 0};
    stack.upperTo = {0.3, 0.3, 0.6};
    stack.upperDivisions = {6, 6, 1};
    ContactSpec spec = contact();
    spec.discretization = Discretization::Mortar;
    ContactSurroundings around;
    around.youngsModulus = {1, 1000};
    const auto isExchanged = [&](double halfWidth, bool isToldAtNodes) {
      stack.upperFrom = {-halfWidth, -halfWidth, 0};
      stack.upperTo = {halfWidth, halfWidth, 0.6};
      spec.isToldAtNodes = isToldAtNodes;
      return buildContact(stackOf(element, element, stack), {spec}, around)[0].isExchanged;
    };
    TEST_ASSERT(!isExchanged(0.3, false));
    TEST_ASSERT(!isExchanged(0.45, false));
    TEST_ASSERT(isExchanged(0.9, false));
    TEST_ASSERT(!isExchanged(0.9, true));  // friction is told at the nodes of the given side
  }
}

// On a face with all multipliers the row of a corner is its own displacement, that of a middle (5 u_m - u_c1 - u_c2) / 3; of 9 nodes each
// its own.
TEUCHOS_UNIT_TEST(QuadraticMortar, rows_between_plane_surfaces_meshed_apart) {
  for (const Topology upper : kQuadratic)
    for (const Topology lower : {Topology::Hex8, Topology::Hex20, Topology::Tet10}) {
      const Mesh mesh = turned(stackOf(lower, upper, apart()), randomRotation(3));
      const auto interface = mortarBetween(mesh);
      double area = 0;
      std::size_t middles = 0;
      for (const ContactPair& pair : interface.pairs) {
        area += pair.area;
        TEST_COMPARE(std::abs(sumOf(pair.secondary) - 1), <=, 1e-11);
        TEST_COMPARE(std::abs(sumOf(pair.primary) - 1), <=, 1e-11);
        TEST_COMPARE(distance(placeOf(mesh, pair.secondary), placeOf(mesh, pair.primary)), <=, 1e-8);
        std::vector<double> weights;
        for (const auto& item : pair.secondary)
          if (std::abs(item.weight) > 1e-9) weights.push_back(item.weight);
        std::sort(weights.begin(), weights.end());
        if (weights.size() == 1) {
          TEST_FLOATING_EQUALITY(weights[0], 1.0, 1e-9);
          continue;
        }
        ++middles;
        TEST_EQUALITY(weights.size(), 3u);
        TEST_COMPARE(std::abs(weights[0] + 1.0 / 3) + std::abs(weights[1] + 1.0 / 3) + std::abs(weights[2] - 5.0 / 3), <=, 1e-8);
      }
      TEST_FLOATING_EQUALITY(area, 2.0, 1e-8);
      TEST_EQUALITY(middles > 0, upper != Topology::Hex27);
    }
}

TEUCHOS_UNIT_TEST(QuadraticMortar, weights_of_regular_faces) {
  Stack stack;
  stack.lowerDivisions = {3, 2, 1};
  stack.upperDivisions = {1, 1, 1};
  const std::map<Topology, std::vector<double>> expected = {{Topology::Hex20, {1.0 / 20, 1.0 / 5}}, {Topology::Hex27, {1.0 / 36, 1.0 / 9, 4.0 / 9}}};
  for (const auto& [topology, values] : expected)
    for (const auto& pair : mortarBetween(stackOf(Topology::Hex8, topology, stack)).pairs) {
      const double part = pair.area / 2;
      TEST_ASSERT(std::any_of(values.begin(), values.end(), [&](double value) { return std::abs(part - value) < 1e-12; }));
    }
  for (const auto& pair : mortarBetween(stackOf(Topology::Hex8, Topology::Tet10, stack)).pairs) {
    const double part = pair.area;  // of a triangle of area 1; nodes on the diagonal have two
    TEST_ASSERT(std::min({std::abs(part - 2.0 / 15), std::abs(part - 4.0 / 15), std::abs(part - 0.2), std::abs(part - 0.4)}) < 1e-12);
  }
}

TEUCHOS_UNIT_TEST(QuadraticMortar, matching_meshes_have_the_same_weights_on_both_sides) {
  for (const Topology topology : kQuadratic) {
    Stack stack;
    stack.lowerMap = stack.upperMap = distort(0.1, 0.5);
    const Mesh mesh = stackOf(topology, topology, stack, bend(2.5));
    for (const Discretization discretization : {Discretization::Automatic, Discretization::NodeToNode}) {
      ContactSpec spec = contact();
      spec.discretization = discretization;
      const auto interface = buildContact(mesh, {spec})[0];
      TEST_ASSERT(interface.pairs.size() > 40);
      for (const auto& pair : interface.pairs) {
        TEST_COMPARE(std::abs(pair.gap), <=, 1e-12);
        for (const auto& [node, weight] : pair.secondary) {
          double across = 0;
          for (const auto& item : pair.primary)
            if (distance(mesh.coordinates[std::size_t(item.node)], mesh.coordinates[std::size_t(node)]) < 1e-9) across = item.weight;
          TEST_COMPARE(std::abs(across - weight), <=, 1e-11);
        }
      }
    }
  }
}

// Where coverage ends inside faces only corners carry multipliers there.
TEUCHOS_UNIT_TEST(QuadraticMortar, partly_covered_faces) {
  for (const Topology upper : kQuadratic)
    for (const double beyond : {0.003, 0.05, 0.11, 0.2}) {
      Stack stack = apart();
      stack.upperFrom = {-beyond, 0.1, 0};
      stack.upperTo = {2 + beyond, 0.9, 1};
      stack.upperMap = nullptr;
      const Mesh mesh = stackOf(Topology::Hex20, upper, stack);
      for (const MultiplierSpace space : {MultiplierSpace::Automatic, MultiplierSpace::Linear}) {
        const auto interface = mortarBetween(mesh, false, space);
        double area = 0, largest = 0;
        for (const auto& pair : interface.pairs) {
          double norm = 0;
          for (const auto& item : pair.secondary) norm += item.weight * item.weight;
          largest = std::max(largest, std::sqrt(norm));
          area += pair.area;
          TEST_COMPARE(pair.area, >, 1e-4);
          TEST_COMPARE(std::abs(sumOf(pair.secondary) - 1), <=, 1e-10);
          TEST_COMPARE(distance(placeOf(mesh, pair.secondary), placeOf(mesh, pair.primary)), <=, 1e-8);
        }
        TEST_FLOATING_EQUALITY(area, 2 * 0.8, 1e-7);
        TEST_COMPARE(largest, <=, 3.0);
      }
    }
}

// Turning both bodies together leaves a tie alone: after the moves  sum D x_s = sum M x_p.
TEUCHOS_UNIT_TEST(QuadraticMortar, tied_nodes_are_moved_onto_the_opposite_surface) {
  for (const Topology upper : {Topology::Hex8, Topology::Tet4, Topology::Hex20, Topology::Hex27, Topology::Tet10})
    for (const double beyond : {0.0, 0.1}) {
      Stack stack = apart();
      stack.upperFrom = {-beyond, 0, 0};
      stack.upperTo = {2 + beyond, 1, 1};
      if (beyond > 0) stack.upperMap = nullptr;
      Mesh mesh = stackOf(Topology::Hex8, upper, stack, bend(2.5));
      const auto interface = mortarBetween(mesh, true);
      double before = 0, after = 0, farthest = 0;
      const auto largestRest = [&] {
        double largest = 0;
        for (const auto& pair : interface.pairs) largest = std::max(largest, distance(placeOf(mesh, pair.secondary), placeOf(mesh, pair.primary)));
        return largest;
      };
      before = largestRest();
      for (const auto& move : interface.moves) {
        farthest = std::max(farthest, Vec3::norm(move.by));
        auto& x = mesh.coordinates[std::size_t(move.node)];
        x = Vec3::add(x, move.by);
      }
      after = largestRest();
      TEST_ASSERT(before > 1e-3 && !interface.moves.empty());
      TEST_COMPARE(after, <=, 1e-12);
      TEST_COMPARE(farthest, <=, 3 * before);
    }
}

TEUCHOS_UNIT_TEST(QuadraticMortar, over_a_rigid_plane) {
  for (const Topology topology : kQuadratic) {
    const Mesh mesh = stackOf(Topology::Hex8, topology, apart());
    ContactSpec spec = contact();
    spec.primarySideSet = "";
    spec.rigidPlane = RigidPlane{{0, 0, -0.1}, {0, 0, 1}};
    double area = 0;
    const auto interface = buildContact(mesh, {spec})[0];
    for (const auto& pair : interface.pairs) {
      area += pair.area;
      TEST_ASSERT(pair.primary.empty());
      TEST_COMPARE(std::abs(pair.gap - 0.1), <=, 1e-14);
      TEST_COMPARE(std::abs(sumOf(pair.secondary) - 1), <=, 1e-11);
      TEST_COMPARE(distance(placeOf(mesh, pair.secondary), mesh.coordinates[std::size_t(pair.secondaryNode)]), <=, 1e-9);  // straight edges
    }
    TEST_FLOATING_EQUALITY(area, 2.0, 1e-9);
  }
}

// A paraboloid that touches a plane with the middle of an edge: rows get the gaps that they make of those of the nodes, so that closed
// rows mean u_n = g_n; but nothing is pressed from the start.
TEUCHOS_UNIT_TEST(QuadraticMortar, gaps_of_curved_faces_are_those_of_the_rows) {
  constexpr double kCurvature = 1e-3, kPlane = -0.2, kEdge = 2.0 / 7;
  Stack stack = apart();
  stack.upperMap = stack.lowerMap = nullptr;
  stack.lowerTo[2] = kPlane;
  const auto curve = [](const Point& x) {
    if (x[2] < -1e-9) return x;
    return Point{x[0], x[1], x[2] + kPlane + 0.5 * kCurvature * ((x[0] - 1) * (x[0] - 1) + (x[1] - 0.5) * (x[1] - 0.5))};
  };
  for (const Topology topology : kQuadratic)
    for (const bool onPlane : {false, true}) {
      const Mesh mesh = stackOf(Topology::Hex8, topology, stack, curve);
      ContactSpec spec = contact();
      spec.discretization = Discretization::Mortar;
      spec.sides = ContactSides::AsGiven;
      if (onPlane) {
        spec.primarySideSet = "";
        spec.rigidPlane = RigidPlane{{0, 0, kPlane}, {0, 0, 1}};
      }
      int others = 0, touching = 0;
      const auto interface = buildContact(mesh, {spec})[0];
      for (const auto& pair : interface.pairs) {
        double sum = 0;
        for (const auto& [node, weight] : pair.secondary) sum += weight * (mesh.coordinates[std::size_t(node)][2] - kPlane);
        TEST_COMPARE(std::abs(pair.gap - std::max(sum, 0.0)), <=, 0.01 * kCurvature * kEdge * kEdge / 12);
        others += std::abs(sum - (mesh.coordinates[std::size_t(pair.secondaryNode)][2] - kPlane)) > 0.1 * kCurvature * kEdge * kEdge / 12;
        touching += sum < -1e-9;
      }
      TEST_EQUALITY(others >= 20, topology != Topology::Hex27);
      TEST_EQUALITY(touching > 0, topology != Topology::Hex27);
    }
}

}  // namespace
