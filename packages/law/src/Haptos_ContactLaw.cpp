// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactLaw.hpp"

#include <algorithm>
#include <cmath>

#include "Haptos_EllipseProjection.hpp"

namespace Haptos {

// P_N = max(0, x_N); P_T the projection of x_T on the ellipse with g(P_N), so that dP_T/dx_N = dP_T/dg for Coulomb and 0 for Tresca.
// An open Coulomb pair has g = 0 and P = 0; an open Tresca pair still has its ellipse.
PairProjection PairLaw::project(const std::array<double, 3>& x) const {
  PairProjection result{};
  const bool closed = x[0] > 0 && !normalPinned;
  if (closed) {
    result.point[0] = x[0];
    result.dPdx[0][0] = 1;
  }
  result.status = closed ? ContactStatus::Slip : ContactStatus::Open;
  if (!frictional() || (coefficients[0] == 0 && coefficients[1] == 0)) return result;
  if (law == FrictionLaw::Coulomb && !closed) return result;
  const auto T = projectOntoEllipse({x[1], x[2]}, coefficients, slipBound(result.point[0]));
  for (int i = 0; i < 2; ++i) {
    result.point[1 + i] = T.point[i];
    for (int j = 0; j < 2; ++j) result.dPdx[1 + i][1 + j] = T.dPdx[i][j];
    if (law == FrictionLaw::Coulomb) result.dPdx[1 + i][0] = T.dPdg[i];
  }
  if (closed && !T.onBoundary) result.status = ContactStatus::Stick;
  return result;
}

PairLaw PairLaw::alongAxes() const {
  PairLaw result = *this;
  for (std::size_t t = 0; turn && t < 2; ++t) result.coefficients[t] *= turn->stretch[t];
  result.turn.reset();
  return result;
}

ContactStatus contactStatus(const PairLaw& pair, const std::array<double, 3>& lambda, const StateScales& scales) {
  const double onEllipse = std::max(1e-6, 10 * scales.tolerance);  // of the radius
  if (lambda[0] <= std::max(1e-9, scales.tolerance) * scales.force) return ContactStatus::Open;
  if (!pair.frictional()) return ContactStatus::Slip;
  const double g = pair.slipBound(lambda[0]);
  double radius2 = 0;
  bool stuck = false;
  for (int t = 0; t < 2; ++t)
    if (pair.coefficients[t] > 0 && g > 0) {
      radius2 += std::pow(lambda[1 + t] / (pair.coefficients[t] * g), 2);
      stuck = true;
    }
  return stuck && std::sqrt(radius2) < 1 - onEllipse ? ContactStatus::Stick : ContactStatus::Slip;
}

}  // namespace Haptos
