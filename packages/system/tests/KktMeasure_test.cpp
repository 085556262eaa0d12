// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_KktMeasure.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>

#include "../../decomposition/tests/DecomposedScene.hpp"
#include "Haptos_CoulombFixedPoint.hpp"
#include "Haptos_PairLaws.hpp"
#include "../../law/tests/PlainLaw.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

SceneOptions partlyClamped() {
  SceneOptions options;
  options.subdomains = 7;
  options.hold = [](int body, const Point& x) {
    return std::string(x[0] < 1e-9 ? "xyz" : body == 0 && x[0] > 1.5 - 1e-9 ? "x" : body == 1 && x[0] > 1.5 - 1e-9 ? "x" : "");
  };
  return options;
}

// The definitions of the errors, written out from the whole vectors.
KktErrors plainErrors(const Scene& scene, const FrictionSpec& friction, const Eigen::VectorXd& lambda,
                      const Eigen::VectorXd& s, const KktScales& scales) {
  const auto at = [&](const Eigen::VectorXd& v, GlobalOrdinal row) { return row < 0 ? 0.0 : v[row]; };
  double lRef = 1e-3 * scales.load;
  for (const auto& pair : scene.rows.pairs)
    lRef = std::max(lRef, std::hypot(lambda[pair.normal], at(lambda, pair.tangential[0]), at(lambda, pair.tangential[1])));
  KktErrors e;
  for (const auto& pair : scene.rows.pairs) {
    const double N = lambda[pair.normal], gap = -s[pair.normal];
    if (!scene.rows.pinned[pair.normal]) {
      e.penetration = std::max(e.penetration, -gap / scales.uRef);
      e.compression = std::max(e.compression, -N / lRef);
      e.complementarity = std::max(e.complementarity, std::min(std::max(0.0, N) / lRef, std::max(0.0, gap) / scales.uRef));
    }
    if (pair.tangential[0] < 0) continue;
    const double g = friction.law == FrictionLaw::Tresca ? friction.slipBound * pair.geometry.area : std::max(0.0, N);
    Pair2 axes, T, moved;
    for (int t = 0; t < 2; ++t) {
      axes[t] = scene.rows.pinned[pair.tangential[t]] ? 0.0 : friction.coefficients[t] * g;
      T[t] = lambda[pair.tangential[t]];
      moved[t] = T[t] + lRef / scales.uRef * s[pair.tangential[t]];
    }
    const Pair2 P = nearestOnEllipse(T, axes), Q = nearestOnEllipse(moved, axes);
    e.cone = std::max(e.cone, std::hypot(T[0] - P[0], T[1] - P[1]) / lRef);
    e.slipLaw = std::max(e.slipLaw, std::hypot(T[0] - Q[0], T[1] - Q[1]) / lRef);
  }
  return e;
}

}  // namespace

TEUCHOS_UNIT_TEST(KktMeasure, EqualsThePlainDefinitions) {
  const auto comm = Tpetra::getDefaultComm();
  KktErrors seen;
  for (const FrictionSpec& friction :
       {FrictionSpec{FrictionLaw::Coulomb, {0.3, 0.15}, 0}, FrictionSpec{FrictionLaw::Tresca, {0.3, 0.0}, 2.0},
        FrictionSpec{FrictionLaw::Frictionless, {0, 0}, 0}}) {
    SceneOptions options = partlyClamped();
    options.frictional = friction.law != FrictionLaw::Frictionless;
    const Scene scene = makeScene(options);
    TEST_ASSERT(std::count(scene.rows.pinned.begin(), scene.rows.pinned.end(), char(1)) > 0);
    const Dealt dealt = deal(comm, scene);
    const ContactLaw law = makeContactLaw(*dealt.multipliers, {friction});
    for (double load : {1.0, 1e5})  // the second one sets l_ref
      for (int trial = 0; trial < 5; ++trial) {
        const Eigen::VectorXd lambda = someVector(scene.rows.numRows(), trial), s = 1e-2 * someVector(scene.rows.numRows(), trial + 0.5);
        const KktScales scales{0.03, load};
        const auto map = dealt.multipliers->map();
        const KktErrors e = measureContact(law, *scattered(map, lambda), *scattered(map, s), scales);
        const KktErrors plain = plainErrors(scene, friction, lambda, s, scales);
        TEST_FLOATING_EQUALITY(e.penetration, plain.penetration, 1e-12);
        TEST_FLOATING_EQUALITY(e.compression, plain.compression, 1e-12);
        TEST_FLOATING_EQUALITY(e.complementarity, plain.complementarity, 1e-12);
        TEST_ASSERT(std::abs(e.cone - plain.cone) < 1e-8 && std::abs(e.slipLaw - plain.slipLaw) < 1e-8);
        seen.penetration += plain.penetration;
        seen.compression += plain.compression;
        seen.complementarity += plain.complementarity;
        seen.cone += plain.cone;
        TEST_EQUALITY(plain.slipLaw > 0, options.frictional);
        TEST_EQUALITY(e.equilibrium, 0.0);
        const double contact = std::max({e.penetration, e.compression, e.complementarity, e.cone, e.slipLaw});
        TEST_EQUALITY(e.kkt(), contact);
        const WorstPair worst = findWorstPair(law, *dealt.multipliers, *scattered(map, lambda), *scattered(map, s), scales);
        TEST_EQUALITY(worst.error, contact);
        TEST_ASSERT(worst.node >= 0);
        TEST_EQUALITY(worst.interface, 0);
      }
  }
  TEST_ASSERT(seen.penetration > 0 && seen.compression > 0 && seen.complementarity > 0 && seen.cone > 0);
}

TEUCHOS_UNIT_TEST(KktMeasure, NothingMeansZero) {
  const Scene scene = makeScene(partlyClamped());
  const Dealt dealt = deal(Tpetra::getDefaultComm(), scene);
  const ContactLaw law = makeContactLaw(*dealt.multipliers, {{FrictionLaw::Coulomb, {0.3, 0.3}, 0}});
  const Vector zero(dealt.multipliers->map());
  TEST_EQUALITY(measureContact(law, zero, zero, {0, 0}).kkt(), 0.0);
}

// Comparisons would take it for 0, on the rank that has it and in reductions.
TEUCHOS_UNIT_TEST(KktMeasure, WhatIsNoNumberIsNoAnswer) {
  const Scene scene = makeScene(partlyClamped());
  const Dealt dealt = deal(Tpetra::getDefaultComm(), scene);
  const ContactLaw law = makeContactLaw(*dealt.multipliers, {{FrictionLaw::Coulomb, {0.3, 0.3}, 0}});
  const Vector zero(dealt.multipliers->map());
  const auto pair = scene.rows.pairs.front();
  for (const GlobalOrdinal row : {GlobalOrdinal(pair.normal), GlobalOrdinal(pair.tangential[0])}) {
    Eigen::VectorXd values = Eigen::VectorXd::Zero(scene.rows.numRows());
    values[row] = std::nan("");
    const auto wrong = scattered(dealt.multipliers->map(), values);
    TEST_ASSERT(std::isinf(measureContact(law, *wrong, zero, {1, 1}).kkt()));
    TEST_ASSERT(std::isinf(measureContact(law, zero, *wrong, {1, 1}).kkt()));
  }
}

TEUCHOS_UNIT_TEST(KktErrors, NamesTheWorst) {
  KktErrors e;
  e.slipLaw = 2;
  e.equilibrium = 1;
  TEST_EQUALITY(e.worst(), "slip_law");
  TEST_EQUALITY(e.kkt(), 2.0);
  e.equilibrium = 3;
  TEST_EQUALITY(e.worst(), "equilibrium");
}

TEUCHOS_UNIT_TEST(CoulombFixedPoint, SlipBoundsFollowTheNormalForce) {
  const Scene scene = makeScene(partlyClamped());
  const auto comm = Tpetra::getDefaultComm();
  const Dealt dealt = deal(comm, scene);
  const auto map = dealt.multipliers->map();
  const ContactLaw law = makeContactLaw(*dealt.multipliers, {{FrictionLaw::Coulomb, {0.3, 0.15}, 0}});
  const auto first = scattered(map, someVector(scene.rows.numRows(), 1.0)), second = scattered(map, someVector(scene.rows.numRows(), 2.0));
  CoulombFixedPoint fixedPoint(map, law, *dealt.multipliers, *first);
  double change = 0, size = 0;  // || g_new - g_old ||, || g_new || from the whole vectors
  const Dense a = gathered(*first), b = gathered(*second);
  for (const auto& pair : scene.rows.pairs) {
    if (scene.rows.pinned[pair.normal]) continue;
    const double before = std::max(0.0, a(pair.normal, 0)), now = std::max(0.0, b(pair.normal, 0));
    change += (now - before) * (now - before);
    size += now * now;
  }
  TEST_ASSERT(change > 0);
  TEST_FLOATING_EQUALITY(fixedPoint.update(*second), std::sqrt(change / size), 1e-12);
  TEST_EQUALITY(fixedPoint.update(*second), 0.0);
}
