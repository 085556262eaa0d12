// SPDX-License-Identifier: BSD-3-Clause
// Patches of distorted elements of all kinds on each other: uniform pressure and stress, however they are meshed, turned and cut.
#include <Teuchos_UnitTestHarness.hpp>
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
  std::string discretization = "Mortar";  ///< that "Automatic" chooses
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

using Corners = std::vector<Point2>;

// What of a convex polygon lies where its coordinate c is at most `end`.
Corners upTo(double end, std::size_t c, const Corners& polygon) {
  Corners kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto& a = polygon[i];
    const auto& b = polygon[(i + 1) % polygon.size()];
    if (a[c] <= end) kept.push_back(a);
    if ((a[c] < end) == (b[c] < end)) continue;
    const double t = (end - a[c]) / (b[c] - a[c]);
    kept.push_back({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])});
  }
  return kept;
}

// Adds p int N dA over a convex part of a face: its map is affine, so that the seven points of degree 5 are exact for any N here.
void addPressure(const Mesh& mesh, const std::vector<std::int64_t>& nodes, const Corners& part, double p, std::map<std::int64_t, double>& forces) {
  const int n = int(nodes.size());
  std::array<Point2, 9> places{};
  for (std::size_t i = 0; i < nodes.size(); ++i) places[i] = {mesh.coordinates[std::size_t(nodes[i])][0], mesh.coordinates[std::size_t(nodes[i])][1]};
  const double root = std::sqrt(15.0);
  std::vector<std::array<double, 3>> rule = {{1.0 / 3, 1.0 / 3, 9.0 / 40}};
  for (const double sign : {-1.0, 1.0}) {
    const double t = (6 + sign * root) / 21, weight = (155 + sign * root) / 1200;
    for (const auto& at : {Point2{t, t}, Point2{1 - 2 * t, t}, Point2{t, 1 - 2 * t}}) rule.push_back({at[0], at[1], weight});
  }
  for (std::size_t k = 2; k < part.size(); ++k) {
    const Point2 a = part[0], ab = {part[k - 1][0] - a[0], part[k - 1][1] - a[1]}, ac = {part[k][0] - a[0], part[k][1] - a[1]};
    const double area = std::abs(ab[0] * ac[1] - ab[1] * ac[0]) / 2;
    for (const auto& [s, t, weight] : rule) {
      const Point2 x = {a[0] + s * ab[0] + t * ac[0], a[1] + s * ab[1] + t * ac[1]};
      const auto N = faceValues(n, referencePoint(n, places, x).value()).N;
      for (std::size_t i = 0; i < nodes.size(); ++i) forces[nodes[i]] += p * weight * area * N[i];
    }
  }
}

// The larger body, of regular hexahedra or faces of three edges, is loaded where the smaller one leaves it free.
NodalForces freePart(const Patch& patch, const Mesh& mesh) {
  const bool isLower = patch.lowerEnd[0] > patch.upperEnd[0];
  const auto end = isLower ? patch.upperEnd : patch.lowerEnd;
  const double p = isLower ? -kPressure : kPressure;
  const auto& set = mesh.sideSets[std::size_t(findSideSet(mesh, isLower ? "lower_contact" : "upper_contact"))];
  const auto offsets = blockOffsets(mesh);
  std::map<std::int64_t, double> forces;
  for (const auto& side : set.sides) {
    const auto nodes = nodesOfSide(mesh, offsets, side);
    Corners face;
    for (std::size_t i = 0; i < std::size_t(numCorners(int(nodes.size()))); ++i)
      face.push_back({mesh.coordinates[std::size_t(nodes[i])][0], mesh.coordinates[std::size_t(nodes[i])][1]});
    addPressure(mesh, nodes, face, p, forces);
    addPressure(mesh, nodes, upTo(end[1], 1, upTo(end[0], 0, face)), -p, forces);
  }
  return [forces](std::int64_t node, const Array3&) {
    const auto found = forces.find(node);
    return Array3{0, 0, found == forces.end() ? 0.0 : found->second};
  };
}

// ANALYTIC: pressure, strain and stress are uniform.
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
  TEST_EQUALITY(result.report.model.discretization, patch.discretization);
  TEST_ASSERT(result.report.model.subdomains >= patch.subdomains);
  if (result.pairs.empty()) return;  // not the root
  double pressure = 0, shear = 0, u = 0, stress = 0;
  for (const auto& pair : result.pairs) {
    pressure = std::max(pressure, std::abs(pair.pressure / kPressure - 1));
    for (double t : pair.tangentialForce) shear = std::max(shear, std::abs(t) / (pair.area * kPressure));
  }
  for (const auto& s : result.elements.stress)
    for (std::size_t c = 0; c < 6; ++c) stress = std::max(stress, std::abs(s[c] / kPressure + (c == 2 ? 1 : 0)));
  for (std::size_t i = 0; i < scene.mesh().numNodes(); ++i) {
    const auto& x = scene.mesh().coordinates[i];
    const Array3 exact = {kNu * x[0], kNu * x[1], -(x[2] + 1)};
    for (std::size_t c = 0; c < 3; ++c) u = std::max(u, std::abs(result.displacement[3 * i + c] * kE / kPressure - exact[c]));
  }
  out << "ANALYTIC pressure " << pressure << ", shear " << shear << ", displacement " << u << ", stress " << stress << ", kkt "
      << result.report.accuracy.errors.kkt() << " after " << result.report.solver.hessianMultiplications << " multiplications, "
      << result.report.model.subdomains << " subdomains\n";
  TEST_COMPARE(pressure, <=, 1e-8);
  TEST_COMPARE(shear, <=, 1e-8);
  TEST_COMPARE(u, <=, 1e-8);
  TEST_ASSERT(!result.elements.stress.empty());
  TEST_COMPARE(stress, <=, 1e-8);
}

TEUCHOS_UNIT_TEST(MortarPatches, of_bricks_and_tetrahedra) {
  for (const Topology lower : {Topology::Hex8, Topology::Tet4})
    for (const Topology upper : {Topology::Hex8, Topology::Tet4}) {
      Patch patch;
      patch.lowerTopology = lower;
      patch.upperTopology = upper;
      patch.lowerDistortion = patch.upperDistortion = 0.25;
      checkPatch(patch, out, success);
    }
}

TEUCHOS_UNIT_TEST(MortarPatches, of_other_cells_and_quadratic_elements) {
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

TEUCHOS_UNIT_TEST(MortarPatches, where_one_body_is_larger) {
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
TEUCHOS_UNIT_TEST(MortarPatches, where_one_body_of_quadratic_elements_is_larger) {
  for (const ElementOrder order : {ElementOrder::Quadratic, ElementOrder::FullQuadratic})
    for (const Cell smaller : {Cell::Hexahedron, Cell::Tetrahedra})
      for (const bool isUpper : {false, true}) {
        if (smaller == Cell::Tetrahedra && order == ElementOrder::FullQuadratic) continue;
        Patch patch;
        patch.order = order;
        patch.lower = {3, 3, 1};
        patch.upper = {2, 3, 1};
        (isUpper ? patch.upperEnd : patch.lowerEnd) = {0.7, 0.55};
        (isUpper ? patch.upperCell : patch.lowerCell) = smaller;
        (isUpper ? patch.upperDistortion : patch.lowerDistortion) = 0.25;
        for (const double friction : {0.0, 0.3}) {
          patch.friction = friction;
          checkPatch(patch, out, success);
        }
      }
}

// Faces of three edges are covered in part by straight cuts across them; both bodies are distorted.
TEUCHOS_UNIT_TEST(MortarPatches, larger_body_of_tetrahedra_or_wedges) {
  const std::vector<std::array<Cell, 2>> bodies = {{Cell::Tetrahedra, Cell::Tetrahedra}, {Cell::Tetrahedra, Cell::Hexahedron}, {Cell::Wedges, Cell::Pyramids}};
  for (const ElementOrder order : {ElementOrder::Linear, ElementOrder::Quadratic})
    for (const auto& [larger, smaller] : bodies)
      for (const bool isUpper : {false, true}) {
        Patch patch;
        patch.order = order;
        patch.lower = {3, 4, 2};
        patch.upper = {4, 3, 2};
        (isUpper ? patch.lowerEnd : patch.upperEnd) = {0.7, 0.55};
        patch.upperCell = isUpper ? larger : smaller;
        patch.lowerCell = isUpper ? smaller : larger;
        patch.lowerDistortion = patch.upperDistortion = 0.25;
        for (const double friction : {0.0, 0.3}) {
          patch.friction = friction;
          patch.subdomains = friction > 0 ? 16 : 4;
          checkPatch(patch, out, success);
        }
      }
}

// Every element type that patches are asked of.
struct ElementsOfBodies {
  std::string name;
  ElementOrder order;
  Cell lower, upper;
};

const std::vector<ElementsOfBodies> kPairings = {{"HEX8", ElementOrder::Linear, Cell::Hexahedron, Cell::Hexahedron},
                                                 {"HEX20", ElementOrder::Quadratic, Cell::Hexahedron, Cell::Hexahedron},
                                                 {"HEX27", ElementOrder::FullQuadratic, Cell::Hexahedron, Cell::Hexahedron},
                                                 {"TETRA4", ElementOrder::Linear, Cell::Tetrahedra, Cell::Tetrahedra},
                                                 {"TETRA10", ElementOrder::Quadratic, Cell::Tetrahedra, Cell::Tetrahedra},
                                                 {"WEDGE6 on PYRAMID5", ElementOrder::Linear, Cell::Pyramids, Cell::Wedges},
                                                 {"HEX8 on TETRA4", ElementOrder::Linear, Cell::Tetrahedra, Cell::Hexahedron},
                                                 {"HEX20 on TETRA10", ElementOrder::Quadratic, Cell::Tetrahedra, Cell::Hexahedron}};

void checkInManySubdomains(Patch patch, const ElementsOfBodies& elements, Teuchos::FancyOStream& out, bool& success) {
  patch.lowerCell = elements.lower;
  patch.upperCell = elements.upper;
  patch.order = elements.order;
  patch.lowerDistortion = patch.upperDistortion = 0.25;
  for (const int subdomains : {4, 16, 50})
    for (const double friction : {0.0, 0.3}) {
      patch.subdomains = subdomains;
      patch.friction = friction;
      out << elements.name << ", friction " << friction << ": ";
      checkPatch(patch, out, success);
    }
}

TEUCHOS_UNIT_TEST(MortarPatches, in_many_subdomains) {
  for (const auto& elements : kPairings) {
    Patch patch;
    patch.lower = elements.order == ElementOrder::Linear ? std::array<int, 3>{5, 4, 2} : std::array<int, 3>{3, 3, 2};
    patch.upper = elements.order == ElementOrder::Linear ? std::array<int, 3>{4, 6, 2} : std::array<int, 3>{4, 4, 2};
    checkInManySubdomains(patch, elements, out, success);
  }
}

// Faces are moved by the same numbers above and below.
TEUCHOS_UNIT_TEST(MortarPatches, matching_in_many_subdomains) {
  for (const auto& elements : kPairings) {
    if (elements.lower != elements.upper) continue;
    const bool isLinear = elements.order == ElementOrder::Linear;
    Patch patch;
    patch.lower = patch.upper = isLinear ? std::array<int, 3>{4, 4, 2} : std::array<int, 3>{3, 3, 3};
    patch.discretization = isLinear ? "Node To Node" : "Mortar";
    checkInManySubdomains(patch, elements, out, success);
  }
}

// ANALYTIC: the same in axes of its own; top and bottom are moved as the uniform strain wants, the other sides are free.
TEUCHOS_UNIT_TEST(MortarPatches, in_a_turned_frame) {
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

}  // namespace
