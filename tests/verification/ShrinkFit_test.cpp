// SPDX-License-Identifier: BSD-3-Clause
// A ring pressed on another, plane strain, with other facets: what gaps are measured to decides.
#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <cmath>

#include "Ring.hpp"
#include "ScenarioBuilder.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Verification;

constexpr double kInside = 0.5, kRadius = 1.0, kOutside = 2.0, kFit = 1e-3, kModulus = 1000.0, kRatio = 0.3, kLength = 0.2;

// ANALYTIC (Lame): p (C_outer + C_inner) R = fit.
double pressureOfFit() {
  const double E = kModulus / (1 - kRatio * kRatio), nu = kRatio / (1 - kRatio), R = kRadius * kRadius, a = kInside * kInside, b = kOutside * kOutside;
  return kFit / (kRadius / E * ((b + R) / (b - R) + nu + (R + a) / (R - a) - nu));
}

struct Fit {
  double thicker = 0;  ///< of the radius of the inner ring's mesh
  std::string gap = "Geometric", smoothing = "None", penetration = "Resolve";
};

SimulationResult press(const Fit& fit) {
  Mesh mesh;
  addRing(mesh, {"inner", kInside, kRadius + fit.thicker, kLength, {32, 3, 1}});
  addRing(mesh, {"outer", kRadius, kOutside, kLength, {40, 4, 1}});
  NodeSet all{1, "all", {}}, alongX{2, "along x", {}}, alongY{3, "along y", {}};
  for (std::size_t i = 0; i < mesh.numNodes(); ++i) {
    all.nodes.push_back(std::int64_t(i));
    if (std::abs(mesh.coordinates[i][1]) < 1e-9) alongX.nodes.push_back(std::int64_t(i));
    if (std::abs(mesh.coordinates[i][0]) < 1e-9) alongY.nodes.push_back(std::int64_t(i));
  }
  mesh.nodeSets = {all, alongX, alongY};
  return ScenarioBuilder(mesh)
      .material("inner", kModulus, kRatio)
      .material("outer", kModulus, kRatio)
      .displacement({"all"}, "z", {0, 0, 0})
      .displacement({"along x"}, "y", {0, 0, 0})
      .displacement({"along y"}, "x", {0, 0, 0})
      .contact("outer_inner", "inner_outer")
      .contactOption("Discretization", "Mortar")
      .contactOption("Sides", "As Given")
      .contactOption("Gap", fit.gap)
      .contactOption("Primary Smoothing", fit.smoothing)
      .contactOption("Initial Penetration", fit.penetration)
      .decomposition("METIS", 4)
      .tolerance(1e-8)
      .solve();
}

// Least, mean and largest pressure over the analytic one.
std::array<double, 3> ratios(const SimulationResult& result) {
  double least = 1e300, most = 0, normal = 0, area = 0;
  for (const auto& pair : result.pairs) {
    least = std::min(least, pair.pressure);
    most = std::max(most, pair.pressure);
    normal += pair.normalForce;
    area += pair.area;
  }
  const double p = pressureOfFit();
  return {least / p, normal / area / p, most / p};
}

TEUCHOS_UNIT_TEST(ShrinkFit, PressureByGapAndBySmoothing) {
  const auto given = press({0, "-0.001"}), cylinder = press({kFit, "Geometric", "Cylinder"}), nagata = press({kFit, "Geometric", "Nagata"}),
             facets = press({kFit});
  for (const auto* result : {&given, &cylinder, &nagata, &facets}) TEST_ASSERT(result->solved);
  if (given.pairs.empty()) return;  // not the root
  for (const auto* result : {&given, &cylinder, &nagata, &facets}) {
    const auto r = ratios(*result);
    out << "pressure / analytic: least " << r[0] << ", mean " << r[1] << ", largest " << r[2] << ", overlap " << result->report.overlaps[0].depth << "\n";
  }
  for (const auto* result : {&given, &cylinder}) {
    TEST_COMPARE(ratios(*result)[0], >, 0.97);
    TEST_COMPARE(ratios(*result)[2], <, 1.03);
    TEST_COMPARE(std::abs(ratios(*result)[1] - 1), <, 0.015);
    TEST_COMPARE(std::abs(result->report.overlaps[0].depth / kFit - 1), <, 1e-3);
  }
  TEST_COMPARE(std::abs(ratios(nagata)[1] - 1), <, 0.03);
  TEST_COMPARE(ratios(facets)[0], <, 1e-3);  // a chord is 4.8e-3 deep, the fit 1e-3: pressed at corners, open between
  TEST_COMPARE(ratios(facets)[2], >, 2);
}

TEUCHOS_UNIT_TEST(ShrinkFit, IgnoredOrClosedThereIsNone) {
  for (const Fit& fit : {Fit{kFit, "Closed"}, Fit{kFit, "Geometric", "Cylinder", "Ignore"}, Fit{0, "0.001"}}) {
    const auto result = press(fit);
    TEST_ASSERT(result.solved);
    TEST_COMPARE(std::abs(resultants(result).normal), <=, 1e-12);
  }
}

}  // namespace
