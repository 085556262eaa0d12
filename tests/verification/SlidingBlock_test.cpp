// SPDX-License-Identifier: BSD-3-Clause
// A flat block pressed on a rigid plane by a unit pressure and drawn along it much farther than it deforms:
// all points slide in one direction, and the mean traction is that of the law.
#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>

#include "ScenarioBuilder.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Verification;

constexpr double kPi = 3.14159265358979323846, kPressure = 1.0;

// Tractions that resist: t1, t2 components of lambda_T per area.
struct Traction {
  double x, y;
};

Traction slide(const Friction& friction, double degrees, bool& success, Teuchos::FancyOStream& out) {
  BoxSpec block;
  block.blockName = "block";
  block.upper = {1.0, 1.0, 0.1};
  block.divisions = {3, 3, 1};
  block.sideSetNames = {"", "", "", "", "bottom", "top"};
  const double theta = degrees * kPi / 180;
  const auto result = ScenarioBuilder(makeBoxes({block}))
                          .material("block", 1e4, 0.0)
                          .displacement({"top"}, "xy", {std::cos(theta), std::sin(theta), 0})
                          .pressure({"top"}, kPressure)
                          .rigidPlane("bottom", {0, 0, 0}, {0, 0, 1}, &friction)
                          .decomposition("METIS", 2)
                          .tolerance(1e-9)
                          .solve();
  TEST_ASSERT(result.solved);
  const auto sum = resultants(result);
  TEST_FLOATING_EQUALITY(sum.normal, kPressure, 1e-7);  // the area is 1
  // Across a direction without resistance the law leaves the traction open, and a pair may count as stuck.
  const bool resisted = friction.coefficients[1] > 0 || degrees != 90;
  for (const auto& pair : result.pairs) TEST_ASSERT(pair.status == ContactStatus::Slip || !resisted);
  out << "theta " << degrees << ": (" << -sum.tangential[0] << ", " << -sum.tangential[1] << "), kkt "
      << result.report.accuracy.errors.kkt() << " after " << result.report.solver.hessianMultiplications << " multiplications "
      << result.report.solver.reason << "\n";
  return {-sum.tangential[0], -sum.tangential[1]};  // the law's sign: along the slip
}

// F^2 t / || F t ||
Traction closedForm(const std::array<double, 2>& F, double degrees) {
  const double t1 = std::cos(degrees * kPi / 180), t2 = std::sin(degrees * kPi / 180);
  const double length = std::hypot(F[0] * t1, F[1] * t2);
  return {F[0] * F[0] * t1 / length, F[1] * F[1] * t2 / length};
}

struct Row {
  double degrees;
  Traction traction;
};

// ANALYTIC: the five values, printed with four digits, and the closed form itself to 1e-6.
constexpr Row rows[] = {{0, {0.3, 0.0}}, {30, {0.2882, 0.0416}}, {45, {0.2683, 0.0671}}, {60, {0.2268, 0.0982}}, {90, {0.0, 0.15}}};

TEUCHOS_UNIT_TEST(SlidingBlock, FiveDirections) {
  const Friction friction{"Coulomb", {0.3, 0.15}};
  for (const auto& row : rows) {
    const auto t = slide(friction, row.degrees, success, out);
    const auto exact = closedForm(friction.coefficients, row.degrees);
    TEST_COMPARE(std::abs(t.x - row.traction.x), <=, 0.5001e-4);
    TEST_COMPARE(std::abs(t.y - row.traction.y), <=, 0.5001e-4);
    TEST_COMPARE(std::hypot(t.x - exact.x, t.y - exact.y), <=, 1e-6);
  }
}

TEUCHOS_UNIT_TEST(SlidingBlock, TrescaIsTheSameAtTheSameBound) {
  const Friction friction{"Tresca", {0.3, 0.15}, {1, 0, 0}, kPressure};
  for (const auto& row : rows) {
    const auto t = slide(friction, row.degrees, success, out);
    const auto exact = closedForm(friction.coefficients, row.degrees);  // ANALYTIC
    TEST_COMPARE(std::hypot(t.x - exact.x, t.y - exact.y), <=, 1e-6);
  }
}

// ANALYTIC: with F = mu I the traction is mu along the slip, in any frame.
TEUCHOS_UNIT_TEST(SlidingBlock, EqualCoefficientsAreIsotropic) {
  for (double turn : {0.0, 25.0}) {
    const Friction friction{"Coulomb", {0.3, 0.3}, {std::cos(turn), std::sin(turn), 0}};
    const auto t = slide(friction, 50, success, out);
    TEST_COMPARE(std::abs(t.x - 0.3 * std::cos(50 * kPi / 180)), <=, 1e-6);
    TEST_COMPARE(std::abs(t.y - 0.3 * std::sin(50 * kPi / 180)), <=, 1e-6);
  }
}

// ANALYTIC: t1 along y is the same as the coefficients exchanged.
TEUCHOS_UNIT_TEST(SlidingBlock, AQuarterTurnOfTheFrameSwapsTheAxes) {
  const Friction turned{"Coulomb", {0.3, 0.15}, {0, 1, 0}};
  for (double degrees : {20.0, 45.0}) {
    const auto t = slide(turned, degrees, success, out);
    const auto exact = closedForm({0.15, 0.3}, degrees);
    TEST_COMPARE(std::hypot(t.x - exact.x, t.y - exact.y), <=, 1e-6);
  }
}

// ANALYTIC: without resistance along t2 the law has no traction there, even when sliding along it.
TEUCHOS_UNIT_TEST(SlidingBlock, ACoefficientZeroGivesNoTractionThere) {
  for (const char* law : {"Coulomb", "Tresca"}) {
    const Friction friction{law, {0.3, 0.0}, {1, 0, 0}, kPressure};
    const auto t = slide(friction, 40, success, out);
    TEST_COMPARE(std::abs(t.x - 0.3), <=, 1e-6);
    TEST_COMPARE(std::abs(t.y), <=, 1e-12);
    const auto along = slide(friction, 90, success, out);
    TEST_COMPARE(std::abs(along.y), <=, 1e-12);
  }
  const auto none = slide({"Coulomb", {0.0, 0.0}}, 40, success, out);
  TEST_ASSERT(none.x == 0 && none.y == 0);
}

}  // namespace
