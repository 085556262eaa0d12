// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_EllipseProjection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Haptos {
namespace {

using Real = long double;
using Pair = std::array<Real, 2>;

Real square(Real t) { return t * t; }

/// Squares of doubles are in the range of Real: no need of the scaling of std::hypot, which is slow in it.
Real length(Real a, Real b) { return std::sqrt(square(a) + square(b)); }

/// (x1/a1)^2 + (x2/a2)^2 for positive semi-axes.
Real level(const Pair& x, const Pair& a) { return square(x[0] / a[0]) + square(x[1] / a[1]); }

/// psi(tau) = sum (a_i x_i / (a_i^2 + tau))^2 and its derivative; psi = 1 at the projection.
template <class T>
struct Secular {
  std::array<T, 2> a, x;
  T slope = 0;
  T operator()(T tau) {
    T psi = 0;
    slope = 0;
    for (int i = 0; i < 2; ++i) {
      const T d = a[i] * a[i] + tau, q = a[i] * x[i] / d;
      psi += q * q;
      slope -= 2 * q * q / d;
    }
    return psi;
  }
};

/// Newton's step for psi^(-1/2) = 1.
template <class T>
T newtonStep(Secular<T>& psi, T tau, T value) {
  return tau + 2 * value * (1 - std::sqrt(value)) / psi.slope;
}

/// The root to the digits of doubles, where they have the range for it; from here few steps in Real are left.
Real approximateRoot(const Pair& a, const Pair& x, Real lo, Real hi) {
  Secular<double> psi{{double(a[0]), double(a[1])}, {double(x[0]), double(x[1])}};
  double tau = double(lo);
  for (int it = 0; it < 20; ++it) {
    const double next = newtonStep(psi, tau, psi(tau)), change = std::abs(next - tau);
    tau = next;
    if (!(change > 1e-12 * std::abs(tau))) break;
  }
  return tau >= lo && tau <= hi ? Real(tau) : lo;
}

/// Root tau >= 0 of psi = 1 for a point x >= 0 outside.  psi^(-1/2) is increasing and concave, so that Newton
/// from the left converges monotonically, from the right after one step; the bracket only guards against round-off.
Real secularRoot(const Pair& a, const Pair& x) {
  Secular<Real> psi{a, x};
  Real lo = std::max({Real(0), a[0] * (x[0] - a[0]), a[1] * (x[1] - a[1])});
  Real hi = length(a[0] * x[0], a[1] * x[1]);
  Real tau = approximateRoot(a, x, lo, hi);
  const Real eps = 2 * std::numeric_limits<Real>::epsilon();
  for (int it = 0; it < 200; ++it) {
    const Real value = psi(tau);
    (value >= 1 ? lo : hi) = tau;
    Real next = newtonStep(psi, tau, value);
    if (!(next >= lo && next <= hi)) next = lo + (hi - lo) / 2;
    const Real change = std::abs(next - tau);
    tau = next;
    if (change <= eps * (tau + square(std::min(a[0], a[1])))) break;
  }
  return tau;
}

/// Projection of a point known to be outside an ellipse with positive semi-axes, in units of the larger one.
/// `shrink` returns N = diag(a^2 / (a^2 + tau)), so that P = N x.
Pair projectFromOutside(const Pair& x, const Pair& a, Pair& shrink) {
  const Real unit = std::max(a[0], a[1]);
  const Pair as{a[0] / unit, a[1] / unit};
  const Real tau = secularRoot(as, {std::abs(x[0]) / unit, std::abs(x[1]) / unit});
  for (int i = 0; i < 2; ++i) shrink[i] = as[i] * as[i] / (as[i] * as[i] + tau);
  return {shrink[0] * x[0], shrink[1] * x[1]};
}

/// P = N x on the boundary, N = (1 + tau a^-2)^-1, tau by P^T a^-2 P = 1; what P loses is its part along the normal w.
void setBoundaryDerivatives(EllipseProjection& r, const Pair& x, const Pair& a, const Pair& shrink, Real g) {
  const Pair p{shrink[0] * x[0], shrink[1] * x[1]};
  const Real unit = std::max(a[0], a[1]);
  Pair w{p[0] / a[0] * (unit / a[0]), p[1] / a[1] * (unit / a[1])};  // outward normal, proportional to a^-2 p
  const Real size = length(w[0], w[1]);
  w = {w[0] / size, w[1] / size};
  const Pair e{-w[1], w[0]};
  // dP/dx = N - N w w^T N / (w^T N w) = sigma e e^T
  const Real sigma = shrink[0] * shrink[1] / (shrink[0] * w[0] * w[0] + shrink[1] * w[1] * w[1]);
  const Real ex = e[0] * x[0] + e[1] * x[1];
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) r.dPdx[i][j] = double(sigma * e[i] * e[j]);
    r.dPdg[i] = double((p[i] - sigma * e[i] * ex) / g);  // P is homogeneous of degree 1 in (x, g)
    r.tangent[i] = double(e[i]);
  }
  r.sigma = double(sigma);
}

/// At least one semi-axis is 0: an interval on axis j, or the origin.
EllipseProjection projectDegenerate(const Pair& x, const Pair& f, const Pair& a) {
  EllipseProjection r{{0, 0}, true, {{{0, 0}, {0, 0}}}, {0, 0}, 0, {0, 0}};
  if (a[0] <= 0 && a[1] <= 0) {  // g = 0 or both coefficients 0: one-sided limit from g > 0
    const Real fx = length(f[0] * x[0], f[1] * x[1]), size = length(x[0], x[1]);
    for (int i = 0; i < 2 && fx > 0; ++i) r.dPdg[i] = double(f[i] * (f[i] * x[i] / fx));
    if (size > 0) r.tangent = {double(-x[1] / size), double(x[0] / size)};
    return r;
  }
  const int j = a[0] > 0 ? 0 : 1;
  const Real sign = x[j] < 0 ? -1 : 1;
  r.onBoundary = std::abs(x[j]) > a[j];
  if (r.onBoundary) {
    r.point[j] = double(sign * a[j]);
    r.dPdg[j] = double(sign * f[j]);
    r.tangent[1 - j] = 1;
  } else {
    r.point[j] = double(x[j]);
    r.dPdx[j][j] = 1;
    r.sigma = 1;
  }
  return r;
}

}  // namespace

EllipseProjection projectOntoEllipse(const std::array<double, 2>& x, const std::array<double, 2>& coefficients,
                                     double g) {
  const Pair xr{x[0], x[1]}, f{coefficients[0], coefficients[1]}, a{f[0] * g, f[1] * g};
  if (!(a[0] > 0 && a[1] > 0)) return projectDegenerate(xr, f, a);
  EllipseProjection r{x, false, {{{1, 0}, {0, 1}}}, {0, 0}, 1, {0, 0}};
  if (level(xr, a) <= 1) return r;
  r.onBoundary = true;
  Pair shrink;
  const Pair p = projectFromOutside(xr, a, shrink);
  r.point = {double(p[0]), double(p[1])};
  setBoundaryDerivatives(r, xr, a, shrink, g);
  return r;
}

std::array<double, 2> projectOntoEllipse(const std::array<double, 2>& x, const std::array<double, 2>& semiAxes,
                                         bool& moved) {
  const Pair xr{x[0], x[1]}, a{semiAxes[0], semiAxes[1]};
  moved = false;
  if (a[0] > 0 && a[1] > 0) {
    if (level(xr, a) <= 1) return x;
    moved = true;
    Pair shrink;
    const Pair p = projectFromOutside(xr, a, shrink);
    return {double(p[0]), double(p[1])};
  }
  const std::array<double, 2> y{std::clamp(x[0], -semiAxes[0], semiAxes[0]),
                                std::clamp(x[1], -semiAxes[1], semiAxes[1])};
  const int j = a[0] > 0 ? 0 : 1;
  moved = y[j] != x[j];
  return y;
}

}  // namespace Haptos
