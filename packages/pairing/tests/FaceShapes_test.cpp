// SPDX-License-Identifier: BSD-3-Clause
// What mortar integrates with: shape functions of faces and their inverse, polygons that are cut, rules on triangles.
#include "Haptos_FaceShapes.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <cmath>
#include <random>

#include "Haptos_ConvexPolygon.hpp"
#include "Haptos_TriangleRule.hpp"

namespace {

using namespace Haptos;

const std::vector<int> kSizes = {3, 4, 6, 8, 9};

std::array<Point2, 9> referenceNodes(int size) {
  if (isTriangle(size)) return {{{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}}};
  return {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, -1}, {1, 0}, {0, 1}, {-1, 0}, {0, 0}}};
}

double factorial(int n) { return n < 2 ? 1.0 : n * factorial(n - 1); }

TEUCHOS_UNIT_TEST(FaceShapes, one_at_its_node_and_derivatives_by_differences) {
  for (const int size : kSizes) {
    const auto nodes = referenceNodes(size);
    for (int j = 0; j < size; ++j) {
      const auto v = faceValues(size, nodes[std::size_t(j)]);
      for (int i = 0; i < size; ++i) TEST_COMPARE(std::abs(v.N[std::size_t(i)] - (i == j)), <=, 1e-15);
    }
    const Point2 x = {0.23, 0.31};
    const double h = 1e-5;
    const auto v = faceValues(size, x), right = faceValues(size, {x[0] + h, x[1]}), left = faceValues(size, {x[0] - h, x[1]}),
               up = faceValues(size, {x[0], x[1] + h}), down = faceValues(size, {x[0], x[1] - h});
    double sum = 0;
    for (std::size_t i = 0; i < std::size_t(size); ++i) {
      sum += v.N[i];
      TEST_COMPARE(std::abs(v.dXi[i] - (right.N[i] - left.N[i]) / (2 * h)), <=, 1e-9);
      TEST_COMPARE(std::abs(v.dEta[i] - (up.N[i] - down.N[i]) / (2 * h)), <=, 1e-9);
    }
    TEST_FLOATING_EQUALITY(sum, 1.0, 1e-14);
  }
}

TEUCHOS_UNIT_TEST(FaceShapes, points_come_back_from_distorted_faces) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shift(-0.25, 0.25), inside(0, 1);
  for (const int size : kSizes)
    for (int repeat = 0; repeat < 200; ++repeat) {
      auto x = referenceNodes(size);
      const double part = isTriangle(size) ? 0.4 : isLinear(size) ? 1.0 : 0.5;  // of the edges between nodes
      for (auto& node : x) node = {1e-3 * (node[0] + part * shift(random)) + 5, 1e-3 * (node[1] + part * shift(random))};
      Point2 at = {inside(random), inside(random)};
      at = isTriangle(size) ? Point2{at[0] * at[1], at[0] * (1 - at[1])} : Point2{2 * at[0] - 1, 2 * at[1] - 1};
      const auto v = faceValues(size, at);
      Point2 target{0, 0};
      for (std::size_t i = 0; i < std::size_t(size); ++i)
        for (std::size_t c = 0; c < 2; ++c) target[c] += v.N[i] * x[i][c];
      const auto found = referencePoint(size, x, target);
      TEST_ASSERT(found.has_value());
      if (!found) continue;
      TEST_COMPARE(std::hypot((*found)[0] - at[0], (*found)[1] - at[1]), <=, 1e-10);
      TEST_COMPARE(distanceOutside(size, *found), <=, 1e-10);
    }
  TEST_ASSERT(distanceOutside(4, {1.2, 0}) > 0.09 && distanceOutside(3, {0.6, 0.6}) > 0.19);
}

TEUCHOS_UNIT_TEST(ConvexPolygon, pieces_of_a_cut_add_up) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto convex = [&] {
    std::vector<double> angles(5);
    for (auto& a : angles) a = 6.28 * uniform(random);
    std::sort(angles.begin(), angles.end());
    Polygon polygon;
    for (double a : angles) polygon.push_back({0.3 + std::cos(a), std::sin(a)});
    return polygon;
  };
  for (int repeat = 0; repeat < 200; ++repeat) {
    const Polygon a = convex(), b = convex();
    const double x = 2 * uniform(random) - 1;
    const Polygon left = {{-9, -9}, {x, -9}, {x, 9}, {-9, 9}}, right = {{x, -9}, {9, -9}, {9, 9}, {x, 9}};
    const auto area = [](const Polygon& p) { return p.empty() ? 0.0 : areaOf(p); };
    TEST_COMPARE(std::abs(area(clipped(a, left, 1e-12)) + area(clipped(a, right, 1e-12)) - areaOf(a)), <=, 1e-10);
    TEST_COMPARE(std::abs(area(clipped(a, b, 1e-12)) - area(clipped(b, a, 1e-12))), <=, 1e-10);
    TEST_COMPARE(std::abs(area(clipped(a, a, 1e-12)) - areaOf(a)), <=, 1e-12);
  }
  const Polygon square = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, beside = {{1 - 1e-14, 0}, {2, 0}, {2, 1}, {1 - 1e-14, 1}};
  TEST_ASSERT(clipped(square, beside, 1e-12).empty());
  TEST_EQUALITY(distanceFrom(square, {0.5, 0.5}), 0.0);
  TEST_FLOATING_EQUALITY(distanceFrom(square, {0.5, -0.25}), 0.25, 1e-14);
}

// int L1^a L2^b L3^c dA = 2 A a! b! c! / (a + b + c + 2)!
TEUCHOS_UNIT_TEST(TriangleRule, is_exact_to_its_degree_and_not_beyond) {
  for (const auto& [rule, degree] : {std::make_pair(sevenPoints(), 5), std::make_pair(thirtySixPoints(), 10), std::make_pair(sixtyFourPoints(), 14)}) {
    double beyond = 0;
    for (int a = 0; a <= degree + 2; ++a)
      for (int b = 0; a + b <= degree + 2; ++b)
        for (int c = 0; a + b + c <= degree + 2; ++c) {
          double sum = 0;
          for (const auto& point : rule)
            sum += point.weight * std::pow(point.shares[0], a) * std::pow(point.shares[1], b) * std::pow(point.shares[2], c);
          const double exact = 2 * factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 2);
          if (a + b + c <= degree) TEST_COMPARE(std::abs(sum - exact), <=, 1e-15);
          beyond = std::max(beyond, std::abs(sum - exact));
        }
    TEST_COMPARE(beyond, >, 1e-14);
  }
}

}  // namespace
