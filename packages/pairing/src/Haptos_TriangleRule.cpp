// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_TriangleRule.hpp"

#include <cmath>

namespace Haptos {
namespace {

// Zeros of the Legendre polynomial of degree n by Newton's method, and their weights; on [0, 1].
template <std::size_t n>
std::array<std::array<double, 2>, n> gaussPoints() {
  std::array<std::array<double, 2>, n> points;
  for (std::size_t i = 0; i < n; ++i) {
    double x = std::cos(3.141592653589793 * (double(i) + 0.75) / (double(n) + 0.5)), slope = 1;
    for (int step = 0; step < 10; ++step) {
      double before = 1, value = x;
      for (std::size_t k = 2; k <= n; ++k) {
        const double next = (double(2 * k - 1) * x * value - double(k - 1) * before) / double(k);
        before = value;
        value = next;
      }
      slope = double(n) * (x * value - before) / (x * x - 1);
      x -= value / slope;
    }
    points[i] = {0.5 * (1 + x), 1 / ((1 - x * x) * slope * slope)};
  }
  return points;
}

std::vector<TrianglePoint> makeSeven() {
  const double root = std::sqrt(15.0);
  std::vector<TrianglePoint> points = {{{1.0 / 3, 1.0 / 3, 1.0 / 3}, 9.0 / 40}};
  for (const double sign : {-1.0, 1.0}) {
    const double a = (6 + sign * root) / 21, weight = (155 + sign * root) / 1200;
    for (std::size_t c = 0; c < 3; ++c) {
      TrianglePoint point{{a, a, a}, weight};
      point.shares[c] = 1 - 2 * a;
      points.push_back(point);
    }
  }
  return points;
}

// (s, t) -> s, (1 - s) t, (1 - s) (1 - t) with the Jacobian 1 - s, of an area of 1/2.
template <std::size_t n>
std::vector<TrianglePoint> makeCollapsed() {
  std::vector<TrianglePoint> points;
  const auto line = gaussPoints<n>();
  for (const auto& [s, ws] : line)
    for (const auto& [t, wt] : line) points.push_back({{s, (1 - s) * t, (1 - s) * (1 - t)}, 2 * ws * wt * (1 - s)});
  return points;
}

}  // namespace

const std::vector<TrianglePoint>& sevenPoints() {
  static const std::vector<TrianglePoint> points = makeSeven();
  return points;
}

const std::vector<TrianglePoint>& thirtySixPoints() {
  static const std::vector<TrianglePoint> points = makeCollapsed<6>();
  return points;
}

const std::vector<TrianglePoint>& sixtyFourPoints() {
  static const std::vector<TrianglePoint> points = makeCollapsed<8>();
  return points;
}

}  // namespace Haptos
