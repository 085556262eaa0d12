// SPDX-License-Identifier: BSD-3-Clause
// Bonded interfaces: two blocks tied together are one block.
#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <cmath>
#include <map>

#include "Haptos_Error.hpp"
#include "ScenarioBuilder.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Verification;

BoxSpec block(const std::string& name, double low, double high, int cells) {
  BoxSpec box;
  box.blockName = name;
  box.lower = {0, 0, low};
  box.upper = {1, 1, high};
  box.divisions = {3, 3, cells};
  box.sideSetNames = {name + "_x0", name + "_x1", "", "", name + "_low", name + "_high"};
  return box;
}

const Friction tied{"Tied"};

ScenarioBuilder pulled(Mesh mesh, const std::string& bottom, const std::string& top) {
  ScenarioBuilder scene(std::move(mesh));
  scene.clamp({bottom}).traction({top}, {0.3, -0.2, 0.5}).tolerance(1e-10);  // pulls: contact would open
  return scene;
}

using Place = std::array<long, 3>;
Place place(const Array3& x) { return {std::lround(1e6 * x[0]), std::lround(1e6 * x[1]), std::lround(1e6 * x[2])}; }

// OWN: the same mesh without an interface.
TEUCHOS_UNIT_TEST(Tied, TwoTiedBlocksAreOne) {
  ScenarioBuilder one = pulled(makeBoxes({block("whole", 0, 2, 6)}), "whole_low", "whole_high");
  one.material("whole", 100, 0.3).decomposition("METIS", 5);
  const auto whole = one.solve();
  std::map<Place, Array3> displacement;
  for (std::size_t i = 0; 3 * i < whole.displacement.size(); ++i)
    displacement[place(one.mesh().coordinates[i])] = {whole.displacement[3 * i], whole.displacement[3 * i + 1], whole.displacement[3 * i + 2]};
  for (const char* method : {"Automatic", "SMALSE", "Subspace Newton"}) {
    ScenarioBuilder two = pulled(makeBoxes({block("lower", 0, 1, 3), block("upper", 1, 2, 3)}), "lower_low", "upper_high");
    two.material("lower", 100, 0.3).material("upper", 100, 0.3).contact("upper_low", "lower_high", &tied).decomposition("METIS", 6).solver(method);
    const auto result = two.solve();
    TEST_ASSERT(result.solved);
    TEST_EQUALITY(result.report.model.contactPairs, 0);
    TEST_EQUALITY(result.report.model.tiedPairs, 16);
    if (std::string(method) == "Automatic") TEST_EQUALITY(result.report.solver.method, "PCPG");
    double largest = 0, error = 0;
    for (std::size_t i = 0; 3 * i < result.displacement.size(); ++i)
      for (int d = 0; d < 3; ++d) {
        const double expected = displacement.at(place(two.mesh().coordinates[i]))[d];
        largest = std::max(largest, std::abs(expected));
        error = std::max(error, std::abs(result.displacement[3 * i + d] - expected));
      }
    out << method << ": " << result.report.solver.method << ", " << result.report.solver.hessianMultiplications
        << " multiplications, difference " << error << " of " << largest << "\n";
    TEST_COMPARE(error, <=, 1e-8 * largest);
  }
}

long multiplicationsOfContrast(double contrast, Teuchos::FancyOStream& out, bool& success) {
  ScenarioBuilder scene = pulled(makeBoxes({block("lower", 0, 1, 3), block("upper", 1, 2, 3)}), "lower_low", "upper_high");
  const auto result = scene.material("lower", 100, 0.3).material("upper", 100 * contrast, 0.3).contact("upper_low", "lower_high", &tied)
                          .decomposition("METIS", 12).tolerance(1e-6).solve();
  TEST_ASSERT(result.solved);
  TEST_EQUALITY(result.report.solver.method, "PCPG");
  out << "contrast " << contrast << ": " << result.report.solver.hessianMultiplications << " multiplications\n";
  return result.report.solver.hessianMultiplications;
}

TEUCHOS_UNIT_TEST(Tied, ContrastsCostNothing) {
  const long alike = multiplicationsOfContrast(1, out, success);
  for (const double contrast : {1e-6, 1e-3, 1e3, 1e6}) TEST_COMPARE(multiplicationsOfContrast(contrast, out, success), <=, alike + 3);
}

// Elements 1 : 1 : .03 make subdomains soft against bending that are no thinner than others.
TEUCHOS_UNIT_TEST(Tied, FlatElementsAreDeflated) {
  BoxSpec lower = block("lower", 0, 0.1, 20), upper = block("upper", 0.1, 0.2, 20);
  lower.divisions = upper.divisions = {6, 6, 20};
  ScenarioBuilder scene = pulled(makeBoxes({lower, upper}), "lower_low", "upper_high");
  const auto result = scene.material("lower", 100, 0.3).material("upper", 400, 0.3).contact("upper_low", "lower_high", &tied)
                          .decomposition("METIS", 24).tolerance(1e-6).solve();
  TEST_ASSERT(result.solved);
  out << result.report.solver.hessianMultiplications << " multiplications, " << result.report.solver.deflation.motions << " motions\n";
  TEST_ASSERT(result.report.solver.deflation.motions > 0);
  TEST_COMPARE(result.report.solver.hessianMultiplications, <=, 40);  // 259 without, 36 where 20 iterations tell
}

// A tied interface and one with friction in the same model: what is tied is held.
TEUCHOS_UNIT_TEST(Tied, BesideContact) {
  const Friction friction{"Coulomb", {0.3, 0.3}};
  ScenarioBuilder scene(makeBoxes({block("first", 0, 1, 2), block("second", 1, 2, 2), block("third", 2, 3, 2)}));
  const auto result = scene.material("first", 100, 0.3).material("second", 200, 0.2).material("third", 100, 0.3)
                          .clamp({"first_low"}).traction({"third_high"}, {0.05, 0, -1})
                          .contact("second_low", "first_high", &tied)
                          .contact("third_low", "second_high", &friction)
                          .decomposition("METIS", 6).tolerance(1e-8).solve();
  TEST_ASSERT(result.solved);
  TEST_EQUALITY(result.report.model.tiedPairs, 16);
  TEST_EQUALITY(result.report.model.contactPairs, 16);
  TEST_EQUALITY(result.report.solver.method, "Subspace Newton");
  if (result.pairs.empty()) return;  // not the root
  for (const auto& interface : result.report.interfaces) {  // in series: both carry the load
    TEST_FLOATING_EQUALITY(interface.normalForce, 1.0, 1e-6);
    TEST_FLOATING_EQUALITY(interface.tangentialForce[0], -0.05, 1e-5);
  }
  TEST_EQUALITY(result.report.interfaces[0].stick, 16L);
  for (const auto& pair : result.pairs)
    if (pair.interface == 0) TEST_ASSERT(std::hypot(pair.slip[0], pair.slip[1], pair.slip[2]) < 1e-7);
}

TEUCHOS_UNIT_TEST(Tied, DisplacementsThatPartItAreRefused) {
  ScenarioBuilder scene(makeBoxes({block("lower", 0, 1, 2), block("upper", 1, 2, 2)}));
  scene.material("lower", 100, 0.3).material("upper", 100, 0.3).contact("upper_low", "lower_high", &tied).clamp({"lower_low", "lower_high"});
  ScenarioBuilder fits = scene;
  fits.displacement({"upper_low"}, "xyz", {0, 0, 0}).traction({"upper_high"}, {0, 0, 1});
  TEST_ASSERT(fits.solve().solved);
  scene.displacement({"upper_low"}, "xyz", {0, 0.1, 0});
  TEST_THROW(scene.prepare(), InsufficientModel);
}

}  // namespace
