// SPDX-License-Identifier: BSD-3-Clause
// Contact of quadratic elements: uniform pressure on matching and on other meshes, overhanging and bent surfaces.
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_CellMesh.hpp"
#include "Haptos_Error.hpp"
#include "ScenarioBuilder.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Verification;

constexpr double kNafemsPressure = 109.89, kE = 1e6, kNu = 0.3;  // NAFEMS CGS-1

struct Body {
  Topology topology;
  std::array<int, 3> divisions{2, 2, 2};
};

double noise(const Array3& x, int component) {
  const double s = std::sin(127.1 * x[0] + 311.7 * x[1] + 74.7 * x[2] + 41.3 * component) * 43758.5453;
  return 2 * (s - std::floor(s)) - 1;
}

// A cube on z = 0, below or above; nodes within faces and inside are moved by a quarter of the mesh width.
Mesh cube(const Body& body, bool isUpper) {
  BoxSpec box;
  box.blockName = isUpper ? "upper" : "lower";
  box.blockId = isUpper ? 2 : 1;
  box.lower = {0, 0, isUpper ? 0.0 : -1.0};
  box.upper = {1, 1, isUpper ? 1.0 : 0.0};
  box.divisions = body.divisions;
  box.sideSetNames = {"x-", "", "y-", "", isUpper ? "upper_contact" : "bottom", isUpper ? "top" : "lower_contact"};
  const auto from = box.lower, to = box.upper;
  box.map = [=](const Array3& x) {
    Array3 y = x;
    for (std::size_t c = 0; c < 3; ++c)
      if (x[c] > from[c] + 1e-9 && x[c] < to[c] - 1e-9) y[c] += 0.25 * (to[c] - from[c]) / body.divisions[c] * noise(x, int(c));
    return y;
  };
  return withElements(makeBoxes({box}), body.topology);
}

// Two meshes as one; sets of the same name become one set.
Mesh together(Mesh mesh, const Mesh& other) {
  const auto nodes = std::int64_t(mesh.numNodes()), elements = std::int64_t(mesh.numElements());
  mesh.coordinates.insert(mesh.coordinates.end(), other.coordinates.begin(), other.coordinates.end());
  for (ElementBlock block : other.blocks) {
    for (auto& node : block.connectivity) node += nodes;
    mesh.blocks.push_back(std::move(block));
  }
  for (const SideSet& set : other.sideSets) {
    int k = findSideSet(mesh, set.name);
    if (k < 0) {
      k = int(mesh.sideSets.size());
      mesh.sideSets.push_back({k + 1, set.name, {}});
    }
    for (const auto& side : set.sides) mesh.sideSets[std::size_t(k)].sides.push_back({side.element + elements, side.side});
  }
  mesh.nodeNumbers.clear();
  mesh.elementNumbers.clear();
  return mesh;
}

ScenarioBuilder scene(const Mesh& mesh, const std::string& discretization, int pieces, const Friction* friction = nullptr) {
  ScenarioBuilder result(mesh);
  result.material("lower", kE, kNu).material("upper", kE, kNu)
      .displacement({"bottom"}, "z", {0, 0, 0}).displacement({"x-"}, "x", {0, 0, 0}).displacement({"y-"}, "y", {0, 0, 0})
      .contact("upper_contact", "lower_contact", friction).contactOption("Discretization", discretization).contactOption("Sides", "As Given")
      .decomposition("METIS", pieces).tolerance(1e-11);
  return result;
}

// ANALYTIC: pressure and strain are uniform.  From 25 to 41 multiplications, whatever the elements, and whether they match.
void checkPatch(const Body& lower, const Body& upper, const std::string& asked, int pieces, double coefficient, Teuchos::FancyOStream& out, bool& success) {
  const Friction friction{"Coulomb", {coefficient, coefficient}};
  const Mesh mesh = together(cube(lower, false), cube(upper, true));
  auto patch = scene(mesh, asked, pieces, coefficient > 0 ? &friction : nullptr);
  const auto result = patch.pressure({"top"}, kNafemsPressure).solve();
  TEST_ASSERT(result.solved);
  TEST_EQUALITY(result.report.model.discretization, "Mortar");  // whose rows are those of matching meshes, too
  TEST_EQUALITY(result.report.model.subdomains, pieces);
  TEST_COMPARE(result.report.solver.hessianMultiplications, <=, 45);
  TEST_EQUALITY(result.report.solver.method, "Subspace Newton");
  if (result.pairs.empty()) return;  // not the root
  double pressure = 0, shear = 0, u = 0, area = 0;
  for (const auto& pair : result.pairs) {
    area += pair.area;
    pressure = std::max(pressure, std::abs(pair.pressure / kNafemsPressure - 1));
    for (double t : pair.tangentialForce) shear = std::max(shear, std::abs(t) / (pair.area * kNafemsPressure));
  }
  for (std::size_t i = 0; i < mesh.numNodes(); ++i) {
    const auto& x = mesh.coordinates[i];
    const Array3 exact = {kNu * x[0], kNu * x[1], -(x[2] + 1)};
    for (std::size_t c = 0; c < 3; ++c) u = std::max(u, std::abs(result.displacement[3 * i + c] * kE / kNafemsPressure - exact[c]));
  }
  out << topologyName(upper.topology) << " on " << topologyName(lower.topology) << ": pressure " << pressure << ", shear " << shear << ", displacement " << u
      << ", area " << area << ", " << result.report.solver.hessianMultiplications << " multiplications\n";
  TEST_FLOATING_EQUALITY(area, 1.0, 1e-9);
  TEST_COMPARE(pressure, <=, 1e-8);
  TEST_COMPARE(shear, <=, 1e-8);
  TEST_COMPARE(u, <=, 1e-8);
}

const std::vector<Topology> quadratic{Topology::Hex20, Topology::Hex27, Topology::Tet10, Topology::Wedge15, Topology::Pyramid13};

// Both meshes are distorted by the same numbers on z = 0, so that they match.
TEUCHOS_UNIT_TEST(QuadraticContact, MatchingPatch) {
  for (const Topology topology : quadratic) {
    if (numRanks() > 1 && topology != Topology::Tet10) continue;
    for (const double friction : {0.0, 0.4}) checkPatch({topology}, {topology}, friction > 0 ? "Automatic" : "Node To Node", friction > 0 ? 4 : 12, friction, out, success);
  }
  checkPatch({Topology::Wedge15}, {Topology::Wedge15, {2, 2, 1}}, "Automatic", 6, 0.3, out, success);
}

// What is asked for node to node is refused where nodes, or middles, have none opposite.
TEUCHOS_UNIT_TEST(QuadraticContact, NodeToNodeRefusesOtherMeshes) {
  for (const auto& [lower, upper] : {std::array<Body, 2>{Body{Topology::Hex20}, Body{Topology::Hex20, {3, 3, 2}}}, {Body{Topology::Hex8}, Body{Topology::Hex20}}}) {
    const Mesh mesh = together(cube(lower, false), cube(upper, true));
    TEST_THROW(scene(mesh, "Node To Node", 4).pressure({"top"}, kNafemsPressure).prepare(), InputError);
    TEST_NOTHROW(scene(mesh, "Automatic", 4).pressure({"top"}, kNafemsPressure).prepare());
  }
}

TEUCHOS_UNIT_TEST(QuadraticContact, NonMatchingPatch) {
  checkPatch({Topology::Hex20}, {Topology::Tet10, {3, 3, 2}}, "Automatic", 6, 0.3, out, success);
  if (numRanks() > 1) return;
  checkPatch({Topology::Tet10, {3, 3, 2}}, {Topology::Hex20}, "Automatic", 6, 0.0, out, success);
  checkPatch({Topology::Hex27, {3, 2, 2}}, {Topology::Hex27}, "Automatic", 6, 0.0, out, success);
  checkPatch({Topology::Pyramid13}, {Topology::Wedge15, {3, 3, 2}}, "Automatic", 6, 0.0, out, success);
  checkPatch({Topology::Hex27}, {Topology::Hex20}, "Automatic", 6, 0.0, out, success);  // the same edges, but centres of sides
  checkPatch({Topology::Hex8, {4, 4, 4}}, {Topology::Hex20}, "Automatic", 6, 0.0, out, success);  // nodes opposite each other but centres
  checkPatch({Topology::Tet4, {4, 4, 4}}, {Topology::Tet10}, "Automatic", 6, 0.0, out, success);
}

// ANALYTIC: a block pressed on a rigid plane.
TEUCHOS_UNIT_TEST(QuadraticContact, RigidPlane) {
  for (const Topology topology : quadratic) {
    if (numRanks() > 1 && topology != Topology::Hex20) continue;
    ScenarioBuilder block(cube({topology}, true));
    const auto result = block.material("upper", kE, kNu).displacement({"x-"}, "x", {0, 0, 0}).displacement({"y-"}, "y", {0, 0, 0})
                            .pressure({"top"}, kNafemsPressure).rigidPlane("upper_contact", {0, 0, 0}, {0, 0, 1}).decomposition("METIS", 4).tolerance(1e-11).solve();
    TEST_ASSERT(result.solved);
    for (const auto& pair : result.pairs) TEST_FLOATING_EQUALITY(pair.pressure, kNafemsPressure, 1e-8);
    for (std::size_t i = 0; 3 * i < result.displacement.size(); ++i)
      TEST_COMPARE(std::abs(result.displacement[3 * i + 2] + kNafemsPressure / kE * block.mesh().coordinates[i][2]), <, 1e-9 * kNafemsPressure / kE);
  }
}

// A secondary surface that stands out beyond the other body: what is covered carries all of the load, and pulls nowhere.
TEUCHOS_UNIT_TEST(QuadraticContact, SecondarySurfaceStandsOut) {
  for (const Topology topology : quadratic) {
    if (numRanks() > 1) continue;
    Mesh upper = cube({topology, {3, 3, 2}}, true);
    for (auto& x : upper.coordinates) x[0] *= 0.7, x[1] *= 0.8;
    ScenarioBuilder two(together(cube({topology}, false), upper));
    const auto result = two.material("lower", kE, kNu).material("upper", kE, kNu)
                            .displacement({"bottom"}, "xyz", {0, 0, 0}).displacement({"x-"}, "x", {0, 0, 0}).displacement({"y-"}, "y", {0, 0, 0})
                            .contact("lower_contact", "upper_contact").contactOption("Discretization", "Automatic").contactOption("Sides", "As Given")
                            .pressure({"top"}, kNafemsPressure).decomposition("METIS", 5).tolerance(1e-10).solve();
    TEST_ASSERT(result.solved);
    TEST_EQUALITY(result.report.model.discretization, "Mortar");
    double force = 0, area = 0, smallest = 0;
    for (const auto& pair : result.pairs) {
      force += pair.normalForce;
      area += pair.area;
      smallest = std::min(smallest, pair.normalForce);
      TEST_COMPARE(pair.area, >, 1e-4);
    }
    out << topologyName(topology) << ": force " << force << " of " << 0.56 * kNafemsPressure << ", area " << area << ", "
        << result.report.solver.hessianMultiplications << " multiplications\n";
    TEST_FLOATING_EQUALITY(force, 0.56 * kNafemsPressure, 1e-8);
    TEST_FLOATING_EQUALITY(area, 0.56, 1e-9);
    TEST_COMPARE(smallest, >, -1e-8 * kNafemsPressure);
  }
}

// Largest error of the pressure between two quarters of rings, radii 1, 1.5 and 2, under a pressure of 1 inside.
// ANALYTIC (Lame): (4 / 2.25 - 1) / 3
double ringError(Topology topology, int n, bool isMatching, Teuchos::FancyOStream& out, bool& success) {
  const auto ring = [&](bool isOuter) {
    BoxSpec box;
    box.blockName = isOuter ? "outer" : "inner";
    box.blockId = isOuter ? 2 : 1;
    box.lower = {isOuter ? 1.5 : 1.0, 0, 0};
    box.upper = {isOuter ? 2.0 : 1.5, 1, 0.25};
    box.divisions = {n, (isOuter && !isMatching ? 3 : 2) * n, 1};
    box.sideSetNames = {isOuter ? "outer_contact" : "inside", isOuter ? "" : "inner_contact", "y-", "y+", "z", "z"};
    return withElements(makeBoxes({box}), topology);
  };
  ScenarioBuilder two(together(ring(false), ring(true)));
  two.moveNodes([](const Array3& x) {
    const double angle = 0.5 * std::acos(-1.0) * x[1];
    return Array3{x[0] * std::cos(angle), x[0] * std::sin(angle), x[2]};
  });
  const auto result = two.material("inner", 100, kNu).material("outer", 100, kNu).pressure({"inside"}, 1.0)
                          .displacement({"y-"}, "y", {0, 0, 0}).displacement({"y+"}, "x", {0, 0, 0}).displacement({"z"}, "z", {0, 0, 0})
                          .contact("inner_contact", "outer_contact").contactOption("Discretization", "Automatic").contactOption("Sides", "As Given")
                          .decomposition("METIS", 4).tolerance(1e-10).solve();
  TEST_ASSERT(result.solved);
  constexpr double kExact = (4 / 2.25 - 1) / 3;
  double error = 0;
  for (const auto& pair : result.pairs) error = std::max(error, std::abs(pair.pressure / kExact - 1));
  return error;
}

TEUCHOS_UNIT_TEST(QuadraticContact, RingsInEachOther) {
  if (numRanks() > 1) return;
  for (const Topology topology : {Topology::Hex8, Topology::Hex20, Topology::Hex27, Topology::Tet10, Topology::Wedge15})
    for (const bool isMatching : {true, false}) {
      const double coarse = ringError(topology, 2, isMatching, out, success), fine = ringError(topology, 4, isMatching, out, success);
      out << topologyName(topology) << (isMatching ? " matching: " : " not matching: ") << coarse << ", " << fine << ", order " << std::log2(coarse / fine) << "\n";
      if (topology == Topology::Hex8) continue;  // for comparison
      TEST_COMPARE(fine, <, 0.02);
      TEST_COMPARE(std::log2(coarse / fine), >, 1.0);
    }
}

}  // namespace
