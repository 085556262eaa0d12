// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CholmodSolver.hpp"

#include <Teuchos_DefaultSerialComm.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_MultiVector.hpp>
#include <cmath>

#include "Haptos_Types_fwd.hpp"

using namespace Haptos;
using Teuchos::rcp;
using Solver = CholmodSolver<CrsMatrix, MultiVector>;

namespace {

/// Seven-point Laplacian + shift on q^3 points, row `weak` with diagonal `weakDiagonal` if weak >= 0.
RCP<CrsMatrix> makeGrid(int q, double shift, int weak = -1, double weakDiagonal = 0) {
  const auto map = rcp(new Map(q * q * q, 0, rcp(new Teuchos::SerialComm<int>())));
  const auto a = rcp(new CrsMatrix(map, 7));
  for (int row = 0; row < q * q * q; ++row) {
    const GlobalOrdinal r = row;
    const double diagonal = row == weak ? weakDiagonal : 6.0 + shift, minusOne = -1.0;
    a->insertGlobalValues(r, 1, &diagonal, &r);
    const int at[3] = {row % q, row / q % q, row / q / q}, step[3] = {1, q, q * q};
    for (int c = 0; c < 3; ++c)
      for (const int side : {-1, 1})
        if (at[c] + side >= 0 && at[c] + side < q) {
          const GlobalOrdinal neighbour = row + side * step[c];
          a->insertGlobalValues(r, 1, &minusOne, &neighbour);
        }
  }
  a->fillComplete();
  return a;
}

/// Largest |A X - B| relative to |B|.
double residual(const CrsMatrix& a, const MultiVector& x, const MultiVector& b) {
  MultiVector r(b, Teuchos::Copy);
  a.apply(x, r, Teuchos::NO_TRANS, 1.0, -1.0);
  Teuchos::Array<double> top(b.getNumVectors()), bottom(b.getNumVectors());
  r.norm2(top());
  b.norm2(bottom());
  double worst = 0;
  for (int j = 0; j < top.size(); ++j) worst = std::max(worst, top[j] / bottom[j]);
  return worst;
}

}  // namespace

TEUCHOS_UNIT_TEST(CholmodSolver, RunsThroughTheAmesos2Interface) {
  const auto a = makeGrid(9, 0.1);
  const auto x = rcp(new MultiVector(a->getRowMap(), 5)), b = rcp(new MultiVector(a->getRowMap(), 5));
  b->randomize();
  const RCP<Amesos2::Solver<CrsMatrix, MultiVector>> solver = rcp(new Solver(a, x, b));
  TEST_EQUALITY(solver->name(), std::string("CHOLMOD"));
  TEST_ASSERT(solver->matrixShapeOK());

  solver->symbolicFactorization();
  TEST_EQUALITY(solver->getStatus().getNumNumericFact(), 0);
  solver->numericFactorization();
  solver->solve();
  TEST_COMPARE(residual(*a, *x, *b), <=, 1e-14);
  TEST_EQUALITY(solver->getStatus().getNumSymbolicFact(), 1);
  TEST_EQUALITY(solver->getStatus().getNumNumericFact(), 1);
  TEST_EQUALITY(solver->getStatus().getNumSolve(), 1);
  TEST_COMPARE(solver->getStatus().getNnzLU(), >, a->getGlobalNumEntries() / 2);
}

TEUCHOS_UNIT_TEST(CholmodSolver, NewValuesKeepTheSymbolicPhase) {
  const auto first = makeGrid(6, 0.1), second = makeGrid(6, 40.0);
  const auto x = rcp(new MultiVector(first->getRowMap(), 1)), b = rcp(new MultiVector(first->getRowMap(), 1));
  b->randomize();
  Solver solver(first, x, b);
  solver.symbolicFactorization().numericFactorization();
  solver.solve();
  solver.setA(second, Amesos2::SYMBFACT);
  solver.numericFactorization();
  solver.solve();
  TEST_COMPARE(residual(*second, *x, *b), <=, 1e-14);
  TEST_COMPARE(residual(*first, *x, *b), >, 0.1);
  TEST_EQUALITY(solver.getStatus().getNumSymbolicFact(), 1);
}

TEUCHOS_UNIT_TEST(CholmodSolver, WidthMayChangeBetweenSolves) {
  const auto a = makeGrid(7, 0.1);
  Solver solver(a, Teuchos::null, Teuchos::null);
  for (const int width : {1, 17, 1, 4}) {
    MultiVector x(a->getRowMap(), width), b(a->getRowMap(), width);
    b.randomize();
    solver.solve(&x, &b);
    TEST_COMPARE(residual(*a, x, b), <=, 1e-14);
  }
  TEST_EQUALITY(solver.getStatus().getNumSolve(), 4);
}

/// Both kernels of CHOLMOD must refuse: 4^3 points are factored row by row, 14^3 by supernodes.
TEUCHOS_UNIT_TEST(CholmodSolver, NamesTheColumnOfAnIndefiniteMatrix) {
  for (const int q : {4, 14}) {
    const int weak = q * q * q / 2 + 1;
    Solver solver(makeGrid(q, 0.1, weak, -3.0), Teuchos::null, Teuchos::null);
    solver.symbolicFactorization();
    std::string message;
    try {
      solver.numericFactorization();
    } catch (const std::runtime_error& e) {
      message = e.what();
    }
    TEST_ASSERT(message.find("not positive definite: pivot of column " + std::to_string(weak)) != std::string::npos);
    out << message << "\n";
    TEST_EQUALITY(solver.getStatus().getNumNumericFact(), 0);
  }
}

// L in single precision: the answer has its digits, and refinement the rest.
TEUCHOS_UNIT_TEST(CholmodSolver, KeepsASupernodalFactorInSinglePrecision) {
  const auto a = makeGrid(12, 0.1);
  for (int columns : {1, 5}) {
    const auto x = rcp(new MultiVector(a->getRowMap(), columns)), b = rcp(new MultiVector(a->getRowMap(), columns));
    b->randomize();
    for (bool single : {false, true}) {
      Solver solver(a, x, b);
      const auto list = Teuchos::parameterList("Amesos2");
      list->sublist("CHOLMOD").set("Single Precision", single);
      solver.setParameters(list);
      solver.symbolicFactorization().numericFactorization().solve();
      const double error = residual(*a, *x, *b);
      TEST_COMPARE(error, <=, single ? 1e-4 : 1e-12);
      if (single) TEST_COMPARE(error, >, 1e-10);
      TEST_ASSERT(solver.getStatus().getNnzLU() > 0);
    }
  }
}

// Another matrix of the same pattern goes through the same analysis.
TEUCHOS_UNIT_TEST(CholmodSolver, FactorsAnewWithTheSameAnalysis) {
  const auto a = makeGrid(12, 0.1);
  const auto x = rcp(new MultiVector(a->getRowMap(), 2)), b = rcp(new MultiVector(a->getRowMap(), 2));
  b->randomize();
  Solver solver(a, x, b);
  solver.symbolicFactorization().numericFactorization();
  const auto entries = solver.getStatus().getNnzLU();
  a->resumeFill();
  a->scale(3.0);
  a->fillComplete();
  solver.numericFactorization().solve();
  TEST_COMPARE(residual(*a, *x, *b), <=, 1e-12);
  TEST_EQUALITY(solver.getStatus().getNnzLU(), entries);
}
