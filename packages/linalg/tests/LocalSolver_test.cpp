// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_LocalSolver.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <stdexcept>

#include "Haptos_Error.hpp"
#include "Haptos_FixingNodes.hpp"
#include "TestSubdomain.hpp"

using namespace Haptos;
using namespace Haptos::Testing;

namespace {

constexpr LocalSolverMethod methods[] = {LocalSolverMethod::Automatic, LocalSolverMethod::Klu2};

/// What makes K^+ the Moore-Penrose inverse; each relative, zero in exact arithmetic.
struct Defects {
  double generalised;  ///< |K K^+ K - K| / |K|
  double asymmetry;    ///< |K^+ - K^+T| / |K^+|
  double negative;     ///< -min eigenvalue / max eigenvalue
  double rigid;        ///< |R^T K^+| / |K^+|
};

Dense inverse(const LocalSolver& solver) {
  const auto n = solver.kernel().rows();
  Dense X(n, n);
  solver.solve(Dense::Identity(n, n), X);
  return X;
}

Defects measure(const TestSubdomain& s, const LocalSolver& solver) {
  const Dense X = inverse(solver), K = s.K;
  Dense complement(K.rows(), K.rows());  // K^+ K, of size one; K times the rounded K^+ would measure cond(K)
  solver.solve(K, complement);
  const Eigen::VectorXd eigenvalues = symmetricEigenvalues(0.5 * (X + X.transpose()));
  return {(K * complement - K).norm() / K.norm(), (X - X.transpose()).norm() / X.norm(),
          -eigenvalues[0] / eigenvalues[K.rows() - 1], (s.kernel.transpose() * X).norm() / X.norm()};
}

LocalSolver makeSolver(const TestSubdomain& s, LocalSolverMethod method = LocalSolverMethod::Automatic) {
  return LocalSolver(s.K, s.kernel, s.coordinates, method);
}

/// Condition number of K_reg over that of K on the complement of its kernel.
double conditionLoss(const TestSubdomain& s, const LocalSolver& solver) {
  const Eigen::VectorXd before = symmetricEigenvalues(s.K), after = symmetricEigenvalues(solver.regularized());
  const auto n = s.K.rows() - 1;
  const double free = before[n] / before[s.kernel.cols()];
  return after[n] / after[0] / free;
}

/// Whether the elements fill a box of a grid of n[0] x n[1] x n[2].
bool isBrick(const std::vector<int>& elements, const std::array<int, 3>& n) {
  std::array<std::set<int>, 3> range;
  for (const int e : elements) {
    range[0].insert(e % n[0]);
    range[1].insert(e / n[0] % n[1]);
    range[2].insert(e / n[0] / n[1]);
  }
  return elements.size() == range[0].size() * range[1].size() * range[2].size();
}

/// Parts of a distorted box; the numbers are such that METIS finds no bricks.
std::vector<TestSubdomain> jaggedParts(double E, double nu) {
  const std::array<int, 3> n{8, 7, 5};
  const auto mesh = boxMesh(n, {1.6, 1.4, 1.0}, 0.15);
  std::vector<TestSubdomain> parts;
  for (const auto& elements : cutByMetis(mesh, 6)) {
    if (isBrick(elements, n)) throw std::logic_error("jaggedParts: a part is a brick");
    parts.push_back(makeSubdomain(mesh, elements, E, nu));
  }
  return parts;
}

/// One subdomain of two METIS parts that have no node in common.
TestSubdomain twoIslands() {
  const auto mesh = boxMesh({14, 3, 3}, {4, 1, 1}, 0.1);
  const auto parts = cutByMetis(mesh, 6);
  for (std::size_t p = 1; p < parts.size(); ++p) {
    auto both = parts[0];
    both.insert(both.end(), parts[p].begin(), parts[p].end());
    auto s = makeSubdomain(mesh, both, 2e5, 0.3);
    if (s.kernel.cols() == 12) return s;
  }
  throw std::logic_error("no two parts without a common node");
}

#define TEST_MOORE_PENROSE(s, solver, tolerance)                                                              \
  {                                                                                                           \
    const auto d = measure(s, solver);                                                                        \
    out << (solver).methodName() << " n " << (s).K.rows() << " kernel " << (s).kernel.cols() << ": KK+K-K "   \
        << d.generalised << " asym " << d.asymmetry << " neg " << d.negative << " rigid " << d.rigid << "\n"; \
    TEST_COMPARE(d.generalised, <=, 1e-12);                                                                   \
    TEST_COMPARE(d.asymmetry, <=, tolerance);                                                                 \
    TEST_COMPARE(d.negative, <=, tolerance);                                                                  \
    TEST_COMPARE(d.rigid, <=, 1e-13);                                                                         \
  }

}  // namespace

TEUCHOS_UNIT_TEST(LocalSolver, InvertsJaggedParts) {
  for (const auto& s : jaggedParts(2e5, 0.3)) {
    TEST_EQUALITY(s.kernel.cols(), 6);
    for (const auto method : methods) TEST_MOORE_PENROSE(s, makeSolver(s, method), 1e-12);
  }
}

// A build without CHOLMOD refuses it.
TEUCHOS_UNIT_TEST(LocalSolver, MethodsAgree) {
  if (!hasCholmod()) TEST_THROW(makeSolver(jaggedParts(2e5, 0.3).front(), LocalSolverMethod::Cholmod), InputError);
  if (!hasCholmod()) return;
  for (const auto& s : jaggedParts(2e5, 0.3)) {
    const auto cholmod = makeSolver(s, LocalSolverMethod::Cholmod), klu2 = makeSolver(s, LocalSolverMethod::Klu2);
    TEST_EQUALITY(std::string(cholmod.methodName()), "CHOLMOD");
    TEST_EQUALITY(std::string(klu2.methodName()), "KLU2");
    const Dense X = inverse(cholmod);
    TEST_COMPARE((X - inverse(klu2)).norm(), <=, 1e-11 * X.norm());
    TEST_COMPARE(cholmod.factorEntries(), <, klu2.factorEntries());
  }
}

TEUCHOS_UNIT_TEST(LocalSolver, DoesNotDependOnUnits) {
  const auto mesh = boxMesh({4, 4, 4}, {1, 1, 1}, 0.15);
  const auto part = cutByMetis(mesh, 2)[0];
  const auto reference = makeSubdomain(mesh, part, 1.0, 0.3);
  const Dense X = inverse(makeSolver(reference));
  for (const double E : {1e-3, 1e3, 1e11})
    for (const double length : {1e-6, 1e4}) {
      auto scaled = mesh;
      for (auto& node : scaled.nodes)
        for (double& x : node) x *= length;
      const auto s = makeSubdomain(scaled, part, E, 0.3);
      const auto solver = makeSolver(s);
      TEST_MOORE_PENROSE(s, solver, 1e-12);
      TEST_COMPARE((E * length * inverse(solver) - X).norm(), <=, 1e-11 * X.norm());  // K is E x length x numbers
      TEST_COMPARE_ARRAYS(solver.fixingNodes(), makeSolver(reference).fixingNodes());
    }
}

TEUCHOS_UNIT_TEST(LocalSolver, TwoPiecesHaveTwelveRigidMotions) {
  const auto s = twoIslands();
  TEST_EQUALITY(s.facePieces, 2);
  for (const auto method : methods) TEST_MOORE_PENROSE(s, makeSolver(s, method), 1e-12);
  // any orthonormal basis of the kernel will do, also one that mixes the pieces
  auto mixed = s;
  mixed.kernel = s.kernel * squareQ(Dense::Random(12, 12));
  TEST_MOORE_PENROSE(mixed, makeSolver(mixed), 1e-12);
}

/// Three elements in a row, joined by an edge and by a corner: 6 + 1 + 3 motions without energy in ONE connected piece.
TEUCHOS_UNIT_TEST(LocalSolver, HingedElementsAreHeld) {
  const auto mesh = boxMesh({3, 3, 2}, {1, 1, 1}, 0.1);
  const auto s = makeSubdomain(mesh, {0, 4, 17}, 2e5, 0.3);
  TEST_EQUALITY(s.facePieces, 3);
  TEST_EQUALITY(s.kernel.cols(), 10);
  for (const auto method : methods) TEST_MOORE_PENROSE(s, makeSolver(s, method), 1e-12);
}

TEUCHOS_UNIT_TEST(LocalSolver, NeedlesAndNearlyIncompressible) {
  const auto needle = boxMesh({4, 3, 3}, {100, 1, 1}, 0.05), beam = boxMesh({100, 1, 1}, {100, 1, 1}, 0.05);
  const auto plate = boxMesh({6, 6, 1}, {100, 100, 1}, 0.02), cube = boxMesh({4, 4, 4}, {1, 1, 1}, 0.1);
  for (const auto method : methods) {
    for (const auto* mesh : {&needle, &beam, &plate}) {
      const auto s = makeSubdomain(*mesh, allElements(*mesh), 2e5, 0.3);
      TEST_MOORE_PENROSE(s, makeSolver(s, method), 1e-8);
    }
    const auto s = makeSubdomain(cube, cutByMetis(cube, 2)[1], 2e5, 0.4999);
    TEST_MOORE_PENROSE(s, makeSolver(s, method), 1e-9);
  }
}

TEUCHOS_UNIT_TEST(LocalSolver, FixingNodesKeepTheConditionNumber) {
  const auto needle = boxMesh({4, 3, 3}, {100, 1, 1}, 0.05), beam = boxMesh({40, 1, 1}, {40, 1, 1}, 0.05);
  std::vector<TestSubdomain> all = jaggedParts(1.0, 0.3);
  all.push_back(twoIslands());
  for (const auto* mesh : {&needle, &beam}) all.push_back(makeSubdomain(*mesh, allElements(*mesh), 1.0, 0.3));
  for (const auto& s : all) {
    const auto solver = makeSolver(s);
    const double loss = conditionLoss(s, solver);
    out << s.coordinates.size() << " nodes, " << solver.fixingNodes().size() << " fixing, condition x " << loss << "\n";
    TEST_COMPARE(loss, <=, 20.0);
    TEST_COMPARE(solver.fixingNodes().size(), <=, 8u * std::size_t(s.facePieces));
  }
}

TEUCHOS_UNIT_TEST(LocalSolver, ManyColumnsEqualOneByOne) {
  const auto s = jaggedParts(2e5, 0.3)[2];
  for (const auto method : methods) {
    const auto solver = makeSolver(s, method);
    const Dense B = Dense::Random(s.K.rows() + 5, 150);
    Dense many = Dense::Constant(s.K.rows() + 9, 150, 3.0);
    solver.solve(B.middleRows(2, s.K.rows()), many.middleRows(4, s.K.rows()));  // columns lie apart in memory
    TEST_EQUALITY(solver.counts().solves, 1 + 3);  // the check at construction, and blocks of 64, 64 and 22
    for (int j = 0; j < 150; j += 7) {
      Eigen::VectorXd one(s.K.rows());
      solver.solve(B.col(j).segment(2, s.K.rows()), one);
      TEST_COMPARE((one - many.col(j).segment(4, s.K.rows())).norm(), <=, 1e-12 * one.norm());
    }
    TEST_EQUALITY((many.topRows(4).array() - 3.0).abs().maxCoeff(), 0.0);
    TEST_EQUALITY((many.bottomRows(5).array() - 3.0).abs().maxCoeff(), 0.0);
    TEST_EQUALITY(solver.counts().symbolic, 1);
    TEST_EQUALITY(solver.counts().numeric, 1);
  }
}

TEUCHOS_UNIT_TEST(LocalSolver, DefiniteMatrixNeedsNoKernel) {
  auto s = jaggedParts(2e5, 0.3)[0];
  for (Eigen::Index i = 0; i < s.K.rows(); ++i) s.K.coeffRef(i, i) += 1e4;
  s.kernel.resize(s.K.rows(), 0);
  for (const auto method : methods) {
    const auto solver = makeSolver(s, method);
    TEST_ASSERT(solver.fixingNodes().empty());
    TEST_COMPARE((s.K * inverse(solver) - Dense::Identity(s.K.rows(), s.K.rows())).norm(), <=, 1e-10);
  }
}

// A column of c entries below and on the diagonal takes c^2 multiplications.
TEUCHOS_UNIT_TEST(LocalSolverFactor, CountsItsWork) {
  const int n = 150;  // few enough would stay a simplicial factor, in double
  const Dense A = 40.0 * Dense::Identity(n, n) + Dense::Ones(n, n);
  for (const auto precision : {FactorPrecision::Double, FactorPrecision::Single}) {
    const LocalSolverFactor factor(A.sparseView(), LocalSolverMethod::Automatic, precision);
    const FactorWork work = factor.work();
    TEST_COMPARE(work.entries, >=, n * (n + 1) / 2);
    TEST_EQUALITY(work.flops, hasCholmod() ? n * (n + 1.0) * (2 * n + 1) / 6 : 0.0);
    TEST_EQUALITY(work.bytesRead, (hasCholmod() && precision == FactorPrecision::Single ? 8 : 16) * work.entries);
  }
}

/// Stiff inclusions, E 1e8 times the rest.  The backward error of every single row, also the soft ones, after Oettli
/// and Prager: |B - K X| over |K| |X| + |B|.
TEUCHOS_UNIT_TEST(LocalSolver, StiffnessContrastKeepsEveryRowAccurate) {
  const auto mesh = boxMesh({5, 5, 5}, {1, 1, 1}, 0.1);
  const auto s = makeSubdomain(mesh, allElements(mesh), [](int e) { return e % 3 == 0 ? 1e8 : 1.0; }, 0.3);
  Dense B = Dense::Random(s.K.rows(), 20), X[2] = {B, B};
  B -= s.kernel * (s.kernel.transpose() * B).eval();
  for (const auto method : methods) {
    const auto solver = makeSolver(s, method);
    double rowwise[2];
    for (const int steps : {0, 1}) {
      solver.solve(B, X[steps], steps);
      const Dense scale = s.K.cwiseAbs() * X[steps].cwiseAbs() + B.cwiseAbs();
      rowwise[steps] = (B - s.K * X[steps]).cwiseAbs().cwiseQuotient(scale).maxCoeff();
    }
    out << solver.methodName() << ": row-wise backward error " << rowwise[0] << ", refined " << rowwise[1] << "\n";
    TEST_COMPARE(rowwise[0], <=, 2e-14);
    TEST_COMPARE(rowwise[1], <=, 1e-14);
    TEST_COMPARE((X[1] - X[0]).norm(), >, 0.0);
  }
}

TEUCHOS_UNIT_TEST(LocalSolver, RefusesAWrongKernel) {
  const auto s = jaggedParts(2e5, 0.3)[1];
  for (const auto method : methods) {
    auto missing = s;  // K keeps one motion without energy that the kernel does not list
    missing.kernel = s.kernel.leftCols(5).eval();
    TEST_THROW(makeSolver(missing, method), std::runtime_error);
    auto foreign = s;
    foreign.kernel.col(3).setUnit(7);
    TEST_THROW(makeSolver(foreign, method), std::runtime_error);
  }
}
