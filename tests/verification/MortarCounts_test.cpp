// SPDX-License-Identifier: BSD-3-Clause
// Meshes that do not match cost hardly more multiplications by F than matching ones of the same size, whichever side is stiffer.
#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "ScenarioBuilder.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Verification;

struct Beams {
  int lower, upper;           ///< elements an edge of length 1
  double shift = 0;           ///< of the upper mesh, in its elements
  double contrast = 1;        ///< E of the upper beam by that of the lower
  std::string method = "METIS";
};

// Two beams on each other as in the benchmark, cut by METIS or into 16 bricks each.
std::pair<Mesh, std::vector<int>> beamsMesh(const Beams& beams) {
  BoxSpec lower, upper;
  lower.blockName = "lower";
  lower.lower = {0, 0, -1};
  lower.upper = {2, 1, 0};
  lower.divisions = {2 * beams.lower, beams.lower, beams.lower};
  lower.sideSetNames = {"clamp", "", "", "", "bottom", "lower_contact"};
  upper.blockName = "upper";
  upper.upper = {2, 1, 1};
  upper.divisions = {2 * beams.upper, beams.upper, beams.upper};
  upper.sideSetNames = {"clamp", "end", "", "", "upper_contact", "top"};
  const double by = 4 * beams.shift / beams.upper;
  upper.map = [by](const Array3& x) { return Array3{x[0] + by * x[0] * (2 - x[0]) / 4, x[1] + by * x[1] * (1 - x[1]), x[2]}; };
  const Mesh mesh = makeBoxes({lower, upper});
  std::vector<int> bricks;
  if (beams.method == "METIS") return {mesh, bricks};
  for (const auto& block : mesh.blocks)
    for (std::size_t e = 0; e < block.numElements(); ++e) {
      Array3 middle{0, 0, 0};
      for (std::size_t i = 0; i < 8; ++i)
        for (std::size_t c = 0; c < 3; ++c) middle[c] += mesh.coordinates[std::size_t(block.connectivity[8 * e + i])][c] / 8;
      const auto half = [](double x) { return int(std::floor(2 * x + 1e-9)); };
      bricks.push_back(16 * (middle[2] > 0) + half(middle[0]) + 4 * half(middle[1]) + 8 * half(middle[2] + (middle[2] < 0)));
    }
  return {mesh, bricks};
}

long multiplications(const Beams& beams, Teuchos::FancyOStream& out, bool& success) {
  const Friction friction{"Coulomb", {0.3, 0.3}};
  const auto [mesh, bricks] = beamsMesh(beams);
  ScenarioBuilder scene(mesh, bricks);
  scene.material("lower", 1e5, 0.3).material("upper", 1e5 * beams.contrast, 0.3).clamp({"clamp"})
      .pressure({"top", "bottom"}, "100*min(1, max(0, 1.5 - x))").traction({"end"}, {10, 10, 10})
      .contact("upper_contact", "lower_contact", &friction)
      .contactOption("Discretization", "Automatic").decomposition(beams.method, beams.method == "METIS" ? 32 : 0);
  const auto result = scene.solve();
  TEST_ASSERT(result.solved);
  out << beams.lower << " : " << beams.upper << " shift " << beams.shift << " contrast " << beams.contrast << " " << beams.method << ": "
      << result.report.solver.hessianMultiplications << " multiplications, " << result.report.model.discretization << ", "
      << result.report.model.contactPairs << " pairs, stick " << result.report.interfaces[0].stick << " slip " << result.report.interfaces[0].slip
      << " open " << result.report.interfaces[0].open << "\n";
  return result.report.solver.hessianMultiplications;
}

// METIS gives bodies subdomains by their elements: a coarse body on a fine one has few and large ones, which costs as much again.
TEUCHOS_UNIT_TEST(MortarCounts, at_most_1_3_times_those_of_matching_meshes) {
  for (const std::string method : {"METIS", "Bricks"})
    for (const double contrast : {1.0, 1e3, 1e-3}) {
      const long matching = multiplications({8, 8, 0, contrast, method}, out, success);
      for (Beams beams : {Beams{8, 8, 0.5}, Beams{6, 9}, Beams{5, 10}, Beams{10, 5}}) {
        beams.contrast = contrast;
        beams.method = method;
        const long count = multiplications(beams, out, success);
        TEST_COMPARE(double(count), <=, (method == "METIS" && beams.lower != beams.upper ? 1.5 : 1.3) * double(matching));
      }
    }
}

}  // namespace
