// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_MpgpIter.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>

#include "Haptos_StatusTestProjectedGradient.hpp"
#include "QpTestProblem.hpp"

namespace {

using namespace HaptosTest;
using Iter = MpgpIter<double, MultiVector, Operator>;
using Program = QuadraticProgram<double, MultiVector, Operator>;
using StopTest = StatusTestProjectedGradient<double, MultiVector, Operator>;

/// A string on obstacles (bounds) with pairs in ellipses between them: tridiagonal, groups of three.
DenseProblem makeString(int groups, double force) {
  DenseProblem d;
  d.groups = groups;
  const int n = 3 * groups;
  d.A = DenseMatrix::Zero(n, n);
  for (int i = 0; i < n; ++i) {
    d.A(i, i) = 2;
    if (i > 0) d.A(i, i - 1) = d.A(i - 1, i) = -1;
  }
  d.Q = DenseMatrix::Zero(n, n);
  d.b = DenseVector::NullaryExpr(n, [&](Eigen::Index i) { return -force * (1 + 0.5 * std::sin(0.2 * double(i))); });
  d.lower = DenseVector::NullaryExpr(groups, [](Eigen::Index i) { return -20.0 - 2.0 * double(i); });
  d.semiAxes.resize(2, groups);
  for (int i = 0; i < groups; ++i)  // the bounds hold one half, the ellipses the other
    if (2 * i < groups)
      d.semiAxes.col(i) << 200.0, 100.0;
    else
      d.semiAxes.col(i) << 15.0 + i, 60.0 - i;
  d.x0 = DenseVector::Zero(n);
  return d;
}

struct Result {
  MpgpCounts counts;
  DenseVector x;
  int operatorCalls;
  double norm;
};

Result solve(const DenseProblem& d, double norm, double tolerance, MpgpOptions options) {
  const auto map = d.makeMap();
  const auto a = rcp(new DenseOperator(map, d.A));
  const auto x = rcp(new MultiVector(map, 1)), b = rcp(new MultiVector(map, 1));
  scatter(d.b, *b);
  const auto program = rcp(new Program(a, x, b, d.makeSet(map)));
  const auto stop = rcp(new StopTest(tolerance * d.b.norm(), 20000));
  OperatorNorm given;
  given.value = norm;
  Iter iter(program, stop, given, options);
  iter.iterate();
  return {iter.counts(), gather(*x), a->applications, iter.operatorNorm().value};
}

void checkKkt(const DenseProblem& d, const DenseVector& x, double tolerance, bool& success,
              Teuchos::FancyOStream& out) {
  const DenseVector g = d.A * x - d.b;
  int onBound = 0, onEllipse = 0, inside = 0;
  for (int i = 0; i < d.groups; ++i) {
    TEST_ASSERT(x[3 * i] >= d.lower[i]);
    const bool atBound = x[3 * i] == d.lower[i];
    onBound += atBound;
    if (atBound) TEST_COMPARE(g[3 * i], >=, -tolerance);
    if (!atBound) TEST_COMPARE(std::abs(g[3 * i]), <=, tolerance);
    const double u = x[3 * i + 1] / d.semiAxes(0, i), w = x[3 * i + 2] / d.semiAxes(1, i);
    TEST_COMPARE(std::hypot(u, w), <=, 1 + 1e-13);
    const double n1 = u / d.semiAxes(0, i), n2 = w / d.semiAxes(1, i);  // outward normal
    const double g1 = g[3 * i + 1], g2 = g[3 * i + 2];
    if (std::hypot(u, w) < 1 - 1e-9) {
      ++inside;
      TEST_COMPARE(std::hypot(g1, g2), <=, tolerance);
    } else {
      ++onEllipse;  // -g points along the outward normal
      TEST_COMPARE(std::abs(g1 * n2 - g2 * n1) / std::hypot(n1, n2), <=, tolerance);
      TEST_COMPARE(g1 * n1 + g2 * n2, <=, tolerance);
    }
  }
  out << onBound << " at their bound, " << onEllipse << " on their ellipse, " << inside << " inside\n";
  TEST_ASSERT(onBound > 3 && onBound < d.groups - 3 && onEllipse > 3 && inside > 3);
}

TEUCHOS_UNIT_TEST(MpgpIter, StringOnObstaclesKeepsKktConditions) {
  const DenseProblem d = makeString(30, 0.3);
  for (const Expansion expansion : {Expansion::FixedStep, Expansion::ProjectedCg, Expansion::Automatic})
    for (const double stepLength : {1.0, 1.9}) {
      MpgpOptions options;
      options.expansion = expansion;
      options.stepLength = stepLength;
      const Result r = solve(d, 4.0, 1e-11, options);
      const MpgpCounts& c = r.counts;
      out << "cg " << c.cg << ", expansion " << c.expansion << ", proportioning " << c.proportioning << ", rejected "
          << c.rejected << ", applications " << c.hessianApplications << "\n";
      TEST_ASSERT(c.cg > 10 && c.expansion > 2 && c.proportioning > 2);  // every kind of step was taken
      TEST_EQUALITY(c.hessianApplications, r.operatorCalls);             // every product is counted
      TEST_EQUALITY(c.hessianApplications, 1 + c.cg + 2 * c.expansion + c.proportioning + c.rejected);
      checkKkt(d, r.x, 1e-9, success, out);
    }
}

TEUCHOS_UNIT_TEST(MpgpIter, CorrectsANormThatIsTooSmall) {
  const DenseProblem d = makeString(30, 0.3);
  MpgpOptions options;
  options.expansion = Expansion::FixedStep;
  options.stepLength = 1.9;
  const Result r = solve(d, 0.05, 1e-11, options);  // true: 4; the fixed step would diverge
  TEST_ASSERT(r.counts.normCorrections > 0);
  TEST_COMPARE(r.norm, >, 1.0);
  checkKkt(d, r.x, 1e-9, success, out);
}

TEUCHOS_UNIT_TEST(MpgpIter, EndsAtTheLongestStep) {
  // A = 2 I, and a step of 2 / ||A||, which mirrors x in the solution: the cost stays up to round-off, as does the norm.
  DenseProblem d = makeString(1, 0);
  d.A = 2 * DenseMatrix::Identity(3, 3);
  d.b << 10, 0, 0;
  d.lower[0] = 0;
  d.semiAxes.setConstant(1);
  MpgpOptions options;
  options.stepLength = 2;
  const Result r = solve(d, 2 * (1 - 1e-13), 1e-10, options);
  TEST_FLOATING_EQUALITY(r.x[0], 5.0, 1e-10);
  TEST_ASSERT(r.counts.proportioning > 0);
  TEST_COMPARE(r.counts.hessianApplications, <, 10);
}

TEUCHOS_UNIT_TEST(MpgpIter, BreakdownSaysWhichAssumptionFailed) {
  DenseProblem d = makeString(4, 0.3);
  d.A(11, 11) = -3;
  d.semiAxes.setConstant(1e6);
  try {
    solve(d, 4.0, 1e-10, {});
    TEST_ASSERT(false);
  } catch (const std::runtime_error& e) {
    TEST_ASSERT(std::string(e.what()).find("not positive semidefinite") != std::string::npos);
  }
  d.A(11, 11) = std::nan("");
  TEST_THROW(solve(d, 4.0, 1e-10, {}), std::runtime_error);
}

TEUCHOS_UNIT_TEST(OperatorNorm, LeavesTheFixedStepStableInFewApplications) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const DenseProblem d = makeRandomProblem(30, 40, 10, 1e-4, seed);
    const auto map = d.makeMap();
    const auto a = rcp(new DenseOperator(map, d.A)), q = rcp(new DenseOperator(map, d.Q));
    const auto x = rcp(new MultiVector(map, 1)), b = rcp(new MultiVector(map, 1));
    const Program program(a, x, b, d.makeSet(map), q);
    const OperatorNorm norm = estimateOperatorNorm(program, 10);
    const double exact = Testing::symmetricEigenvalues(d.A).maxCoeff();
    out << "estimate / exact " << norm.value / exact << " in " << norm.applications << "\n";
    TEST_EQUALITY(norm.applications, a->applications);
    TEST_COMPARE(norm.applications, <=, 10);
    // the fixed step must stay below 2 / ||A|| even where the estimate is too small
    TEST_COMPARE(MpgpOptions().stepLength / norm.value, <, 2 / exact);
    TEST_COMPARE(norm.value, <, 1.25 * exact);
    TEST_ASSERT(norm.decoupled);
    const Program coupled(q, x, b, d.makeSet(map), q);
    TEST_ASSERT(!estimateOperatorNorm(coupled, 10).decoupled);
  }
}

}  // namespace
