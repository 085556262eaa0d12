// SPDX-License-Identifier: BSD-3-Clause
// A cube on a rigid plane, its top displaced down and sideways: part of the bottom sticks, part slips.
#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>

#include "ScenarioBuilder.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Verification;

// OWN: forces on the body by an independent dense solver of the same discrete problem.
struct Row {
  int n;
  std::array<double, 2> F;
  Array3 force;
  long stick, slip;
};

const Row rows[] = {{4, {0.3, 0.3}, {-1.09116274e-4, -1.09116274e-4, 1.07812329e-3}, 8, 17},
                    {4, {0.3, 0.15}, {-1.07334043e-4, -9.28951386e-5, 1.06474424e-3}, 3, 22},
                    {8, {0.3, 0.3}, {-1.04970403e-4, -1.04970403e-4, 1.06879413e-3}, 37, 44},
                    {8, {0.3, 0.15}, {-1.02947571e-4, -9.02654912e-5, 1.05664891e-3}, 8, 73}};

SimulationResult solveCube(int n, const std::array<double, 2>& F, int subdomains, const std::string& method) {
  BoxSpec cube;
  cube.blockName = "cube";
  cube.divisions = {n, n, n};
  cube.sideSetNames = {"", "", "", "", "bottom", "top"};
  const Friction friction{"Coulomb", F};
  return ScenarioBuilder(makeBoxes({cube}))
      .material("cube", 1.0, 0.3)
      .displacement({"top"}, "xyz", {4e-4, 4e-4, -1e-3})
      .rigidPlane("bottom", {0, 0, 0}, {0, 0, 1}, &friction)
      .decomposition("METIS", subdomains)
      .solver(method)
      .maximumMultiplications(20000)
      .tolerance(1e-9)
      .solve();
}

void checkRow(const Row& row, int subdomains, const std::string& method, Teuchos::FancyOStream& out, bool& success) {
  const auto result = solveCube(row.n, row.F, subdomains, method);
  TEST_ASSERT(result.solved);
  TEST_EQUALITY(result.report.model.subdomains, subdomains);
  const auto& contact = result.report.interfaces.at(0);
  const auto sum = resultants(result);
  out << "n " << row.n << ", " << subdomains << " subdomains, " << result.report.solver.method << ": kkt "
      << result.report.accuracy.errors.kkt() << ", " << result.report.solver.hessianMultiplications << " multiplications\n";
  if (result.pairs.empty()) return;  // not the root
  for (int d = 0; d < 3; ++d) TEST_FLOATING_EQUALITY(sum.force[d], row.force[d], 5e-7);  // OWN, 6 digits
  TEST_EQUALITY(contact.stick, row.stick);                                               // OWN
  TEST_EQUALITY(contact.slip, row.slip);
  TEST_EQUALITY(contact.open, 0);
}

TEUCHOS_UNIT_TEST(PartialSlip, FourRowsOfTheTable) {
  for (const auto& row : rows) checkRow(row, row.n == 4 ? 1 : 6, "Automatic", out, success);
}

TEUCHOS_UNIT_TEST(PartialSlip, SmalseOnJaggedParts) { checkRow(rows[1], 5, "SMALSE", out, success); }

// ANALYTIC: the scene is its own mirror image about x = y where the coefficients are exchanged.
TEUCHOS_UNIT_TEST(PartialSlip, ExchangedCoefficientsMirrorTheForces) {
  const auto a = solveCube(4, {0.3, 0.15}, 3, "Automatic"), b = solveCube(4, {0.15, 0.3}, 3, "Automatic");
  const auto fa = resultants(a).force, fb = resultants(b).force;
  if (a.pairs.empty()) return;
  TEST_FLOATING_EQUALITY(fa[0], fb[1], 1e-7);
  TEST_FLOATING_EQUALITY(fa[1], fb[0], 1e-7);
  TEST_COMPARE(std::abs(fa[0] - fa[1]), >, 0.1 * std::abs(fa[0]));  // the axes matter
}

}  // namespace
