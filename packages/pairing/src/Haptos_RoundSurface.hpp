// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>

#include "Haptos_ContactSurface.hpp"

namespace Haptos {

/// \brief A cylinder about an axis through `centre`, or without axis a sphere about it.
struct RoundSurface {
  std::array<double, 3> centre;
  std::optional<std::array<double, 3>> axis;  ///< of length 1
  double radius;
  double misfit;  ///< farthest that a fitted node lies off it
};

/// \brief The cylinder of least sum of squared distances to the nodes, by Gauss and Newton's method from the axis to which normals are most nearly
/// orthogonal and the circle of Kasa (1976) across it.  Serial.
/// \throws InputError if nodes lie off it by more than a quarter of the element size, or the surface is flat
RoundSurface fitCylinder(const ContactSurface& surface);
RoundSurface fitSphere(const ContactSurface& surface);  ///< the same for a sphere

/// \brief How far along the unit vector n the line through x meets the surface: of both points the one nearer to `guess`; nothing if it does not.
std::optional<double> distanceAlong(const RoundSurface& round, const std::array<double, 3>& x, const std::array<double, 3>& n, double guess);

}  // namespace Haptos
