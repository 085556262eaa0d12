// SPDX-License-Identifier: BSD-3-Clause
// Slowly varying jumps of a contact surface, and groups of its pairs: rigid motions are among the jumps, and neither depends on the ranks.
#include "Haptos_SmoothJumps.hpp"

#include <Eigen/Geometry>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <set>

#include "../../feti/tests/FetiScene.hpp"
#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_PairGroups.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

constexpr std::array<int, 3> kElements{11, 9, 1};

Scene blocks(bool isFrictional, const std::array<int, 3>& elements = kElements) {
  SceneOptions o;
  o.lower = o.upper = elements;
  o.subdomains = 6;
  o.frictional = isFrictional;
  o.hold = [](int body, const Point& x) { return std::string(body == 0 && x[2] < -1 + 1e-9 ? "xyz" : ""); };
  return makeScene(o);
}

std::vector<Eigen::Vector3d> placesIn(const Scene& scene, const MultiplierMap& multipliers) {
  std::map<std::int64_t, Point> of;
  for (const auto& sub : scene.subdomains)
    for (int i = 0; i < sub.numNodes(); ++i) of[sub.nodes[std::size_t(i)]] = sub.coordinates[std::size_t(i)];
  std::vector<Eigen::Vector3d> places;
  for (const LocalPair& pair : multipliers.pairs()) places.emplace_back(of.at(pair.geometry.secondaryNode).data());
  return places;
}

// A rigid motion's jumps, by (N, T1, T2)
Eigen::VectorXd rigidJump(const MultiplierMap& multipliers, const std::vector<Eigen::Vector3d>& places, int motion) {
  Eigen::VectorXd jump = Eigen::VectorXd::Zero(3 * Eigen::Index(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector3d u = motion < 3 ? Eigen::Vector3d(Eigen::Vector3d::Unit(motion)) : Eigen::Vector3d(Eigen::Vector3d::Unit(motion - 3).cross(places[i]));
    const LocalPair& pair = multipliers.pairs()[i];
    const LocalFrame& f = pair.geometry.frame;
    const std::array<const std::array<double, 3>*, 3> axes{&f.normal, &f.t1, &f.t2};
    for (std::size_t a = 0; a < 3; ++a)
      if (a == 0 || pair.tangential[0] >= 0) jump[3 * Eigen::Index(i) + Eigen::Index(a)] = u.dot(Eigen::Vector3d(axes[a]->data()));
  }
  return jump;
}

TEUCHOS_UNIT_TEST(SmoothJumps, HaveRigidMotionsAndKnowNoRanks) {
  for (const bool isFrictional : {false, true}) {
    const Scene scene = blocks(isFrictional);
    const Feti feti = makeFeti(Tpetra::getDefaultComm(), scene);
    const MultiplierMap& multipliers = *feti.dealt.multipliers;
    const auto places = placesIn(scene, multipliers);
    const Eigen::MatrixXd V = smoothJumps(multipliers, places);
    constexpr int kPairs = (kElements[0] + 1) * (kElements[1] + 1);
    TEST_EQUALITY(V.cols(), 6 * (kPairs / 32));
    const Eigen::MatrixXd gram = sumOfAll(*feti.comm, Eigen::MatrixXd(V.transpose() * V));
    for (int motion = 0; motion < 6; ++motion) {
      const Eigen::VectorXd rigid = rigidJump(multipliers, places, motion), right = sumOfAll(*feti.comm, Eigen::VectorXd(V.transpose() * rigid));
      const double left = sumOfAll(*feti.comm, (rigid - V * solveLeastSquares(gram, right, 1e-10)).squaredNorm());
      TEST_COMPARE(std::sqrt(left), <, 1e-7 * std::max(1.0, std::sqrt(sumOfAll(*feti.comm, rigid.squaredNorm()))));
    }
    // The sum over all pairs of each column's square is the same whoever has them.
    const Scene again = blocks(isFrictional);
    const Feti alone = makeFeti(Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF)), again);
    const Eigen::MatrixXd whole = smoothJumps(*alone.dealt.multipliers, placesIn(again, *alone.dealt.multipliers));
    TEST_COMPARE((gram - whole.transpose() * whole).norm(), <, 1e-12 * gram.norm());
  }
}

// By the nodes of their pairs.
std::vector<std::set<std::pair<std::int64_t, bool>>> nodesOf(const std::vector<PairGroup>& groups, const MultiplierMap& multipliers) {
  struct Member {
    std::int64_t node;
    int group;
    bool isOwn;
  };
  std::vector<Member> members;
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (std::size_t k = 0; k < groups[g].pairs.size(); ++k)
      members.push_back({multipliers.pairs()[std::size_t(groups[g].pairs[k])].geometry.secondaryNode, int(g), groups[g].isOwn[k] != 0});
  std::vector<std::set<std::pair<std::int64_t, bool>>> result(groups.size());
  for (const Member& member : gatheredOnAll(*multipliers.map()->getComm(), members)) result[std::size_t(member.group)].insert({member.node, member.isOwn});
  return result;
}

TEUCHOS_UNIT_TEST(PairGroups, CoverAllPairsOnceAndOverlapAndKnowNoRanks) {
  const Scene scene = blocks(true), again = blocks(true);
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), scene), alone = makeFeti(Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF)), again);
  const MultiplierMap &multipliers = *feti.dealt.multipliers, &whole = *alone.dealt.multipliers;
  const auto groups = nodesOf(groupsOfPairs(multipliers, placesIn(scene, multipliers)), multipliers);
  TEST_ASSERT(groups == nodesOf(groupsOfPairs(whole, placesIn(again, whole)), whole));
  constexpr int kPairs = (kElements[0] + 1) * (kElements[1] + 1);
  TEST_EQUALITY(int(groups.size()), kPairs / 12);
  std::set<std::int64_t> own;
  int numOwn = 0, numOthers = 0;
  for (const auto& group : groups)
    for (const auto& [node, isOwn] : group) {
      if (isOwn) own.insert(node);
      (isOwn ? numOwn : numOthers) += 1;
    }
  TEST_EQUALITY(numOwn, kPairs);
  TEST_EQUALITY(int(own.size()), kPairs);
  out << "members of groups that are not their own: " << numOthers << "\n";
  TEST_ASSERT(numOthers > kPairs / 2 && numOthers < 3 * kPairs);
}

// More interfaces than there would be groups: each has one of its own, as pairs of one that had no centre would not be near any.
TEUCHOS_UNIT_TEST(PairGroups, OfManySmallInterfacesAreTheInterfaces) {
  Scene scene = blocks(true);
  constexpr std::size_t kPairsOfEach = 6;
  const std::vector<ContactPair> pairs = scene.interfaces.front().pairs;
  scene.interfaces.assign(pairs.size() / kPairsOfEach, {});
  std::vector<std::set<std::pair<std::int64_t, bool>>> expected(scene.interfaces.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    scene.interfaces[i / kPairsOfEach].pairs.push_back(pairs[i]);
    expected[i / kPairsOfEach].insert({pairs[i].secondaryNode, true});
  }
  buildRows(scene);
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), scene);
  const MultiplierMap& multipliers = *feti.dealt.multipliers;
  TEST_COMPARE(expected.size(), >, std::size_t(multipliers.numPairs() / 12));
  TEST_ASSERT(nodesOf(groupsOfPairs(multipliers, placesIn(scene, multipliers)), multipliers) == expected);
}

// On a grid many pairs are in the middle between two centres, many nodes on the edge of a cell of those that centres are chosen from, and many
// cells as far from the centres before: round-off of other units, or of another origin, would decide.
TEUCHOS_UNIT_TEST(PairGroups, KnowNoUnits) {
  for (const std::array<int, 3>& elements : {kElements, {16, 8, 1}, {18, 12, 1}, {32, 4, 1}}) {
    const Scene scene = blocks(true, elements);
    const Feti feti = makeFeti(Tpetra::getDefaultComm(), scene);
    const MultiplierMap& multipliers = *feti.dealt.multipliers;
    const auto places = placesIn(scene, multipliers);
    const auto groups = nodesOf(groupsOfPairs(multipliers, places), multipliers);
    for (const double unit : {0.3, 7.0, 1000.0}) {
      std::vector<Eigen::Vector3d> moved;
      for (const Eigen::Vector3d& x : places) moved.emplace_back(unit * (x + Eigen::Vector3d(0.1, 0.2, 0.3)));
      TEST_ASSERT(groups == nodesOf(groupsOfPairs(multipliers, moved), multipliers));
    }
  }
}

}  // namespace
