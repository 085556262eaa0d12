// SPDX-License-Identifier: BSD-3-Clause
// Where surfaces of contact end, meet and share: a slit in one body and its tip, T-joints, several bodies on one surface, a corner.
// ANALYTIC but for the last: all bodies are strained uniformly, with the pressure of the load wherever they touch.
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "Haptos_CellMesh.hpp"
#include "ScenarioBuilder.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Verification;

constexpr double kDown = 100, kAside = 40, kE = 1e6, kNu = 0.3;

int ranks() { return Tpetra::getDefaultComm()->getSize(); }

BoxSpec box(const std::string& name, const Array3& lower, const Array3& upper, const std::array<int, 3>& divisions,
            const std::array<std::string, 6>& sides) {
  BoxSpec spec;
  spec.blockName = name;
  spec.lower = lower;
  spec.upper = upper;
  spec.divisions = divisions;
  spec.sideSetNames = sides;
  return spec;
}

// One node where several lie at one place, but for those of the upper and lower side of a slit in z = 0, x < tip.
Mesh joined(Mesh mesh, double tip) {
  std::map<std::array<long, 4>, std::int64_t> known;
  std::vector<std::int64_t> target(mesh.numNodes());
  for (auto& block : mesh.blocks)
    for (auto& node : block.connectivity) {
      const auto& x = mesh.coordinates[std::size_t(node)];
      const bool isAtSlit = std::abs(x[2]) < 1e-9 && x[0] < tip - 1e-9;
      const auto key = [](double value) { return std::lround(value * 1e6); };
      node = known.emplace(std::array<long, 4>{key(x[0]), key(x[1]), key(x[2]), isAtSlit && block.name[0] == 'u'}, node).first->second;
    }
  return mesh;
}

// Supports at x-, y-, bottom; the top and x+ are pressed.
ScenarioBuilder& load(ScenarioBuilder& scene, double aside) {
  scene.displacement({"x-"}, "x", {0, 0, 0}).displacement({"y-"}, "y", {0, 0, 0}).displacement({"bottom"}, "z", {0, 0, 0}).pressure({"top"}, kDown);
  if (aside > 0) scene.pressure({"x+"}, aside);
  return scene.contactOption("Sides", "As Given").decomposition("METIS", 5).tolerance(1e-11);
}

// Pressures are those of the loads, kDown along z and `aside` along x, nothing is sheared, and both areas are what they should be.
void checkForces(const SimulationResult& result, double aside, const std::array<double, 2>& areas, Teuchos::FancyOStream& out, bool& success) {
  double pressure = 0, shear = 0;
  std::array<double, 2> found{0, 0};
  for (const auto& pair : result.pairs) {
    const bool isAside = std::abs(pair.normal[0]) > 0.9;
    const double wanted = isAside ? aside : kDown;
    found[isAside] += pair.area;
    pressure = std::max(pressure, std::abs(pair.normalForce / (pair.area * wanted) - 1));
    for (double t : pair.tangentialForce) shear = std::max(shear, std::abs(t) / (pair.area * kDown));
  }
  out << result.pairs.size() << " pairs, pressure off by " << pressure << ", shear " << shear << ", areas " << found[0] << ", " << found[1] << "\n";
  TEST_COMPARE(pressure, <=, 1e-8);
  TEST_COMPARE(shear, <=, 1e-8);
  for (std::size_t k = 0; k < 2; ++k) TEST_COMPARE(std::abs(found[k] - areas[k]), <=, 1e-9);
}

// Of the nodes that have elements: u = (a x, b y, c z) from the supports.
void checkDisplacements(const Mesh& mesh, const SimulationResult& result, double aside, double bottom, Teuchos::FancyOStream& out, bool& success) {
  const Array3 stress = {-aside, 0, -kDown};
  std::vector<char> isUsed(mesh.numNodes(), 0);
  for (const auto& block : mesh.blocks)
    for (const auto node : block.connectivity) isUsed[std::size_t(node)] = 1;
  double error = 0;
  for (std::size_t i = 0; i < mesh.numNodes(); ++i)
    for (std::size_t c = 0; isUsed[i] && c < 3; ++c) {
      const double strain = ((1 + kNu) * stress[c] - kNu * (stress[0] + stress[1] + stress[2])) / kE;
      const double exact = strain * (mesh.coordinates[i][c] - (c == 2 ? bottom : 0));
      error = std::max(error, std::abs(result.displacement[3 * i + c] - exact) * kE / kDown);
    }
  out << "displacements off by " << error << ", " << result.report.solver.hessianMultiplications << " multiplications\n";
  TEST_COMPARE(error, <=, 1e-8);
}

ScenarioBuilder& steel(ScenarioBuilder& scene) {
  for (const auto& block : scene.mesh().blocks) scene.material(block.name, kE, kNu);
  return scene;
}

// A body against itself: the slit starts at the side and ends within.
void checkSlit(Topology topology, int upperCells, const Friction* friction, Teuchos::FancyOStream& out, bool& success) {
  const Mesh bricks = joined(makeBoxes({box("ll", {0, 0, -1}, {1, 1, 0}, {3, 2, 2}, {"x-", "", "y-", "", "bottom", "slit_below"}),
                                        box("lr", {1, 0, -1}, {2, 1, 0}, {2, 2, 2}, {"", "x+", "y-", "", "bottom", ""}),
                                        box("ul", {0, 0, 0}, {1, 1, 1}, {upperCells, 2, 2}, {"x-", "", "y-", "", "slit_above", "top"}),
                                        box("ur", {1, 0, 0}, {2, 1, 1}, {2, 2, 2}, {"", "x+", "y-", "", "", "top"})}), 1);
  ScenarioBuilder scene(topology == Topology::Hex8 ? bricks : withElements(bricks, topology));
  steel(scene).contact("slit_above", "slit_below", friction).contactOption("Discretization", "Automatic");
  const auto result = load(scene, 0).solve();
  TEST_ASSERT(result.solved);
  TEST_EQUALITY(result.report.model.bodies, 1);
  const bool isMortar = topology != Topology::Hex8 || upperCells != 3;
  TEST_EQUALITY(result.report.model.discretization, isMortar ? "Mortar" : "Node To Node");
  if (result.pairs.empty()) return;  // not the root
  // node to node, the nodes of the tip carry their part without a pair: a third of an element's breadth, halved
  checkForces(result, 0, {isMortar ? 1.0 : 1 - 1.0 / 6, 0}, out, success);
  checkDisplacements(scene.mesh(), result, 0, -1, out, success);
}

TEUCHOS_UNIT_TEST(Joints, a_slit_in_one_body) {
  const Friction friction{"Coulomb", {0.3, 0.3}};
  for (const Topology topology : {Topology::Hex8, Topology::Hex20, Topology::Tet10})
    for (const int cells : {3, 4}) {
      if (ranks() > 1 && topology != Topology::Hex8) continue;
      checkSlit(topology, cells, nullptr, out, success);
      checkSlit(topology, cells, &friction, out, success);
    }
}

// Two bodies beside each other carry a third one.
Mesh tee(Topology topology, bool isMatching) {
  const int n = isMatching ? 2 : 3;
  const Mesh bricks = makeBoxes({box("left", {0, 0, -1}, {1, 1, 0}, {2, 2, 2}, {"x-", "left_side", "y-", "", "bottom", "left_top"}),
                                 box("right", {1, 0, -1}, {2, 1, 0}, {2, n, isMatching ? 2 : 3}, {"right_side", "x+", "y-", "", "bottom", "right_top"}),
                                 box("bridge", {0, 0, 0}, {2, 1, 1}, {isMatching ? 4 : 5, n, 2}, {"x-", "x+", "y-", "", "foot", "top"})});
  return topology == Topology::Hex8 ? bricks : withElements(bricks, topology);
}

Mesh withUnion(Mesh mesh, const std::string& name, const std::vector<std::string>& parts) {
  SideSet all{std::int64_t(mesh.sideSets.size()) + 1, name, {}};
  for (const auto& part : parts) {
    const auto& sides = mesh.sideSets[std::size_t(findSideSet(mesh, part))].sides;
    all.sides.insert(all.sides.end(), sides.begin(), sides.end());
  }
  mesh.sideSets.push_back(std::move(all));
  return mesh;
}

// \param foot what the bridge stands on: two contacts with their tops as secondary sides, or one set of both as either side
// \param laws between the two bodies, below the bridge; null: no friction
void checkTee(Topology topology, bool isMatching, const std::string& foot, std::array<const Friction*, 2> laws, Teuchos::FancyOStream& out, bool& success) {
  const auto [side, friction] = laws;
  ScenarioBuilder scene(withUnion(tee(topology, isMatching), "tops", {"left_top", "right_top"}));
  steel(scene).contact("left_side", "right_side", side);
  if (foot == "two contacts") scene.contact("left_top", "foot", friction).contact("right_top", "foot", friction);
  else if (foot == "secondary") scene.contact("tops", "foot", friction);
  else scene.contact("foot", "tops", friction);
  scene.contactOption("Discretization", "Automatic");
  const auto result = load(scene, kAside).solve();
  TEST_ASSERT(result.solved);
  TEST_EQUALITY(result.report.model.bodies, 3);
  if (result.pairs.empty()) return;  // not the root
  checkForces(result, kAside, {2, 1}, out, success);
  checkDisplacements(scene.mesh(), result, kAside, -1, out, success);
}

TEUCHOS_UNIT_TEST(Joints, a_bridge_on_two_bodies) {
  const Friction friction{"Coulomb", {0.3, 0.3}}, tied{"Tied"};
  const std::vector<std::array<const Friction*, 2>> laws = {{nullptr, nullptr}, {&friction, &friction}, {nullptr, &friction}, {&friction, nullptr}, {&tied, &friction}, {&tied, &tied}};
  for (const Topology topology : {Topology::Hex8, Topology::Hex20, Topology::Tet10})
    for (const bool isMatching : {true, false})
      for (const char* foot : {"two contacts", "secondary", "primary"}) {
        if (ranks() > 1 && (topology != Topology::Hex8 || foot != std::string("two contacts"))) continue;
        out << topologyName(topology) << (isMatching ? ", matching, " : ", ") << foot << "\n";
        for (std::size_t k = 0; k < (topology == Topology::Hex8 ? laws.size() : 2); ++k) checkTee(topology, isMatching, foot, laws[k], out, success);
      }
}

// A block in a corner, by two contacts or by one that is cut along its crease.
TEUCHOS_UNIT_TEST(Joints, a_block_in_a_corner) {
  const Friction friction{"Coulomb", {0.3, 0.3}};
  for (const Topology topology : {Topology::Hex8, Topology::Hex20})
    for (const bool isOne : {false, true})
      for (const Friction* law : {static_cast<const Friction*>(nullptr), &friction}) {
        if (ranks() > 1 && topology != Topology::Hex8) continue;
        const Mesh bricks = makeBoxes({box("floor", {0, 0, -1}, {1, 1, 0}, {3, 2, 1}, {"floor_x", "", "y-", "", "bottom", "floor_top"}),
                                       box("wall", {-1, 0, 0}, {0, 1, 1}, {1, 2, 4}, {"x-", "wall_side", "y-", "", "bottom_of_wall", ""}),
                                       box("block", {0, 0, 0}, {1, 1, 1}, {4, 3, 3}, {"block_side", "x+", "y-", "", "block_foot", "top"})});
        const Mesh mesh = topology == Topology::Hex8 ? bricks : withElements(bricks, topology);
        ScenarioBuilder scene(withUnion(withUnion(mesh, "corner", {"floor_top", "wall_side"}), "edge", {"block_foot", "block_side"}));
        steel(scene).displacement({"bottom_of_wall"}, "z", {0, 0, 0}).displacement({"floor_x"}, "x", {0, 0, 0});
        if (isOne) scene.contact("edge", "corner", law);
        else scene.contact("block_foot", "floor_top", law).contact("block_side", "wall_side", law);
        scene.contactOption("Discretization", "Automatic");
        const auto result = load(scene, kAside).solve();
        TEST_ASSERT(result.solved);
        if (result.pairs.empty() || law) continue;  // with friction, what the floor's breadth grows by and the block's does not rubs
        checkForces(result, kAside, {1, 1}, out, success);
      }
}

// A slider whose overhang is drawn over a floor: nodes that nothing lay opposite come down on it.  nu = 0 and rollers: all is alike along y, so that
// the floor's surface is a line x -> z, which nodes may be compared with wherever they are.
void checkSlider(int sliderCells, double push, const Friction* friction, Teuchos::FancyOStream& out, bool& success) {
  BoxSpec floor, slider;
  floor.blockName = "floor";
  floor.lower = {0, 0, -1};
  floor.upper = {1.5, 0.5, 0};
  floor.divisions = {6, 1, 3};
  floor.sideSetNames = {"", "", "walls", "walls", "ground", "floor_contact"};
  slider.blockName = "slider";
  slider.lower = {0.25, 0, 0.01};
  slider.upper = {2.25, 0.5, 0.51};
  slider.divisions = {sliderCells, 1, 2};
  slider.sideSetNames = {"", "", "walls", "walls", "slider_contact", "top"};
  const Mesh mesh = makeBoxes({floor, slider});
  ScenarioBuilder scene(mesh);
  scene.material("floor", 100, 0).material("slider", 300, 0).clamp({"ground"}).displacement({"walls"}, "y", {0, 0, 0})
      .displacement({"top"}, "xz", {push, 0, -0.03}).contact("slider_contact", "floor_contact", friction)
      .contactOption("Discretization", "Automatic").contactOption("Sides", "As Given").decomposition("METIS", 4).tolerance(1e-9);
  const long before = scene.prepare().contactPairs;
  const auto result = scene.solve();
  TEST_ASSERT(result.solved);
  const long late = result.report.model.contactPairs - before;
  const auto& notes = result.report.model.notes;
  const bool isTold = std::any_of(notes.begin(), notes.end(), [](const std::string& note) { return note.find("are carried into the other body") != std::string::npos; });
  TEST_EQUALITY(isTold, late > 0);
  TEST_EQUALITY(late, push < -0.2 ? (sliderCells == 8 ? 4 : 6) : 0);
  if (result.pairs.empty()) return;  // not the root
  std::vector<std::array<double, 2>> surface, nodes;  // displaced, of y = 0
  for (std::size_t i = 0; i < mesh.numNodes(); ++i) {
    const auto& x = mesh.coordinates[i];
    if (x[1] != 0 || (x[2] != 0 && x[2] != slider.lower[2])) continue;
    const std::array<double, 2> place = {x[0] + result.displacement[3 * i], x[2] + result.displacement[3 * i + 2]};
    if (x[2] == 0) surface.push_back(place);
    else if (x[0] > floor.upper[0] + 0.01) nodes.push_back(place);
  }
  std::sort(surface.begin(), surface.end());
  double deepest = 0;
  std::size_t touching = 0;
  for (const auto& [x, z] : nodes) {
    const auto right = std::upper_bound(surface.begin(), surface.end(), std::array<double, 2>{x, 1e9});
    if (right == surface.begin() || right == surface.end()) continue;
    const auto left = right - 1;
    const double below = (*left)[1] + ((*right)[1] - (*left)[1]) * (x - (*left)[0]) / ((*right)[0] - (*left)[0]);
    deepest = std::max(deepest, below - z);
    touching += std::abs(below - z) < 1e-6;
  }
  out << late << " late pairs, " << touching << " nodes touch, the deepest is inside by " << deepest << ", "
      << result.report.solver.hessianMultiplications << " multiplications\n";
  TEST_COMPARE(deepest, <=, 1e-6);  // of 0.03: rows have the weights of the displacements before them
  TEST_EQUALITY(touching > 0, late > 0);
}

TEUCHOS_UNIT_TEST(Joints, an_overhang_that_is_drawn_over_the_floor) {
  const Friction friction{"Coulomb", {0.3, 0.2}};
  for (const double push : {-0.1, -0.6})
    for (const Friction* law : {static_cast<const Friction*>(nullptr), &friction}) {
      if (ranks() == 1) checkSlider(8, push, law, out, success);  // as the floor: node to node
      checkSlider(10, push, law, out, success);
    }
}

}  // namespace
