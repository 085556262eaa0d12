// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_JumpOperator.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <limits>

#include "DecomposedScene.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

SceneOptions clamped(int subdomains) {
  SceneOptions options;
  options.subdomains = subdomains;
  options.hold = [](int body, const Point& x) { return std::string(body == 0 && x[2] < -1 + 1e-9 ? "xyz" : ""); };
  return options;
}

RCP<const Communicator> self() { return Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF)); }

// Rows that more than one rank touches.
int sharedRows(const Dealt& dealt) {
  Vector ones(dealt.multipliers->remote().map()), counts(dealt.multipliers->map());
  ones.putScalar(1.0);
  counts.putScalar(1.0);
  dealt.multipliers->remote().addToOwners(ones, counts);
  const Dense all = gathered(counts);
  return int((all.array() > 1.5).count());
}

}  // namespace

TEUCHOS_UNIT_TEST(JumpOperator, EqualsDenseMatrixInBothModes) {
  const auto comm = Tpetra::getDefaultComm();
  for (int subdomains : {2, 3, 11}) {  // fewer subdomains than ranks too
    const Scene scene = makeScene(clamped(subdomains));
    const Dealt dealt = deal(comm, scene);
    const Dense B = denseB(scene), u = someColumns(B.cols(), 3), l = someColumns(B.rows(), 2);
    if (comm->getSize() > 1 && subdomains == 11) TEST_ASSERT(sharedRows(dealt) > 10);
    MultiVector s(dealt.jump->getRangeMap(), 3), f(dealt.jump->getDomainMap(), 2);
    dealt.jump->apply(*scatteredColumns(dealt.jump->getDomainMap(), u), s);
    dealt.jump->apply(*scatteredColumns(dealt.jump->getRangeMap(), l), f, Teuchos::TRANS);
    TEST_ASSERT(largest(gathered(s) - B * u) < 1e-14);
    TEST_ASSERT(largest(gathered(f) - B.transpose() * l) < 1e-14);
  }
}

TEUCHOS_UNIT_TEST(JumpOperator, TransposeIsTheAdjoint) {
  const Scene scene = makeScene(clamped(9));
  const Dealt dealt = deal(Tpetra::getDefaultComm(), scene);
  const auto u = scattered(dealt.jump->getDomainMap(), someVector(scene.offsets().back(), 3.0));
  const auto l = scattered(dealt.jump->getRangeMap(), someVector(scene.rows.numRows(), 4.0));
  Vector Bu(dealt.jump->getRangeMap()), BTl(dealt.jump->getDomainMap());
  dealt.jump->apply(*u, Bu);
  dealt.jump->apply(*l, BTl, Teuchos::TRANS);
  const double left = Bu.dot(*l), right = u->dot(BTl);
  TEST_ASSERT(std::abs(left) > 1e-3);
  TEST_FLOATING_EQUALITY(left, right, 1e-12);
}

TEUCHOS_UNIT_TEST(JumpOperator, AlphaAndBeta) {
  const Scene scene = makeScene(clamped(6));
  const Dealt dealt = deal(Tpetra::getDefaultComm(), scene);
  const Dense B = denseB(scene);
  const auto check = [&](Teuchos::ETransp mode, const Dense& A, const RCP<const Map>& from, const RCP<const Map>& to) {
    const Dense x = someColumns(A.cols(), 2), y0 = someColumns(A.rows(), 2) * 3.0;
    const auto xv = scatteredColumns(from, x);
    for (const auto& [alpha, beta] : {std::pair{1.0, 1.0}, {-2.5, 0.5}, {0.0, 2.0}, {3.0, -1.0}}) {
      const auto y = scatteredColumns(to, y0);
      dealt.jump->apply(*xv, *y, mode, alpha, beta);
      TEST_ASSERT(largest(gathered(*y) - (alpha * A * x + beta * y0)) < 1e-13);
    }
    MultiVector y(to, 2);  // beta = 0 overwrites whatever is there
    y.putScalar(std::numeric_limits<double>::quiet_NaN());
    dealt.jump->apply(*xv, y, mode, 2.0, 0.0);
    TEST_ASSERT(largest(gathered(y) - 2.0 * A * x) < 1e-13);
  };
  check(Teuchos::NO_TRANS, B, dealt.jump->getDomainMap(), dealt.jump->getRangeMap());
  check(Teuchos::TRANS, B.transpose(), dealt.jump->getRangeMap(), dealt.jump->getDomainMap());
}

TEUCHOS_UNIT_TEST(MultiplierMap, EveryRowIsOwnedOnceWithItsData) {
  const auto comm = Tpetra::getDefaultComm();
  const Scene scene = makeScene(clamped(8));
  const Dealt dealt = deal(comm, scene);
  const MultiplierMap& m = *dealt.multipliers;
  TEST_EQUALITY(GlobalOrdinal(m.map()->getGlobalNumElements()), scene.rows.numRows());
  TEST_EQUALITY(m.numEquality(), scene.rows.numEquality);
  TEST_EQUALITY(m.numPairs(), GlobalOrdinal(scene.rows.pairs.size()));
  const auto c = Teuchos::rcp(new Vector(m.map()));
  std::copy(m.c().begin(), m.c().end(), c->getDataNonConst(0).begin());
  const Dense all = gathered(*c);  // would add up, were a row owned twice
  for (GlobalOrdinal row = 0; row < scene.rows.numRows(); ++row) TEST_EQUALITY(all(row, 0), scene.rows.c[row]);
  for (int row = 0; row < int(m.kinds().size()); ++row) {
    const auto global = m.map()->getGlobalElement(row);
    TEST_ASSERT(m.kinds()[row] == scene.rows.kinds[global] && m.pinned()[row] == scene.rows.pinned[global]);
    TEST_EQUALITY(m.nodes()[row], scene.rows.node[global]);
  }
  long pairs = 0, mine = long(m.pairs().size());
  Teuchos::reduceAll(*comm, Teuchos::REDUCE_SUM, mine, Teuchos::outArg(pairs));
  TEST_EQUALITY(pairs, long(scene.rows.pairs.size()));
  for (const auto& pair : m.pairs()) TEST_ASSERT(pair.normal >= 0 && pair.tangential[0] >= 0 && pair.tangential[1] >= 0);
}

// The cut and B do not know how many ranks there are.
TEUCHOS_UNIT_TEST(MultiplierMap, SameRowsOnAnyNumberOfRanks) {
  const Scene scene = makeScene(clamped(7));
  const Dealt many = deal(Tpetra::getDefaultComm(), scene), one = deal(self(), scene);
  TEST_EQUALITY(one.multipliers->map()->getGlobalNumElements(), many.multipliers->map()->getGlobalNumElements());
  const Eigen::VectorXd u = someVector(scene.offsets().back());
  Vector s(many.jump->getRangeMap()), sOne(one.jump->getRangeMap());
  many.jump->apply(*scattered(many.jump->getDomainMap(), u), s);
  one.jump->apply(*scattered(one.jump->getDomainMap(), u), sOne);
  TEST_ASSERT(largest(gathered(s) - gathered(sOne)) < 1e-14);

  long first = 0, sum = 0;  // all ranks made the same cut by themselves
  for (std::size_t e = 0; e < scene.partition.ofElement.size(); ++e) sum += long(e * e % 1009) * scene.partition.ofElement[e];
  first = sum;
  Teuchos::broadcast(*Tpetra::getDefaultComm(), 0, Teuchos::outArg(first));
  TEST_EQUALITY(first, sum);
}

// Tied and contact interfaces, lists of any length, nodes in several pairs: the numbers and values of the serial reference.
TEUCHOS_UNIT_TEST(MultiplierMap, RowsOfListsAreThoseOfTheReference) {
  const auto comm = Tpetra::getDefaultComm();
  for (bool frictional : {true, false}) {
    const Scene scene = makeListScene(frictional);
    const Dealt dealt = deal(comm, scene);
    const MultiplierMap& m = *dealt.multipliers;
    TEST_EQUALITY(GlobalOrdinal(m.map()->getGlobalNumElements()), scene.rows.numRows());
    TEST_EQUALITY(m.numEquality(), scene.rows.numEquality);
    const Dense B = denseB(scene), u = someColumns(B.cols(), 1);
    Vector s(dealt.jump->getRangeMap());
    dealt.jump->apply(*scatteredColumns(dealt.jump->getDomainMap(), u), s);
    TEST_ASSERT(largest(gathered(s) - B * u) < 1e-14);
    std::array<int, 5> seen{};
    for (int row = 0; row < int(m.kinds().size()); ++row) {
      const auto global = std::size_t(m.map()->getGlobalElement(row));
      ++seen[std::size_t(m.kinds()[row])];
      TEST_ASSERT(m.kinds()[row] == scene.rows.kinds[global] && m.pinned()[row] == scene.rows.pinned[global]);
      TEST_ASSERT(std::abs(m.c()[row] - scene.rows.c[global]) < 1e-15);
      TEST_EQUALITY(m.nodes()[row], scene.rows.node[global]);
    }
    for (const auto& pair : m.pairs()) {
      const auto reference = *std::find_if(scene.rows.pairs.begin(), scene.rows.pairs.end(), [&](const PairRows& other) {
        return other.interface == pair.interface && other.pair == pair.pair;
      });
      TEST_EQUALITY(m.map()->getGlobalElement(pair.normal), reference.normal);
      for (int t = 0; t < 2; ++t)
        TEST_EQUALITY(pair.tangential[t] < 0 ? -1 : m.map()->getGlobalElement(pair.tangential[t]), reference.tangential[t]);
      TEST_EQUALITY(pair.geometry.primary.size(), reference.geometry.primary.size());
    }
    std::array<int, 5> all{};
    Teuchos::reduceAll(*comm, Teuchos::REDUCE_SUM, 5, seen.data(), all.data());
    TEST_ASSERT(all[int(RowKind::Tied)] > 3 && all[int(RowKind::Normal)] > 3);
    TEST_EQUALITY(all[int(RowKind::Tangential)], frictional ? 2 * all[int(RowKind::Normal)] : 0);
  }
}

// Gluing and Dirichlet rows of a node, and the rows of a pair, lie on one rank; node to node the pair's are where its nodes' are.
TEUCHOS_UNIT_TEST(MultiplierMap, RowsOfOneNodeOrPairHaveOneOwner) {
  const auto comm = Tpetra::getDefaultComm();
  SceneOptions options = clamped(9);
  const Scene scene = makeScene(options);
  const Dealt dealt = deal(comm, scene);
  const MultiplierMap& m = *dealt.multipliers;
  std::vector<int> owner(scene.mesh.numNodes(), 0), all(owner);  // 1 + the rank
  for (const auto& rows : m.nodeRows()) owner[std::size_t(rows.node)] = 1 + comm->getRank();
  Teuchos::reduceAll(*comm, Teuchos::REDUCE_SUM, int(owner.size()), owner.data(), all.data());
  for (std::size_t i = 0; i < m.kinds().size(); ++i)
    if (isEquality(m.kinds()[i])) TEST_EQUALITY(all[std::size_t(m.nodes()[i])], 1 + comm->getRank());
  for (int row = 0; row < int(m.kinds().size()); ++row)
    TEST_EQUALITY(dealt.rankOf[std::size_t(scene.rows.owner[std::size_t(m.map()->getGlobalElement(row))])], comm->getRank());
  for (const auto& pair : m.pairs())
    for (const auto* side : {&pair.geometry.secondary, &pair.geometry.primary})
      if (all[std::size_t(side->front().node)] > 0) TEST_EQUALITY(all[std::size_t(side->front().node)], 1 + comm->getRank());
}
