// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DualOperator.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>

#include "FetiScene.hpp"
#include "Haptos_DualProblem.hpp"
#include "Haptos_RigidBodyModes.hpp"
#include "Haptos_SubdomainSurface.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

Scene brickScene(int k, int p) {
  Scene scene;
  scene.mesh = makeTwoBeams({k, p});
  PartitionOptions cut;
  cut.method = PartitionMethod::Bricks;
  cut.bricks = brickSubdomains({k, p});
  cutScene(scene, cut);
  scene.materials = {{"soft", 7.0, 0.3}, {"hard", 21.0, 0.25}};
  return scene;
}

int numClasses(Scene& scene) {
  scene.subdomains = extractSubdomains(scene.mesh, scene.partition, {0, 1});
  LocalSystems systems(stiffnessOf(scene.subdomains, scene));
  systems.assemble();
  systems.factor(LocalSolverMethod::Automatic);
  return systems.numClasses();
}

}  // namespace

// The dense matrix knows nothing of ranks, so F is the same on any number of them.
TEUCHOS_UNIT_TEST(DualOperator, EqualsDenseBKpBT) {
  for (int subdomains : {3, 7})
    for (auto dual : {LocalDual::Implicit, LocalDual::Explicit}) {
      const Scene scene = makeScene(heldScene(subdomains));
      const Feti feti = makeFeti(Tpetra::getDefaultComm(), scene, dual);
      TEST_EQUALITY(feti.systems->numCondensed(), dual == LocalDual::Explicit ? feti.systems->size() : 0);
      const Dense F = denseOf(*feti.F), reference = denseF(scene);
      TEST_ASSERT(largest(reference) > 1e-3);
      TEST_ASSERT(largest(F - reference) < 1e-11 * largest(reference));
      TEST_EQUALITY(feti.F->applications(), long(scene.rows.numRows()));
    }
}

TEUCHOS_UNIT_TEST(DualOperator, SymmetricAndPositiveSemidefinite) {
  const Scene scene = makeScene(heldScene(6));
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), scene);
  const Dense F = denseOf(*feti.F);
  TEST_ASSERT(largest(F - F.transpose()) < 1e-13 * largest(F));
  TEST_ASSERT(smallestEigenvalue(F) > -1e-12 * largest(F));
}

TEUCHOS_UNIT_TEST(DualOperator, AlphaAndBeta) {
  const Scene scene = makeScene(heldScene(4));
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), scene);
  const Dense F = denseF(scene), x = someColumns(F.cols(), 2), y0 = 2.0 * someColumns(F.cols(), 2);
  const auto y = scatteredColumns(feti.map(), y0);
  feti.F->apply(*scatteredColumns(feti.map(), x), *y, Teuchos::NO_TRANS, -3.0, 0.5);
  TEST_ASSERT(largest(gathered(*y) - (-3.0 * F * x + 0.5 * y0)) < 1e-10 * largest(F));
}

// h - F l comes with the displacements of the same l, which are made once.
TEUCHOS_UNIT_TEST(DualProblem, JumpsComeWithTheirDisplacements) {
  const Scene scene = makeScene(heldScene(4));
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), scene);
  const Dense F = denseF(scene), f = someColumns(Eigen::Index(scene.offsets().back()), 1), l = someColumns(F.cols(), 1), c = 0.3 * someColumns(F.cols(), 1);
  DualProblem dual(feti.F, feti.G, Teuchos::rcp(new CoarseProblem(*feti.comm, feti.G->rows(), {}, {})));
  const auto column = [](const RCP<const Map>& map, const Dense& values) { return scattered(map, Eigen::VectorXd(values.col(0))); };
  dual.setStep({column(feti.dealt.jump->getDomainMap(), f), column(feti.map(), c), {}});
  const auto lambda = column(feti.map(), l), none = column(feti.map(), 0 * l);
  const long before = feti.F->applications();
  const Dense h = gathered(*dual.jumpsOf(*none)), jumps = gathered(*dual.jumpsOf(*lambda));
  TEST_ASSERT(largest(h) > 1e-3);
  TEST_ASSERT(largest(jumps - (h - F * l)) < 1e-10 * largest(h));
  TEST_EQUALITY(feti.F->applications() - before, 2L);

  const auto s = dual.jumpsOf(*lambda);  // the same once more
  const long solves = feti.systems->localSolves();
  const auto u = recoverPrimal(dual, *lambda, *s);
  TEST_EQUALITY(feti.F->applications() - before, 2L);
  TEST_EQUALITY(feti.systems->localSolves(), solves);
  recoverPrimal(dual, *none, *s);  // of another l they are made
  TEST_ASSERT(feti.systems->localSolves() > solves || feti.systems->size() == 0);
  // G^T a = s - (B u - c) is what rigid motions add: where s are the jumps themselves, nothing.
  Vector rest(*s, Teuchos::Copy);
  rest.update(1.0, *dual.step.c, 1.0);
  feti.dealt.jump->apply(*u, rest, Teuchos::NO_TRANS, -1.0, 1.0);
  TEST_ASSERT(rest.norm2() < 1e-10 * s->norm2());
}

// Two materials, so two classes; one moved node makes its brick a class of its own.
TEUCHOS_UNIT_TEST(LocalSystems, BricksAreCongruentUntilANodeMoves) {
  Scene scene = brickScene(2, 3);
  TEST_EQUALITY(scene.partition.count, 32);
  TEST_EQUALITY(numClasses(scene), 2);
  const auto inside = [](const Point& x) {  // an inner node of one brick
    return std::abs(x[0] - 1.0 / 6) < 1e-9 && std::abs(x[1] - 1.0 / 6) < 1e-9 && std::abs(x[2] - 1.0 / 6) < 1e-9;
  };
  int moved = 0;
  for (auto& x : scene.mesh.coordinates)
    if (inside(x)) x[0] += 1e-3, ++moved;
  TEST_EQUALITY(moved, 1);
  TEST_EQUALITY(numClasses(scene), 3);
  for (auto& x : scene.mesh.coordinates)  // a node shared by bricks: every brick around it
    if (std::abs(x[0] - 1.0) < 1e-9 && std::abs(x[1] - 0.5) < 1e-9 && std::abs(x[2] - 0.5) < 1e-9) x[1] += 1e-3, ++moved;
  TEST_EQUALITY(moved, 2);
  TEST_EQUALITY(numClasses(scene), 3 + 8);
}

TEUCHOS_UNIT_TEST(LocalSystems, JaggedPartsAreAllDifferent) {
  SceneOptions options = heldScene(7);
  options.lower = options.upper = {4, 3, 3};
  Scene scene = makeScene(options);
  TEST_EQUALITY(numClasses(scene), 7);
}

// Members of a class go through the factor together; the result is that of one after the other.
TEUCHOS_UNIT_TEST(LocalSystems, CongruentSubdomainsAreSolvedTogether) {
  Scene scene = brickScene(1, 2);
  TEST_EQUALITY(numClasses(scene), 2);
  LocalSystems systems(stiffnessOf(scene.subdomains, scene));
  systems.assemble();
  systems.factor(LocalSolverMethod::Automatic);
  TEST_EQUALITY(systems.numCondensed(), 0);
  std::vector<std::size_t> offsets{0};
  for (const auto& sub : scene.subdomains) offsets.push_back(offsets.back() + sub.numDofs());
  const auto map = Teuchos::rcp(new Map(Tpetra::global_size_t(offsets.back()), 0, Tpetra::getDefaultComm(), Tpetra::LocallyReplicated));
  const Dense f = someColumns(Eigen::Index(offsets.back()), 2);
  MultiVector u(map, 2);
  systems.applyPseudoInverse(offsets, *scatteredColumns(map, f), u);
  TEST_EQUALITY(systems.localSolves(), 8L);
  const FactorWork work = systems.work();
  TEST_ASSERT(work.entries > 0);
  TEST_EQUALITY(work.bytesRead, 2 * 16 * work.entries);  // each factor forward and backward, once a vector, whatever its members
  const auto K = denseStiffness(scene);
  for (std::size_t s = 0; s < K.size(); ++s) {
    const Dense reference = densePseudoInverse(K[s]) * f.middleRows(Eigen::Index(offsets[s]), K[s].rows());
    for (std::size_t v = 0; v < 2; ++v) {
      const auto data = u.getData(v);
      for (Eigen::Index i = 0; i < K[s].rows(); ++i)
        TEST_ASSERT(std::abs(data[Eigen::Index(offsets[s]) + i] - reference(i, Eigen::Index(v))) < 1e-10 * largest(reference));
    }
  }
}

// K^+ of a condensed subdomain on all unknowns, and in blocks (a full matrix) as well as one by one (a packed one).
TEUCHOS_UNIT_TEST(DenseSurfaceMatrices, EqualsDensePseudoInverse) {
  const Scene scene = makeScene(heldScene(3));
  const auto K = denseStiffness(scene);
  int withInterior = 0;
  for (std::size_t s = 0; s < scene.subdomains.size(); ++s) {
    const auto boundary = surfaceDofs(scene.subdomains[s].groups, scene.subdomains[s].numNodes());
    if (Eigen::Index(boundary.size()) < K[s].rows()) ++withInterior;
    const Eigen::SparseMatrix<double> sparse = K[s].sparseView();
    const Dense R = rigidBodyModes(scene.subdomains[s].coordinates, {}), reference = densePseudoInverse(K[s]), f = someColumns(K[s].rows(), 3);
    for (std::size_t members : {1, 9}) {
      const DenseSurfaceMatrices condensed(sparse, R, boundary, members);
      Dense u(f.rows(), f.cols());
      condensed.solve(f, u);
      TEST_ASSERT(largest(u - reference * f) < 1e-10 * largest(reference * f));
      const Eigen::Index nb = Eigen::Index(boundary.size());
      Dense P(nb, nb), expected(nb, nb);
      condensed.applyInverse(Dense::Identity(nb, nb), P);
      for (Eigen::Index i = 0; i < nb; ++i)
        for (Eigen::Index j = 0; j < nb; ++j) expected(i, j) = reference(boundary[i], boundary[j]);
      TEST_ASSERT(largest(P - expected) < 1e-10 * largest(expected));
    }
  }
  TEST_ASSERT(withInterior > 0);
}

// A motion without energy that R lacks is refused, as it is by the sparse factor.
TEUCHOS_UNIT_TEST(DenseSurfaceMatrices, RefusesAnIncompleteKernel) {
  const Scene scene = makeScene(heldScene(3));
  const Eigen::SparseMatrix<double> K = denseStiffness(scene)[0].sparseView();
  const Dense R = rigidBodyModes(scene.subdomains[0].coordinates, {}), five = R.leftCols(5);
  const auto boundary = surfaceDofs(scene.subdomains[0].groups, scene.subdomains[0].numNodes());
  TEST_THROW(DenseSurfaceMatrices(K, five, boundary, 1), std::runtime_error);
  Dense wrong = R;
  wrong.col(2).setOnes();
  TEST_THROW(DenseSurfaceMatrices(K, wrong, boundary, 1), std::runtime_error);
}
