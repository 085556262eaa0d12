// SPDX-License-Identifier: BSD-3-Clause
// What a ContactSystem takes beside Coulomb's law on node pairs: Tresca, tied pairs, several primary nodes, wider kernels.
#include <Teuchos_UnitTestHarness.hpp>

#include "ContactScene.hpp"
#include "Haptos_FetiSystem.hpp"
#include "Haptos_RigidBodyModes.hpp"

using namespace Haptos;
using namespace Haptos::Testing;

namespace {

const FrictionSpec kTresca{FrictionLaw::Tresca, {0.3, 0.15}, 0.9, false};

std::unique_ptr<Filled> makeWith(const FrictionSpec& friction) {
  auto filled = std::make_unique<Filled>();
  filled->friction = friction;
  filled->addMatrices();
  filled->addRest();
  return filled;
}

// Forces at the nodes of the upper block that keep u: what contact and supports must add up to where there is no load.
Eigen::VectorXd forcesThatKeep(const Filled& filled, const Eigen::VectorXd& u) {
  Eigen::VectorXd forces = Eigen::VectorXd::Zero(u.size());
  for (const Piece& piece : filled.pieces) {
    if (piece.body == 0) continue;
    Eigen::VectorXd local(3 * Eigen::Index(piece.nodes.size()));
    for (std::size_t i = 0; i < piece.nodes.size(); ++i) local.segment<3>(3 * Eigen::Index(i)) = u.segment<3>(3 * Eigen::Index(piece.nodes[i]));
    const Eigen::VectorXd f = stiffnessOf(piece) * local;
    for (std::size_t i = 0; i < piece.nodes.size(); ++i) forces.segment<3>(3 * Eigen::Index(piece.nodes[i])) += f.segment<3>(3 * Eigen::Index(i));
  }
  return forces;
}

// Largest difference of this rank's contact forces to those that keep u; n = -z, t1 = x, t2 = n x t1 = -y.
double forceError(const Filled& filled, const Eigen::VectorXd& u) {
  const auto contact = filled.system.contactForces();
  const Eigen::VectorXd kept = forcesThatKeep(filled, u);
  double worst = 0;
  for (std::size_t i = 0; i < contact.size(); ++i) {
    const auto& [N, T1, T2] = contact[i];
    const Eigen::Vector3d onSecondary(-T1, T2, N);
    worst = std::max(worst, (onSecondary - kept.segment<3>(3 * Eigen::Index(filled.secondaries[i]))).norm());
  }
  return worst / kept.lpNorm<Eigen::Infinity>();
}

int sumOf(int mine) {
  int all = 0;
  Teuchos::reduceAll(*Tpetra::getDefaultComm(), Teuchos::REDUCE_SUM, mine, Teuchos::outArg(all));
  return all;
}

// A coarse block below a fine one: nodes of the upper one lie at nodes, on edges and inside faces of the lower one.
Mesh coarseBelowFine() {
  std::vector<BoxSpec> boxes(2);
  for (int b = 0; b < 2; ++b) {
    boxes[b].blockName = b == 0 ? "lower" : "upper";
    boxes[b].lower = {0, 0, double(b - 1)};
    boxes[b].upper = {2, 1, double(b)};
    boxes[b].divisions = {2 * (b + 1), b + 1, b + 1};
  }
  return makeBoxes(boxes);
}

// Bilinear weights of the lower block's nodes at a place in the interface; a cell of it is a square of length 1.
std::vector<std::pair<GlobalOrdinal, double>> weightsAt(const Mesh& mesh, const Point& x) {
  std::vector<std::pair<GlobalOrdinal, double>> weights;
  for (std::size_t node = 0; node < 18; ++node) {  // 3 x 2 x 3 at the most, lower block first
    const Point& p = mesh.coordinates[node];
    const double weight = std::max(0.0, 1 - std::abs(p[0] - x[0])) * std::max(0.0, 1 - std::abs(p[1] - x[1]));
    if (node < 12 && std::abs(p[2]) < 1e-9 && weight > 1e-9) weights.emplace_back(idOf(std::int64_t(node)), weight);
  }
  return weights;
}

}  // namespace

TEUCHOS_UNIT_TEST(ContactLaws, ForcesAreThoseThatKeepTheBodies) {
  const auto coulomb = makeSystem();
  const Eigen::VectorXd u = coulomb->solve();
  TEST_ASSERT(forceError(*coulomb, u) < 1e-7);
}

TEUCHOS_UNIT_TEST(ContactLaws, TrescaIsAsByParameters) {
  const auto filled = makeWith(kTresca);
  const Eigen::VectorXd u = filled->solve();
  TEST_ASSERT(filled->outcome.solved);
  TEST_ASSERT(difference(u, solveByParameters(filled->mesh, kTresca)) < 1e-8);
  TEST_ASSERT(forceError(*filled, u) < 1e-7);
  TEST_ASSERT(difference(u, makeSystem()->solve()) > 1e-3);
  const auto forces = filled->system.contactForces();
  int slipping = 0, sticking = 0;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const double g = kTresca.slipBound * areaAt(filled->mesh.coordinates[filled->secondaries[i]]);
    const double level = std::hypot(forces[i][1] / 0.3, forces[i][2] / 0.15) / g;
    TEST_ASSERT(level < 1 + 1e-6);
    ++(level > 1 - 1e-6 ? slipping : sticking);
  }
  out << sumOf(slipping) << " slip, " << sumOf(sticking) << " stick\n";
  TEST_ASSERT(sumOf(slipping) > 0 && sumOf(sticking) > 0);
}

// Against one body, whose pieces have the nodes of the interface in common.
TEUCHOS_UNIT_TEST(ContactLaws, TiedPairsAreAsOneBody) {
  const auto tied = makeWith({FrictionLaw::Frictionless, {0, 0}, 0, true});
  const Eigen::VectorXd u = tied->solve();
  TEST_ASSERT(tied->outcome.solved);
  TEST_ASSERT(forceError(*tied, u) < 1e-7);
  Filled one;
  const auto& x = one.mesh.coordinates;
  std::map<std::int64_t, std::int64_t> below;
  for (std::size_t a = 0; a < x.size() / 2; ++a)
    for (std::size_t b = x.size() / 2; b < x.size(); ++b)
      if (std::hypot(x[a][0] - x[b][0], x[a][1] - x[b][1], x[a][2] - x[b][2]) < 1e-9) below[std::int64_t(b)] = std::int64_t(a);
  TEST_EQUALITY(below.size(), 15u);
  for (std::size_t i = 0; i < one.pieces.size(); ++i) {
    one.pieces[i].body = 0;
    for (auto& node : one.pieces[i].nodes)
      if (below.count(node) > 0) node = below[node];
  }
  one.addMatrices();
  for (std::size_t node = 0; node < x.size(); ++node)
    if (x[node][0] < 1e-9 && below.count(std::int64_t(node)) == 0 && Tpetra::getDefaultComm()->getRank() == 0)
      for (int d = 0; d < 3; ++d) one.system.prescribe(idOf(std::int64_t(node)), d, 0.0);
  Eigen::VectorXd whole = one.solve();
  for (const auto& [b, a] : below) whole.segment<3>(3 * b) = whole.segment<3>(3 * a);
  TEST_ASSERT(difference(whole, u) < 1e-8);
  TEST_ASSERT(difference(whole, makeSystem()->solve()) > 1e-3);
}

// Uniform pressure p on a fine block on a coarse one: stresses are uniform and bodies strain apart; the fine side's forces, put on
// the coarse one by its shape functions, are those of uniform pressure there, as the coarse functions are sums of fine ones.
TEUCHOS_UNIT_TEST(ContactLaws, SeveralPrimaryNodesCarryUniformPressure) {
  constexpr double p = 0.4;
  Filled filled(coarseBelowFine());
  filled.addMatrices();
  filled.system.addInterface("interface", {FrictionLaw::Frictionless, {0, 0}, 0, false});
  const auto& x = filled.mesh.coordinates;
  const int rank = Tpetra::getDefaultComm()->getRank(), ranks = Tpetra::getDefaultComm()->getSize();
  std::map<std::size_t, int> counts;  // pairs by primary nodes
  for (std::size_t node = 0; node < x.size(); ++node) {
    if (int(node) % ranks != rank) continue;
    const auto id = idOf(std::int64_t(node));
    if (x[node][0] < 1e-9) filled.system.prescribe(id, 0, 0.0);
    if (x[node][1] < 1e-9) filled.system.prescribe(id, 1, 0.0);
    if (x[node][2] < -1 + 1e-9) filled.system.prescribe(id, 2, 0.0);
    if (node < 12 || std::abs(x[node][2]) > 1e-9) continue;
    const auto weights = weightsAt(filled.mesh, x[node]);
    ++counts[weights.size()];
    filled.system.addPair({0, id, weights, {0, 0, -1}, {1, 0, 0}});
    filled.secondaries.push_back(node);
  }
  TEST_ASSERT(sumOf(counts[1]) == 6 && sumOf(counts[2]) == 7 && sumOf(counts[4]) == 2);
  const Eigen::VectorXd u = filled.solve([](const Point& at) { return Point{0, 0, at[2] > 1 - 1e-9 ? -p * areaAt(at) : 0.0}; });
  Eigen::VectorXd expected(u.size());
  for (std::size_t node = 0; node < x.size(); ++node) {
    const auto& lower = kMaterials[0];
    const auto& m = kMaterials[node < 12 ? 0 : 1];
    const double sag = node < 12 ? (x[node][2] + 1) / lower.youngsModulus : 1 / lower.youngsModulus + x[node][2] / m.youngsModulus;
    const double swell = p * m.poissonsRatio / m.youngsModulus;
    expected.segment<3>(3 * Eigen::Index(node)) << swell * x[node][0], swell * x[node][1], -p * sag;
  }
  TEST_ASSERT(difference(expected, u) < 1e-8);
  const auto forces = filled.system.contactForces();
  for (std::size_t i = 0; i < forces.size(); ++i) TEST_FLOATING_EQUALITY(forces[i][0], p * areaAt(x[filled.secondaries[i]]), 1e-7);
}

// The lower block in its middle and both of its ends together: two pieces that hang together by nothing, twelve motions.
TEUCHOS_UNIT_TEST(ContactLaws, KernelsMayHaveMoreThanSixColumns) {
  Filled filled;
  const auto& x = filled.mesh.coordinates;
  const auto& block = filled.mesh.blocks[0];
  std::vector<std::size_t> ends, middle;
  for (std::size_t e = 0; e < block.numElements(); ++e) {
    double centre = 0;
    for (std::size_t i = 8 * e; i < 8 * e + 8; ++i) centre += x[std::size_t(block.connectivity[i])][0] / 8;
    (std::abs(centre - 1) > 0.5 ? ends : middle).push_back(e);
  }
  const Piece apart = pieceOf(filled.mesh, 0, ends);
  filled.pieces = {pieceOf(filled.mesh, 0, middle), filled.pieces[2], filled.pieces[3]};
  filled.addMatrices();
  std::vector<int> side;
  for (const auto& place : apart.coordinates) side.push_back(place[0] > 1);
  Eigen::MatrixXd kernel = rigidBodyModes(apart.coordinates, side);
  TEST_EQUALITY(kernel.cols(), 12);
  const auto ids = idsOf(apart.nodes);
  const auto places = flat(apart.coordinates);
  const auto add = [&](Filled& to) {
    to.matrices.push_back(crsOf(stiffnessOf(apart)));
    if (Tpetra::getDefaultComm()->getRank() == Tpetra::getDefaultComm()->getSize() - 1)
      to.system.addSubdomain({0, Teuchos::arrayViewFromVector(ids), Teuchos::arrayViewFromVector(places), to.matrices.back(),
                              Teuchos::ArrayView<const double>(kernel.data(), kernel.size())});
  };
  add(filled);
  filled.addRest();
  const Eigen::VectorXd u = filled.solve();
  TEST_ASSERT(filled.outcome.solved);
  TEST_EQUALITY(filled.system.solver().system().kernelDimension(), 12 + 3 * 6);
  TEST_ASSERT(difference(makeSystem()->solve(), u) < 1e-8);

  Filled other;  // stretched, one side is not without energy
  for (Eigen::Index i = 0; i < kernel.rows(); i += 3) kernel(i, 11) = places[std::size_t(i)];
  add(other);
  TEST_ASSERT(contains(refusal([&] { other.system.setUp(); }), "kernel that it does not have"));
}
