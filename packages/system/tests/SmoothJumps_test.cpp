// SPDX-License-Identifier: BSD-3-Clause
// Slowly varying jumps of a contact surface: rigid motions are among them, and they do not depend on the ranks.
#include "Haptos_SmoothJumps.hpp"

#include <Eigen/Geometry>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>

#include "../../feti/tests/FetiScene.hpp"
#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_Reductions.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

constexpr std::array<int, 3> kElements{11, 9, 1};

Scene blocks(bool isFrictional) {
  SceneOptions o;
  o.lower = o.upper = kElements;
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

}  // namespace
