// SPDX-License-Identifier: BSD-3-Clause
#include "ReferenceLaw.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Haptos::Scenes {
namespace {

using Wide = long double;

struct Tangential {
  Eigen::Vector2d point = Eigen::Vector2d::Zero();
  Eigen::Matrix2d slope = Eigen::Matrix2d::Zero();  // d point / d x
  Eigen::Vector2d growth = Eigen::Vector2d::Zero();  // d point / d g
};

// Derivatives at a boundary point p of a true ellipse: only the direction e along the boundary is left.
void differentiate(const Eigen::Vector2d& a, double tau, const Eigen::Vector2d& x, double g, Tangential& t) {
  Eigen::Vector2d n, w;
  for (int i = 0; i < 2; ++i) {
    n[i] = a[i] * a[i] / (a[i] * a[i] + tau);
    w[i] = t.point[i] / (a[i] * a[i]);
  }
  w /= w.cwiseAbs().maxCoeff();
  w.normalize();
  const Eigen::Vector2d e(-w[1], w[0]);
  const double sigma = n[0] * n[1] / (w[0] * w[0] * n[0] + w[1] * w[1] * n[1]);
  t.slope = sigma * e * e.transpose();
  t.growth = (t.point - t.slope * x) / g;  // P is homogeneous of degree 1 in (x, g)
}

Tangential projectTangential(const Eigen::Vector2d& x, const std::array<double, 2>& F, double g) {
  Tangential t;
  const Eigen::Vector2d a(F[0] * g, F[1] * g);
  if (!(g > 0)) {  // the apex of the cone; it grows along F^2 x
    const double norm = std::hypot(F[0] * x[0], F[1] * x[1]);
    for (int i = 0; i < 2 && norm > 0; ++i) t.growth[i] = F[i] * F[i] * x[i] / norm;
    return t;
  }
  if (a[0] > 0 && a[1] > 0) {
    double tau;
    const auto p = nearestOnEllipse({x[0], x[1]}, {a[0], a[1]}, tau);
    t.point = {p[0], p[1]};
    if (tau > 0) differentiate(a, tau, x, g, t);
    else t.slope.setIdentity();
    return t;
  }
  for (int i = 0; i < 2; ++i) {
    if (!(a[i] > 0)) continue;
    t.point[i] = std::clamp(x[i], -a[i], a[i]);
    if (std::abs(x[i]) <= a[i]) t.slope(i, i) = 1;
    else t.growth[i] = std::copysign(F[i], x[i]);
  }
  return t;
}

}  // namespace

std::array<double, 2> nearestOnEllipse(const std::array<double, 2>& y, const std::array<double, 2>& a, double& tau) {
  const Wide u = std::abs(Wide(y[0])) / a[0], v = std::abs(Wide(y[1])) / a[1];
  tau = 0;
  if (u * u + v * v <= 1) return y;
  const auto excess = [&](Wide t) {
    Wide sum = 0;
    for (int i = 0; i < 2; ++i) {
      const Wide q = Wide(a[i]) * y[i] / (Wide(a[i]) * a[i] + t);
      sum += q * q;
    }
    return sum - 1;
  };
  Wide low = 0, high = std::hypot(Wide(a[0]) * y[0], Wide(a[1]) * y[1]);
  for (int step = 0; step < 400; ++step) {
    const Wide middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) break;
    (excess(middle) > 0 ? low : high) = middle;
  }
  tau = std::max(double(high), std::numeric_limits<double>::min());
  std::array<double, 2> point;
  for (int i = 0; i < 2; ++i) point[i] = double(Wide(a[i]) * a[i] * y[i] / (Wide(a[i]) * a[i] + high));
  return point;
}

ReferenceProjection projectOnLaw(const ReferenceLaw& law, const Eigen::Vector3d& x) {
  ReferenceProjection P{Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()};
  const bool closed = x[0] > 0 && !law.normalPinned, coulomb = law.slipForce < 0;
  if (closed) {
    P.point[0] = x[0];
    P.derivative(0, 0) = 1;
  }
  if (coulomb && !closed) return P;
  const Tangential t = projectTangential(x.tail<2>(), law.coefficients, coulomb ? x[0] : law.slipForce);
  P.point.tail<2>() = t.point;
  P.derivative.bottomRightCorner<2, 2>() = t.slope;
  if (coulomb) P.derivative.bottomLeftCorner<2, 1>() = t.growth;
  return P;
}

}  // namespace Haptos::Scenes
