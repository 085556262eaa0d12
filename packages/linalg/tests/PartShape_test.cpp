// SPDX-License-Identifier: BSD-3-Clause
// Which parts are thin, whatever their elements.
#include "Haptos_PartShape.hpp"

#include <Eigen/Core>
#include <Teuchos_UnitTestHarness.hpp>
#include <array>
#include <cmath>

#include "DividedPart.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

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
      const double aspect = Part(n, warped).aspect(knowsElements);
      out << n[0] << " x " << n[1] << " x " << n[2] << ": " << aspect << "\n";
      TEST_COMPARE(aspect, <, 5);
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
      const double aspect = Part({n, 3, 2}, pipe(angle, thickness), closes).aspect(knowsElements);
      out << angle << ", " << knowsElements << ": " << aspect << ", of a box " << exact << "\n";
      TEST_COMPARE(aspect, >, 0.15 * exact);
      TEST_COMPARE(aspect, <, 1.6 * exact);
    }
  }
}

// Elements of which each turns by 45 degrees: no piece is straight, but the volume tells.  A few elements are no shell.
TEUCHOS_UNIT_TEST(PartShape, CoarselyBentPartsAreThin) {
  const double pi = std::acos(-1.0);
  TEST_ASSERT(isSlender(Part({8, 1, 1}, pipe(2 * pi, 0.01), true).aspect()));
  TEST_ASSERT(!isSlender(Part({8, 1, 1}, pipe(2 * pi, 0.5), true).aspect()));
  for (const auto& n : {std::array{1, 1, 1}, {1, 1, 3}, {2, 1, 2}}) TEST_COMPARE(Part(n, box(n[0], n[1], n[2])).aspect(), <, 6);
}

TEUCHOS_UNIT_TEST(PartShape, PlacesThatTellNothing) {
  for (double size : {0.0, 1.0}) TEST_ASSERT(isSlender(Part({4, 4, 1}, box(size, size, 0)).aspect(false)));
  // corners of a tetrahedron, many nodes at each but for round-off
  const auto corner = [](double u, double v, double w) -> Eigen::Vector3d {
    const Eigen::Vector3d x(u > 0.5, v > 0.5, (u > 0.5) != (v > 0.5));
    return (1 + 1e-16 * w) * (x + Eigen::Vector3d::Constant(0.1));
  };
  TEST_ASSERT(!isSlender(Part({9, 9, 3}, corner).aspect(false)));
}

}  // namespace
