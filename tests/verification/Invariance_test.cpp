// SPDX-License-Identifier: BSD-3-Clause
// What must not matter: the frame, the order of the axes, the principal direction where F1 = F2, units; what must matter
// little: the stiffness contrast.  ANALYTIC: forces turn with the scene, counts stay.
#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>
#include <sstream>

#include "ScenarioBuilder.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Verification;

const Rotation axesSwapped{Array3{0, 1, 0}, Array3{0, 0, 1}, Array3{1, 0, 0}};  // x -> z -> y -> x

/// The benchmark of two beams; everything is turned by Q, lengths and forces are in units of `length` and `force`.
struct Variant {
  int k = 2, p = 3;
  bool brief = false;
  Rotation Q = identity;
  std::array<double, 2> F{0.5, 0.15};
  Array3 direction{std::cos(0.4), std::sin(0.4), 0};
  double length = 1, force = 1, contrast = 1;
  double tolerance = 1e-6;
};

// 100 clip(1.5 - x, 0, 1) in the turned coordinates
std::string ramp(const Variant& v) {
  std::ostringstream text;
  text.precision(17);
  text << 100 * v.force / (v.length * v.length) << "*min(1, max(0, 1.5 - ((" << v.Q[0][0] << ")*x + (" << v.Q[1][0] << ")*y + ("
       << v.Q[2][0] << ")*z)/" << v.length << "))";
  return text.str();
}

SimulationResult solve(const Variant& v) {
  const double perArea = v.force / (v.length * v.length);
  const Friction friction{"Coulomb", v.F, v.Q * v.direction};
  ScenarioBuilder scene(TwoBeamsSpec{v.k, v.p});
  scene
      .moveNodes([&](const Array3& x) {
        return v.Q * Array3{v.length * x[0], v.length * x[1], v.length * x[2]};
      })
      .material("lower", 6.9e4 * perArea, 0.333)
      .material("upper", (v.contrast == 1 ? 2.119e5 : 6.9e4 * v.contrast) * perArea, 0.277)
      .clamp({"lower_clamp", "upper_clamp"})
      .contact("upper_contact", "lower_contact", &friction)
      .decomposition("Bricks")
      .tolerance(v.tolerance);
  const Array3 pull = v.brief ? Array3{40 * perArea, 30 * perArea, 25 * perArea} : Array3{10 * perArea, 10 * perArea, 10 * perArea};
  scene.traction({"upper_end"}, v.Q * pull);
  if (v.brief) scene.pressure({"upper_top"}, 100 * perArea);
  else scene.pressure({"upper_top", "lower_bottom"}, ramp(v));
  return scene.solve();
}

/// Largest deviation of the forces of `other` from those of `first`, turned and in units, relative to the largest; on the root.
double deviation(const SimulationResult& first, const SimulationResult& other, const Variant& v) {
  double largest = 0, error = first.pairs.size() == other.pairs.size() ? 0.0 : 1.0;
  for (std::size_t i = 0; i < first.pairs.size() && error < 1; ++i) {
    const Array3 expected = v.Q * first.pairs[i].force;
    for (int d = 0; d < 3; ++d) {
      largest = std::max(largest, std::abs(expected[d]));
      error = std::max(error, std::abs(other.pairs[i].force[d] / v.force - expected[d]));
    }
  }
  return largest > 0 ? error / largest : error;
}

long count(const SimulationResult& result) { return result.report.solver.hessianMultiplications; }

bool statesOccur(const SimulationResult& result, bool brief) {
  const auto& contact = result.report.interfaces.at(0);
  return (brief || contact.stick > 0) && contact.slip > 0 && contact.open > 0;  // "brief" leaves little that sticks
}

TEUCHOS_UNIT_TEST(Invariance, TurningTheSceneTurnsTheForces) {
  for (const bool brief : {false, true})
    for (const auto& [k, p] : {std::pair{2, 3}, {3, 2}})
      for (const double tolerance : {1e-6, 1e-9}) {
        Variant straight;
        straight.k = k, straight.p = p, straight.brief = brief, straight.tolerance = tolerance;
        const auto first = solve(straight);
        TEST_ASSERT(first.solved && statesOccur(first, brief));
        for (const Rotation& Q : {tilted, axesSwapped}) {
          Variant turned = straight;
          turned.Q = Q;
          const auto other = solve(turned);
          TEST_ASSERT(other.solved);
          const double error = deviation(first, other, turned);
          out << "k " << k << ", p " << p << (brief ? ", brief" : ", squeeze") << ", tolerance " << tolerance << ": counts "
              << count(first) << ", " << count(other) << ", deviation " << error << "\n";
          TEST_COMPARE(std::abs(count(first) - count(other)), <=, 2);
          TEST_COMPARE(error, <=, 1e-3 * tolerance);  // nothing in the method knows the axes
        }
      }
}

TEUCHOS_UNIT_TEST(Invariance, AxesSwappedTogetherWithCoefficients) {
  for (const bool brief : {false, true}) {
    Variant a;
    a.brief = brief;
    Variant b = a;
    b.F = {a.F[1], a.F[0]};
    b.direction = {-std::sin(0.4), std::cos(0.4), 0};
    const auto first = solve(a), other = solve(b);
    TEST_ASSERT(first.solved && other.solved && statesOccur(first, brief));
    out << "counts " << count(first) << ", " << count(other) << ", deviation " << deviation(first, other, b) << "\n";
    TEST_COMPARE(std::abs(count(first) - count(other)), <=, 2);
    TEST_COMPARE(deviation(first, other, b), <=, 1e-5);
    Variant wrong = a;  // the coefficients alone do make a difference
    wrong.F = b.F;
    if (!first.pairs.empty()) TEST_COMPARE(deviation(first, solve(wrong), wrong), >, 1e-2);
  }
}

TEUCHOS_UNIT_TEST(Invariance, DirectionIsNothingWhereTheCoefficientsAreEqual) {
  for (const bool brief : {false, true}) {
    Variant a;
    a.brief = brief;
    a.F = {0.3, 0.3};
    a.direction = {1, 0, 0};
    const auto first = solve(a);
    TEST_ASSERT(first.solved && statesOccur(first, brief));
    for (const Array3& direction : {Array3{0, 1, 0}, Array3{0.6, -0.8, 0}, Array3{0.2, 0.3, 0.7}}) {
      Variant b = a;
      b.direction = direction;
      const auto other = solve(b);
      out << "counts " << count(first) << ", " << count(other) << ", deviation " << deviation(first, other, b) << "\n";
      TEST_ASSERT(other.solved);
      TEST_EQUALITY(count(first), count(other));
      TEST_COMPARE(deviation(first, other, b), <=, 1e-5);
    }
  }
}

TEUCHOS_UNIT_TEST(Invariance, UnitsAreNothing) {
  for (const bool brief : {false, true}) {
    Variant mmN;
    mmN.brief = brief;
    const auto first = solve(mmN);
    TEST_ASSERT(first.solved);
    for (const auto& [length, force] : {std::pair{1e-3, 1.0}, {1e-3, 1e-3}, {2.54e-2, 4.448}, {1e6, 1e-6}}) {  // m and N first
      Variant other = mmN;
      other.length = length;
      other.force = force;
      const auto result = solve(other);
      out << "units " << length << ", " << force << ": counts " << count(first) << ", " << count(result) << ", deviation "
          << deviation(first, result, other) << "\n";
      TEST_ASSERT(result.solved);
      TEST_COMPARE(std::abs(count(first) - count(result)), <=, 2);
      TEST_COMPARE(deviation(first, result, other), <=, 1e-5);
    }
  }
}

TEUCHOS_UNIT_TEST(Invariance, StiffnessContrastMattersLittle) {
  for (const bool brief : {false, true}) {
    Variant equal;
    equal.brief = brief;
    equal.F = {0.3, 0.3};
    equal.contrast = 1 + 1e-12;  // both moduli 6.9e4
    const long base = count(solve(equal));
    for (const double contrast : {1e-6, 1e-4, 1e-2, 1e2, 1e4, 1e6}) {
      Variant v = equal;
      v.contrast = contrast;
      const auto result = solve(v);
      out << (brief ? "brief" : "squeeze") << ", contrast " << contrast << ": " << count(result) << " against " << base << "\n";
      TEST_ASSERT(result.solved);
      TEST_COMPARE(count(result), <=, long(1.5 * double(base)));
    }
  }
}

}  // namespace
