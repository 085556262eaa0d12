// SPDX-License-Identifier: BSD-3-Clause
// Code_Aster's test SSNV128 (V6.04.128), the scene of inputs/ssnv128.xml: a square plate pressed on a rigid plane
// and pushed along it with friction 1, in plane strain.
#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>

#include "ScenarioBuilder.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Verification;

constexpr double kEdge = 0.04;

SimulationResult solvePlate(int n) {
  BoxSpec plate;
  plate.blockName = "plate";
  plate.upper = {kEdge, kEdge, kEdge / n};  // one layer of cubes
  plate.divisions = {n, n, 1};
  plate.sideSetNames = {"left", "right", "bottom", "top", "faces", "faces"};
  const Friction friction{"Coulomb", {1, 1}};
  return ScenarioBuilder(makeBoxes({plate}))
      .material("plate", 1.3e11, 0.2)
      .displacement({"faces"}, "z", {0, 0, 0})
      .displacement({"right"}, "x", {0, 0, 0})
      .pressure({"top"}, 5e7)
      .pressure({"left"}, 15e7)
      .rigidPlane("bottom", {0, 0, 0}, {0, 1, 0}, &friction)
      .tolerance(1e-10)  // a node whose force is nearly 0 is open only where the digits tell
      .solve();
}

struct Point {
  double x, published, own;
};

// EXTERNAL: u_x(y = 0) as Code_Aster publishes it, within 5 %; OWN: a 2D solve on 128 x 128 elements.
constexpr Point points[] = {{0, 2.86e-5, 2.8602e-5},
                            {0.00125, 2.72e-5, 2.7225e-5},
                            {0.005, 2.28e-5, 2.2867e-5},
                            {0.0075, 1.98e-5, 1.9807e-5},
                            {0.01125, 1.50e-5, 1.5413e-5}};

TEUCHOS_UNIT_TEST(Ssnv128, DisplacementsAndResultants) {
  const int n = 64;
  const auto result = solvePlate(n);
  TEST_ASSERT(result.solved);
  TEST_ASSERT(result.report.model.subdomains > 1);
  if (result.displacement.empty()) return;  // not the root
  for (const auto& point : points) {
    const int node = int(std::lround(point.x / kEdge * n));  // x runs fastest, so the line y = z = 0 comes first
    const double ux = result.displacement[3 * std::size_t(node)];
    out << "u_x(" << point.x << ") = " << 1e5 * ux << "e-5\n";
    TEST_FLOATING_EQUALITY(ux, point.published, 0.05);
    TEST_FLOATING_EQUALITY(ux, point.own, 0.01);
  }
  const double thickness = kEdge / n;
  const auto sum = resultants(result);
  const auto& contact = result.report.interfaces.at(0);
  out << "sum N " << sum.normal / thickness << " N/m, sum T " << sum.tangential[0] / thickness << " N/m; " << contact.stick
      << " stick, " << contact.slip << " slip, " << contact.open << " open; kkt " << result.report.accuracy.errors.kkt()
      << " after " << result.report.solver.hessianMultiplications << " multiplications (" << result.report.solver.method << ")\n";
  TEST_FLOATING_EQUALITY(sum.normal / thickness, 5e7 * kEdge, 1e-8);       // ANALYTIC: 2e6, equilibrium
  TEST_FLOATING_EQUALITY(sum.tangential[0] / thickness, -1.4054e6, 0.01);  // OWN
  TEST_EQUALITY(contact.stick, 32);  // REGRESSION: both methods agree on all three zones
  TEST_EQUALITY(contact.slip, 86);
  TEST_EQUALITY(contact.open, 12);
}

}  // namespace
