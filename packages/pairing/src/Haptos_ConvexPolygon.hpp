// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_FaceShapes.hpp"

namespace Haptos {

/// \brief Corners anticlockwise, convex.
using Polygon = std::vector<Point2>;

double areaOf(const Polygon& polygon);
Point2 centroidOf(const Polygon& polygon);

/// \brief What of `subject` lies in `window` (Sutherland and Hodgman 1974); empty where nothing does.
/// \param tolerance lengths below it are round-off: corners so near to an edge are on it, corners so near to each other are one
Polygon clipped(const Polygon& subject, const Polygon& window, double tolerance);

/// \brief Distance of a point from the polygon's inside, 0 in it; a lower bound of it beside a corner.
double distanceFrom(const Polygon& polygon, const Point2& x);

}  // namespace Haptos
