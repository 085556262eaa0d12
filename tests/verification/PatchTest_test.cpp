// SPDX-License-Identifier: BSD-3-Clause
// Two blocks on each other under a uniform pressure: the stress is uniform on any mesh that matches.
#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_CellMesh.hpp"
#include "Haptos_ContactPairs.hpp"
#include "ScenarioBuilder.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Verification;

constexpr double kPressure = 7.0, kHeight1 = 0.6, kHeight2 = 0.4, kE1 = 300.0, kE2 = 500.0;
constexpr double kPi = 3.14159265358979323846;

using Map = std::function<Array3(const Array3&)>;

Mesh stackedBlocks(const std::array<int, 2>& divisions, Topology topology, const Map& map) {
  BoxSpec lower, upper;
  lower.blockName = "lower";
  lower.upper = {1.0, 1.5, kHeight1};
  lower.divisions = {divisions[0], divisions[0] + 1, 2};
  lower.sideSetNames = {"x-", "", "y-", "", "bottom", "lower_contact"};
  lower.topology = topology == Topology::Tet4 ? topology : Topology::Hex8;
  lower.map = map;
  upper = lower;
  upper.blockName = "upper";
  upper.lower = {0.0, 0.0, kHeight1};
  upper.upper = {1.0, 1.5, kHeight1 + kHeight2};
  upper.divisions = {divisions[1], divisions[1] + 1, 2};
  upper.sideSetNames = {"x-", "", "y-", "", "upper_contact", "top"};
  const Mesh mesh = makeBoxes({lower, upper});
  return topology == Topology::Hex8 || topology == Topology::Tet4 ? mesh : withElements(mesh, topology);
}

ScenarioBuilder patch(Mesh mesh) {
  return ScenarioBuilder(std::move(mesh))
      .material("lower", kE1, 0.0)
      .material("upper", kE2, 0.0)
      .displacement({"bottom"}, "z", {0, 0, 0})
      .displacement({"x-"}, "x", {0, 0, 0})
      .displacement({"y-"}, "y", {0, 0, 0})
      .pressure({"top"}, kPressure)
      .contact("upper_contact", "lower_contact")
      .tolerance(1e-12);
}

// Integral of every shape function over a side set whose sides lie in planes z = const; the bilinear
// integrand times the Jacobian is of degree 2 per direction, so 2 x 2 Gauss points are exact.
std::vector<double> tributaryAreas(const Mesh& mesh, const std::string& name) {
  std::vector<double> areas(mesh.numNodes(), 0.0);
  const auto offsets = blockOffsets(mesh);
  for (const auto& side : mesh.sideSets[findSideSet(mesh, name)].sides) {
    const auto nodes = nodesOfSide(mesh, offsets, side);
    const auto at = [&](std::size_t i) { return mesh.coordinates[nodes[i]]; };
    if (nodes.size() == 3) {
      const double area = 0.5 * std::abs((at(1)[0] - at(0)[0]) * (at(2)[1] - at(0)[1]) - (at(2)[0] - at(0)[0]) * (at(1)[1] - at(0)[1]));
      for (auto node : nodes) areas[node] += area / 3;
      continue;
    }
    constexpr double signs[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (int q = 0; q < 4; ++q) {
      const double xi = signs[q][0] / std::sqrt(3.0), eta = signs[q][1] / std::sqrt(3.0);
      double J[2][2] = {{0, 0}, {0, 0}};
      for (std::size_t a = 0; a < 4; ++a)
        for (int d = 0; d < 2; ++d) {
          J[0][d] += 0.25 * signs[a][0] * (1 + signs[a][1] * eta) * at(a)[d];
          J[1][d] += 0.25 * signs[a][1] * (1 + signs[a][0] * xi) * at(a)[d];
        }
      const double weight = std::abs(J[0][0] * J[1][1] - J[0][1] * J[1][0]);
      for (std::size_t a = 0; a < 4; ++a)
        areas[nodes[a]] += weight * 0.25 * (1 + signs[a][0] * xi) * (1 + signs[a][1] * eta);
    }
  }
  return areas;
}

double exactUz(double z, bool upper) {
  return upper ? -kPressure * (kHeight1 / kE1 + (z - kHeight1) / kE2) : -kPressure * z / kE1;
}

// ANALYTIC: u_z linear in each block, lambda_N = p x tributary area, both to 1e-10.
void checkPatch(const ScenarioBuilder& scene, Teuchos::FancyOStream& out, bool& success) {
  const auto result = scene.solve();
  TEST_ASSERT(result.report.model.subdomains > 2);  // the bodies are really cut
  const Mesh& mesh = scene.mesh();
  const auto areas = tributaryAreas(mesh, "upper_contact");
  const double uMax = std::abs(exactUz(kHeight1 + kHeight2, true));
  double uError = 0, forceError = 0, largest = 0, smallest = 1e300;
  for (std::size_t i = 0; 3 * i < result.displacement.size(); ++i) {
    const double* u = &result.displacement[3 * i];
    const double e = exactUz(mesh.coordinates[i][2], mesh.coordinates[i][2] > kHeight1);
    uError = std::max({uError, std::abs(u[2] - e) / uMax, std::abs(u[0]) / uMax, std::abs(u[1]) / uMax});
  }
  for (const auto& pair : result.pairs) {
    const double exact = kPressure * areas[pair.secondaryNode];
    largest = std::max(largest, exact);
    smallest = std::min(smallest, exact);
    forceError = std::max(forceError, std::abs(pair.normalForce - exact));
  }
  if (result.pairs.empty()) return;  // not the root
  TEST_ASSERT(smallest > 0 && smallest < 0.5 * largest);
  TEST_COMPARE(uError, <=, 1e-10);
  TEST_COMPARE(forceError / largest, <=, 1e-10);
  out << "ANALYTIC u_z error " << uError << ", lambda_N error " << forceError / largest << ", kkt "
      << result.report.accuracy.errors.kkt() << " after " << result.report.solver.hessianMultiplications << " multiplications, "
      << result.report.model.subdomains << " subdomains\n";
}

// Grades in all directions, keeping planes z = const.
Array3 grade(const Array3& x) {
  const auto stretch = [](double s) { return s * (0.4 + 0.6 * s); };
  return {stretch(x[0]), 1.5 * stretch(x[1] / 1.5), x[2]};
}

// Moves inner nodes in the plane; on z = kHeight1 by the same amount from both sides.  Outer faces stay where they are.
Array3 skew(const Array3& x) {
  const double bubble = std::sin(kPi * x[0]) * std::sin(kPi * x[1] / 1.5);
  return {x[0] + 0.12 * bubble * std::cos(2 * x[2]), x[1] - 0.15 * bubble * std::cos(3 * x[2]), x[2]};
}

// Beside that moves inner nodes across: only off the contact plane and the ends, where z must stay.
Array3 skewAcross(const Array3& x) {
  auto y = skew(x);
  const bool inner = x[2] > 1e-9 && std::abs(x[2] - kHeight1) > 1e-9 && x[2] < kHeight1 + kHeight2 - 1e-9;
  if (inner) y[2] += 0.06 * std::sin(3 * x[0] + 2 * x[1]);
  return y;
}

TEUCHOS_UNIT_TEST(PatchTest, UniformMesh) {
  checkPatch(patch(stackedBlocks({3, 3}, Topology::Hex8, {})).decomposition("METIS", 5), out, success);
}

TEUCHOS_UNIT_TEST(PatchTest, GradedMesh) {
  checkPatch(patch(stackedBlocks({4, 4}, Topology::Hex8, grade)).decomposition("METIS", 6), out, success);
}

TEUCHOS_UNIT_TEST(PatchTest, SkewedMesh) {
  checkPatch(patch(stackedBlocks({4, 4}, Topology::Hex8, skewAcross)).decomposition("METIS", 7), out, success);
}

TEUCHOS_UNIT_TEST(PatchTest, SkewedTetrahedra) {
  checkPatch(patch(stackedBlocks({3, 3}, Topology::Tet4, skewAcross)).decomposition("METIS", 6), out, success);
}

// The faces of pyramids' bases and of wedges, triangles.
TEUCHOS_UNIT_TEST(PatchTest, SkewedPyramidsAndWedges) {
  for (const auto topology : {Topology::Pyramid5, Topology::Wedge6})
    checkPatch(patch(stackedBlocks({3, 3}, topology, skewAcross)).decomposition("METIS", 6), out, success);
}

TEUCHOS_UNIT_TEST(PatchTest, SmalseReachesTheSameDigits) {
  checkPatch(patch(stackedBlocks({3, 3}, Topology::Hex8, skewAcross)).decomposition("METIS", 4).solver("SMALSE"), out, success);
}

TEUCHOS_UNIT_TEST(PatchTest, NodeToNodeRefusesANonMatchingInterface) {
  const auto scene = patch(stackedBlocks({3, 4}, Topology::Hex8, {})).decomposition("METIS", 4);
  std::string message;
  try {
    scene.prepare();
  } catch (const InputError& e) {
    message = e.what();
  }
  out << message << "\n";
  // It says how far, where, and what would help.  ANALYTIC: of the spacings 1/4, 0.3 against 1/3, 0.375 the
  // node (0.5, 0.6) lies worst, hypot(1/6, 0.15) from its neighbour.
  for (const char* part : {"do not match", "Largest tangential mismatch: 0.2242", "upper_contact", "lower_contact", "(0.5, 0.6, 0.6)", "Mesh both surfaces alike"})
    TEST_ASSERT(message.find(part) != std::string::npos);
}

}  // namespace
