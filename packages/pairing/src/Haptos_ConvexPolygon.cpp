// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ConvexPolygon.hpp"

#include <algorithm>
#include <cmath>

namespace Haptos {
namespace {

// Twice the area of the triangle a b c, positive counter-clockwise.
double crossed(const Point2& a, const Point2& b, const Point2& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

double distance(const Point2& a, const Point2& b) { return std::hypot(b[0] - a[0], b[1] - a[1]); }

// Signed distance from the edge a -> b, positive inside.
double distanceInside(const Point2& a, const Point2& b, const Point2& x) { return crossed(a, b, x) / distance(a, b); }

// Corners that nearly coincide become one: conforming meshes would breed slivers, whose integrals are all round-off.
void append(Polygon& polygon, const Point2& x, double tolerance) {
  if (polygon.empty() || distance(polygon.back(), x) > tolerance) polygon.push_back(x);
}

// Sutherland and Hodgman: what lies inside of one edge of a convex window, corner by corner.  Corners on the edge count as inside, so
// that faces with common edges neither lose nor double anything.
Polygon clippedByEdge(const Polygon& subject, const Point2& a, const Point2& b, double tolerance) {
  Polygon result;
  for (std::size_t i = 0; i < subject.size(); ++i) {
    const Point2 &x = subject[i], &y = subject[(i + 1) % subject.size()];
    const double dx = distanceInside(a, b, x), dy = distanceInside(a, b, y);
    if (dx >= -tolerance) append(result, x, tolerance);
    if ((dx > tolerance && dy < -tolerance) || (dx < -tolerance && dy > tolerance)) {
      const double t = dx / (dx - dy);
      append(result, {x[0] + t * (y[0] - x[0]), x[1] + t * (y[1] - x[1])}, tolerance);
    }
  }
  while (result.size() > 1 && distance(result.front(), result.back()) <= tolerance) result.pop_back();
  return result;
}

}  // namespace

// Fans of triangles from the first corner: exact for convex polygons, and relative to a corner, so that no digits are lost far away.
double areaOf(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t i = 2; i < polygon.size(); ++i) twice += crossed(polygon[0], polygon[i - 1], polygon[i]);
  return 0.5 * twice;
}

Point2 centroidOf(const Polygon& polygon) {
  Point2 sum{0, 0};
  double twice = 0;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const double a = crossed(polygon[0], polygon[i - 1], polygon[i]);
    twice += a;
    for (std::size_t c = 0; c < 2; ++c) sum[c] += a * (polygon[0][c] + polygon[i - 1][c] + polygon[i][c]) / 3;
  }
  return {sum[0] / twice, sum[1] / twice};
}

Polygon clipped(const Polygon& subject, const Polygon& window, double tolerance) {
  Polygon result = subject;
  for (std::size_t i = 0; i < window.size() && result.size() >= 3; ++i) {
    const Point2 &a = window[i], &b = window[(i + 1) % window.size()];
    if (distance(a, b) > tolerance) result = clippedByEdge(result, a, b, tolerance);
  }
  if (result.size() < 3) result.clear();
  return result;
}

double distanceFrom(const Polygon& polygon, const Point2& x) {
  double outside = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if (distance(a, b) > 0) outside = std::max(outside, -distanceInside(a, b, x));
  }
  return outside;
}

}  // namespace Haptos
