// SPDX-License-Identifier: BSD-3-Clause
// Which parts are thin, whatever their elements, and what a node meets there.
#include "Haptos_PartShape.hpp"

#include <Eigen/Core>
#include <Teuchos_UnitTestHarness.hpp>
#include <array>
#include <cmath>
#include <functional>

#include "Haptos_NodeNeighbours.hpp"
#include "Haptos_StiffnessAssembler.hpp"

namespace {

using namespace Haptos;
using Place = std::function<Eigen::Vector3d(double, double, double)>;

// A cube of n elements, put in place; on request its ends along the first direction are one.
struct Part {
  Coordinates coordinates;
  std::vector<ElementGroup> groups = std::vector<ElementGroup>(1);

  Part(const std::array<int, 3>& n, const Place& place, bool closes = false) {
    const int columns = closes ? n[0] : n[0] + 1;
    const auto number = [&](int i, int j, int k) { return (i % columns * (n[1] + 1) + j) * (n[2] + 1) + k; };
    for (int i = 0; i < columns; ++i)
      for (int j = 0; j <= n[1]; ++j)
        for (int k = 0; k <= n[2]; ++k) {
          const Eigen::Vector3d x = place(double(i) / n[0], double(j) / n[1], double(k) / n[2]);
          coordinates.push_back({x[0], x[1], x[2]});
        }
    for (int i = 0; i < n[0]; ++i)
      for (int j = 0; j < n[1]; ++j)
        for (int k = 0; k < n[2]; ++k)
          for (const auto& [a, b, c] : {std::array{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}})
            groups[0].connectivity.push_back(number(i + a, j + b, k + c));
  }
  PartShape shape(bool knowsElements = true) const {
    PartVolume volume;
    if (knowsElements) nodalStiffness(coordinates, groups, {1.0}, &volume);
    return shapeOfPart(coordinates, nodeNeighbours(int(coordinates.size()), groups), volume);
  }
};

Place box(double a, double b, double c) {
  return [=](double u, double v, double w) { return Eigen::Vector3d(a * u, b * v, c * w); };
}

Place pipe(double angle, double thickness) {
  return [=](double u, double v, double w) {
    const double r = 1 + thickness * w;
    return Eigen::Vector3d(r * std::cos(angle * u), -0.5 * v, r * std::sin(angle * u));
  };
}

TEUCHOS_UNIT_TEST(PartShape, AspectsOfBoxesAndPlanes) {
  TEST_FLOATING_EQUALITY(aspectOf(Part({6, 6, 6}, box(3, 0.6, 1.8)).coordinates), 5.0, 1e-10);
  TEST_COMPARE(aspectOf(Part({6, 6, 6}, box(3, 0, 1.8)).coordinates), >, 1e7);
  TEST_ASSERT(isSlender(10.5) && !isSlender(9.5));
}

// Layers of nodes are far from each other, warped, and each of them is a shell by itself.
TEUCHOS_UNIT_TEST(PartShape, FlatElementsMakeNoThinPart) {
  const auto warped = [](double u, double v, double w) { return Eigen::Vector3d(u, v, w + 0.02 * std::sin(5 * u) * std::cos(4 * v)); };
  for (const auto& n : {std::array{24, 24, 2}, {2, 24, 24}, {3, 3, 40}, {40, 40, 1}, {8, 8, 8}})
    for (bool knowsElements : {true, false}) {
      const PartShape shape = Part(n, warped).shape(knowsElements);
      out << n[0] << " x " << n[1] << " x " << n[2] << ": " << shape.aspect << "\n";
      TEST_COMPARE(shape.aspect, <, 5);
      TEST_EQUALITY(shape.nodeStiffness, 1.0);
    }
}

TEUCHOS_UNIT_TEST(PartShape, BentPartsAreThin) {
  const double pi = std::acos(-1.0), thickness = 0.02;
  for (double angle : {pi / 3, pi, 2 * pi}) {
    const int n = angle < 2 ? 8 : 24;
    const bool closes = angle > 6;
    const double extent = angle > 3 ? std::sqrt(6.0) : 1.0;  // of a box that spreads as far
    const double exact = extent / thickness;
    for (bool knowsElements : {true, false}) {
      const double aspect = Part({n, 3, 2}, pipe(angle, thickness), closes).shape(knowsElements).aspect;
      out << angle << ", " << knowsElements << ": " << aspect << ", of a box " << exact << "\n";
      TEST_COMPARE(aspect, >, 0.15 * exact);
      TEST_COMPARE(aspect, <, 1.6 * exact);
    }
  }
}

// Elements of which each turns by 45 degrees: no piece is straight, but the volume tells.  A few elements are no shell.
TEUCHOS_UNIT_TEST(PartShape, CoarselyBentPartsAreThin) {
  const double pi = std::acos(-1.0);
  const PartShape thin = Part({8, 1, 1}, pipe(2 * pi, 0.01), true).shape();
  const PartShape thick = Part({8, 1, 1}, pipe(2 * pi, 0.5), true).shape();
  TEST_ASSERT(isSlender(thin.aspect) && !isSlender(thick.aspect));
  TEST_COMPARE(thin.nodeStiffness, <, 0.5);
  TEST_EQUALITY(thick.nodeStiffness, 1.0);
  for (const auto& n : {std::array{1, 1, 1}, {1, 1, 3}, {2, 1, 2}}) TEST_COMPARE(Part(n, box(n[0], n[1], n[2])).shape().aspect, <, 6);
}

// a x a x t: the harmonic over the arithmetic mean of the squares; in its middle a node and its neighbours spread as far as its elements.
TEUCHOS_UNIT_TEST(PartShape, NodesOfThinPartsMeetLess) {
  const PartShape plate = Part({10, 10, 2}, box(1, 1, 0.02)).shape(), cubes = Part({60, 2, 2}, box(6, 0.2, 0.2)).shape();
  const double a2 = 0.01, t2 = 1e-4, expected = 9 / ((2 * a2 + t2) * (2 / a2 + 1 / t2));
  TEST_FLOATING_EQUALITY(plate.nodeStiffness, expected, 0.5);  // nodes of the surface spread less across it
  TEST_ASSERT(isSlender(cubes.aspect));
  TEST_COMPARE(cubes.nodeStiffness, >, 0.8);
}

TEUCHOS_UNIT_TEST(PartShape, PlacesThatTellNothing) {
  for (double size : {0.0, 1.0}) {
    const PartShape shape = Part({4, 4, 1}, box(size, size, 0)).shape(false);
    TEST_ASSERT(isSlender(shape.aspect));
    TEST_ASSERT(shape.nodeStiffness > 0 && shape.nodeStiffness <= 1);
  }
  // corners of a tetrahedron, many nodes at each but for round-off
  const auto corner = [](double u, double v, double w) -> Eigen::Vector3d {
    const Eigen::Vector3d x(u > 0.5, v > 0.5, (u > 0.5) != (v > 0.5));
    return (1 + 1e-16 * w) * (x + Eigen::Vector3d::Constant(0.1));
  };
  TEST_ASSERT(!isSlender(Part({9, 9, 3}, corner).shape(false).aspect));
}

}  // namespace
