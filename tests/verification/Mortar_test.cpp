// SPDX-License-Identifier: BSD-3-Clause
// Contact and ties between meshes that do not match: the answer of matching ones, sliding, rigid rotation, a published beam.
#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <cmath>
#include <string>

#include "ScenarioBuilder.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Verification;

// OWN: on meshes that match, mortar gives the answer of node to node, where pairs stick, slip and are open.
TEUCHOS_UNIT_TEST(Mortar, matching_meshes_have_one_answer) {
  for (const Topology topology : {Topology::Hex8, Topology::Tet4}) {
    BoxSpec lower, upper;
    lower.blockName = "lower";
    lower.lower = {0, 0, -1};
    lower.upper = {1, 1, 0};
    lower.divisions = {6, 4, 2};
    lower.topology = topology;
    lower.sideSetNames = {"", "", "", "", "bottom", "lower_contact"};
    upper = lower;
    upper.blockName = "upper";
    upper.lower = {0, 0, 0};
    upper.upper = {1, 1, 1};
    upper.sideSetNames = {"", "", "", "", "upper_contact", "top"};
    const Friction friction{"Coulomb", {0.6, 0.3}, {1, 1, 0}};
    const auto solve = [&](const std::string& discretization) {
      return ScenarioBuilder(makeBoxes({lower, upper})).material("lower", 1e5, 0.3).material("upper", 3e5, 0.2).clamp({"bottom"})
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
