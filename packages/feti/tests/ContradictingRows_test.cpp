// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContradictingRows.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>

#include "FetiScene.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

struct Obstacle {
  Point normal;
  double gap;
};

// At one node of the upper body's top, which nothing else touches, and at the two nodes of a pair between the bodies.
std::optional<Contradiction> found(const std::vector<Obstacle>& atTop, const std::vector<Obstacle>& atUpper = {}, const std::vector<Obstacle>& atLower = {},
                                   std::int64_t* node = nullptr) {
  Scene scene = makeScene({});
  const ContactPair& between = scene.interfaces.front().pairs.front();
  const std::int64_t top = std::int64_t(scene.mesh.numNodes()) - 1, upper = between.secondary.front().node, lower = between.primary.front().node;
  ContactInterface obstacles;
  obstacles.name = "obstacles";
  const auto add = [&](std::int64_t at, const std::vector<Obstacle>& list) {
    for (const Obstacle& o : list) obstacles.pairs.push_back({at, {{at, 1.0}}, {}, makeFrame(o.normal, {0.3, 0.5, 1.0}), o.gap, 0.5});
  };
  add(top, atTop);
  add(upper, atUpper);
  add(lower, atLower);
  scene.interfaces.push_back(obstacles);
  buildRows(scene);
  if (node) *node = top;
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), scene);
  Vector c(feti.map());
  const auto& values = feti.dealt.jump->multipliers().c();
  std::copy(values.begin(), values.end(), c.getDataNonConst(0).begin());
  return findContradiction(feti.dealt.jump->multipliers(), c, 1e-9);
}

}  // namespace

TEUCHOS_UNIT_TEST(ContradictingRows, ANodeBetweenTwoPlanes) {
  std::int64_t node = -1;
  const auto pinched = found({{{0, 0, 1}, -0.1}, {{0, 0, -1}, 0.04}}, {}, {}, &node);
  TEST_ASSERT(pinched.has_value());
  TEST_EQUALITY(pinched->node, node);
  TEST_FLOATING_EQUALITY(pinched->depth, 0.03, 1e-9);  // half of what is missing
  TEST_ASSERT(!found({{{0, 0, 1}, -0.1}, {{0, 0, -1}, 0.1}}).has_value());
  TEST_ASSERT(!found({{{0, 0, 1}, -0.1}, {{0, 0, -1}, 0.2}}).has_value());
}

TEUCHOS_UNIT_TEST(ContradictingRows, CornersAndPrisms) {
  const double s = std::sqrt(0.75);
  TEST_ASSERT(!found({{{1, 0, 0}, -0.1}, {{0, 1, 0}, -0.2}, {{0, 0, 1}, -0.3}}).has_value());  // overlaps that the node can leave
  TEST_ASSERT(!found({{{1, 0, 0}, -0.1}, {{1, 0, 0}, -0.2}, {{1, 1e-3, 0}, -0.3}}).has_value());
  const auto prism = found({{{1, 0, 0}, -0.1}, {{-0.5, s, 0}, -0.1}, {{-0.5, -s, 0}, 0.05}});
  TEST_ASSERT(prism.has_value());
  TEST_FLOATING_EQUALITY(prism->depth, 0.05, 1e-9);  // the sum of what is missing, by three
  TEST_ASSERT(!found({{{1, 0, 0}, -0.1}, {{-0.5, s, 0}, -0.1}, {{-0.5, -s, 0}, 0.25}}).has_value());
}

// What lies between is another body's node.
TEUCHOS_UNIT_TEST(ContradictingRows, NodesOfTwoBodiesBetweenPlanes) {
  const auto between = [](double low, double high) { return found({}, {{{0, 0, 1}, high}}, {{{0, 0, -1}, low}}); };
  TEST_ASSERT(!between(-0.1, 0.1).has_value());
  const auto pinched = between(-0.1, 0.04);
  TEST_ASSERT(pinched.has_value());
  TEST_FLOATING_EQUALITY(pinched->depth, 0.02, 1e-9);
}

TEUCHOS_UNIT_TEST(ContradictingRows, OneContactEachHasRoom) {
  TEST_ASSERT(!found({}).has_value());
  TEST_ASSERT(!found({{{0.2, 0.3, 1}, -5}}).has_value());
}
