// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_EllipseProjection.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <cmath>
#include <random>

namespace {

using namespace Haptos;
using Real = long double;
using Point = std::array<double, 2>;

/// Brute force: bisection for the angle at which the distance to the boundary point stops falling.  Knows nothing of
/// the secular equation.  For a point outside, the distance has one minimum in the quarter of the point.
Point nearestByAngle(const Point& x, const Point& a) {
  const auto slope = [](Real s, const Point& ax, const Point& y) {
    const Real c = std::cos(s), q = std::sin(s);
    return -(ax[0] * c - std::abs(y[0])) * ax[0] * q + (ax[1] * q - std::abs(y[1])) * ax[1] * c;
  };
  const Real eighth = std::acos(-1.0L) / 4;
  // angles are measured from the nearer axis, where small ones are resolved
  const bool swap = slope(eighth, a, x) < 0;
  const Point as = swap ? Point{a[1], a[0]} : a, xs = swap ? Point{x[1], x[0]} : x;
  Real lo = 0, hi = eighth;
  for (int it = 0; it < 400; ++it) (slope((lo + hi) / 2, as, xs) < 0 ? lo : hi) = (lo + hi) / 2;
  const Point y{std::copysign(double(as[0] * std::cos(hi)), xs[0]), std::copysign(double(as[1] * std::sin(hi)), xs[1])};
  return swap ? Point{y[1], y[0]} : y;
}

/// A dense sampling of the boundary finds nothing nearer than the bisection does (checks the oracle itself).
bool nothingNearer(const Point& x, const Point& a, const Point& y) {
  const Real d = std::hypot(Real(x[0]) - y[0], Real(x[1]) - y[1]);
  for (int k = 0; k < 2000; ++k) {
    const Real s = 2 * std::acos(-1.0L) * k / 2000;
    if (std::hypot(a[0] * std::cos(s) - x[0], a[1] * std::sin(s) - x[1]) < d * (1 - 1e-12L)) return false;
  }
  return true;
}

TEUCHOS_UNIT_TEST(EllipseProjection, MatchesBruteForceAtAnyRatioAndScale) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  double worst = 0, largestRatio = 1;
  int outside = 0;
  for (int k = 0; k < 300; ++k) {
    const double scale = std::pow(10.0, 30 * unit(rng));
    const Point f{std::pow(10.0, 4 * unit(rng)), std::pow(10.0, 4 * unit(rng))};
    const double g = scale;
    const Point a{f[0] * g, f[1] * g};
    const double reach = std::pow(10.0, 2 * unit(rng));
    const Point x{unit(rng) * reach * a[0], unit(rng) * reach * std::max(a[0], a[1])};
    const EllipseProjection p = projectOntoEllipse(x, f, g);
    const double level = std::hypot(x[0] / a[0], x[1] / a[1]);
    TEST_EQUALITY(p.onBoundary, level > 1);
    bool moved = false;
    const Point pointOnly = projectOntoEllipse(x, a, moved);  // its semi-axes are rounded products
    for (int i = 0; i < 2; ++i)
      TEST_COMPARE(std::abs(pointOnly[i] - p.point[i]), <=, 1e-14 * std::max(a[0], a[1]));
    TEST_EQUALITY(moved, p.onBoundary);
    if (!p.onBoundary) {
      TEST_ASSERT(p.point == x);
      continue;
    }
    ++outside;
    largestRatio = std::max({largestRatio, a[0] / a[1], a[1] / a[0]});
    const Point y = nearestByAngle(x, a);
    TEST_ASSERT(nothingNearer(x, a, y));
    for (int i = 0; i < 2; ++i) worst = std::max(worst, std::abs(p.point[i] - y[i]) / std::max(a[0], a[1]));
    TEST_FLOATING_EQUALITY(std::hypot(p.point[0] / a[0], p.point[1] / a[1]), 1.0, 1e-14);
  }
  out << outside << " points outside, ratio up to " << largestRatio << ", worst relative error " << worst << "\n";
  TEST_ASSERT(outside > 100 && largestRatio > 1e6);
  TEST_COMPARE(worst, <, 1e-14);
}

/// Optimality x - P = tau a^-2 P holds in each component to its own precision, at axis ratio 1e8 as well.
TEUCHOS_UNIT_TEST(EllipseProjection, NormalConditionAtExtremeRatio) {
  for (const double ratio : {1e6, 1e8})
    for (const Point x : {Point{0.3, 0.5}, Point{1.2, 1e-9}, Point{0.999, 1e-3}, Point{0.0, 2.0}, Point{-3.0, 0.0},
                          Point{1 + 1e-12, 1e-14}, Point{0.5, -2e-6}}) {
      const Point a{1, 1 / ratio};
      const EllipseProjection p = projectOntoEllipse(x, a, 1.0);
      TEST_ASSERT(p.onBoundary);
      const double tau0 = p.point[0] != 0 ? (x[0] - p.point[0]) / p.point[0] : -1;
      const double tau1 = p.point[1] != 0 ? (x[1] - p.point[1]) / p.point[1] / (ratio * ratio) : -1;
      if (tau0 > 1e-9 && tau1 > 0) TEST_FLOATING_EQUALITY(tau0, tau1, 1e-6);  // tau0 cancels by up to 1e9
      TEST_FLOATING_EQUALITY(std::hypot(p.point[0], p.point[1] * ratio), 1.0, 1e-14);
      TEST_ASSERT(p.sigma >= 0 && p.sigma < 1);
      TEST_COMPARE(std::abs(p.tangent[0] * p.point[0] + p.tangent[1] * p.point[1] * ratio * ratio), <=,
                   1e-14 * ratio);  // e is orthogonal to the normal a^-2 P
    }
}

TEUCHOS_UNIT_TEST(EllipseProjection, DerivativesMatchDifferences) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  int outside = 0;
  for (int k = 0; k < 200; ++k) {
    const Point f{std::pow(10.0, 1.5 * unit(rng)), std::pow(10.0, 1.5 * unit(rng))};
    const double g = 0.7;
    const Point x{3 * unit(rng), 3 * unit(rng)};
    const EllipseProjection p = projectOntoEllipse(x, f, g);
    const double level = std::hypot(x[0] / (f[0] * g), x[1] / (f[1] * g));
    if (std::abs(level - 1) < 1e-3) continue;
    outside += p.onBoundary;
    // error of a central difference: h^2 x the third derivative, which grows like (larger radius of curvature)^2
    const double h = 1e-5 * std::min(f[0], f[1]) * g;
    for (int j = 0; j < 2; ++j) {
      Point up = x, down = x;
      up[j] += h;
      down[j] -= h;
      const Point pu = projectOntoEllipse(up, f, g).point, pd = projectOntoEllipse(down, f, g).point;
      for (int i = 0; i < 2; ++i) {
        TEST_COMPARE(std::abs((pu[i] - pd[i]) / (2 * h) - p.dPdx[i][j]), <=, 1e-6);
        TEST_COMPARE(std::abs(p.dPdx[i][j] - (p.onBoundary ? p.sigma * p.tangent[i] * p.tangent[j] : double(i == j))),
                     <=, 1e-15);
      }
    }
    const double hg = 1e-6;
    const Point pu = projectOntoEllipse(x, f, g + hg).point, pd = projectOntoEllipse(x, f, g - hg).point;
    for (int i = 0; i < 2; ++i)
      TEST_COMPARE(std::abs((pu[i] - pd[i]) / (2 * hg) - p.dPdg[i]), <=, 1e-6 * std::max(1.0, f[i]));
  }
  TEST_ASSERT(outside > 50);
}

TEUCHOS_UNIT_TEST(EllipseProjection, ZeroSemiAxesAndZeroPressure) {
  const EllipseProjection inside = projectOntoEllipse({0.2, 5.0}, {0.3, 0.0}, 1.0);
  TEST_ASSERT((inside.point == Point{0.2, 0.0}) && !inside.onBoundary);
  TEST_EQUALITY(inside.dPdx[0][0], 1.0);
  TEST_EQUALITY(inside.dPdx[1][1], 0.0);
  const EllipseProjection clamped = projectOntoEllipse({-1.0, 5.0}, {0.3, 0.0}, 2.0);
  TEST_ASSERT((clamped.point == Point{-0.6, 0.0}) && clamped.onBoundary);
  TEST_EQUALITY(clamped.dPdg[0], -0.3);
  TEST_EQUALITY(clamped.dPdx[0][0], 0.0);

  // Coulomb at g = 0: the limit of dP/dg from g > 0
  const Point x{0.4, -0.3}, f{0.5, 0.2};
  const EllipseProjection limit = projectOntoEllipse(x, f, 0.0), near = projectOntoEllipse(x, f, 1e-9);
  TEST_ASSERT((limit.point == Point{0.0, 0.0}));
  for (int i = 0; i < 2; ++i) {
    TEST_FLOATING_EQUALITY(limit.dPdg[i], near.dPdg[i], 1e-7);
    TEST_FLOATING_EQUALITY(limit.dPdg[i], near.point[i] / 1e-9, 1e-7);
  }
  const EllipseProjection origin = projectOntoEllipse({0, 0}, f, 0.0);
  TEST_ASSERT((origin.dPdg == Point{0.0, 0.0}));
}

}  // namespace
