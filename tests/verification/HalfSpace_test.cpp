// SPDX-License-Identifier: BSD-3-Clause
// A slightly curved block against a plane: Hertz' pressure and the stick zone of Cattaneo and Mindlin, a/R = 0.001.
#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <cmath>

#include "ScenarioBuilder.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Verification;

constexpr double kPi = 3.14159265358979323846, kRadius = 50.0, kContact = 0.05;
constexpr double kSize = 0.3;  // of the block: 6 contact radii stand for a half space
constexpr int kFine = 7, kCells = 10, kLayers = 8;

// Moves the equidistant points of [0, size] to the places of a graded axis; odd, for halves.
double toAxis(const std::vector<double>& axis, double x) {
  const auto at = std::size_t(std::lround(std::abs(x) / kSize * double(axis.size() - 1)));
  return std::copysign(axis[at], x);
}

// z is counted from the contact plane; the curved face is z = r^2 / (2 R).
BoxSpec block(const std::string& name, bool upper, bool curved, bool half) {
  BoxSpec box;
  box.blockName = name;
  box.lower = {half ? -kSize : 0.0, 0.0, upper ? 0.0 : -kSize};
  box.upper = {kSize, kSize, upper ? kSize : 0.0};
  box.divisions = {half ? 2 * kCells : kCells, kCells, kLayers};
  box.sideSetNames = {half ? "" : "x0", "", "y0", "", name + (upper ? "_contact" : "_far"), name + (upper ? "_far" : "_contact")};
  const auto across = gradedAxis(1.3 * kContact, kFine, kSize, kCells), along = gradedAxis(0.7 * kContact, 4, kSize, kLayers);
  box.map = [across, along, curved](const Array3& x) {
    Array3 y{toAxis(across, x[0]), toAxis(across, x[1]), toAxis(along, x[2])};
    if (curved) y[2] += (1 - std::abs(y[2]) / kSize) * (y[0] * y[0] + y[1] * y[1]) / (2 * kRadius);
    return y;
  };
  return box;
}

// p(r)^2 = p0^2 (1 - r^2/a^2), fitted to points (r^2, p^2) by least squares.
struct Profile {
  double peak, radius;
};

Profile fitProfile(const std::vector<std::array<double, 2>>& points) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const auto& [r2, p2] : points) n += 1, x += r2, y += p2, xx += r2 * r2, xy += r2 * p2;
  const double slope = (n * xy - x * y) / (n * xx - x * x), start = (y - slope * x) / n;
  return {std::sqrt(start), std::sqrt(-start / slope)};
}

double squaredRadius(const Mesh& mesh, const PairResult& pair) {
  const auto& x = mesh.coordinates[pair.secondaryNode];
  return x[0] * x[0] + x[1] * x[1];
}

// ANALYTIC: contact radius and central pressure at the force that was found, within 2 %.
TEUCHOS_UNIT_TEST(HalfSpace, HertzOnARigidPlane) {
  const double nu = 0.3, stiffness = 1 / (1 - nu * nu);
  const auto scene = ScenarioBuilder(makeBoxes({block("body", true, true, false)}))
                         .material("body", 1.0, nu)
                         .displacement({"x0"}, "x", {0, 0, 0})
                         .displacement({"y0"}, "y", {0, 0, 0})
                         .displacement({"body_far"}, "z", {0, 0, -5.2e-5})
                         .rigidPlane("body_contact", {0, 0, 0}, {0, 0, 1});
  const auto result = scene.solve();
  TEST_ASSERT(result.solved);
  if (result.pairs.empty()) return;  // not the root
  const double force = 4 * resultants(result).normal;
  const double a = std::cbrt(0.75 * force * kRadius / stiffness), p0 = 1.5 * force / (kPi * a * a);
  std::vector<std::array<double, 2>> points;
  for (const auto& pair : result.pairs)
    if (squaredRadius(scene.mesh(), pair) < 0.64 * a * a)
      points.push_back({squaredRadius(scene.mesh(), pair), pair.pressure * pair.pressure});
  const auto found = fitProfile(points);
  out << "P " << force << ": a " << found.radius << " (Hertz " << a << "), p0 " << found.peak << " (Hertz " << p0 << "); "
      << points.size() << " nodes, " << result.report.solver.hessianMultiplications << " multiplications\n";
  TEST_ASSERT(points.size() > 20 && result.report.interfaces.at(0).open > 50);
  TEST_ASSERT(std::abs(a - kContact) < 0.15 * kContact);  // the mesh is fine where the contact is
  TEST_FLOATING_EQUALITY(found.radius, a, 0.02);
  TEST_FLOATING_EQUALITY(found.peak, p0, 0.02);
}

struct StickZone {
  double load;         // Q / (mu P)
  double ratio;        // c / a by the profiles of p and mu p - q
  double ratioByArea;  // by the area of the nodes that moved by less than 1 % of the largest slip
};

// nu = 0 and equal blocks, so that pressure and traction do not feel each other.
StickZone pull(double displacement, const std::array<double, 2>& F, Teuchos::FancyOStream& out, bool& success) {
  const Friction friction{"Coulomb", F};
  const auto scene = ScenarioBuilder(makeBoxes({block("lower", false, false, true), block("upper", true, true, true)}))
                         .material("lower", 1.0, 0.0)
                         .material("upper", 1.0, 0.0)
                         .clamp({"lower_far"})
                         .displacement({"upper_far"}, "xyz", {displacement, 0, -5.2e-5})
                         .displacement({"y0"}, "y", {0, 0, 0})
                         .contact("upper_contact", "lower_contact", &friction)
                         .decomposition("METIS", 4)
                         .tolerance(1e-5)
                         .maximumMultiplications(10000);
  const auto result = scene.solve();
  TEST_ASSERT(result.solved);
  const auto sum = resultants(result);
  const double mu = F[0], load = -sum.tangential[0] / (mu * sum.normal);
  const double a = std::cbrt(0.75 * 2 * sum.normal * kRadius / 0.5), expected = std::cbrt(1 - load) * a;
  std::vector<std::array<double, 2>> pressures, rests;
  double stickArea = 0, largestSlip = 0;
  for (const auto& pair : result.pairs)
    if (pair.status != ContactStatus::Open) largestSlip = std::max(largestSlip, std::abs(pair.slip[0]));
  for (const auto& pair : result.pairs) {
    const double r2 = squaredRadius(scene.mesh(), pair);
    if (r2 < 0.64 * a * a) pressures.push_back({r2, pair.pressure * pair.pressure});
    if (pair.status == ContactStatus::Open) continue;
    const double area = pair.normalForce / pair.pressure, rest = mu * pair.pressure + pair.tangentialForce[0] / area;
    if (r2 < 0.64 * expected * expected) rests.push_back({r2, rest * rest});
    if (std::abs(pair.slip[0]) < 0.01 * largestSlip) stickArea += area;
  }
  TEST_ASSERT(rests.size() > 10);
  const double radius = fitProfile(pressures).radius;
  const StickZone zone{load, fitProfile(rests).radius / radius, std::sqrt(2 * stickArea / kPi) / radius};
  out << "Q/(mu P) " << zone.load << ": c/a " << zone.ratio << ", by area " << zone.ratioByArea << " (Cattaneo "
      << std::cbrt(1 - zone.load) << "), a " << radius << " (Hertz " << a << "); " << result.report.solver.hessianMultiplications
      << " multiplications (" << result.report.solver.method << "), kkt " << result.report.accuracy.errors.kkt() << " " << result.report.solver.reason << "\n";
  TEST_FLOATING_EQUALITY(radius, a, 0.03);  // ANALYTIC
  return zone;
}

// ANALYTIC: c/a = (1 - Q/(mu P))^(1/3), mu the coefficient along the pull, within 2 %; by area 8 %, one ring of nodes.
void checkZone(const StickZone& zone, Teuchos::FancyOStream& out, bool& success) {
  TEST_ASSERT(zone.load > 0.2 && zone.load < 0.8);
  TEST_FLOATING_EQUALITY(zone.ratio, std::cbrt(1 - zone.load), 0.02);
  TEST_FLOATING_EQUALITY(zone.ratioByArea, std::cbrt(1 - zone.load), 0.08);
}

TEUCHOS_UNIT_TEST(HalfSpace, CattaneoMindlinAlongAPrincipalAxis) {
  checkZone(pull(0.6e-5, {0.5, 0.15}, out, success), out, success);
}

// ANALYTIC: with nu = 0 the points slip along the pull, so the other coefficient has no effect.
TEUCHOS_UNIT_TEST(HalfSpace, TheOtherCoefficientHasNoEffect) {
  const auto low = pull(1.05e-5, {0.5, 0.15}, out, success), high = pull(1.05e-5, {0.5, 0.5}, out, success);
  checkZone(low, out, success);
  TEST_FLOATING_EQUALITY(low.load, high.load, 1e-3);
  TEST_FLOATING_EQUALITY(low.ratio, high.ratio, 1e-2);
}

}  // namespace
