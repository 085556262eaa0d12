// SPDX-License-Identifier: BSD-3-Clause
// Slow and plain versions of the projections, written without the code they test.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

namespace Haptos::Testing {

using Pair2 = std::array<double, 2>;
using Triple = std::array<double, 3>;

/// Nearest point of an interval or ellipse with semi-axes a, by a search over the angle.
inline Pair2 nearestOnEllipse(const Pair2& x, const Pair2& a) {
  if (a[0] == 0 || a[1] == 0) return {std::clamp(x[0], -a[0], a[0]), std::clamp(x[1], -a[1], a[1])};
  if (std::hypot(x[0] / a[0], x[1] / a[1]) <= 1) return x;
  const auto point = [&](double t) { return Pair2{a[0] * std::cos(t), a[1] * std::sin(t)}; };
  const auto distance = [&](double t) { return std::hypot(x[0] - point(t)[0], x[1] - point(t)[1]); };
  double best = 0;
  for (int i = 0; i < 3600; ++i)
    if (distance(i * M_PI / 1800) < distance(best)) best = i * M_PI / 1800;
  // The distance is stationary at the nearest point: bisect its derivative (x - p) . p' .
  const auto slope = [&](double t) {
    return (x[0] - a[0] * std::cos(t)) * a[0] * std::sin(t) - (x[1] - a[1] * std::sin(t)) * a[1] * std::cos(t);
  };
  double low = best - M_PI / 1800, high = best + M_PI / 1800;
  for (int i = 0; i < 100; ++i) (slope(0.5 * (low + high)) > 0 ? high : low) = 0.5 * (low + high);
  return point(0.5 * (low + high));
}

/// Reproducible values in [-1, 1].
inline double pseudoRandom(int i) { return std::sin(1.0 + 12.9898 * i + 78.233 * i * (i % 7)); }

}  // namespace Haptos::Testing
