// SPDX-License-Identifier: BSD-3-Clause
// What nodes of thin parts meet where something touches them.
#include "Haptos_TouchedNodes.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <cmath>
#include <functional>

#include "DividedPart.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;
using Vector = Eigen::Vector3d;

// Its nodes where `outward` is not zero.
std::vector<double> alone(const Part& part, const std::function<Vector(const Vector&)>& outward) {
  TouchedNodes touched;
  for (int node = 0; node < int(part.coordinates.size()); ++node) {
    const Vector normal = outward(Vector(part.coordinates[std::size_t(node)].data()));
    if (normal.isZero()) continue;
    touched.nodes.push_back(node);
    touched.normals.push_back(normal);
  }
  return stiffnessAlone(part.coordinates, part.neighbours(), touched);
}

double smallest(const std::vector<double>& values) { return *std::min_element(values.begin(), values.end()); }
double largest(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }

// On planes z = constant.
std::function<Vector(const Vector&)> onPlanes(std::vector<double> heights) {
  return [=](const Vector& x) -> Vector {
    for (const double z : heights)
      if (std::abs(x[2] - z) < 1e-12) return {0, 0, z > 0 ? 2.0 : -2.0};
    return Vector::Zero();
  };
}

// a x a x t: E t over E a^2 / t, times 3.4 inside and up to 9 at corners.
TEUCHOS_UNIT_TEST(TouchedNodes, SurfacesOfPlatesYield) {
  const double a = 0.1;
  for (const int layers : {1, 2, 4})
    for (const double t : {0.03, 0.01, 1e-3}) {
      const auto values = alone(Part({10, 10, layers}, box(10 * a, 10 * a, layers * t)), onPlanes({0}));
      out << t << ": " << smallest(values) << " to " << largest(values) << "\n";
      TEST_EQUALITY(values.size(), std::size_t(121));
      TEST_COMPARE(smallest(values), >, 2 * t * t / (a * a));
      TEST_COMPARE(largest(values), <, 9.5 * t * t / (a * a));
    }
  const auto cubes = alone(Part({10, 10, 2}, box(10 * a, 10 * a, 2 * a)), onPlanes({0}));
  TEST_COMPARE(smallest(cubes), >, 0.8);
}

// Shims, and plates between others: the other side holds.
TEUCHOS_UNIT_TEST(TouchedNodes, WhatIsTouchedFromBothSidesDoesNot) {
  const Part plate({10, 10, 3}, box(1, 1, 0.03));
  TEST_EQUALITY(smallest(alone(plate, onPlanes({0, 0.03}))), 1.0);
  TEST_COMPARE(largest(alone(plate, onPlanes({0.03}))), <, 0.1);
  // where it is
  const auto half = alone(plate, [](const Vector& x) -> Vector {
    if (x[2] == 0) return {0, 0, -1};
    return Vector(0, 0, x[2] > 0.029 && x[0] < 0.55 ? 1 : 0);
  });
  TEST_EQUALITY(std::count(half.begin(), half.end(), 1.0), 2 * 6 * 11);
  TEST_COMPARE(smallest(half), <, 0.1);
}

// Ends of towers, and needles that lie: neighbours on the same surface hold.
TEUCHOS_UNIT_TEST(TouchedNodes, LongElementsDoNotYield) {
  const auto end = alone(Part({8, 8, 10}, box(0.01, 0.01, 1)), onPlanes({0, 1}));
  TEST_EQUALITY(end.size(), std::size_t(2 * 81));
  TEST_EQUALITY(smallest(end), 1.0);
  TEST_COMPARE(smallest(alone(Part({10, 4, 4}, box(1, 0.01, 0.01)), onPlanes({0}))), >, 0.8);
}

// Around a drum: what lies beside a node is farther inward than what lies below it.
TEUCHOS_UNIT_TEST(TouchedNodes, BentSurfacesYieldAsFlatOnesDo) {
  const double pi = std::acos(-1.0), t = 0.005;
  const Part ring({10, 4, 2}, pipe(2 * pi, 2 * t), true);
  for (const double radius : {1.0, 1 + 2 * t}) {
    const auto values = alone(ring, [&](const Vector& x) -> Vector {
      const double r = std::hypot(x[0], x[2]);
      return std::abs(r - radius) < 1e-9 ? Vector((radius > 1 ? 1 : -1) * Vector(x[0], 0, x[2])) : Vector::Zero();
    });
    const double b = 0.125;  // the shorter side of its elements
    TEST_EQUALITY(values.size(), std::size_t(50));
    TEST_COMPARE(smallest(values), >, 2 * t * t / (b * b));
    TEST_COMPARE(largest(values), <, 9.5 * t * t / (b * b));
  }
}

TEUCHOS_UNIT_TEST(TouchedNodes, PlacesThatTellNothing) {
  for (double size : {0.0, 1.0})
    for (const double value : alone(Part({4, 4, 1}, box(size, size, 0)), [](const Vector&) { return Vector(0, 0, -1); }))
      TEST_ASSERT(value > 0 && value <= 1);
  TouchedNodes noNormal{{0}, {Vector::Zero()}};
  const Part plate({10, 10, 2}, box(1, 1, 0.01));
  TEST_EQUALITY(stiffnessAlone(plate.coordinates, plate.neighbours(), noNormal)[0], 1.0);
}

}  // namespace
