// SPDX-License-Identifier: BSD-3-Clause
// Nodes in several contacts, against the kernel of a dense B^T.
#include "Haptos_DependentRows.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_CrsMatrix.hpp>

#include "FetiScene.hpp"
#include "Haptos_ConstraintRows.hpp"
#include "Haptos_CouplingGram.hpp"
#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_DependentGroups.hpp"
#include "Haptos_Reductions.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

// Both bodies of a scene on rigid planes x = 0 and y = 0 too: nodes between the bodies are in two or three contacts; parts of the plane y = 0 lean.
// Some nodes at x = 0 are held along z.
Scene corneredScene(bool isTied) {
  SceneOptions options;
  options.subdomains = 6;
  options.hold = [](int body, const Point& x) {
    if (body == 0 && std::abs(x[2]) > 1 - 1e-9) return std::string("xyz");
    return std::string(body == 1 && std::abs(x[2]) < 1e-9 && std::abs(x[0]) < 1e-9 && x[1] > 0.5 ? "z" : "");
  };
  Scene scene = makeScene(options);
  scene.interfaces.front().tied = isTied;
  for (const int d : {0, 1}) {
    ContactInterface wall;
    wall.name = d == 0 ? "x" : "y";
    for (std::size_t i = 0; i < scene.mesh.numNodes(); ++i) {
      const Point& x = scene.mesh.coordinates[i];
      if (std::abs(x[std::size_t(d)]) > 1e-9 || x[2] < -1 + 1e-9) continue;
      Point normal{d == 0 ? -1.0 : 0.0, d == 0 ? 0.0 : -1.0, d == 1 && x[0] > 0.8 ? 0.3 : 0.0};
      ContactPair pair{std::int64_t(i), {{std::int64_t(i), 1.0}}, {}, makeFrame(normal, {0, 0, 1}), 0.0, 0.5};
      wall.pairs.push_back(pair);
    }
    scene.interfaces.push_back(wall);
  }
  buildRows(scene);
  return scene;
}

// Onto z with B^T z = 0, z on rows of pairs alone.
Dense projectorOntoKernel(const Scene& scene, Eigen::Index& dimension) {
  const Dense B = denseB(scene);
  Dense all = Dense::Zero(B.rows(), B.rows());
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < B.rows(); ++i) {
    const RowKind kind = scene.rows.kinds[std::size_t(i)];
    if ((kind == RowKind::Tied || !isEquality(kind)) && !scene.rows.pinned[std::size_t(i)]) rows.push_back(i);
  }
  const Dense Bp = B(rows, Eigen::all);
  const SymmetricEigen eigen(Bp * Bp.transpose());
  dimension = (eigen.values.array() < 1e-10).count();
  const Dense basis = eigen.vectors.leftCols(dimension);
  all(rows, rows) = basis * basis.transpose();
  return all;
}

Dense contactPart(const Scene& scene, Dense E, bool bothSides) {
  for (Eigen::Index i = 0; i < E.rows(); ++i) {
    if (!isEquality(scene.rows.kinds[std::size_t(i)])) continue;
    E.row(i).setZero();
    if (bothSides) E.col(i).setZero();
  }
  return E;
}

DependentRows rowsOf(const Feti& feti, const Vector& diagonal) {
  const MultiplierMap& multipliers = feti.dealt.jump->multipliers();
  return makeDependentRows(multipliers, findDependentGroups(multipliers), diagonal);
}

void compareWithKernel(const Scene& scene, Teuchos::FancyOStream& out, bool& success) {
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), scene);
  Vector diagonal(feti.map());
  diagonal.putScalar(2);
  const DependentRows found = rowsOf(feti, diagonal);
  Eigen::Index dimension = 0;
  const Dense Q = projectorOntoKernel(scene, dimension);
  out << dimension << " forces without effect\n";
  TEST_EQUALITY(found.all.is_null(), dimension == 0);
  if (found.all.is_null()) return;
  const Dense E = denseOf(*found.all), expected = E.trace() / double(dimension) * Q;
  TEST_COMPARE(E.trace(), >, 2.0 * double(dimension));  // k is more than M's diagonal
  TEST_COMPARE(largest(E - expected), <=, 1e-10 * largest(E));
  TEST_COMPARE(largest(denseOf(*found.contactRows) - contactPart(scene, expected, false)), <=, 1e-10 * largest(E));
  TEST_COMPARE(largest(denseOf(*found.contact) - contactPart(scene, expected, true)), <=, 1e-10 * largest(E));
}

// Each pair has a node of its own, which is held along y: along y both act on the third alone, and the second, with this weight, on a fourth.
Scene sceneOfHeldNodes(double weight) {
  SceneOptions options;
  options.hold = [](int body, const Point& x) { return std::string(body == 1 && x[2] > 1 - 1e-9 && x[1] < 1e-9 ? "y" : ""); };
  Scene scene = makeScene(options);
  std::vector<std::int64_t> held, others;
  for (std::size_t i = 0; i < scene.mesh.numNodes(); ++i) {
    const Point& x = scene.mesh.coordinates[i];
    if (x[2] > 1 - 1e-9) (x[1] < 1e-9 ? held : others).push_back(std::int64_t(i));
  }
  ContactInterface lists;
  lists.name = "lists";
  for (std::size_t k = 0; k < 2; ++k) {
    lists.pairs.push_back({held[k], {{held[k], 0.5}, {others.front(), 0.5}}, {}, makeFrame({0, 0, -1}, {1, 0, 0}), 0.0, 0.5});
    if (k == 1 && weight > 0) lists.pairs.back().secondary.push_back({others.back(), weight});
  }
  scene.interfaces.push_back(lists);
  buildRows(scene);
  return scene;
}

// Two planes for each pair of neighbours on a face whose nodes are held along y, with normals that have round-off along it: T2 is y and has no effect.
Scene sceneBetweenPlanes() {
  SceneOptions options;
  options.hold = [](int body, const Point& x) { return std::string(body == 1 && x[2] > 1 - 1e-9 ? "y" : ""); };
  Scene scene = makeScene(options);
  std::vector<std::int64_t> face;
  for (std::size_t i = 0; i < scene.mesh.numNodes(); ++i)
    if (scene.mesh.coordinates[i][2] > 1 - 1e-9) face.push_back(std::int64_t(i));
  for (const Point& normal : {Point{-0.6, 1e-17, -0.8}, Point{0.8, 1e-17, -0.6}}) {
    ContactInterface plane;
    plane.name = normal[0] < 0 ? "left" : "right";
    for (std::size_t k = 0; k + 1 < face.size(); ++k)
      plane.pairs.push_back({face[k], {{face[k], 0.6}, {face[k + 1], 0.4}}, {}, makeFrame(normal, {normal[2], 0, -normal[0]}), 0.0, 0.5});
    scene.interfaces.push_back(plane);
  }
  buildRows(scene);
  return scene;
}

// Of the largest entry of S^-1 to that of one over S's diagonal.  Collective.
double growthOfInverse(const Feti& feti) {
  const auto& comm = *Tpetra::getDefaultComm();
  const CouplingGram S(feti.dealt.jump->multipliers(), true);
  const auto n = Eigen::Index(S.rows().size());
  const Dense inverse = S.solve(Dense::Identity(n, largestOfAll(comm, int(n))));  // as many columns on all ranks
  return largestOfAll(comm, n > 0 ? inverse.cwiseAbs().maxCoeff() / S.rowDiagonal().maxCoeff() : 0.0);
}

}  // namespace

TEUCHOS_UNIT_TEST(DependentRows, NodesInThreeContacts) {
  const Scene scene = corneredScene(false);
  Eigen::Index dimension = 0;
  projectorOntoKernel(scene, dimension);
  TEST_COMPARE(dimension, >=, 20);
  compareWithKernel(scene, out, success);
}

TEUCHOS_UNIT_TEST(DependentRows, NodesInContactThatAreTied) { compareWithKernel(corneredScene(true), out, success); }

TEUCHOS_UNIT_TEST(DependentRows, RowsOfListsDependOnNoOthers) {
  compareWithKernel(makeListScene(true), out, success);
  compareWithKernel(makeScene({}), out, success);
}

TEUCHOS_UNIT_TEST(DependentRows, PairsWhoseOwnNodesAreHeld) {
  const Scene scene = sceneOfHeldNodes(0);
  Eigen::Index dimension = 0;
  projectorOntoKernel(scene, dimension);
  TEST_EQUALITY(dimension, 1);
  compareWithKernel(scene, out, success);
}

// Forces along z, |B^T z| = 1e-6 |z|, have next to no effect: the law decides about them as well, and the inverse of S makes nothing large of them.
TEUCHOS_UNIT_TEST(DependentRows, NearlyDependentOnes) {
  const auto made = [](double weight) {
    const Feti feti = makeFeti(Tpetra::getDefaultComm(), sceneOfHeldNodes(weight));
    Vector diagonal(feti.map());
    diagonal.putScalar(2);
    const DependentRows found = rowsOf(feti, diagonal);
    return found.all.is_null() ? Dense() : denseOf(*found.all);
  };
  const Dense exact = made(0), nearly = made(1e-6);
  TEST_ASSERT(exact.size() > 0 && nearly.rows() == exact.rows() && largest(nearly - exact) <= 1e-4 * largest(exact));
  TEST_EQUALITY(made(0.1).size(), 0);
  for (const double weight : {0.0, 1e-6, 1e-4})
    TEST_COMPARE(growthOfInverse(makeFeti(Tpetra::getDefaultComm(), sceneOfHeldNodes(weight))), <, 10.0);
}

// What supports hold has nothing in S, and gets nothing of Q but the round-off of turning, which an inverse would make all of.
TEUCHOS_UNIT_TEST(DependentRows, NormalsWithRoundOffAlongWhatIsHeld) {
  const Scene scene = sceneBetweenPlanes();
  Eigen::Index dimension = 0;
  projectorOntoKernel(scene, dimension);
  TEST_COMPARE(dimension, >=, 22);
  compareWithKernel(scene, out, success);
  TEST_COMPARE(growthOfInverse(makeFeti(Tpetra::getDefaultComm(), scene)), <, 100.0);
}

// k is the mean over the rows of a group, weighed by what they take part.
TEUCHOS_UNIT_TEST(DependentRows, StiffnessGoesWithTheDiagonal) {
  const Scene scene = corneredScene(false);
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), scene);
  Vector diagonal(feti.map());
  diagonal.putScalar(1);
  const Dense once = denseOf(*rowsOf(feti, diagonal).all);
  for (std::size_t i = 0; i < scene.rows.kinds.size(); ++i)
    if (const auto row = feti.map()->getLocalElement(GlobalOrdinal(i)); row >= 0) diagonal.getDataNonConst(0)[row] = 1 + 0.1 * double(i % 7);
  const Dense E = denseOf(*rowsOf(feti, diagonal).all);
  Eigen::VectorXd d(E.rows());
  for (Eigen::Index i = 0; i < d.size(); ++i) d[i] = 1 + 0.1 * double(i % 7);
  TEST_FLOATING_EQUALITY(E.trace(), once.diagonal().dot(d), 1e-10);
  TEST_COMPARE(largest(denseB(scene).transpose() * E), <=, 1e-9 * largest(E));
}
