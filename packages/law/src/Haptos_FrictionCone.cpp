// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_FrictionCone.hpp"

#include <algorithm>
#include <cmath>

#include "Haptos_EllipseProjection.hpp"

namespace Haptos {
namespace {

struct Height {
  double value;       // phi(g) = half the derivative of the squared distance at height g
  double slope;       // phi'(g) >= 1
  EllipseProjection section;
};

// At height g the nearest point is the projection of x_T on the section; d(g) = (g - x_N)^2 + |x_T - P(x_T, g)|^2 is convex.
Height evaluate(const std::array<double, 3>& x, const std::array<double, 2>& F, double g) {
  const std::array<double, 2> T{x[1], x[2]};
  Height h{0, 1, projectOntoEllipse(T, F, g)};
  double outward = 0, along = 0;
  for (int i = 0; i < 2; ++i) {
    outward += (T[i] - h.section.point[i]) * h.section.dPdg[i];
    along += T[i] * h.section.dPdg[i];
  }
  h.value = g - x[0] - outward;
  // The squared distance is homogeneous of degree 2 in (T, g): Euler gives its second derivative.
  if (g > 0) h.slope = 1 + std::max(0.0, (along - outward) / g);
  return h;
}

// Newton's method, kept inside a bracket.
double findHeight(const std::array<double, 3>& x, const std::array<double, 2>& F) {
  double low = std::max(0.0, x[0]), high = std::max(low, std::abs(x[0])) + std::hypot(F[0] * x[1], F[1] * x[2]);
  double g = 0.5 * (low + high);
  for (int i = 0; i < 100; ++i) {
    const Height h = evaluate(x, F, g);
    (h.value > 0 ? high : low) = g;
    double next = g - h.value / h.slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - g) <= 1e-15 * (std::abs(g) + std::abs(x[0]))) return next;
    g = next;
  }
  return g;
}

}  // namespace

// The root g of phi = d'/2, unless x lies in the cone or its polar; dg/dx from phi(g, x) = 0.
ConeProjection projectOntoFrictionCone(const std::array<double, 3>& x, const std::array<double, 2>& F) {
  ConeProjection result{};
  if (x[0] <= -std::hypot(F[0] * x[1], F[1] * x[2])) return result;  // the polar cone goes to the apex
  const double g = x[0] > 0 && !projectOntoEllipse({x[1], x[2]}, F, x[0]).onBoundary ? x[0] : findHeight(x, F);
  const Height h = evaluate(x, F, g);
  result.point = {g, h.section.point[0], h.section.point[1]};
  const double slope = h.section.onBoundary ? h.slope : 1.0;
  const std::array<double, 3> dg{1 / slope, h.section.dPdg[0] / slope, h.section.dPdg[1] / slope};
  result.dPdx[0] = dg;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 3; ++j)
      result.dPdx[1 + i][j] = (j > 0 ? h.section.dPdx[i][j - 1] : 0.0) + h.section.dPdg[i] * dg[j];
  return result;
}

}  // namespace Haptos
