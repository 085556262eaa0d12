// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DualPreconditioner.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>

#include <algorithm>
#include <cmath>

#include "DensePreconditioner.hpp"
#include "Haptos_ContactBlock.hpp"
#include "Haptos_SubdomainSurface.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

// Pinned rows too: both sides are clamped at x = 0.
Scene scene() {
  SceneOptions options = heldScene(6);
  options.lower = options.upper = {4, 3, 3};
  return makeScene(options);
}

// One component is prescribed at many nodes, some of them inside a subdomain.
Scene sceneHeldInside() {
  SceneOptions options = heldScene(4);
  options.lower = options.upper = {4, 3, 3};
  const auto outside = options.hold;
  options.hold = [outside](int body, const Point& x) { return x[0] > 0.2 && body == 1 ? std::string("y") : outside(body, x); };
  return makeScene(options);
}

constexpr double kSingle = 2e-6;  // what single precision leaves of an entry, in parts of the largest

RCP<DualPreconditioner> make(const Feti& feti, PreconditionerKind kind) {
  return Teuchos::rcp(new DualPreconditioner(feti.dealt.jump, feti.systems,
                                             SurfaceOperators(*feti.systems, {*feti.systems, *feti.dealt.jump}, kind, LocalSolverMethod::Automatic)));
}

}  // namespace

TEUCHOS_UNIT_TEST(DualPreconditioner, EqualsDenseFormula) {
  const Scene s = scene();
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), s), dense = makeFeti(Tpetra::getDefaultComm(), s, LocalDual::Explicit);
  for (auto kind : {PreconditionerKind::Dirichlet, PreconditionerKind::Lumped}) {
    const Dense bySolves = denseOf(*make(feti, kind)), byMatrices = denseOf(*make(dense, kind)), reference = denseM(s, kind);
    for (const Dense& M : {bySolves, byMatrices}) {
      TEST_ASSERT(largest(M - reference) < kSingle * largest(reference));
      TEST_ASSERT(largest(M - reference) > 1e-9 * largest(reference));  // it is kept in single precision
    }
  }
  TEST_ASSERT(largest(denseM(s, PreconditionerKind::Dirichlet) - denseM(s, PreconditionerKind::Lumped)) >
              1e-2 * largest(denseM(s, PreconditionerKind::Lumped)));  // the interiors are not empty
}

// Rows at nodes inside a subdomain must not be left to the unit matrix, whose size depends on the units.
TEUCHOS_UNIT_TEST(DualPreconditioner, PrescribedNodesInside) {
  const Scene s = sceneHeldInside();
  std::size_t inside = 0;
  for (const auto& sub : s.subdomains) {
    const auto surface = surfaceDofs(sub.groups, sub.numNodes());
    for (int dof : boundaryOf(s, sub)) inside += !std::binary_search(surface.begin(), surface.end(), dof);
  }
  TEST_ASSERT(inside > 0);
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), s), dense = makeFeti(Tpetra::getDefaultComm(), s, LocalDual::Explicit);
  for (auto kind : {PreconditionerKind::Dirichlet, PreconditionerKind::Lumped}) {
    const Dense reference = denseM(s, kind);
    for (const Feti* f : {&feti, &dense}) {
      const auto M = make(*f, kind);
      TEST_ASSERT(largest(denseOf(*M) - reference) < kSingle * largest(reference));
      const Eigen::VectorXd diagonal = gathered(*M->diagonal());
      for (Eigen::Index row = 0; row < diagonal.size(); ++row)
        TEST_ASSERT(reference(row, row) < 1e-6 * largest(reference) || diagonal[row] > 0.1 * reference(row, row));
    }
  }
}

TEUCHOS_UNIT_TEST(DualPreconditioner, SymmetricAndPositiveSemidefinite) {
  const Scene s = scene();
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), s);
  for (auto kind : {PreconditionerKind::Dirichlet, PreconditionerKind::Lumped}) {
    const Dense M = denseOf(*make(feti, kind));
    TEST_ASSERT(largest(M - M.transpose()) < kSingle * largest(M));
    TEST_ASSERT(smallestEigenvalue(M) > -kSingle * largest(M));
  }
}

// Between contact rows, and in contact rows, against the dense formula; the union of a class's contact nodes is used.
TEUCHOS_UNIT_TEST(DualPreconditioner, ContactBlockAndContactRows) {
  const Scene s = scene();
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), s);
  const Dense reference = denseM(s, PreconditionerKind::Dirichlet);
  const auto M = make(feti, PreconditionerKind::Dirichlet);
  const auto block = Teuchos::rcp(new ContactBlock(M));
  const Dense between = denseOf(*block), rows = denseOf(ContactRows(M, block));
  const auto isContact = [&](Eigen::Index row) {
    const RowKind kind = s.rows.kinds[std::size_t(row)];
    return kind == RowKind::Normal || kind == RowKind::Tangential;
  };
  int contact = 0;
  for (Eigen::Index i = 0; i < reference.rows(); ++i) {
    contact += isContact(i);
    for (Eigen::Index j = 0; j < reference.cols(); ++j) {
      const double expected = isContact(i) && isContact(j) ? reference(i, j) : 0.0;
      TEST_ASSERT(std::abs(between(i, j) - expected) < kSingle * largest(reference));
      if (isContact(i)) TEST_ASSERT(std::abs(rows(i, j) - reference(i, j)) < kSingle * largest(reference));
    }
  }
  TEST_ASSERT(contact > 0 && contact < reference.rows());
  std::size_t active = 0;
  for (const auto& members : block->activeMembers()) active += members.size();
  TEST_ASSERT(active > 0);
}

TEUCHOS_UNIT_TEST(DualPreconditioner, PinnedRowsGiveNothing) {
  const Scene s = scene();
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), s);
  const auto M = make(feti, PreconditionerKind::Dirichlet);
  const Dense A = denseOf(*M), diagonal = gathered(*M->diagonal());
  int pinned = 0;
  for (Eigen::Index row = 0; row < A.rows(); ++row) {
    if (s.rows.pinned[row]) {
      ++pinned;
      TEST_EQUALITY(largest(A.row(row)), 0.0);
      TEST_EQUALITY(diagonal(row, 0), 0.0);
    } else {
      TEST_ASSERT(A(row, row) > 0 && diagonal(row, 0) > 0);
    }
  }
  TEST_ASSERT(pinned > 0);
}

// Without gluing M is the inverse of F on Ker G, whatever components are prescribed: one layer of elements on rollers, where every node
// on the surface has a row and hardly any unknown of it is touched.
TEUCHOS_UNIT_TEST(DualPreconditioner, InvertsFWhereNothingIsGlued) {
  SceneOptions options;
  options.lower = options.upper = {5, 1, 4};
  options.subdomains = 2;
  options.contact = false;
  options.hold = [](int, const Point& x) { return std::string(x[0] < 1e-9 ? "xyz" : "y"); };
  const Scene s = makeScene(options);
  TEST_EQUALITY(s.subdomains.size(), 2u);
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), s), dense = makeFeti(Tpetra::getDefaultComm(), s, LocalDual::Explicit);
  for (const Feti* f : {&feti, &dense}) {
    const auto GGT = Teuchos::rcp(new CoarseProblem(*f->comm, f->G->rows(), {}, {}));
    const Dense P = denseOf(Projector(f->G, GGT, Projector::Onto::KernelOfG)), F = denseOf(*f->F);
    const Dense product = P * denseOf(*make(*f, PreconditionerKind::Dirichlet)) * P * F * P;
    out << "largest difference to the projector " << largest(product - P) << "\n";
    TEST_ASSERT(largest(product - P) < 1e-4);
  }
}

// Its spectrum with F must be far tighter than that of F alone: that is what it is for.
TEUCHOS_UNIT_TEST(DualPreconditioner, TightensTheSpectrum) {
  SceneOptions options = heldScene(6);
  options.lower = options.upper = {6, 4, 4};
  const Scene s = makeScene(options);
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), s);
  const auto GGT = Teuchos::rcp(new CoarseProblem(*feti.comm, feti.G->rows(), {}, {}));
  const Dense P = denseOf(Projector(feti.G, GGT, Projector::Onto::KernelOfG)), F = denseOf(*feti.F);
  const auto spread = [](const Dense& A) {  // largest to smallest nonzero eigenvalue
    const Eigen::VectorXd d = realEigenvalues(A);
    double low = 1e300;
    for (double value : d)
      if (value > 1e-9 * d.maxCoeff()) low = std::min(low, value);
    return d.maxCoeff() / low;
  };
  const double plain = spread(P * F * P);
  const double better = spread(P * denseOf(*make(feti, PreconditionerKind::Dirichlet)) * P * F * P);
  out << "condition of P F P " << plain << ", preconditioned " << better << "\n";
  TEST_ASSERT(better < 0.25 * plain);
}

TEUCHOS_UNIT_TEST(RowGram, EqualsDensePseudoInverse) {
  const Scene s = scene();
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), s);
  const Dense B = denseB(s);
  for (bool scaled : {true, false}) {
    const Dense gram = scaled ? Dense(B * denseW(s).asDiagonal() * B.transpose()) : Dense(B * B.transpose());
    const Dense reference = densePseudoInverse(gram), x = someColumns(B.rows(), 1);
    const RowGram rowGram(feti.dealt.jump->multipliers(), scaled);
    const auto y = scatteredColumns(feti.map(), x);
    rowGram.apply(*y, *y);
    TEST_ASSERT(largest(gathered(*y) - reference * x) < 1e-11 * largest(reference));
    const double coupling = largest(gram - Dense(gram.diagonal().asDiagonal())) / largest(gram);
    out << "largest coupling of two rows " << coupling << "\n";
    // Means and differences of copies are orthogonal; unequal weights couple them.
    TEST_EQUALITY(coupling > 1e-3, scaled);
  }
}
