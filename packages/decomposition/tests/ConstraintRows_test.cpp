// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ConstraintRows.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <set>

#include "DecomposedScene.hpp"
#include "DenseAlgebra.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

bool near(double a, double b) { return std::abs(a - b) < 1e-12; }

// The displacement of every node, given to all its copies.
Eigen::VectorXd onCopies(const Scene& scene, const std::function<Point(std::int64_t)>& field) {
  const auto offsets = scene.offsets();
  Eigen::VectorXd u(offsets.back());
  for (const auto& sub : scene.subdomains)
    for (int i = 0; i < sub.numNodes(); ++i)
      for (int d = 0; d < 3; ++d) u[offsets[sub.id] + 3 * i + d] = field(sub.nodes[i])[d];
  return u;
}

Point someField(std::int64_t node) {
  return {std::sin(1.0 + 3.0 * double(node)), std::cos(2.0 * double(node)), std::sin(5.0 * double(node))};
}

// The field with the prescribed values where there are any.
Eigen::VectorXd admissibleField(const Scene& scene) {
  std::map<std::pair<std::int64_t, int>, double> given;
  for (const auto& p : scene.prescribed) given[{p.node, p.component}] = p.value;
  return onCopies(scene, [&](std::int64_t node) {
    Point u = someField(node);
    for (int d = 0; d < 3; ++d)
      if (given.count({node, d})) u[d] = given[{node, d}];
    return u;
  });
}

SceneOptions clampedAtEnd() {
  SceneOptions options;
  options.hold = [](int body, const Point& x) { return std::string(x[0] < 1e-9 ? (body == 0 ? "xyz" : "z") : ""); };
  return options;
}

double smallestSingularValue(const Scene& scene) {
  const Dense B = denseB(scene);
  Dense kept(0, B.cols());
  for (Eigen::Index row = 0; row < B.rows(); ++row)
    if (!scene.rows.pinned[row]) {
      kept.conservativeResize(kept.rows() + 1, Eigen::NoChange);
      kept.bottomRows(1) = B.row(row);
    }
  return singularValues(kept).tail<1>()[0];
}

}  // namespace

TEUCHOS_UNIT_TEST(ConstraintRows, GluingAndDirichletRowsAreOrthonormal) {
  SceneOptions options = clampedAtEnd();
  options.subdomains = 12;
  const Scene scene = makeScene(options);
  const Dense BE = denseB(scene).topRows(scene.rows.numEquality);
  std::map<std::int64_t, int> copies;
  for (const auto& sub : scene.subdomains)
    for (auto node : sub.nodes) ++copies[node];
  int most = 0;
  for (const auto& [node, count] : copies) most = std::max(most, count);
  TEST_ASSERT(most >= 4);  // nodes where many subdomains meet
  TEST_ASSERT(largest(BE * BE.transpose() - Dense::Identity(BE.rows(), BE.rows())) < 1e-14);
}

TEUCHOS_UNIT_TEST(ConstraintRows, EqualityRowsHoldForEqualCopies) {
  SceneOptions options = clampedAtEnd();
  options.subdomains = 9;  // some of them meet on the clamped face
  const Scene scene = makeScene(options);
  const Eigen::VectorXd jump = denseB(scene) * admissibleField(scene);
  int dirichlet = 0, scaled = 0;
  for (GlobalOrdinal row = 0; row < scene.rows.numEquality; ++row) {
    TEST_ASSERT(near(jump[row], scene.rows.c[row]));
    dirichlet += scene.rows.kinds[row] == RowKind::Dirichlet;
    scaled += scene.rows.offsets[row + 1] - scene.rows.offsets[row] > 1 && scene.rows.kinds[row] == RowKind::Dirichlet;
  }
  TEST_EQUALITY(dirichlet, int(scene.prescribed.size()));
  TEST_ASSERT(scaled > 0);  // prescribed nodes that several subdomains share
}

TEUCHOS_UNIT_TEST(ConstraintRows, ContactRowsAreJumpsOfTheMean) {
  SceneOptions options;
  options.subdomains = 7;
  options.friction = {1, 2, 0};
  const Scene scene = makeScene(options);
  const auto offsets = scene.offsets();
  Eigen::VectorXd u = someVector(offsets.back());  // the copies differ
  std::map<std::int64_t, std::pair<Eigen::Vector3d, int>> mean;
  for (const auto& sub : scene.subdomains)
    for (int i = 0; i < sub.numNodes(); ++i) {
      auto& m = mean.try_emplace(sub.nodes[i], Eigen::Vector3d::Zero(), 0).first->second;
      m.first += u.segment<3>(offsets[sub.id] + 3 * i);
      ++m.second;
    }
  const Eigen::VectorXd jump = denseB(scene) * u;
  TEST_EQUALITY(int(scene.rows.pairs.size()), 16);
  bool averaged = false;
  for (const auto& pair : scene.rows.pairs) {
    const auto& [secondary, copies] = mean.at(pair.geometry.secondaryNode);
    const auto& [primary, otherCopies] = mean.at(pair.geometry.primary.at(0).node);
    averaged = averaged || copies > 1 || otherCopies > 1;
    const Eigen::Vector3d d = secondary / copies - primary / otherCopies;
    const auto along = [&](const Point& axis) { return d.dot(Eigen::Vector3d(axis[0], axis[1], axis[2])); };
    TEST_ASSERT(near(jump[pair.normal], along(pair.geometry.frame.normal)));
    TEST_ASSERT(near(jump[pair.tangential[0]], along(pair.geometry.frame.t1)));
    TEST_ASSERT(near(jump[pair.tangential[1]], along(pair.geometry.frame.t2)));
  }
  TEST_ASSERT(averaged);
}

// Lower nodes at x = 0 are clamped, upper ones held in z only: N has nothing left to act on, T acts on the upper one.
TEUCHOS_UNIT_TEST(ConstraintRows, PrescribedComponentsMoveToTheRightHandSide) {
  SceneOptions options = clampedAtEnd();
  options.gap = 0.01;
  const Scene scene = makeScene(options);
  std::set<std::pair<std::int64_t, int>> given;
  for (const auto& p : scene.prescribed) given.insert({p.node, p.component});
  const Eigen::VectorXd u = admissibleField(scene);
  const Dense B = denseB(scene);
  int pinned = 0, half = 0;
  for (const auto& pair : scene.rows.pairs) {
    const auto s = pair.geometry.secondaryNode, p = pair.geometry.primary.at(0).node;
    const bool normalHeld = given.count({s, 2}) && given.count({p, 2});
    TEST_EQUALITY(bool(scene.rows.pinned[pair.normal]), normalHeld);
    pinned += normalHeld;
    for (GlobalOrdinal row : {pair.normal, pair.tangential[0], pair.tangential[1]})
      for (auto k = scene.rows.offsets[row]; k < scene.rows.offsets[row + 1]; ++k) {
        const RowEntry& entry = scene.rows.entries[k];
        const auto node = scene.subdomains[entry.subdomain].nodes[entry.dof / 3];
        TEST_ASSERT(!given.count({node, entry.dof % 3}));
      }
    half += given.count({p, 0}) && !given.count({s, 0}) && !scene.rows.pinned[pair.tangential[0]];
  }
  TEST_ASSERT(pinned > 0);
  TEST_ASSERT(half > 0);

  // B u - c is still the gap function n . [u] - d of the whole displacement.
  const auto offsets = scene.offsets();
  std::map<std::int64_t, Eigen::Vector3d> nodal;
  for (const auto& sub : scene.subdomains)
    for (int i = 0; i < sub.numNodes(); ++i) nodal[sub.nodes[i]] = u.segment<3>(offsets[sub.id] + 3 * i);
  for (const auto& pair : scene.rows.pairs) {
    const Eigen::Vector3d d = nodal[pair.geometry.secondaryNode] - nodal[pair.geometry.primary.at(0).node];
    const Eigen::Vector3d n(pair.geometry.frame.normal.data()), t1(pair.geometry.frame.t1.data());
    TEST_ASSERT(near(B.row(pair.normal).dot(u) - scene.rows.c[pair.normal], n.dot(d) - pair.geometry.gap));
    TEST_ASSERT(near(B.row(pair.tangential[0]).dot(u) - scene.rows.c[pair.tangential[0]], t1.dot(d)));
    TEST_ASSERT(near(pair.geometry.gap, 0.01));
  }
}

// A roller: x and y held on both sides, so both tangential rows are empty and the normal row is not.
TEUCHOS_UNIT_TEST(ConstraintRows, RollersPinTangentialRowsOnly) {
  SceneOptions options;
  options.hold = [](int, const Point& x) { return std::string(x[0] < 1e-9 ? "xy" : ""); };
  const Scene scene = makeScene(options);
  int rollers = 0;
  for (const auto& pair : scene.rows.pairs) {
    const bool roller = scene.mesh.coordinates[pair.geometry.secondaryNode][0] < 1e-9;
    rollers += roller;
    TEST_ASSERT(!scene.rows.pinned[pair.normal]);
    for (auto row : pair.tangential) TEST_EQUALITY(bool(scene.rows.pinned[row]), roller);
  }
  TEST_EQUALITY(rollers, 4);
  TEST_ASSERT(smallestSingularValue(scene) > 1e-3);
}

TEUCHOS_UNIT_TEST(ConstraintRows, RowsHaveFullRank) {
  for (int subdomains : {2, 5, 12}) {
    SceneOptions options = clampedAtEnd();
    options.subdomains = subdomains;
    options.friction = {1, 1, 0};
    const Scene scene = makeScene(options);
    TEST_ASSERT(std::count(scene.rows.pinned.begin(), scene.rows.pinned.end(), char(1)) > 0);
    const double sigma = smallestSingularValue(scene);
    out << subdomains << " subdomains: smallest singular value " << sigma << "\n";
    TEST_ASSERT(sigma > 1e-3);
  }
}

// Laws are evaluated where the pairs are owned: by the ranks of both bodies.
TEUCHOS_UNIT_TEST(ConstraintRows, BothBodiesOwnPairs) {
  SceneOptions options = clampedAtEnd();
  options.subdomains = 16;  // few would all be even, or all odd
  const Scene scene = makeScene(options);
  std::array<int, 2> owned{0, 0};
  for (const auto& pair : scene.rows.pairs) ++owned[std::size_t(scene.subdomains[std::size_t(scene.rows.owner[pair.normal])].body)];
  out << owned[0] << " and " << owned[1] << " pairs\n";
  const int all = owned[0] + owned[1];
  TEST_ASSERT(all >= 4 && 4 * owned[0] >= all && 4 * owned[1] >= all);
}
