// SPDX-License-Identifier: BSD-3-Clause
#include <Teuchos_UnitTestHarness.hpp>
#include <limits>

#include "ContactScenes.hpp"
#include "Haptos_LocalFrame.hpp"

namespace {
using namespace Haptos;
using Scenes::distance;
using Scenes::Point;

double orthonormalityError(const LocalFrame& f) {
  const double lengths = std::abs(Vec3::norm(f.normal) - 1) + std::abs(Vec3::norm(f.t1) - 1);
  return lengths + std::abs(Vec3::dot(f.normal, f.t1)) + distance(f.t2, Vec3::cross(f.normal, f.t1)) +
         distance(f.normal, Vec3::cross(f.t1, f.t2));
}

Point tilted(double degrees) {  // from z towards y
  const double angle = degrees * std::acos(-1.0) / 180.0;
  return {0.0, std::sin(angle), std::cos(angle)};
}

TEUCHOS_UNIT_TEST(LocalFrame, ProjectsTheDirectionOnTheTangentPlane) {
  const LocalFrame f = makeFrame({0, 0, -3}, {2, 0, 5});
  TEST_ASSERT(distance(f.normal, {0, 0, -1}) < 1e-15);
  TEST_ASSERT(distance(f.t1, {1, 0, 0}) < 1e-15);
  TEST_ASSERT(distance(f.t2, {0, -1, 0}) < 1e-15);  // t2 = n x t1
}

TEUCHOS_UNIT_TEST(LocalFrame, IsOrthonormalForAnyDirection) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    const auto r = Scenes::randomRotation(seed);
    TEST_COMPARE(orthonormalityError(makeFrame(r[0], Vec3::add(r[0], Vec3::scale(2e-3, r[1])))), <, 1e-14);
    const LocalFrame f = makeFrame(r[0], Vec3::add(Vec3::scale(7, r[0]), Vec3::scale(0.5, r[2])));
    TEST_COMPARE(orthonormalityError(f), <, 1e-14);
    TEST_COMPARE(distance(f.t1, r[2]), <, 1e-13);
  }
}

TEUCHOS_UNIT_TEST(LocalFrame, TakesTheNextAxisAlongTheNormal) {
  const Point x = {1, 0, 0}, z = {0, 0, 1};
  TEST_ASSERT(distance(makeFrame(z, z).t1, x) < 1e-15);
  TEST_ASSERT(distance(makeFrame(z, {0, 0, -4}).t1, x) < 1e-15);
  TEST_ASSERT(distance(makeFrame(z, tilted(0.099)).t1, x) < 1e-15);
  TEST_ASSERT(distance(makeFrame(z, tilted(0.101)).t1, {0, 1, 0}) < 1e-14);
  TEST_ASSERT(distance(makeFrame(z, tilted(180 - 0.099)).t1, x) < 1e-15);
  TEST_ASSERT(distance(makeFrame(x, x).t1, z) < 1e-15);  // x is along the normal too: z
  TEST_ASSERT(distance(makeFrame({1, 1e-3, 0}, x).t1, z) < 1e-14);
}

TEUCHOS_UNIT_TEST(LocalFrame, DoesNotDependOnLengths) {
  const LocalFrame f = makeFrame({0, 1, 2}, {3, 2, 1});
  const LocalFrame g = makeFrame({0, 1e-200, 2e-200}, {3e250, 2e250, 1e250});
  TEST_COMPARE(distance(f.t1, g.t1) + distance(f.t2, g.t2) + distance(f.normal, g.normal), <, 1e-15);
}

TEUCHOS_UNIT_TEST(LocalFrame, RefusesZeroAndNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  TEST_THROW(makeFrame({0, 0, 1}, {0, 0, 0}), InputError);
  TEST_THROW(makeFrame({0, 0, 1}, {nan, 0, 1}), InputError);
  TEST_THROW(makeFrame({0, 0, 1}, {inf, 0, 1}), InputError);
  TEST_THROW(makeFrame({0, 0, 0}, {1, 0, 0}), InputError);
  TEST_THROW(makeFrame({0, nan, 1}, {1, 0, 0}), InputError);
}

}  // namespace
