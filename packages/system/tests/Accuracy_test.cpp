// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Accuracy.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <set>

#include "../../feti/tests/FetiScene.hpp"
#include "Haptos_ContactResults.hpp"
#include "Haptos_PairLaws.hpp"
#include "Haptos_WrittenField.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

// Two blocks pressed on each other between a clamp and a moved top; friction strong enough that all pairs stick, so
// that the solution is that of a linear saddle point problem, which is solved densely.
class PressedBlocks {
 public:
  PressedBlocks() : scene(makeScene(options())), feti(makeFeti(Tpetra::getDefaultComm(), scene)) {
    law = std::make_unique<ContactLaw>(makeContactLaw(*feti.dealt.multipliers, {{FrictionLaw::Coulomb, {40, 30}, 0}}));
    gather = std::make_unique<NodalGather>(feti.comm, nodesOf(feti.dealt.mine), std::int64_t(scene.mesh.numNodes()));
    for (const auto& p : scene.prescribed)
      if (gather->nodes().owner(p.node) == feti.comm->getRank()) prescribed.push_back(p);
    const Dense B = denseB(scene);
    const auto K = denseStiffness(scene);
    const auto offsets = scene.offsets();
    const Eigen::Index n = B.cols(), m = B.rows();
    load = 1e-3 * someVector(n, 2.0);
    Dense A = Dense::Zero(n + m, n + m);
    for (std::size_t s = 0; s < K.size(); ++s) A.block(offsets[s], offsets[s], K[s].rows(), K[s].rows()) = K[s];
    A.bottomLeftCorner(m, n) = B;
    A.topRightCorner(n, m) = B.transpose();
    Eigen::VectorXd b(n + m);
    b.head(n) = load;
    b.tail(m) = Eigen::Map<const Eigen::VectorXd>(scene.rows.c.data(), m);
    const Eigen::VectorXd x = luSolve(A, b);
    u = x.head(n);
    lambda = x.tail(m);
    step = {onRanks(load), scattered(feti.map(), Eigen::Map<const Eigen::VectorXd>(scene.rows.c.data(), m)), prescribed};
    for (const auto& sub : feti.dealt.mine) bodies.push_back(sub.body);
  }

  AccuracyInput input() const {
    return {*feti.systems, bodies, 2, *feti.dealt.jump, *law, step, *gather, measureLoads(*gather, *step.f, *feti.comm)};
  }

  Accuracy measure(const Eigen::VectorXd& withU, const Eigen::VectorXd& withLambda) const {
    const auto u = onRanks(withU), lambda = scattered(feti.map(), withLambda);
    return measureAccuracy(input(), *u, *lambda, *residualOf(input(), *u, *lambda));
  }

  RCP<Vector> onRanks(const Eigen::VectorXd& x) const { return scattered(feti.dealt.jump->getDomainMap(), x); }

  // One value a copy -> sums over the copies of a node, by mesh node and component.
  Eigen::VectorXd nodalSums(const Eigen::VectorXd& x) const {
    const auto offsets = scene.offsets();
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(3 * Eigen::Index(scene.mesh.numNodes()));
    for (const auto& sub : scene.subdomains)
      for (int i = 0; i < sub.numNodes(); ++i) sums.segment<3>(3 * sub.nodes[i]) += x.segment<3>(offsets[sub.id] + 3 * i);
    return sums;
  }

  // The means over the copies, for every copy.
  Eigen::VectorXd means(const Eigen::VectorXd& x) const {
    const Eigen::VectorXd mean = nodalSums(x).cwiseQuotient(nodalSums(Eigen::VectorXd::Ones(x.size())));
    const auto offsets = scene.offsets();
    Eigen::VectorXd result(x.size());
    for (const auto& sub : scene.subdomains)
      for (int i = 0; i < sub.numNodes(); ++i) result.segment<3>(offsets[sub.id] + 3 * i) = mean.segment<3>(3 * sub.nodes[i]);
    return result;
  }

  // || K (u - v) || of nodal sums, but where displacements are prescribed: where u is in equilibrium with gluing forces and others, v lacks it.
  double imbalanceOf(const Eigen::VectorXd& v, const Eigen::VectorXd& ofU) const {
    Eigen::VectorXd r(v.size());
    const auto K = denseStiffness(scene);
    const auto offsets = scene.offsets();
    for (std::size_t s = 0; s < K.size(); ++s) r.segment(offsets[s], K[s].rows()) = K[s] * (ofU - v).segment(offsets[s], K[s].rows());
    Eigen::VectorXd nodal = nodalSums(r);
    for (const auto& p : scene.prescribed) nodal[3 * p.node + p.component] = 0;
    return nodal.norm();
  }

  // The copies of all nodes moved apart by at most 1e-3, each its own way.
  Eigen::VectorXd torn() const { return u + 1e-3 * someVector(u.size(), 5.0); }

  static SceneOptions options() {
    SceneOptions o = heldScene(5);
    o.hold = [](int body, const Point& x) { return std::string((body == 0 ? x[2] < -1 + 1e-9 : x[2] > 1 - 1e-9) ? "xyz" : ""); };
    o.value = [](const Point& x) { return x[2] > 0 ? Point{0.001, 0, -0.02} : Point{0, 0, 0}; };
    return o;
  }

  Scene scene;
  Feti feti;
  std::unique_ptr<ContactLaw> law;
  std::unique_ptr<NodalGather> gather;
  std::vector<PrescribedDisplacement> prescribed;  // of this rank's range
  StepData step;
  std::vector<int> bodies;
  Eigen::VectorXd load, u, lambda;
};

}  // namespace

TEUCHOS_UNIT_TEST(Accuracy, ZeroForTheExactSolution) {
  const PressedBlocks blocks;
  for (const auto& pair : blocks.scene.rows.pairs) TEST_ASSERT(blocks.lambda[pair.normal] > 1e-3);
  const Accuracy a = blocks.measure(blocks.u, blocks.lambda);
  out << "kkt " << a.errors.kkt() << " (" << a.errors.worst() << "), floor " << a.floor << "\n";
  TEST_ASSERT(a.errors.kkt() < 1e-11);
  TEST_ASSERT(a.scales.uRef > 0.02 && a.ext > 0 && a.scales.load > 0);
  TEST_ASSERT(a.floor > 0 && a.floor < 1e-13);
}

// Each error by itself, from the perturbation that makes it.
TEUCHOS_UNIT_TEST(Accuracy, LargeForPerturbedSolutions) {
  const PressedBlocks blocks;
  const auto& pair = blocks.scene.rows.pairs[3];
  const Dense B = denseB(blocks.scene);
  const double lRef = blocks.measure(blocks.u, blocks.lambda).scales.load;
  TEST_ASSERT(lRef > 0);

  Eigen::VectorXd lambda = blocks.lambda;
  lambda[pair.normal] = -lambda[pair.normal];
  const Accuracy pulled = blocks.measure(blocks.u, lambda);
  TEST_ASSERT(pulled.errors.compression > 0.1);
  TEST_ASSERT(pulled.errors.equilibrium > 0.01);

  lambda = blocks.lambda;
  lambda[pair.tangential[0]] = 100 * lambda[pair.normal];
  TEST_ASSERT(blocks.measure(blocks.u, lambda).errors.cone > 0.1);

  Eigen::VectorXd u = blocks.u;  // all copies of the secondary node move by 1 % of u_ref
  const auto offsets = blocks.scene.offsets();
  const auto move = [&](int component, double by, bool onlyFirst) {
    u = blocks.u;
    bool first = true;
    for (const auto& sub : blocks.scene.subdomains)
      for (int i = 0; i < sub.numNodes(); ++i)
        if (sub.nodes[i] == pair.geometry.secondaryNode && (first || !onlyFirst)) u[offsets[sub.id] + 3 * i + component] += by, first = false;
  };
  move(2, -2e-4, false);
  const Accuracy sunk = blocks.measure(u, blocks.lambda);
  TEST_ASSERT(sunk.errors.penetration > 5e-3 && sunk.errors.continuity < 1e-12);
  move(2, +2e-4, false);
  TEST_ASSERT(blocks.measure(u, blocks.lambda).errors.complementarity > 5e-3);
  move(0, 2e-4, false);
  TEST_ASSERT(blocks.measure(u, blocks.lambda).errors.slipLaw > 1e-3);

  u = blocks.u;  // one copy of a node that several subdomains share
  std::map<std::int64_t, int> copies;
  for (const auto& sub : blocks.scene.subdomains)
    for (auto node : sub.nodes) ++copies[node];
  const auto shared = std::find_if(copies.begin(), copies.end(), [](auto& c) { return c.second > 1; })->first;
  for (const auto& sub : blocks.scene.subdomains) {
    const auto it = std::lower_bound(sub.nodes.begin(), sub.nodes.end(), shared);
    if (it == sub.nodes.end() || *it != shared) continue;
    u[offsets[sub.id] + 3 * (it - sub.nodes.begin())] += 2e-4;
    break;
  }
  TEST_ASSERT(blocks.measure(u, blocks.lambda).errors.continuity > 5e-3);
  const Accuracy moved = blocks.measure(1.01 * blocks.u, blocks.lambda);  // away from the prescribed values
  TEST_ASSERT(moved.errors.continuity > 5e-3);
}

TEUCHOS_UNIT_TEST(WrittenField, IsTheMeanAndItsImbalanceThatOfNodes) {
  const PressedBlocks blocks;
  const auto input = blocks.input();
  const auto lambda = scattered(blocks.feti.map(), blocks.lambda);
  const auto exact = blocks.onRanks(blocks.u);
  const WrittenField none(input, *exact, *residualOf(input, *exact, *lambda));
  const double scale = blocks.measure(blocks.u, blocks.lambda).ext;
  TEST_ASSERT(none.imbalance() < 1e-11 * scale);

  const auto u = blocks.onRanks(blocks.torn());
  const WrittenField field(input, *u, Vector(u->getMap()));
  const Eigen::VectorXd v = blocks.means(blocks.torn());
  TEST_ASSERT((gathered(*field.v()).col(0) - v).norm() < 1e-13 * v.norm());
  TEST_ASSERT(field.imbalance() > 1e-3 * scale);
  TEST_FLOATING_EQUALITY(field.imbalance(), blocks.imbalanceOf(v, blocks.torn()), 1e-10);

  // K u_exact = f - B^T lambda: with the residual of the torn u comes what it lacks itself.
  const WrittenField unbalanced(input, *u, *residualOf(input, *u, *lambda));
  TEST_FLOATING_EQUALITY(unbalanced.imbalance(), blocks.imbalanceOf(v, blocks.u), 1e-10);
}

// What is prescribed stays, copies stay together, and what is said of the imbalance is what the field has.
TEUCHOS_UNIT_TEST(WrittenField, SmoothsWhatVariesFromElementToElement) {
  const PressedBlocks blocks;
  const auto input = blocks.input();
  const auto u = blocks.onRanks(blocks.torn());
  const Vector balanced(u->getMap());
  WrittenField field(input, *u, balanced);
  const double before = field.imbalance();
  field.smooth(0.05 * before);
  const Eigen::VectorXd v = gathered(*field.v()).col(0), mean = blocks.means(blocks.torn());
  out << "imbalance " << before << " -> " << field.imbalance() << "\n";
  TEST_ASSERT(field.imbalance() <= 0.05 * before && field.imbalance() > 0);
  TEST_FLOATING_EQUALITY(field.imbalance(), blocks.imbalanceOf(v, blocks.torn()), 1e-9);
  TEST_ASSERT((v - blocks.means(v)).norm() < 1e-13 * v.norm());
  const Eigen::VectorXd moved = blocks.nodalSums(v - mean);
  for (const auto& p : blocks.scene.prescribed) TEST_ASSERT(std::abs(moved[3 * p.node + p.component]) < 1e-15);
  TEST_ASSERT(moved.cwiseAbs().maxCoeff() > 1e-5);
}

// What the usual effort leaves to the method is smoothed where the method has no more to give.
TEUCHOS_UNIT_TEST(WrittenField, LastEffortGoesFurther) {
  const PressedBlocks blocks;
  const auto input = blocks.input();
  const auto u = blocks.onRanks(blocks.torn());
  const Vector balanced(u->getMap());
  const auto left = [&](SmoothingEffort effort) {
    WrittenField field(input, *u, balanced);
    const double before = field.imbalance();
    field.smooth(1e-300 * before, effort);  // as good as hopeless within the usual steps
    return field.imbalance() / before;
  };
  const double usual = left(SmoothingEffort::Usual), last = left(SmoothingEffort::Last);
  out << "left " << usual << ", " << last << "\n";
  TEST_ASSERT(last < 1e-10 && last < 0.1 * usual);
}

// After some steps K is assembled: what is left is what elements say of v.
TEUCHOS_UNIT_TEST(WrittenField, ManyStepsKnowWhatIsLeft) {
  const PressedBlocks blocks;
  const auto input = blocks.input();
  const auto u = blocks.onRanks(blocks.torn());
  WrittenField field(input, *u, Vector(u->getMap()));
  const double before = field.imbalance();
  field.smooth(1e-3 * before);
  TEST_COMPARE(field.imbalance(), <=, 1e-3 * before);
  Vector change(*field.v(), Teuchos::Copy), residual(u->getMap());
  change.update(-1.0, *u, 1.0);
  subtractForces(input, change, residual);
  TEST_FLOATING_EQUALITY(WrittenField(input, *field.v(), residual).imbalance(), field.imbalance(), 1e-6);
}

// A recursion goes on where the digits of v end; what is said of v is not the recursion's.
TEUCHOS_UNIT_TEST(WrittenField, SaysWhatDigitsLeave) {
  const PressedBlocks blocks;
  const auto input = blocks.input();
  const auto u = blocks.onRanks(blocks.torn());
  Vector far(*u, Teuchos::Copy), residual(u->getMap());  // bodies that went far have fewer digits
  {
    const auto data = far.getDataNonConst(0);
    for (auto& value : data) value += 1e4;
  }
  WrittenField field(input, far, residual);
  field.smooth(1e-300, SmoothingEffort::Last);
  Vector change(*field.v(), Teuchos::Copy);
  change.update(-1.0, far, 1.0);
  subtractForces(input, change, residual);
  const double left = WrittenField(input, *field.v(), residual).imbalance(), scale = blocks.measure(blocks.u, blocks.lambda).ext;
  out << "said " << field.imbalance() / scale << ", left " << left / scale << "\n";
  TEST_FLOATING_EQUALITY(field.imbalance(), left, 0.2);  // the means of v are rounded once more
  TEST_ASSERT(left < 1e-6 * scale);
}

TEUCHOS_UNIT_TEST(Accuracy, ReactionsAreThoseOfTheClamp) {
  const PressedBlocks blocks;
  const auto offsets = blocks.scene.offsets();
  Eigen::VectorXd r = -blocks.load;  // K u - f, summed over the copies, at the clamped nodes
  const auto K = denseStiffness(blocks.scene);
  for (std::size_t s = 0; s < K.size(); ++s)
    r.segment(offsets[s], K[s].rows()) += K[s] * blocks.u.segment(offsets[s], K[s].rows());
  std::map<std::int64_t, Eigen::Vector3d> nodal;
  for (const auto& sub : blocks.scene.subdomains)
    for (int i = 0; i < sub.numNodes(); ++i)
      nodal.try_emplace(sub.nodes[i], Eigen::Vector3d::Zero()).first->second += r.segment<3>(offsets[sub.id] + 3 * i);
  double sum = 0, most = 0;
  std::int64_t last = -1;
  for (const auto& p : blocks.scene.prescribed) {
    if (p.node == last) continue;
    last = p.node;
    sum += nodal[p.node].squaredNorm();
    most = std::max(most, nodal[p.node].norm());
  }
  const LoadScales reactions = measureReactions(*blocks.feti.dealt.multipliers, *scattered(blocks.feti.map(), blocks.lambda));
  TEST_FLOATING_EQUALITY(reactions.norm, std::sqrt(sum), 1e-9);
  TEST_FLOATING_EQUALITY(reactions.largest, most, 1e-9);
}

TEUCHOS_UNIT_TEST(ContactResults, ForcesBalanceAndStatesAreCounted) {
  const PressedBlocks blocks;
  const auto lambda = scattered(blocks.feti.map(), blocks.lambda);
  Vector s(blocks.feti.map());
  const auto pairs = gatherContactResults(*blocks.feti.dealt.multipliers, *blocks.law, *lambda, s, {1.0, 0.0});
  if (blocks.feti.comm->getRank() != 0) {
    TEST_ASSERT(pairs.empty());
    return;
  }
  TEST_EQUALITY(pairs.size(), blocks.scene.rows.pairs.size());
  double normal = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& rows = blocks.scene.rows.pairs[i];
    TEST_EQUALITY(pairs[i].secondaryNode, rows.geometry.secondaryNode);
    normal += blocks.lambda[rows.normal];
    for (int d = 0; d < 3; ++d) {
      const double force = -(blocks.lambda[rows.normal] * rows.geometry.frame.normal[d] +
                             blocks.lambda[rows.tangential[0]] * rows.geometry.frame.t1[d] +
                             blocks.lambda[rows.tangential[1]] * rows.geometry.frame.t2[d]);
      TEST_ASSERT(std::abs(pairs[i].force[d] - force) < 1e-14);
    }
    TEST_FLOATING_EQUALITY(pairs[i].pressure, blocks.lambda[rows.normal] / rows.geometry.area, 1e-13);
  }
  const auto sums = summarizeInterfaces(pairs, {0}), exchanged = summarizeInterfaces(pairs, {1});
  TEST_ASSERT(std::hypot(sums[0].tangentialForce[0], sums[0].tangentialForce[1]) > 0);
  for (int d = 0; d < 3; ++d) TEST_EQUALITY(exchanged[0].tangentialForce[d], -sums[0].tangentialForce[d]);
  TEST_FLOATING_EQUALITY(sums[0].normalForce, normal, 1e-13);
  TEST_EQUALITY(sums[0].stick, long(pairs.size()));
  TEST_EQUALITY(sums[0].open + sums[0].slip, 0L);
}

TEUCHOS_UNIT_TEST(ContactResults, SlipIsTheTangentialJump) {
  std::vector<PairResult> pairs(2);
  pairs[0].secondary = {{1, 1.0}};
  pairs[0].primary = {{0, 1.0}};
  pairs[0].normal = {0, 0.6, 0.8};
  pairs[1].secondary = {{0, 1.0}};  // a rigid plane has no nodes
  pairs[1].normal = {1, 0, 0};
  // The last rank has the pairs, the first ones the two nodes.
  const auto comm = Tpetra::getDefaultComm();
  const NodalGather gather(comm, {}, 2);
  const std::vector<double> u{3, 4, 5, 1, 7, 8};
  if (comm->getRank() != comm->getSize() - 1) pairs.clear();
  const double slip[2][3] = {{-2, 3 - 0.6 * 4.2, 3 - 0.8 * 4.2}, {0, 4, 5}};
  for (const double sign : {1.0, -1.0}) {  // of the side that the input calls secondary
    setSlip(gather, {u.begin() + 3 * gather.firstNode(), u.begin() + 3 * (gather.firstNode() + std::ptrdiff_t(gather.numNodes()))},
            {char(sign < 0)}, pairs);
    for (std::size_t i = 0; i < pairs.size(); ++i)
      for (int d = 0; d < 3; ++d) TEST_ASSERT(std::abs(pairs[i].slip[d] - sign * slip[i][d]) < 1e-14);
  }
}

// Of pairs with lists: forces on nodes are B^T lambda, slips are what tangential rows measure, tied pairs among them.
TEUCHOS_UNIT_TEST(ContactResults, ListsShareForcesAndSlips) {
  const Scene scene = makeListScene();
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), scene);
  const MultiplierMap& multipliers = *feti.dealt.multipliers;
  Eigen::VectorXd lambda = someVector(scene.rows.numRows());
  for (Eigen::Index row = 0; row < lambda.size(); ++row)
    if (scene.rows.pinned[std::size_t(row)] || scene.rows.kinds[std::size_t(row)] == RowKind::Gluing ||
        scene.rows.kinds[std::size_t(row)] == RowKind::Dirichlet)
      lambda[row] = 0;
  const ContactLaw law = makeContactLaw(multipliers, std::vector<FrictionSpec>(3, {FrictionLaw::Coulomb, {0.3, 0.2}}));
  Vector s(feti.map());
  auto pairs = gatherContactResults(multipliers, law, *scattered(feti.map(), lambda), s, {1.0, 0.0});
  const auto tied = gatherTiedResults(multipliers, *scattered(feti.map(), lambda));
  pairs.insert(pairs.end(), tied.begin(), tied.end());
  std::vector<double> u(3 * scene.mesh.numNodes());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = std::sin(1.0 + 3.0 * double(i));
  for (const auto& p : scene.prescribed) u[3 * std::size_t(p.node) + std::size_t(p.component)] = p.value;
  const NodalGather gather(feti.comm, nodesOf(feti.dealt.mine), std::int64_t(scene.mesh.numNodes()));
  const auto first = u.begin() + 3 * gather.firstNode();
  setSlip(gather, {first, first + 3 * std::ptrdiff_t(gather.numNodes())}, std::vector<char>(scene.interfaces.size(), 0), pairs);
  if (feti.comm->getRank() != 0) return;
  std::size_t expected = 0;
  for (const auto& interface : scene.interfaces) expected += interface.pairs.size();
  TEST_EQUALITY(pairs.size(), expected);

  std::set<std::pair<std::int64_t, int>> given;
  for (const auto& p : scene.prescribed) given.insert({p.node, p.component});
  const auto offsets = scene.offsets();
  const Eigen::VectorXd f = -denseB(scene).transpose() * lambda;
  Eigen::VectorXd nodal = Eigen::VectorXd::Zero(3 * Eigen::Index(scene.mesh.numNodes())), wanted = nodal;
  for (const auto& sub : scene.subdomains)
    for (int i = 0; i < sub.numNodes(); ++i) wanted.segment<3>(3 * sub.nodes[std::size_t(i)]) += f.segment<3>(offsets[std::size_t(sub.id)] + 3 * i);
  for (const auto& pair : pairs)
    for (const auto* side : {&pair.secondary, &pair.primary})
      for (const auto& [node, weight] : *side)
        for (int d = 0; d < 3; ++d)
          if (!given.count({node, d})) nodal[3 * node + d] += (side == &pair.secondary ? weight : -weight) * pair.force[std::size_t(d)];
  TEST_ASSERT(largest(wanted) > 0.1);
  TEST_ASSERT(largest(nodal - wanted) < 1e-12);

  Eigen::VectorXd copies(offsets.back());
  for (const auto& sub : scene.subdomains)
    for (int i = 0; i < sub.numDofs(); ++i) copies[offsets[std::size_t(sub.id)] + i] = u[3 * std::size_t(sub.nodes[std::size_t(i / 3)]) + std::size_t(i % 3)];
  const Eigen::VectorXd jump = denseB(scene) * copies;
  for (const auto& rows : scene.rows.pairs)
    for (const auto& pair : pairs)
      if (pair.interface == rows.interface && pair.pair == rows.pair)
        for (int t = 0; t < 2; ++t) {
          if (rows.geometry.isPinned[std::size_t(t) + 1]) continue;  // the row is empty
          const auto& axis = t == 0 ? rows.geometry.frame.t1 : rows.geometry.frame.t2;
          const double slip = Eigen::Map<const Eigen::Vector3d>(pair.slip.data()).dot(Eigen::Map<const Eigen::Vector3d>(axis.data()));
          TEST_ASSERT(std::abs(slip - (jump[rows.tangential[t]] - scene.rows.c[std::size_t(rows.tangential[t])])) < 1e-12);
        }
}
