// SPDX-License-Identifier: BSD-3-Clause
// The law off its axes: two blocks with orthotropic friction whose axes lie askew to the mesh, the load and the slip.
#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>

#include "ScenarioBuilder.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Verification;

constexpr std::array<double, 2> kF = {0.5, 0.15};

// Everything is turned by Q: mesh, prescribed displacements, tractions and the axes of friction.
SimulationResult solveTurned(const Rotation& Q, int subdomains) {
  BoxSpec lower, upper;
  lower.blockName = "lower";
  lower.upper = {1, 1, 0.5};
  lower.divisions = {4, 4, 2};
  lower.sideSetNames = {"", "", "", "", "bottom", "lower_contact"};
  lower.map = [Q](const Array3& x) { return Q * x; };
  upper = lower;
  upper.blockName = "upper";
  upper.lower = {0, 0, 0.5};
  upper.upper = {1, 1, 1};
  upper.sideSetNames = {"", "side", "", "", "upper_contact", "top"};
  const Friction friction{"Coulomb", kF, Q * Array3{std::cos(0.6), std::sin(0.6), 0.3}};
  return ScenarioBuilder(makeBoxes({lower, upper}))
      .material("lower", 1.0, 0.3)
      .material("upper", 2.0, 0.2)
      .clamp({"bottom"})
      .displacement({"top"}, "xyz", Q * Array3{3e-4, 2e-4, -8e-4})
      .traction({"side"}, Q * Array3{-1e-4, 2e-4, 1e-4})
      .contact("upper_contact", "lower_contact", &friction)
      .decomposition("METIS", subdomains)
      .maximumMultiplications(20000)
      .tolerance(1e-9)
      .solve();
}

// Greatest deviation from lambda_T = g F^2 Tu / || F Tu || over the slipping pairs, of the largest lambda_N.
struct LawCheck {
  double error = 0, angle = 0;  // angle: largest between traction and slip [rad]
  int slipping = 0;
};

LawCheck checkLaw(const SimulationResult& result, const Array3& normal) {
  double largestForce = 0, largestSlip = 0;
  for (const auto& pair : result.pairs) {
    largestForce = std::max(largestForce, pair.normalForce);
    largestSlip = std::max(largestSlip, std::sqrt(dot(pair.slip, pair.slip)));
  }
  LawCheck check;
  for (const auto& pair : result.pairs) {
    const Array3 t2 = cross(normal, pair.axis);
    const double Tu[2] = {dot(pair.slip, pair.axis), dot(pair.slip, t2)};
    const double lambda[2] = {-dot(pair.tangentialForce, pair.axis), -dot(pair.tangentialForce, t2)};
    // Near the border of the stick zone the direction of a vanishing slip says nothing.
    if (pair.status != ContactStatus::Slip || std::hypot(Tu[0], Tu[1]) < 1e-3 * largestSlip) continue;
    ++check.slipping;
    const double scale = pair.normalForce / std::hypot(kF[0] * Tu[0], kF[1] * Tu[1]);
    for (int j = 0; j < 2; ++j)
      check.error = std::max(check.error, std::abs(lambda[j] - scale * kF[j] * kF[j] * Tu[j]) / largestForce);
    const double sine = std::abs(lambda[0] * Tu[1] - lambda[1] * Tu[0]) / (std::hypot(lambda[0], lambda[1]) * std::hypot(Tu[0], Tu[1]));
    check.angle = std::max(check.angle, std::asin(std::min(1.0, sine)));
  }
  return check;
}

// ANALYTIC: the associated law holds point by point, in both frames.
TEUCHOS_UNIT_TEST(RotatedLaw, SlipObeysTheAssociatedLaw) {
  for (const auto& Q : {identity, tilted}) {
    const auto result = solveTurned(Q, 4);
    TEST_ASSERT(result.solved);
    const auto& contact = result.report.interfaces.at(0);
    const auto check = checkLaw(result, Q * Array3{0, 0, -1});
    out << contact.stick << " stick, " << contact.slip << " slip, " << contact.open << " open; error of the law " << check.error
        << ", largest angle of traction and slip " << check.angle << ", kkt " << result.report.accuracy.errors.kkt() << "\n";
    if (result.pairs.empty()) continue;  // not the root
    TEST_ASSERT(check.slipping >= 8);
    TEST_COMPARE(check.angle, >, 0.2);  // the isotropic law would have 0
    TEST_COMPARE(check.error, <=, 1e-6);
  }
}

// ANALYTIC: a turned scene has the turned forces, whatever the decomposition.
TEUCHOS_UNIT_TEST(RotatedLaw, ATurnedSceneHasTurnedForces) {
  const auto straight = solveTurned(identity, 5), turned = solveTurned(tilted, 3);
  TEST_EQUALITY(straight.pairs.size(), turned.pairs.size());
  double largest = 0, error = 0, change = 0;
  for (std::size_t i = 0; i < straight.pairs.size(); ++i) {
    const Array3 expected = tilted * straight.pairs[i].force;
    TEST_ASSERT(straight.pairs[i].status == turned.pairs[i].status);
    for (int d = 0; d < 3; ++d) {
      largest = std::max(largest, std::abs(expected[d]));
      error = std::max(error, std::abs(turned.pairs[i].force[d] - expected[d]));
      change = std::max(change, std::abs(turned.pairs[i].force[d] - straight.pairs[i].force[d]));
    }
  }
  if (straight.pairs.empty()) return;  // not the root
  out << "difference " << error / largest << " of the largest force\n";
  TEST_COMPARE(error, <=, 1e-6 * largest);
  TEST_COMPARE(change, >, 0.5 * largest);  // it was turned
}

}  // namespace
