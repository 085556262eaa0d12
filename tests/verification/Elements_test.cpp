// SPDX-License-Identifier: BSD-3-Clause
// Meshes of all element types in many pieces: linear fields are reproduced, the cut does not matter, equal pieces share.
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_CellMesh.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_LinearElasticity.hpp"
#include "ScenarioBuilder.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Verification;

constexpr double kYoung = 210.0, kPoisson = 0.3;

struct Patch {
  std::string name;
  Mesh mesh;
};

// A box of hexahedra, 1 x 1.5 x 1, its inner nodes moved by a quarter of the mesh width.
Mesh distortedBlock(std::array<int, 3> n, double distortion) {
  BoxSpec box;
  box.blockName = "box";
  box.upper = {1, 1.5, 1};
  box.divisions = n;
  box.sideSetNames = {"skin", "skin", "skin", "skin", "skin", "skin"};
  return distortedBox(box, distortion);
}

Mesh mixed(const Mesh& hexahedra, std::size_t layer, ElementOrder order) {
  std::vector<Cell> cells;
  for (std::size_t e = 0; e < hexahedra.numElements(); ++e)
    cells.push_back(std::array<Cell, 3>{Cell::Hexahedron, Cell::Pyramids, Cell::Wedges}[e / layer % 3]);
  return withCells(hexahedra, cells, order);
}

// Of every topology and two mixed ones; on several ranks, where runs take long, the mixed ones and one other.
std::vector<Patch> patchesOf(const Mesh& box, std::size_t layer) {
  std::vector<Patch> result{{"mixed", mixed(box, layer, ElementOrder::Linear)}, {"mixed quadratic", mixed(box, layer, ElementOrder::Quadratic)}};
  for (int t = 0; t < kNumTopologies; ++t)
    if (numRanks() == 1 || Topology(t) == Topology::Tet10) result.push_back({topologyName(Topology(t)), withElements(box, Topology(t))});
  return result;
}

ScenarioBuilder withMaterial(const Mesh& mesh, std::vector<int> bricks = {}) {
  ScenarioBuilder scene(mesh, std::move(bricks));
  for (const auto& block : mesh.blocks) scene.material(block.name, kYoung, kPoisson);
  return scene;
}

// ANALYTIC: u = H x + c, prescribed on the whole surface, mid-nodes too, holds inside; the stress is uniform.
TEUCHOS_UNIT_TEST(Elements, LinearFieldInManyPieces) {
  constexpr double H[3][3] = {{1.3e-3, -0.4e-3, 0.7e-3}, {0.2e-3, -0.6e-3, 1.1e-3}, {-0.6e-3, 0.5e-3, 0.8e-3}};
  const double shear = kYoung / (2 * (1 + kPoisson)), lambda = kYoung * kPoisson / ((1 + kPoisson) * (1 - 2 * kPoisson));
  const double trace = H[0][0] + H[1][1] + H[2][2];
  const std::array<double, 6> stress{2 * shear * H[0][0] + lambda * trace, 2 * shear * H[1][1] + lambda * trace, 2 * shear * H[2][2] + lambda * trace,
                                     shear * (H[0][1] + H[1][0]), shear * (H[1][2] + H[2][1]), shear * (H[0][2] + H[2][0])};
  for (const auto& [name, mesh] : patchesOf(distortedBlock({3, 3, 3}, 0.25), 9))
    for (const int pieces : {4, 16}) {
      const auto result = withMaterial(mesh)
                              .displacementField({"skin"}, "xyz",
                                            {"0.0013*x - 0.0004*y + 0.0007*z + 0.001", "0.0002*x - 0.0006*y + 0.0011*z", "-0.0006*x + 0.0005*y + 0.0008*z"})
                              .decomposition("METIS", pieces)
                              .tolerance(1e-13)
                              .solve();
      TEST_ASSERT(result.solved);
      TEST_EQUALITY(result.report.model.subdomains, pieces);
      TEST_EQUALITY(result.report.model.bodies, 1);
      double uError = 0, sError = 0;
      for (std::size_t i = 0; 3 * i < result.displacement.size(); ++i)  // rank 0
        for (std::size_t c = 0; c < 3; ++c) {
          double exact = c == 0 ? 0.001 : 0.0;
          for (std::size_t d = 0; d < 3; ++d) exact += H[c][d] * mesh.coordinates[i][d];
          uError = std::max(uError, std::abs(result.displacement[3 * i + c] - exact));
        }
      for (const auto& s : result.elements.stress)
        for (std::size_t c = 0; c < 6; ++c) sError = std::max(sError, std::abs(s[c] - stress[c]));
      out << name << " in " << pieces << ": u " << uError / 3e-3 << ", stress " << sError / 0.5 << ", " << result.report.solver.hessianMultiplications
          << " multiplications\n";
      TEST_COMPARE(uError, <, 1e-10 * 3e-3);
      TEST_COMPARE(sError, <, 1e-10 * 0.5);
    }
}

// A bent bar, clamped at one end, under traction, pressure on a curved side and its weight: one piece and many give the same.
TEUCHOS_UNIT_TEST(Elements, TheCutDoesNotMatter) {
  BoxSpec box;
  box.blockName = "bar";
  box.upper = {3, 1, 1};
  box.divisions = {6, 2, 3};
  box.sideSetNames = {"left", "right", "", "", "", "top"};
  const auto bend = [](const Array3& x) {
    return Array3{x[0] + 0.1 * x[0] * x[2], x[1] * (1 + 0.1 * x[0]), x[2] - 0.1 * x[0] * x[0]};
  };
  for (const auto& [name, mesh] : patchesOf(makeBoxes({box}), 12)) {
    std::vector<double> whole;
    for (const int pieces : {1, 16}) {
      auto scene = withMaterial(mesh);
      scene.moveNodes(bend).clamp({"left"}).traction({"right"}, {1.0, 0.5, -0.25}).pressure({"top"}, "0.3*x");
      const auto result = scene.decomposition("METIS", pieces).tolerance(1e-12).solve();
      TEST_ASSERT(result.solved);
      if (pieces == 1) whole = result.displacement;
      double largest = 0, difference = 0;
      for (std::size_t i = 0; i < whole.size(); ++i) {
        largest = std::max(largest, std::abs(whole[i]));
        difference = std::max(difference, std::abs(whole[i] - result.displacement[i]));
      }
      if (!whole.empty()) TEST_COMPARE(largest, >, 0.4);
      out << name << " in " << pieces << ": " << difference << " of " << largest << ", " << result.report.solver.hessianMultiplications
          << " multiplications\n";
      TEST_COMPARE(difference, <=, 1e-9 * largest);
    }
  }
}

// Equal bricks of quadratic elements have the same nodes in the same order, and share one matrix.
TEUCHOS_UNIT_TEST(Elements, EqualBricksShare) {
  BoxSpec box;
  box.blockName = "bar";
  box.upper = {3, 1, 1};
  box.divisions = {6, 2, 2};
  box.sideSetNames = {"left", "right", "", "", "", ""};
  const Mesh hexahedra = makeBoxes({box});
  for (int t = 0; t < kNumTopologies; ++t) {
    const Mesh mesh = withElements(hexahedra, Topology(t));
    const int perCell = int(mesh.numElements() / hexahedra.numElements());
    std::vector<int> bricks;
    for (int e = 0; e < int(mesh.numElements()); ++e) bricks.push_back(e / perCell % 6 / 2);
    const auto result = withMaterial(mesh, bricks).clamp({"left"}).traction({"right"}, {1, 0, 0}).decomposition("Bricks").solve();
    TEST_ASSERT(result.solved);
    TEST_EQUALITY(result.report.model.subdomains, 3);
    out << topologyName(Topology(t)) << ": " << result.report.model.congruenceClasses << " classes\n";
    TEST_COMPARE(result.report.model.congruenceClasses, <=, numRanks());
  }
}

std::string refusal(const ScenarioBuilder& scene) {
  try {
    scene.solve();
  } catch (const InputError& error) {
    return error.what();
  }
  return "(nothing thrown)";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEUCHOS_UNIT_TEST(Elements, BadMeshesAreRefusedOnAllRanks) {
  const auto solvable = [](Mesh mesh) { return withMaterial(std::move(mesh)).clamp({"skin"}).decomposition("METIS", 4); };
  const Mesh box = distortedBlock({2, 2, 2}, 0.2);
  // a mid-node at a corner
  Mesh collapsed = withElements(box, Topology::Tet10);
  const auto& nodes = collapsed.blocks[0].connectivity;
  collapsed.coordinates[std::size_t(nodes[10 * 30 + 4])] = collapsed.coordinates[std::size_t(nodes[10 * 30 + 1])];
  const auto atCorner = refusal(solvable(collapsed));
  out << atCorner << "\n";
  TEST_ASSERT(contains(atCorner, "(TETRA10) of block \"box\" has its node") && contains(atCorner, "must lie between 1/4 and 3/4"));
  // linear and quadratic elements on one side: every second element of the box stays linear
  Mesh half = withElements(box, Topology::Hex20);
  half.blocks.push_back({77, "linear", Topology::Hex8, {}});
  for (int i = 0; i < 8; ++i) half.blocks[1].connectivity.push_back(half.blocks[0].connectivity[std::size_t(20 * 7 + i)]);
  half.blocks[0].connectivity.resize(20 * 7);
  const auto hanging = refusal(solvable(half));
  out << hanging << "\n";
  TEST_ASSERT(contains(hanging, "and 8 share the corners of a side, but not the nodes in the middle"));
}

}  // namespace
