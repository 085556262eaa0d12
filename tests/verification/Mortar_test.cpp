// SPDX-License-Identifier: BSD-3-Clause
// Contact and ties between meshes that do not match: uniform stress, sliding, rigid rotation, a published beam.
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "Haptos_CellMesh.hpp"
#include "Haptos_FaceShapes.hpp"
#include "ScenarioBuilder.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Verification;

// NAFEMS CGS-1
constexpr double kPressure = 109.89, kE = 1e6, kNu = 0.3;

struct Patch {
  std::array<int, 3> lower{4, 4, 3}, upper{5, 5, 3};
  Topology lowerTopology = Topology::Hex8, upperTopology = Topology::Hex8;
  Cell lowerCell = Cell::Hexahedron, upperCell = Cell::Hexahedron;  ///< of Hex8
  ElementOrder order = ElementOrder::Linear;
  std::array<double, 2> lowerEnd{1, 1}, upperEnd{1, 1};  ///< both begin at 0, 0
  double lowerDistortion = 0, upperDistortion = 0;       ///< of the element size
  int subdomains = 4;
  double friction = 0;
};

bool isAlone() { return Tpetra::getDefaultComm()->getSize() == 1; }

struct Rectangle {
  std::array<double, 2> from, to;
};

// A number in [-1, 1] that depends on the place and component alone.
double noise(const Array3& x, int component) {
  const double s = std::sin(127.1 * x[0] + 311.7 * x[1] + 74.7 * x[2] + 41.3 * component) * 43758.5453;
  return 2 * (s - std::floor(s)) - 1;
}

// Moves nodes within the faces of the box and inside by noise.
std::function<Array3(const Array3&)> distorted(const BoxSpec& box, double part) {
  const auto from = box.lower, to = box.upper;
  const auto divisions = box.divisions;
  return [=](const Array3& x) {
    Array3 y = x;
    for (std::size_t c = 0; c < 3; ++c)
      if (x[c] > from[c] + 1e-9 && x[c] < to[c] - 1e-9) y[c] += part * (to[c] - from[c]) / divisions[c] * noise(x, int(c));
    return y;
  };
}

Mesh patchMesh(const Patch& patch) {
  BoxSpec lower, upper;
  lower.blockName = "lower";
  lower.lower = {0, 0, -1};
  lower.upper = {patch.lowerEnd[0], patch.lowerEnd[1], 0};
  lower.divisions = patch.lower;
  lower.topology = patch.lowerTopology;
  lower.sideSetNames = {"x-", "", "y-", "", "bottom", "lower_contact"};
  lower.map = distorted(lower, patch.lowerDistortion);
  upper.blockName = "upper";
  upper.lower = {0, 0, 0};
  upper.upper = {patch.upperEnd[0], patch.upperEnd[1], 1};
  upper.divisions = patch.upper;
  upper.topology = patch.upperTopology;
  upper.sideSetNames = {"x-", "", "y-", "", "upper_contact", "top"};
  upper.map = distorted(upper, patch.upperDistortion);
  const Mesh mesh = makeBoxes({lower, upper});
  if (patch.order == ElementOrder::Linear && patch.lowerCell == Cell::Hexahedron && patch.upperCell == Cell::Hexahedron) return mesh;
  std::vector<Cell> cells(mesh.numElements(), patch.upperCell);
  std::fill_n(cells.begin(), mesh.blocks[0].numElements(), patch.lowerCell);
  return withCells(mesh, cells, patch.order);
}

// Adds p int N dA over a rectangle within a face whose edges lie along x and y: the map is linear, four points are exact.
void addPressure(const Mesh& mesh, const std::vector<std::int64_t>& nodes, const Rectangle& over, double p, std::map<std::int64_t, double>& forces) {
  constexpr double kPlaces[] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526};
  constexpr double kWeights[] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461, 0.3478548451374538};
  std::array<Point2, 9> places{};
  for (std::size_t i = 0; i < nodes.size(); ++i) places[i] = {mesh.coordinates[std::size_t(nodes[i])][0], mesh.coordinates[std::size_t(nodes[i])][1]};
  const double halves[2] = {(over.to[0] - over.from[0]) / 2, (over.to[1] - over.from[1]) / 2};
  if (halves[0] <= 0 || halves[1] <= 0) return;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const Point2 x = {over.from[0] + halves[0] * (1 + kPlaces[i]), over.from[1] + halves[1] * (1 + kPlaces[j])};
      const auto N = faceValues(int(nodes.size()), referencePoint(int(nodes.size()), places, x).value()).N;
      for (std::size_t n = 0; n < nodes.size(); ++n) forces[nodes[n]] += p * kWeights[i] * kWeights[j] * halves[0] * halves[1] * N[n];
    }
}

// The larger body, of regular hexahedra, is loaded where the smaller one leaves it free.
NodalForces freePart(const Patch& patch, const Mesh& mesh) {
  const bool isLower = patch.lowerEnd[0] > patch.upperEnd[0];
  const auto cut = isLower ? patch.upperEnd : patch.lowerEnd;
  const auto& set = mesh.sideSets[std::size_t(findSideSet(mesh, isLower ? "lower_contact" : "upper_contact"))];
  const auto offsets = blockOffsets(mesh);
  std::map<std::int64_t, double> forces;
  for (const auto& side : set.sides) {
    const auto nodes = nodesOfSide(mesh, offsets, side);
    Rectangle face{{1e9, 1e9}, {-1e9, -1e9}};
    for (const auto node : nodes)
      for (std::size_t c = 0; c < 2; ++c) {
        face.from[c] = std::min(face.from[c], mesh.coordinates[std::size_t(node)][c]);
        face.to[c] = std::max(face.to[c], mesh.coordinates[std::size_t(node)][c]);
      }
    addPressure(mesh, nodes, face, (isLower ? -1 : 1) * kPressure, forces);
    for (std::size_t c = 0; c < 2; ++c) face.to[c] = std::min(face.to[c], cut[c]);
    addPressure(mesh, nodes, face, (isLower ? 1 : -1) * kPressure, forces);
  }
  return [forces](std::int64_t node, const Array3&) {
    const auto found = forces.find(node);
    return Array3{0, 0, found == forces.end() ? 0.0 : found->second};
  };
}

// ANALYTIC: pressure and strain are uniform.
void checkPatch(const Patch& patch, Teuchos::FancyOStream& out, bool& success) {
  const Friction friction{"Coulomb", {patch.friction, patch.friction}};
  ScenarioBuilder scene(patchMesh(patch));
  scene.material("lower", kE, kNu).material("upper", kE, kNu)
      .displacement({"bottom"}, "z", {0, 0, 0}).displacement({"x-"}, "x", {0, 0, 0}).displacement({"y-"}, "y", {0, 0, 0})
      .pressure({"top"}, kPressure)
      .contact("upper_contact", "lower_contact", patch.friction > 0 ? &friction : nullptr)
      .contactOption("Discretization", "Automatic").contactOption("Sides", "As Given")
      .decomposition("METIS", patch.subdomains).tolerance(1e-11);
  if (patch.lowerEnd != patch.upperEnd) scene.nodalForces(freePart(patch, scene.mesh()));
  const auto result = scene.solve();
  TEST_ASSERT(result.solved);
  TEST_EQUALITY(result.report.model.discretization, "Mortar");
  TEST_ASSERT(result.report.model.subdomains >= patch.subdomains);
  if (result.pairs.empty()) return;  // not the root
  double pressure = 0, shear = 0, u = 0;
  for (const auto& pair : result.pairs) {
    pressure = std::max(pressure, std::abs(pair.pressure / kPressure - 1));
    for (double t : pair.tangentialForce) shear = std::max(shear, std::abs(t) / (pair.area * kPressure));
  }
  for (std::size_t i = 0; i < scene.mesh().numNodes(); ++i) {
    const auto& x = scene.mesh().coordinates[i];
    const Array3 exact = {kNu * x[0], kNu * x[1], -(x[2] + 1)};
    for (std::size_t c = 0; c < 3; ++c) u = std::max(u, std::abs(result.displacement[3 * i + c] * kE / kPressure - exact[c]));
  }
  out << "ANALYTIC pressure " << pressure << ", shear " << shear << ", displacement " << u << ", kkt "
      << result.report.accuracy.errors.kkt() << " after " << result.report.solver.hessianMultiplications << " multiplications, "
      << result.report.model.subdomains << " subdomains\n";
  TEST_COMPARE(pressure, <=, 1e-8);
  TEST_COMPARE(shear, <=, 1e-8);
  TEST_COMPARE(u, <=, 1e-8);
}

TEUCHOS_UNIT_TEST(Mortar, patch_of_bricks_and_tetrahedra) {
  for (const Topology lower : {Topology::Hex8, Topology::Tet4})
    for (const Topology upper : {Topology::Hex8, Topology::Tet4}) {
      Patch patch;
      patch.lowerTopology = lower;
      patch.upperTopology = upper;
      patch.lowerDistortion = patch.upperDistortion = 0.25;
      checkPatch(patch, out, success);
    }
}

TEUCHOS_UNIT_TEST(Mortar, patch_of_other_cells_and_quadratic_elements) {
  const std::vector<std::array<Cell, 2>> bodies = {{Cell::Hexahedron, Cell::Hexahedron}, {Cell::Hexahedron, Cell::Tetrahedra},
                                                   {Cell::Tetrahedra, Cell::Tetrahedra}, {Cell::Wedges, Cell::Pyramids}};
  for (const ElementOrder order : {ElementOrder::Linear, ElementOrder::Quadratic, ElementOrder::FullQuadratic})
    for (const auto& [lower, upper] : bodies) {
      const bool isWhole = lower == Cell::Hexahedron && upper == Cell::Hexahedron;
      if (isWhole ? order == ElementOrder::Linear : order == ElementOrder::FullQuadratic) continue;
      Patch patch;
      patch.lower = {2, 2, 1};
      patch.upper = {3, 3, 1};
      patch.lowerCell = lower;
      patch.upperCell = upper;
      patch.order = order;
      patch.lowerDistortion = patch.upperDistortion = 0.25;
      checkPatch(patch, out, success);
    }
}

TEUCHOS_UNIT_TEST(Mortar, patch_where_one_body_is_larger) {
  Patch patch;
  patch.upperEnd = {0.7, 0.55};
  patch.upper = {4, 3, 3};
  checkPatch(patch, out, success);
  patch.upperDistortion = 0.25;
  patch.friction = 0.3;
  checkPatch(patch, out, success);
  patch = {};
  patch.lowerEnd = {0.7, 0.55};
  patch.lowerDistortion = 0.25;
  checkPatch(patch, out, success);
  patch.friction = 0.3;
  patch.upper = {6, 6, 2};
  checkPatch(patch, out, success);
}

// Faces of the larger body are covered in part, its quadratic ones, too; the smaller body is distorted.
TEUCHOS_UNIT_TEST(Mortar, patch_where_one_body_of_quadratic_elements_is_larger) {
  for (const ElementOrder order : {ElementOrder::Quadratic, ElementOrder::FullQuadratic})
    for (const Cell smaller : {Cell::Hexahedron, Cell::Tetrahedra})
      for (const bool isUpper : {false, true}) {
        if (smaller == Cell::Tetrahedra && order == ElementOrder::FullQuadratic) continue;
        if (!isAlone() && smaller == Cell::Hexahedron) continue;
        Patch patch;
        patch.order = order;
        patch.lower = {3, 3, 1};
        patch.upper = {2, 3, 1};
        (isUpper ? patch.upperEnd : patch.lowerEnd) = {0.7, 0.55};
        (isUpper ? patch.upperCell : patch.lowerCell) = smaller;
        (isUpper ? patch.upperDistortion : patch.lowerDistortion) = 0.25;
        for (const double friction : {0.0, 0.3}) {
          patch.friction = friction;
          if (isAlone() || friction > 0) checkPatch(patch, out, success);
        }
      }
}

struct ElementsOfBodies {
  std::string name;
  ElementOrder order;
  Cell lower, upper;
};

// Of every element type that patches are asked of; on several ranks, where runs take long, each in one number of subdomains, with friction.
TEUCHOS_UNIT_TEST(Mortar, patch_in_many_subdomains) {
  const std::vector<ElementsOfBodies> pairings = {{"HEX8", ElementOrder::Linear, Cell::Hexahedron, Cell::Hexahedron},
                                         {"HEX20", ElementOrder::Quadratic, Cell::Hexahedron, Cell::Hexahedron},
                                         {"HEX27", ElementOrder::FullQuadratic, Cell::Hexahedron, Cell::Hexahedron},
                                         {"TETRA4", ElementOrder::Linear, Cell::Tetrahedra, Cell::Tetrahedra},
                                         {"TETRA10", ElementOrder::Quadratic, Cell::Tetrahedra, Cell::Tetrahedra},
                                         {"PYRAMID5 on WEDGE6", ElementOrder::Linear, Cell::Wedges, Cell::Pyramids},
                                         {"HEX8 on TETRA4", ElementOrder::Linear, Cell::Tetrahedra, Cell::Hexahedron},
                                         {"HEX20 on TETRA10", ElementOrder::Quadratic, Cell::Tetrahedra, Cell::Hexahedron}};
  int turn = 0;
  for (const auto& [name, order, lower, upper] : pairings) {
    ++turn;
    for (const int subdomains : {4, 16, 50})
      for (const double friction : {0.0, 0.3}) {
        if (!isAlone() && (friction == 0 || subdomains != std::array<int, 3>{4, 16, 50}[std::size_t(turn % 3)])) continue;
        Patch patch;
        patch.lower = order == ElementOrder::Linear ? std::array<int, 3>{5, 4, 2} : std::array<int, 3>{3, 3, 2};
        patch.upper = order == ElementOrder::Linear ? std::array<int, 3>{4, 6, 2} : std::array<int, 3>{4, 4, 2};
        patch.lowerCell = lower;
        patch.upperCell = upper;
        patch.order = order;
        patch.lowerDistortion = patch.upperDistortion = 0.25;
        patch.subdomains = subdomains;
        patch.friction = friction;
        out << name << ", friction " << friction << ": ";
        checkPatch(patch, out, success);
      }
  }
}

// ANALYTIC: the same in axes of its own; top and bottom are moved as the uniform strain wants, the other sides are free.
TEUCHOS_UNIT_TEST(Mortar, patch_in_a_turned_frame) {
  for (const Cell upper : {Cell::Hexahedron, Cell::Tetrahedra})
    for (const ElementOrder order : {ElementOrder::Linear, ElementOrder::Quadratic}) {
      Patch patch;
      patch.lower = {3, 2, 1};
      patch.upper = {2, 3, 1};
      patch.upperCell = upper;
      patch.order = order;
      patch.lowerDistortion = patch.upperDistortion = 0.25;
      const auto Q = rotation({1, 2, -0.7}, 0.9);
      const Array3 strain = {kNu * kPressure / kE, kNu * kPressure / kE, -kPressure / kE};
      std::array<std::string, 3> field;
      double G[3][3];  // Q strain Q^T: u = G x, the fixed point is in z = 0
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t d = 0; d < 3; ++d) G[c][d] = Q[c][0] * strain[0] * Q[d][0] + Q[c][1] * strain[1] * Q[d][1] + Q[c][2] * strain[2] * Q[d][2];
        char text[100];
        std::snprintf(text, sizeof text, "%.17g*x + %.17g*y + %.17g*z", G[c][0], G[c][1], G[c][2]);
        field[c] = text;
      }
      const Friction friction{"Coulomb", {0.2, 0.5}};
      ScenarioBuilder scene(patchMesh(patch));
      const auto result = scene.moveNodes([&](const Array3& x) { return Q * x; }).material("lower", kE, kNu).material("upper", kE, kNu)
                              .displacementField({"bottom", "top"}, "xyz", field).contact("upper_contact", "lower_contact", &friction)
                              .contactOption("Discretization", "Automatic").decomposition("METIS", 4).tolerance(1e-11).solve();
      TEST_ASSERT(result.solved);
      TEST_EQUALITY(result.report.model.discretization, "Mortar");
      double pressure = 0, error = 0;
      for (const auto& pair : result.pairs) pressure = std::max(pressure, std::abs(pair.pressure / kPressure - 1));
      for (std::size_t i = 0; 3 * i < result.displacement.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
          error = std::max(error, std::abs(result.displacement[3 * i + c] - dot({G[c][0], G[c][1], G[c][2]}, scene.mesh().coordinates[i])) * kE / kPressure);
      out << "ANALYTIC pressure " << pressure << ", displacement " << error << "\n";
      TEST_COMPARE(pressure, <=, 1e-8);
      TEST_COMPARE(error, <=, 1e-8);
    }
}

// OWN: on meshes that match, mortar gives the answer of node to node, where pairs stick, slip and are open.
TEUCHOS_UNIT_TEST(Mortar, matching_meshes_have_one_answer) {
  for (const Topology topology : {Topology::Hex8, Topology::Tet4}) {
    Patch patch;
    patch.lower = patch.upper = {6, 4, 2};
    patch.lowerTopology = patch.upperTopology = topology;
    const Friction friction{"Coulomb", {0.6, 0.3}, {1, 1, 0}};
    const auto solve = [&](const std::string& discretization) {
      return ScenarioBuilder(patchMesh(patch)).material("lower", 1e5, 0.3).material("upper", 3e5, 0.2).clamp({"bottom"})
          .displacementField({"top"}, "xyz", {"-0.0018", "0.0001", "-0.002*(0.7 - x)"}).contact("upper_contact", "lower_contact", &friction)
          .contactOption("Discretization", discretization).contactOption("Sides", "As Given").decomposition("METIS", 6).tolerance(1e-12).solve();
    };
    const auto nodes = solve("Node To Node"), mortar = solve("Mortar");
    TEST_ASSERT(nodes.solved && mortar.solved);
    TEST_ASSERT(nodes.report.model.discretization != mortar.report.model.discretization);
    if (nodes.pairs.empty()) continue;  // not the root
    const auto& states = nodes.report.interfaces[0];
    TEST_ASSERT(states.stick > 2 && states.slip > 2 && states.open > 2);
    double force = 0, largestForce = 0, u = 0, largest = 0;
    TEST_EQUALITY(nodes.pairs.size(), mortar.pairs.size());
    for (std::size_t k = 0; k < std::min(nodes.pairs.size(), mortar.pairs.size()); ++k) {
      TEST_EQUALITY(nodes.pairs[k].secondaryNode, mortar.pairs[k].secondaryNode);
      TEST_ASSERT(nodes.pairs[k].status == mortar.pairs[k].status);
      for (std::size_t c = 0; c < 3; ++c) {
        largestForce = std::max(largestForce, std::abs(nodes.pairs[k].force[c]));
        force = std::max(force, std::abs(nodes.pairs[k].force[c] - mortar.pairs[k].force[c]));
      }
    }
    for (std::size_t i = 0; i < nodes.displacement.size(); ++i) {
      largest = std::max(largest, std::abs(nodes.displacement[i]));
      u = std::max(u, std::abs(nodes.displacement[i] - mortar.displacement[i]));
    }
    out << topologyName(topology) << ": " << states.stick << " stick, " << states.slip << " slip, " << states.open << " open; forces " << force / largestForce
        << ", displacements " << u / largest << "\n";
    TEST_COMPARE(force, <=, 1e-9 * largestForce);
    TEST_COMPARE(u, <=, 1e-9 * largest);
  }
}

// ANALYTIC (NAFEMS CGS-4): a block that is pushed up a slope; once all slips, F / G = (tan a + mu) / (1 - mu tan a).
TEUCHOS_UNIT_TEST(Mortar, pushed_up_a_slope) {
  constexpr double kSlope = 0.1;
  for (const double mu : {0.0, 0.1, 0.2, 0.3}) {
    BoxSpec wedge, block;
    wedge.blockName = "wedge";
    wedge.lower = {0, 0, -1};
    wedge.upper = {6, 1, 0};
    wedge.divisions = {11, 3, 2};
    wedge.sideSetNames = {"", "", "", "", "ground", "slope"};
    wedge.map = [](const Array3& x) { return Array3{x[0], x[1], x[2] + kSlope * x[0] * (1 + x[2])}; };
    block.blockName = "block";
    block.lower = {1.1, 0.1, 0};
    block.upper = {3.3, 0.9, 1};
    block.divisions = {4, 2, 2};
    block.sideSetNames = {"pushed", "", "", "", "sole", "top"};
    block.map = [](const Array3& x) { return Array3{x[0], x[1], x[2] + kSlope * x[0]}; };
    const Friction friction{"Coulomb", {mu, mu}};
    const auto result = ScenarioBuilder(makeBoxes({wedge, block})).material("wedge", 1100, 0).material("block", 1100, 0)
                            .clamp({"ground"}).displacement({"pushed"}, "xy", {0.5, 0, 0}).traction({"top"}, {0, 0, -2})
                            .contact("sole", "slope", mu > 0 ? &friction : nullptr)
                            .contactOption("Discretization", "Automatic").contactOption("Sides", "As Given")
                            .decomposition("METIS", 4).tolerance(1e-11).solve();
    TEST_ASSERT(result.solved);
    if (result.pairs.empty()) continue;  // not the root
    const auto sum = resultants(result);
    const auto& interface = result.report.interfaces[0];
    TEST_ASSERT(interface.slip > 0 && interface.stick == 0);
    const double ratio = -sum.force[0] / sum.force[2], exact = (kSlope + mu) / (1 - mu * kSlope);
    out << "ANALYTIC F/G " << ratio << ", " << exact << "\n";
    TEST_COMPARE(std::abs(ratio - exact), <=, 1e-8);
    TEST_COMPARE(std::abs(sum.force[2] / (2 * 2.2 * 0.8 * std::hypot(1, kSlope)) - 1), <=, 1e-8);
  }
}

// ANALYTIC: tied across a curved interface, both bodies turn together without any stress.
TEUCHOS_UNIT_TEST(Mortar, turning_a_curved_tie_is_free) {
  BoxSpec lower, upper;
  lower.blockName = "lower";
  lower.lower = {-1, 0, -1};
  lower.upper = {1, 1, 0};
  lower.divisions = {9, 3, 2};
  lower.sideSetNames = {"", "", "", "", "inside", "lower_contact"};
  lower.map = [](const Array3& x) { return Array3{(2 + x[2]) * std::sin(x[0]), x[1], (2 + x[2]) * std::cos(x[0])}; };
  upper = lower;
  upper.blockName = "upper";
  upper.lower = {-1, 0, 0};
  upper.upper = {1, 1, 1};
  upper.divisions = {12, 4, 2};
  upper.sideSetNames = {"", "", "", "", "upper_contact", "outside"};
  const Mesh mesh = makeBoxes({lower, upper});
  const std::size_t firstUpper = 10 * 4 * 3;
  const Friction tied{"Tied"};
  for (const char* sides : {"As Given", "Automatic"}) {
    const auto result = ScenarioBuilder(mesh).material("lower", 100, 0.3).material("upper", 300, 0.3)
                            .displacementField({"inside"}, "xyz", {"0.1*z - 0.2*y", "0.2*x - 0.05*z", "0.05*y - 0.1*x"})
                            .contact("upper_contact", "lower_contact", &tied)
                            .contactOption("Discretization", "Mortar").contactOption("Sides", sides)
                            .decomposition("METIS", 6).tolerance(1e-12).solve();
    TEST_ASSERT(result.solved);
    if (result.pairs.empty()) continue;  // not the root
    double largest = 0, error = 0;
    for (const auto& pair : result.pairs) largest = std::max(largest, std::hypot(pair.force[0], pair.force[1], pair.force[2]));
    for (std::size_t i = firstUpper; i < mesh.numNodes(); ++i) {
      const auto& x = mesh.coordinates[i];
      if (std::hypot(x[0], x[2]) < 2.1) continue;  // on the interface, where nodes were moved
      const Array3 exact = {0.1 * x[2] - 0.2 * x[1], 0.2 * x[0] - 0.05 * x[2], 0.05 * x[1] - 0.1 * x[0]};
      for (std::size_t c = 0; c < 3; ++c) error = std::max(error, std::abs(result.displacement[3 * i + c] - exact[c]));
    }
    out << "ANALYTIC largest force " << largest << " (stiffness x displacement about 100), displacement off by " << error << "\n";
    TEST_COMPARE(largest, <=, 1e-10);
    TEST_COMPARE(error, <=, 1e-11);
    TEST_EQUALITY(result.pairs.size(), std::string(sides) == "As Given" ? 65u : 40u);  // the softer side carries the multipliers
  }
}

// EXTERNAL: two cantilever beams of ESPRESO's tests, a gap between them, frictionless; largest displacement 0.1293 on these meshes.
TEUCHOS_UNIT_TEST(Mortar, cantilevers_across_a_gap) {
  BoxSpec lower, upper;
  lower.blockName = "lower";
  lower.lower = {-0.5, -2.1, 0};
  lower.upper = {0.5, 2.9, 1};
  lower.divisions = {4, 16, 4};
  lower.sideSetNames = {"", "", "lower_end", "", "", "lower_contact"};
  upper.blockName = "upper";
  upper.lower = {-0.5, 0, 1.1};
  upper.upper = {0.5, 5, 2.1};
  upper.divisions = {3, 16, 3};
  upper.sideSetNames = {"", "", "", "upper_end", "upper_contact", "top"};
  const auto result = ScenarioBuilder(makeBoxes({lower, upper})).material("lower", 2.1e9, 0.3).material("upper", 2.1e7, 0.3)
                          .clamp({"lower_end", "upper_end"}).pressure({"top"}, 1e5)
                          .contact("upper_contact", "lower_contact").contactOption("Discretization", "Automatic")
                          .decomposition("METIS", 6).tolerance(1e-8).solve();
  TEST_ASSERT(result.solved);
  if (result.pairs.empty()) return;  // not the root
  double largest = 0;
  for (std::size_t i = 0; i < result.displacement.size(); i += 3)
    largest = std::max(largest, std::hypot(result.displacement[i], result.displacement[i + 1], result.displacement[i + 2]));
  out << "EXTERNAL largest displacement " << largest << ", 0.1293\n";
  TEST_COMPARE(std::abs(largest / 0.1293 - 1), <=, 0.01);
  TEST_ASSERT(result.report.interfaces[0].slip > 0 && result.report.interfaces[0].open > 0);
}

}  // namespace
