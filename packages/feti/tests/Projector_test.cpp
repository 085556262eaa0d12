// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Projector.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>

#include "FetiScene.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

// G = R^T B^T from the local kernels, which differ by an orthogonal matrix from any other basis.
Dense denseG(const Scene& scene, const Feti& feti) {
  const Dense B = denseB(scene);
  const auto offsets = scene.offsets();
  Dense mine = Dense::Zero(6 * scene.partition.count, B.rows()), G = mine;
  for (int i = 0; i < feti.systems->size(); ++i) {
    const int s = feti.dealt.first + i;
    const Dense& R = (*feti.systems)[i].R();
    mine.middleRows(6 * s, 6) = R.transpose() * B.middleCols(offsets[s], R.rows()).transpose();
  }
  Teuchos::reduceAll(*feti.comm, Teuchos::REDUCE_SUM, int(mine.size()), mine.data(), G.data());
  return G;
}

struct Projectors {
  Scene scene;
  Feti feti;
  RCP<CoarseProblem> GGT;
  Projector P, Q;

  explicit Projectors(int subdomains)
      : scene(makeScene(heldScene(subdomains))),
        feti(makeFeti(Tpetra::getDefaultComm(), scene)),
        GGT(Teuchos::rcp(new CoarseProblem(*feti.comm, feti.G->rows(), {}, {}))),
        P(feti.G, GGT, Projector::Onto::KernelOfG),
        Q(feti.G, GGT, Projector::Onto::ImageOfGT) {}
};

}  // namespace

TEUCHOS_UNIT_TEST(NaturalCoarseSpace, EqualsDenseInBothModes) {
  const Projectors p(7);
  const Dense G = denseG(p.scene, p.feti), x = someColumns(G.cols(), 2), a = someColumns(G.rows(), 2), y0 = someColumns(G.cols(), 2);
  TEST_ASSERT(largest(p.feti.G->applyG(*scatteredColumns(p.feti.map(), x)) - G * x) < 1e-12);
  const auto y = scatteredColumns(p.feti.map(), y0);
  p.feti.G->applyGT(a, *y, -2.0, 3.0);
  TEST_ASSERT(largest(gathered(*y) - (-2.0 * G.transpose() * a + 3.0 * y0)) < 1e-12);
}

TEUCHOS_UNIT_TEST(Projector, ProjectsOnTheKernelOfG) {
  for (int subdomains : {2, 7}) {
    const Projectors p(subdomains);
    const Dense G = denseG(p.scene, p.feti), P = denseOf(p.P), Q = denseOf(p.Q);
    const Dense I = Dense::Identity(P.rows(), P.rows());
    TEST_ASSERT(G.norm() > 1.0);
    TEST_ASSERT(largest(P * P - P) < 1e-12);
    TEST_ASSERT(largest(G * P) < 1e-12);
    TEST_ASSERT(largest(P - P.transpose()) < 1e-12);
    TEST_ASSERT(largest(Q - (I - P)) < 1e-12);
    TEST_ASSERT(std::abs(Q.trace() - 6.0 * subdomains) < 1e-10);  // the rank of G
    TEST_ASSERT(largest(Q - G.transpose() * ldltSolve(G * G.transpose(), G)) < 1e-11);
  }
}

TEUCHOS_UNIT_TEST(Projector, AlphaAndBeta) {
  const Projectors p(5);
  for (const Projector* projector : {&p.P, &p.Q}) {
    const Dense A = denseOf(*projector), x = someColumns(A.cols(), 2), y0 = 2.0 * someColumns(A.cols(), 2);
    const auto y = scatteredColumns(p.feti.map(), y0);
    projector->apply(*scatteredColumns(p.feti.map(), x), *y, Teuchos::NO_TRANS, -3.0, 0.5);
    TEST_ASSERT(largest(gathered(*y) - (-3.0 * A * x + 0.5 * y0)) < 1e-11);
  }
}

TEUCHOS_UNIT_TEST(ProjectedDualOperator, IsPFPAndGivesQx) {
  const Projectors p(6);
  const ProjectedDualOperator A(p.feti.F, p.feti.G, p.GGT);
  const Dense P = denseOf(p.P), Q = denseOf(p.Q), F = denseF(p.scene);
  TEST_ASSERT(largest(denseOf(A) - P * F * P) < 1e-10 * largest(F));
  const Dense x = someColumns(P.cols(), 1);
  MultiVector Ax(p.feti.map(), 1), Qx(p.feti.map(), 1);
  const long before = p.GGT->solves();
  A.applyWithProjection(*scatteredColumns(p.feti.map(), x), Ax, Qx);
  TEST_EQUALITY(p.GGT->solves() - before, 2L);
  TEST_ASSERT(largest(gathered(Qx) - Q * x) < 1e-12);
  TEST_ASSERT(largest(gathered(Ax) - P * F * P * x) < 1e-10 * largest(F));
}

TEUCHOS_UNIT_TEST(CoarseProblem, EqualsDenseWithWeightsAndHolds) {
  const Projectors p(7);
  const Dense G = denseG(p.scene, p.feti);
  const Eigen::VectorXd q = someVector(G.cols()).array() + 1.5;
  std::vector<double> mine;
  for (int i = 0; i < int(localNumElements(*p.feti.map())); ++i) mine.push_back(q[p.feti.map()->getGlobalElement(i)]);
  Dense A = G * q.asDiagonal() * G.transpose();
  const Dense b = someColumns(A.rows(), 3);
  TEST_ASSERT(largest(CoarseProblem(*p.feti.comm, p.feti.G->rows(), mine, {}).solve(b) - ldltSolve(A, b)) <
              1e-10 * largest(ldltSolve(A, b)));

  Eigen::SparseVector<double> w(A.rows());
  w.insert(2) = 0.6;
  w.insert(9) = -0.8;
  A += A.diagonal().maxCoeff() * Dense(w) * Dense(w).transpose();
  const Dense x = CoarseProblem(*p.feti.comm, p.feti.G->rows(), mine, {w}).solve(b);
  TEST_ASSERT(largest(x - ldltSolve(A, b)) < 1e-10 * largest(x));
}
