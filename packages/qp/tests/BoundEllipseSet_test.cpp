// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_BoundEllipseSet.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>
#include <limits>

#include "Haptos_Error.hpp"
#include "QpTestProblem.hpp"

namespace {

using namespace HaptosTest;
const double inf = std::numeric_limits<double>::infinity();

RCP<const Map> makeLocalMap(int entriesPerRank) {
  const auto comm = Tpetra::getDefaultComm();
  return rcp(new Map(Tpetra::global_size_t(entriesPerRank) * comm->getSize(), std::size_t(entriesPerRank), 0, comm));
}

void setLocal(MultiVector& x, const std::vector<double>& values) {
  auto view = x.getDataNonConst(0);
  for (std::size_t i = 0; i < values.size(); ++i) view[i] = values[i];
}

TEUCHOS_UNIT_TEST(BoundEllipseSet, ProjectsAndRemembersWhatItMoved) {
  const auto map = makeLocalMap(10);
  BoundEllipseSet set(map, {{0, -1.0}, {1, -inf}},
                      {{{2, 3}, {2.0, 1.0}}, {{4, 5}, {0.0, 1.0}}, {{6, 7}, {1.0, 1.0}, {5.0, 0.0}}}, {8});
  MultiVector x(map, 1);
  setLocal(x, {-3.0, -1e30, 4.0, 3.0, 7.0, 0.5, 8.0, 0.0, 9.0, -7.0});
  set.project(x);
  const auto v = x.getData(0);
  TEST_EQUALITY(v[0], -1.0);
  TEST_EQUALITY(v[1], -1e30);
  TEST_FLOATING_EQUALITY(std::hypot(v[2] / 2, v[3]), 1.0, 1e-14);
  TEST_EQUALITY(v[4], 0.0);
  TEST_EQUALITY(v[5], 0.5);
  TEST_EQUALITY(v[6], 6.0);
  TEST_EQUALITY(v[8], 0.0);
  TEST_EQUALITY(v[9], -7.0);
  TEST_ASSERT(set.isBoundActive(0) && !set.isBoundActive(1));
  TEST_ASSERT(set.isEllipseActive(0) && !set.isEllipseActive(1) && set.isEllipseActive(2));

  // projecting again changes no bit and keeps what is active
  const DenseVector before = gather(x);
  set.project(x);
  TEST_EQUALITY((gather(x) - before).norm(), 0.0);
  TEST_ASSERT(set.isBoundActive(0) && set.isEllipseActive(0) && set.isEllipseActive(2));

  // a point put on the same boundary by other means is free
  BoundEllipseSet fresh(map, {}, {{{2, 3}, {2.0, 1.0}}});
  setLocal(x, {0, 0, 2.0, 0.0});
  fresh.project(x);
  TEST_ASSERT(!fresh.isEllipseActive(0));

  // larger ellipses free the pair, unless x moves along with them
  set.setSemiAxes({{4.0, 2.0}, {0.0, 1.0}, {2.0, 2.0}});
  MultiVector y(map, 1);
  scatter(before, y);
  set.project(y);
  TEST_ASSERT(!set.isEllipseActive(0));
}

TEUCHOS_UNIT_TEST(BoundEllipseSet, SlidingPairFollowsItsEllipse) {
  const auto map = makeLocalMap(4);
  BoundEllipseSet set(map, {}, {{{0, 1}, {2.0, 1e-6}}, {{2, 3}, {1.0, 1.0}}});
  MultiVector x(map, 1);
  setLocal(x, {3.0, 1.0, 0.1, 0.2});
  set.project(x);
  const double old = x.getData(0)[1];
  set.setSemiAxes({{3.0, 1.5e-6}, {0.5, 0.5}}, &x);
  set.project(x);
  TEST_ASSERT(set.isEllipseActive(0) && !set.isEllipseActive(1));
  TEST_FLOATING_EQUALITY(x.getData(0)[1], 1.5 * old, 1e-12);
  TEST_EQUALITY(x.getData(0)[2], 0.1);  // a sticking pair stays where it is
  set.setSemiAxes({{0.0, 0.0}, {0.0, 0.0}}, &x);
  set.project(x);
  TEST_EQUALITY(gather(x).norm(), 0.0);
}

TEUCHOS_UNIT_TEST(BoundEllipseSet, LargestStepEndsOnTheBoundary) {
  const auto map = makeLocalMap(4);
  const int rank = map->getComm()->getRank();
  for (const double ratio : {1.0, 1e-6, 1e-9}) {
    BoundEllipseSet set(map, {{0, -1.0}}, {{{1, 2}, {1.0, ratio}}});
    MultiVector x(map, 1), p(map, 1);
    setLocal(x, {0.0, 0.3, -0.5 * ratio, 0.0});
    set.project(x);
    setLocal(p, {0.0, 0.01, rank == 0 ? ratio : 0.1 * ratio, 1.0});  // the first rank's pair is hit first
    const double t = set.maxFeasibleStep(x, p);
    const double u = 0.3 - 0.01 * t, w = -0.5 - t;
    TEST_FLOATING_EQUALITY(u * u + w * w, 1.0, 1e-13);
    setLocal(p, {rank == 0 ? 100.0 : 0.0, 0.0, 0.0, 1.0});
    TEST_FLOATING_EQUALITY(set.maxFeasibleStep(x, p), 0.01, 1e-15);
    p.putScalar(0.0);
    TEST_EQUALITY(set.maxFeasibleStep(x, p), inf);
  }
}

TEUCHOS_UNIT_TEST(BoundEllipseSet, SplitsTheGradientIntoFreeAndBoundaryParts) {
  const auto map = makeLocalMap(8);
  BoundEllipseSet set(map, {{0, 0.0}, {1, 0.0}}, {{{2, 3}, {1.0, 0.5}}, {{4, 5}, {1.0, 0.0}}}, {6});
  MultiVector x(map, 1), g(map, 1), phi(map, 1), phiR(map, 1), beta(map, 1);
  setLocal(x, {-1.0, 1.0, 2.0, 0.0, 0.25, 3.0, 1.0, 1.0});
  set.project(x);
  setLocal(g, {-2.0, 5.0, -1.0, 0.4, 3.0, 3.0, 3.0, 3.0});
  const double alpha = 0.5;
  set.splitGradient(x, g, alpha, phi, phiR, beta);
  const auto f = phi.getData(0), r = phiR.getData(0), b = beta.getData(0);
  TEST_ASSERT(b[0] == -2.0 && f[0] == 0.0);               // wants to leave its bound
  TEST_ASSERT(f[1] == 5.0 && r[1] == 2.0 && b[1] == 0.0);  // would hit the bound after 1 / alpha
  TEST_ASSERT(f[2] == 0.0 && f[3] == 0.0 && b[3] != 0.0);
  TEST_ASSERT(f[4] == 3.0 && f[5] == 0.0 && r[5] == 0.0);  // the entry with semi-axis 0 is fixed
  TEST_FLOATING_EQUALITY(r[4], 2.5, 1e-15);                // ends at -1
  TEST_ASSERT(f[6] == 0.0 && r[6] == 0.0 && f[7] == 3.0 && r[7] == 3.0);
  // reduced gradient = (x - P(x - alpha g)) / alpha
  bool moved = false;
  const auto p = projectOntoEllipse({1.0 + 0.5, -0.2}, {1.0, 0.5}, moved);
  TEST_FLOATING_EQUALITY(b[2], (1.0 - p[0]) / alpha, 1e-14);
  TEST_FLOATING_EQUALITY(b[3], -p[1] / alpha, 1e-14);
}

TEUCHOS_UNIT_TEST(BoundEllipseSet, RefusesWrongInputOnAllRanks) {
  const auto map = makeLocalMap(4);
  const double axis = map->getComm()->getRank() == 0 ? -1.0 : 1.0;  // wrong on one rank only
  TEST_THROW(BoundEllipseSet(map, {}, {{{0, 1}, {axis, 1.0}}}), InputError);
  TEST_THROW(BoundEllipseSet(map, {}, {{{0, 1}, {inf, 1.0}}}), InputError);
  TEST_THROW(BoundEllipseSet(map, {{0, inf}}, {}), InputError);
  TEST_THROW(BoundEllipseSet(map, {{4, 0.0}}, {}), InputError);
  TEST_THROW(BoundEllipseSet(map, {{1, 0.0}}, {{{0, 1}, {1.0, 1.0}}}), InputError);
  BoundEllipseSet set(map, {}, {{{0, 1}, {1.0, 1.0}}});
  TEST_THROW(set.setSemiAxes({{axis, 1.0}}), InputError);
  TEST_THROW(set.setSemiAxes({}), InputError);
}

}  // namespace
