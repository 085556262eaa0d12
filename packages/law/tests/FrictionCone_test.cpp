// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_FrictionCone.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <vector>

#include "PlainLaw.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

const std::vector<Pair2>& coefficients() {
  static const std::vector<Pair2> list{{0.3, 0.3}, {0.3, 0.15}, {5, 2}, {1, 1e-6}, {1e-6, 1}, {1e3, 1e-3}, {0.3, 0}, {0, 0.3}, {0, 0}};
  return list;
}

Triple scaledPoint(int i) {
  const double size = std::pow(10.0, i % 5 - 2);
  return {pseudoRandom(3 * i), size * pseudoRandom(3 * i + 1), size * pseudoRandom(3 * i + 2)};
}

double norm(const Triple& x) { return std::hypot(x[0], x[1], x[2]); }

// How far x is outside { N >= 0, || F^-1 T || <= N }, in the unit of x.
double outsideCone(const Triple& x, const Pair2& F) {
  double radius = 0, off = 0;
  for (int i = 0; i < 2; ++i) (F[i] > 0 ? radius : off) = std::hypot(F[i] > 0 ? radius : off, F[i] > 0 ? x[1 + i] / F[i] : x[1 + i]);
  // A distance in N is one in T times the coefficient of that direction.
  const double scale = std::min(1.0, std::max(F[0], F[1]));
  return std::max({off, -x[0], (radius - x[0]) * scale * (radius > 0 ? std::hypot(x[1], x[2]) / radius : 1)});
}

}  // namespace

// Moreau: p is the projection on a closed convex cone iff p lies in it, x - p in its polar, and both are orthogonal.
TEUCHOS_UNIT_TEST(FrictionCone, MoreauDecomposition) {
  int apex = 0, inside = 0, surface = 0;
  for (const auto& F : coefficients())
    for (int i = 0; i < 400; ++i) {
      const Triple x = scaledPoint(i), p = projectOntoFrictionCone(x, F).point;
      const Triple rest{x[0] - p[0], x[1] - p[1], x[2] - p[2]};
      const double tolerance = 1e-11 * norm(x);
      TEST_ASSERT(outsideCone(p, F) <= tolerance);
      TEST_ASSERT(rest[0] + std::hypot(F[0] * rest[1], F[1] * rest[2]) <= tolerance * std::max({1.0, F[0], F[1]}));
      TEST_ASSERT(std::abs(rest[0] * p[0] + rest[1] * p[1] + rest[2] * p[2]) <= tolerance * norm(x));
      (norm(p) == 0 ? apex : norm(rest) == 0 ? inside : surface) += 1;
    }
  TEST_ASSERT(apex > 100 && inside > 50 && surface > 500);
}

TEUCHOS_UNIT_TEST(FrictionCone, PositivelyHomogeneous) {
  for (const auto& F : coefficients())
    for (int i = 0; i < 50; ++i) {
      const Triple x = scaledPoint(i), p = projectOntoFrictionCone(x, F).point;
      for (double factor : {1e-8, 1e8}) {
        const Triple q = projectOntoFrictionCone({factor * x[0], factor * x[1], factor * x[2]}, F).point;
        for (int d = 0; d < 3; ++d) TEST_ASSERT(std::abs(q[d] / factor - p[d]) <= 1e-11 * norm(x));
      }
    }
}

TEUCHOS_UNIT_TEST(FrictionCone, DerivativeAgreesWithDifferences) {
  int compared = 0;
  for (const Pair2& F : {Pair2{0.3, 0.3}, {0.3, 0.15}, {5, 2}, {0.3, 0}, {0, 0}, {1, 1e-3}})
    for (int i = 0; i < 120; ++i) {
      const Triple x = scaledPoint(i);
      const double h = 1e-5 * norm(x);
      const ConeProjection at = projectOntoFrictionCone(x, F);
      for (int j = 0; j < 3; ++j) {
        Triple low = x, high = x;
        low[j] -= h;
        high[j] += h;
        const auto pLow = projectOntoFrictionCone(low, F).point, pHigh = projectOntoFrictionCone(high, F).point;
        double bend = 0;
        for (int d = 0; d < 3; ++d) bend = std::max(bend, std::abs(pHigh[d] - 2 * at.point[d] + pLow[d]) / h);
        if (bend > 1e-3) continue;  // a kink, or too curved for this step
        ++compared;
        for (int d = 0; d < 3; ++d) TEST_ASSERT(std::abs((pHigh[d] - pLow[d]) / (2 * h) - at.dPdx[d][j]) < 1e-3);
      }
    }
  TEST_ASSERT(compared > 1000);
}

TEUCHOS_UNIT_TEST(FrictionCone, DerivativeIsSymmetricWithSpectrumInUnitInterval) {
  for (const auto& F : coefficients())
    for (int i = 0; i < 60; ++i) {
      const auto D = projectOntoFrictionCone(scaledPoint(i), F).dPdx;
      double trace = 0;
      for (int r = 0; r < 3; ++r) {
        trace += D[r][r];
        for (int c = 0; c < 3; ++c) TEST_ASSERT(std::abs(D[r][c] - D[c][r]) < 1e-7);
      }
      TEST_ASSERT(trace > -1e-9 && trace < 3 + 1e-9);
      for (int k = 0; k < 20; ++k) {
        const Triple v{pseudoRandom(k), pseudoRandom(k + 50), pseudoRandom(k + 90)};
        double form = 0;
        for (int r = 0; r < 3; ++r)
          for (int c = 0; c < 3; ++c) form += v[r] * D[r][c] * v[c];
        TEST_ASSERT(form > -1e-7 && form < (1 + 1e-7) * norm(v) * norm(v));
      }
    }
}
