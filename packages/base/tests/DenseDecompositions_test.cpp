// SPDX-License-Identifier: BSD-3-Clause
// Decompositions of ours, or of LAPACK behind our names, of matrices whose answers are known.
#include "Haptos_DenseDecompositions.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>
#include <limits>

#include "DenseAlgebra.hpp"

using namespace Haptos;
using Dense = Eigen::MatrixXd;
using Values = Eigen::VectorXd;

namespace {

Dense numbers(Eigen::Index rows, Eigen::Index columns, double phase) {
  return Dense::NullaryExpr(rows, columns, [&](Eigen::Index i, Eigen::Index j) { return std::sin(phase + 1.7 * double(i * i % 1009) + 2.3 * double(j) * double(i % 31 + 1)); });
}

// A v = theta B v with theta as given: B = L L^T, A = L Q diag(theta) Q^T L^T
struct Pencil {
  Dense A, B;
  explicit Pencil(const Values& theta) {
    const Eigen::Index n = theta.size();
    const Dense Q = Testing::squareQ(numbers(n, n, 0.3));
    Dense L = Dense::Zero(n, n);
    for (Eigen::Index j = 0; j < n; ++j)
      for (Eigen::Index i = j; i < n; ++i) L(i, j) = i == j ? 1 + 0.5 * std::sin(double(j)) : 0.3 * std::sin(double(3 * i + j)) / double(1 + i - j);
    A = L * Q * theta.asDiagonal() * Q.transpose() * L.transpose();
    B = L * L.transpose();
  }
};

}  // namespace

// Some, some in pairs that are the same, one that round-off left negative, none, all.
TEUCHOS_UNIT_TEST(EigenBelow, FindsAllBelowABound) {
  for (const auto& [n, few] : {std::pair(300, 40), {60, 0}, {60, 60}, {1, 1}}) {
    Values mu(n);
    for (Eigen::Index k = 0; k < n; ++k) mu[k] = k < few ? 0.1 * double((k + 1) / 2 * 2) / few : 0.2 + double(k);
    if (few > 0) mu[0] = -1e-13;
    const Dense Q = Testing::squareQ(numbers(n, n, 0.3)), A = Q * mu.asDiagonal() * Q.transpose();
    const EigenBelow found(A, 0.15);
    TEST_EQUALITY(found.values.size(), Eigen::Index(few));
    TEST_EQUALITY(found.vectors.cols(), Eigen::Index(few));
    if (found.values.size() != few || few == 0) continue;
    TEST_COMPARE((found.values - mu.head(few)).cwiseAbs().maxCoeff(), <, 1e-12 * double(n));
    TEST_COMPARE((found.vectors.transpose() * found.vectors - Dense::Identity(few, few)).cwiseAbs().maxCoeff(), <, 1e-11);
    TEST_COMPARE((A * found.vectors - found.vectors * found.values.asDiagonal()).cwiseAbs().maxCoeff(), <, 1e-11 * double(n));
  }
}

// A few of them above the bound in a matrix that is large, some of those close together; with all of them above it, and in a small one; none, or one that
// is hardly above it.
TEUCHOS_UNIT_TEST(LargestEigen, FindsAllAboveABound) {
  for (const auto& [n, many] : {std::pair(700, 50), {700, 600}, {90, 20}, {90, 0}, {90, 1}}) {
    Values theta(n);
    for (Eigen::Index k = 0; k < n; ++k) theta[k] = k < n - many ? 3.5 * double(k + 1) / double(n - many) : 5 * std::pow(200.0, double((k - n + many) / 2 * 2) / many);
    if (many == 1) theta[n - 1] = 4.001;
    const Pencil pencil(theta);
    const LargestEigen found(pencil.A, pencil.B, 4);
    TEST_EQUALITY(found.values.size(), Eigen::Index(many));
    TEST_EQUALITY(found.vectors.cols(), Eigen::Index(many));
    if (found.values.size() != many || many == 0) continue;
    for (Eigen::Index k = 0; k < many; ++k) TEST_COMPARE(std::abs(found.values[k] / theta[n - many + k] - 1), <, 0.01);
    const Dense &V = found.vectors, gram = V.transpose() * pencil.B * V;
    TEST_COMPARE((gram - Dense::Identity(many, many)).cwiseAbs().maxCoeff(), <, 1e-9);
    const Dense left = pencil.A * V - pencil.B * V * found.values.asDiagonal(), BInverseLeft = Testing::choleskySolve(pencil.B, left);
    for (Eigen::Index k = 0; k < many; ++k)  // in the norm of B^-1
      TEST_COMPARE(std::sqrt(left.col(k).dot(BInverseLeft.col(k))), <, 0.031 * found.values[k]);
  }
}

TEUCHOS_UNIT_TEST(LargestEigen, FindsNoneOfWhatIsNotDefinite) {
  for (const Eigen::Index n : {30, 600}) {
    Dense B = Dense::Identity(n, n);
    B(n - 1, n - 1) = -1;
    TEST_EQUALITY(LargestEigen(2 * Dense::Identity(n, n), B, 1).values.size(), 0);
    TEST_EQUALITY(LargestEigen(0.5 * Dense::Identity(n, n), Dense::Identity(n, n), 1).values.size(), 0);
  }
}

TEUCHOS_UNIT_TEST(SymmetricTimes, ReadsTheLowerTriangle) {
  const Dense A = numbers(70, 70, 0.7), symmetric = A.selfadjointView<Eigen::Lower>();
  const Values x = numbers(70, 1, 0.2);
  TEST_COMPARE((symmetricTimes(A, x) - symmetric * x).norm(), <, 1e-13 * A.norm() * x.norm());
  TEST_EQUALITY(symmetricTimes(Dense(0, 0), Values(0)).size(), 0);
}

// Of blocks of larger matrices, of one column and of several, and of matrices without rows or columns.
TEUCHOS_UNIT_TEST(Product, IsThatOfAnyShape) {
  const Dense whole = numbers(40, 30, 0.4), X = numbers(40, 5, 1.3);
  for (const Eigen::Index rows : {0, 1, 25})
    for (const Eigen::Index columns : {0, 1, 20}) {
      const auto A = whole.block(3, 2, rows, columns);
      for (const Eigen::Index width : {0, 1, 5}) {
        const Dense right = X.topLeftCorner(columns, width), left = X.topLeftCorner(rows, width);
        TEST_COMPARE((product(A, right) - Dense(A) * right).norm(), <=, 1e-13);
        TEST_COMPARE((transposedProduct(A, left) - Dense(A).transpose() * left).norm(), <=, 1e-13);
      }
      Values y = numbers(rows, 1, 0.7), z = numbers(columns, 1, 0.9);
      const Values x = numbers(columns, 1, 0.2), w = numbers(rows, 1, 0.3), wantedY = y - 2 * A * x, wantedZ = z + 3 * A.transpose() * w;
      addProduct(-2, A, x, y);
      addTransposedProduct(3, A, w, z);
      TEST_COMPARE((y - wantedY).norm() + (z - wantedZ).norm(), <=, 1e-13);
    }
}

TEUCHOS_UNIT_TEST(PivotedCholesky, LeavesDependentRowsOut) {
  const Eigen::Index n = 40, rank = 25;
  const Dense X = numbers(n, rank, 0.1), A = X * X.transpose(), b = A * numbers(n, 2, 0.9);
  const PivotedCholesky factor(A, 1e-10);
  TEST_EQUALITY(factor.rank(), rank);
  const Dense x = factor.solve(b);
  TEST_COMPARE((A * x - b).norm(), <, 1e-9 * b.norm());
  TEST_EQUALITY((x.col(0).array() == 0).count(), n - rank);
  const Dense half = factor.solveHalf(b);
  TEST_EQUALITY(half.rows(), rank);
  TEST_COMPARE((half.transpose() * half - b.transpose() * x).norm(), <, 1e-9 * (b.transpose() * x).norm());
  TEST_EQUALITY(factor.solve(Dense(n, 0)).cols(), 0);
  TEST_EQUALITY(PivotedCholesky(Dense::Zero(3, 3), 1e-10).solve(Dense::Ones(3, 1)).norm(), 0.0);
}

TEUCHOS_UNIT_TEST(DenseFactor, SolvesOrSaysThatItCannot) {
  using Kind = DenseFactor::Kind;
  const Dense X = numbers(30, 30, 0.2), S = X * X.transpose() + Dense::Identity(30, 30), b = numbers(30, 3, 0.5);
  TEST_COMPARE((X * DenseFactor(X, Kind::Lu).solve(b) - b).norm(), <, 1e-10 * b.norm());
  Dense lower = S;
  lower.triangularView<Eigen::StrictlyUpper>().setConstant(std::numeric_limits<double>::quiet_NaN());
  TEST_COMPARE((S * DenseFactor(lower, Kind::Cholesky).solve(b) - b).norm(), <, 1e-10 * b.norm());
  TEST_ASSERT(!DenseFactor(-S, Kind::Cholesky).solve(b).allFinite());
  TEST_ASSERT(!DenseFactor(Dense::Zero(30, 30), Kind::Lu).solve(b).allFinite());
  TEST_EQUALITY(DenseFactor().solve(Dense(0, 2)).size(), 0);
}

TEUCHOS_UNIT_TEST(AddGram, AddsToTheLowerTriangle) {
  const Dense T = numbers(7, 5, 0.4), before = numbers(5, 5, 0.6);
  Dense A = before;
  addGram(T, A);
  const Dense expected = before + T.transpose() * T;
  TEST_COMPARE(Dense((A - expected).triangularView<Eigen::Lower>()).cwiseAbs().maxCoeff(), <, 1e-14);
}

// Of three vectors in the kernel, of none, of more than were thought of; b is not in the image.
TEUCHOS_UNIT_TEST(SolveNearlySingular, IsTheShortestOfLeastResidual) {
  constexpr Eigen::Index n = 250, kMost = 5;
  const Dense P = Testing::squareQ(numbers(n, n, 0.9)), Q = Testing::squareQ(numbers(n, n, 0.3));
  const Values b = numbers(n, 1, 0.2);
  for (const Eigen::Index kernel : {3, 0, 8}) {
    Values sigma(n), inverse = Values::Zero(n);
    for (Eigen::Index k = 0; k < n; ++k) sigma[k] = k < kernel ? 0.0 : std::pow(10.0, 3 * std::sin(double(k)));
    inverse.tail(n - kernel) = sigma.tail(n - kernel).cwiseInverse();
    const Values expected = Q * inverse.asDiagonal() * (P.transpose() * b);
    const Values found = solveNearlySingular(P * sigma.asDiagonal() * Q.transpose(), b, kMost);
    TEST_COMPARE((found - expected).norm(), <, 1e-8 * expected.norm());
  }
  TEST_COMPARE(solveNearlySingular(Dense::Zero(n, n), b, kMost).norm(), <=, 0.0);
}

// The kernel given, given in part (the rest is found), and not at all.
TEUCHOS_UNIT_TEST(PseudoInverse, LeavesTheKernelOut) {
  constexpr Eigen::Index n = 150, kFree = 7;
  const Dense Q = Testing::squareQ(numbers(n, n, 0.9));
  Values theta(n), inverse = Values::Zero(n);
  for (Eigen::Index k = 0; k < n; ++k) theta[k] = k < kFree ? 0.0 : std::pow(10.0, 3 * std::sin(double(k)));
  inverse.tail(n - kFree) = theta.tail(n - kFree).cwiseInverse();
  const Dense A = Q * theta.asDiagonal() * Q.transpose();
  const Dense expected = Q * inverse.asDiagonal() * Q.transpose();
  for (const Eigen::Index given : {kFree, Eigen::Index(3), Eigen::Index(0)}) {
    const Dense found = pseudoInverse(A, Q.leftCols(given), 1e-10);
    TEST_COMPARE((found - expected).cwiseAbs().maxCoeff(), <=, 1e-8 * expected.maxCoeff());
  }
}
