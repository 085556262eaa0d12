// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactLaw.hpp"

#include <Teuchos_UnitTestHarness.hpp>

#include "PlainLaw.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

PairLaw makeLaw(FrictionLaw law, const Pair2& F, double slipForce = 0, bool pinned = false) {
  return {0, {law == FrictionLaw::Frictionless ? -1 : 1, law == FrictionLaw::Frictionless ? -1 : 2}, F, slipForce, law, pinned};
}

// All kinds of pair laws, with the range of x in which their set matters.
std::vector<PairLaw> manyLaws() {
  std::vector<PairLaw> laws;
  for (const Pair2& F : {Pair2{0.3, 0.3}, {0.3, 0.15}, {2.0, 0.05}, {0.4, 0.0}, {0.0, 0.4}, {0.0, 0.0}})
    for (bool pinned : {false, true}) {
      laws.push_back(makeLaw(FrictionLaw::Coulomb, F, 0, pinned));
      laws.push_back(makeLaw(FrictionLaw::Tresca, F, 0.8, pinned));
      laws.push_back(makeLaw(FrictionLaw::Tresca, F, 0.0, pinned));
    }
  laws.push_back(makeLaw(FrictionLaw::Frictionless, {0, 0}));
  return laws;
}

Triple somePoint(int i) { return {pseudoRandom(3 * i), pseudoRandom(3 * i + 1), pseudoRandom(3 * i + 2)}; }

Triple plainProjection(const PairLaw& law, const Triple& x) {
  Triple p{law.normalPinned ? 0.0 : std::max(0.0, x[0]), 0, 0};
  if (!law.frictional()) return p;
  const double g = law.law == FrictionLaw::Tresca ? law.slipForce : p[0];
  const Pair2 T = nearestOnEllipse({x[1], x[2]}, {law.coefficients[0] * g, law.coefficients[1] * g});
  return {p[0], T[0], T[1]};
}

}  // namespace

TEUCHOS_UNIT_TEST(PairLaw, ProjectsOnTheNearestPoint) {
  int slipping = 0, sticking = 0, open = 0;
  for (const auto& law : manyLaws())
    for (int i = 0; i < 60; ++i) {
      const Triple x = somePoint(i), p = plainProjection(law, x);
      const PairProjection projected = law.project(x);
      for (int d = 0; d < 3; ++d) TEST_ASSERT(std::abs(projected.point[d] - p[d]) < 1e-9);
      slipping += projected.status == ContactStatus::Slip;
      sticking += projected.status == ContactStatus::Stick;
      open += projected.status == ContactStatus::Open;
      TEST_EQUALITY(projected.status == ContactStatus::Open, x[0] <= 0 || law.normalPinned);
    }
  out << slipping << " slip, " << sticking << " stick, " << open << " open\n";
  TEST_ASSERT(slipping > 50 && sticking > 20 && open > 50);
}

TEUCHOS_UNIT_TEST(PairLaw, ProjectionIsIdempotent) {
  for (const auto& law : manyLaws())
    for (int i = 0; i < 40; ++i) {
      const auto p = law.project(somePoint(i)).point, again = law.project(p).point;
      for (int d = 0; d < 3; ++d) TEST_ASSERT(std::abs(again[d] - p[d]) < 1e-12);
    }
}

TEUCHOS_UNIT_TEST(PairLaw, DerivativeAgreesWithDifferences) {
  constexpr double h = 1e-6;
  int compared = 0, coupled = 0;
  for (const auto& law : manyLaws())
    for (int i = 0; i < 60; ++i) {
      const Triple x = somePoint(i);
      const PairProjection at = law.project(x);
      for (int j = 0; j < 3; ++j) {
        Triple low = x, high = x;
        low[j] -= h;
        high[j] += h;
        const auto pLow = law.project(low), pHigh = law.project(high);
        // A kink lies between: the one-sided slopes differ.
        bool kink = false;
        for (int d = 0; d < 3; ++d)
          kink = kink || std::abs(pHigh.point[d] - 2 * at.point[d] + pLow.point[d]) > 1e-3 * h;
        if (kink) continue;
        ++compared;
        coupled += j == 0 && std::abs(at.dPdx[1][0]) > 1e-3;
        for (int d = 0; d < 3; ++d)
          TEST_ASSERT(std::abs((pHigh.point[d] - pLow.point[d]) / (2 * h) - at.dPdx[d][j]) < 1e-4);
      }
    }
  TEST_ASSERT(compared > 4000);
  TEST_ASSERT(coupled > 50);  // Coulomb: the tangential force follows the normal one
}

TEUCHOS_UNIT_TEST(PairLaw, PinnedComponentsStayZero) {
  const auto pinned = makeLaw(FrictionLaw::Coulomb, {0.3, 0.3}, 0, true).project({1, 1, 1});
  for (double value : pinned.point) TEST_EQUALITY(value, 0.0);
  TEST_ASSERT(pinned.status == ContactStatus::Open);
  const auto oneAxis = makeLaw(FrictionLaw::Coulomb, {0.3, 0.0}).project({1, 5, 5});
  TEST_FLOATING_EQUALITY(oneAxis.point[1], 0.3, 1e-14);
  TEST_EQUALITY(oneAxis.point[2], 0.0);
}

TEUCHOS_UNIT_TEST(ContactStatus, FollowsTheDefinition) {
  const PairLaw coulomb = makeLaw(FrictionLaw::Coulomb, {0.3, 0.15});
  TEST_ASSERT(contactStatus(coulomb, {1e-10, 0, 0}, {1.0, 0.0}) == ContactStatus::Open);
  TEST_ASSERT(contactStatus(coulomb, {1, 0, 0}, {1.0, 0.0}) == ContactStatus::Stick);
  TEST_ASSERT(contactStatus(coulomb, {1, 0.3, 0}, {1.0, 0.0}) == ContactStatus::Slip);
  TEST_ASSERT(contactStatus(coulomb, {1, 0, 0.15 * (1 - 5e-7)}, {1.0, 0.0}) == ContactStatus::Slip);
  TEST_ASSERT(contactStatus(coulomb, {1, 0, 0.15 * (1 - 2e-6)}, {1.0, 0.0}) == ContactStatus::Stick);
  TEST_ASSERT(contactStatus(makeLaw(FrictionLaw::Frictionless, {0, 0}), {1, 0, 0}, {0.0, 0.0}) == ContactStatus::Slip);
  TEST_ASSERT(contactStatus(makeLaw(FrictionLaw::Coulomb, {0, 0}), {1, 0, 0}, {0.0, 0.0}) == ContactStatus::Slip);
  TEST_ASSERT(contactStatus(makeLaw(FrictionLaw::Tresca, {0.3, 0.3}, 2.0), {1, 0.5, 0}, {0.0, 0.0}) == ContactStatus::Stick);
  // what the tolerance of a run does not resolve makes no states
  const StateScales coarse{2.0, 1e-4};
  TEST_ASSERT(contactStatus(coulomb, {1.9e-4, 0, 0}, coarse) == ContactStatus::Open);
  TEST_ASSERT(contactStatus(coulomb, {2.1e-4, 0, 0}, coarse) == ContactStatus::Stick);
  TEST_ASSERT(contactStatus(coulomb, {1, 0, 0.15 * (1 - 0.9e-3)}, coarse) == ContactStatus::Slip);
  TEST_ASSERT(contactStatus(coulomb, {1, 0, 0.15 * (1 - 1.1e-3)}, coarse) == ContactStatus::Stick);
}
