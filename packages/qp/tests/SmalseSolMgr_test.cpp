// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SmalseSolMgr.hpp"

#include <BelosSolverFactory_Tpetra.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <Teuchos_VerboseObject.hpp>
#include <cmath>
#include <sstream>

#include "Haptos_Error.hpp"
#include "Haptos_OptionTable.hpp"
#include "QpTestProblem.hpp"

namespace {

using namespace HaptosTest;
using Manager = SmalseSolMgr<double, MultiVector, Operator>;
using Program = QuadraticProgram<double, MultiVector, Operator>;

/// Independent reference: ADMM on the assembled matrices, the splitting x in {Q x = Q x0}, z in Omega, with the x-step
/// solved directly.  Shares the projection on one ellipse with the solver (tested by itself), nothing else.
DenseVector solveByAdmm(const DenseProblem& d, const DenseMatrix& axes, DenseVector z) {
  const int n = d.size();
  const DenseMatrix I = DenseMatrix::Identity(n, n), P = I - d.Q;
  const DenseVector xq = d.Q * d.x0;
  const double sigma = 0.03;  // near the geometric mean of the spectrum of A
  const Testing::Solve step = Testing::ldltFactor(P * (d.A + sigma * I) * P + d.Q);
  DenseVector u = DenseVector::Zero(n);
  for (int it = 0; it < 100000; ++it) {
    const DenseVector x = P * step(P * (d.b + sigma * (z - u) - d.A * xq)) + xq;
    const DenseVector zNew = d.project(1.6 * x - 0.6 * z + u, axes);
    u += 1.6 * x - 0.6 * z - zNew;
    const double change = (zNew - z).norm() + (x - zNew).norm();
    z = zNew;
    if (change <= 1e-14 * (1 + z.norm())) break;
  }
  return z;
}

/// Semi-axes from the bounded entries (Coulomb), counted from the lower bound.
struct CoulombUpdate : FeasibleSetUpdate<MultiVector> {
  RCP<BoundEllipseSet> set;
  std::array<double, 2> f{{0.9, 0.6}};
  bool follow = true;
  int calls = 0;
  double update(MultiVector& x) override {
    ++calls;
    std::vector<std::array<double, 2>> axes;
    double sums[2] = {0, 0}, all[2] = {0, 0};
    {
      const auto view = x.getData(0);
      for (std::size_t i = 0; i < set->bounds().size(); ++i) {
        const double g = view[set->bounds()[i].row] - set->bounds()[i].lower;
        axes.push_back({f[0] * g, f[1] * g});
        for (int k = 0; k < 2; ++k) {
          sums[0] += std::pow(axes.back()[k] - set->ellipses()[i].semiAxes[k], 2);
          sums[1] += axes.back()[k] * axes.back()[k];
        }
      }
    }
    set->setSemiAxes(axes, follow ? &x : nullptr);
    Teuchos::reduceAll(*x.getMap()->getComm(), Teuchos::REDUCE_SUM, 2, sums, all);
    return all[1] > 0 ? std::sqrt(all[0] / all[1]) : 0;
  }
};

/// Everything that one solve needs, with units: A in unitA, x in unitX.
struct Setup {
  RCP<DenseOperator> A, Q;
  RCP<MultiVector> x, b, x0;
  RCP<BoundEllipseSet> set;
  RCP<Program> program;
  Manager manager;

  explicit Setup(DenseProblem d, double unitA = 1, double unitX = 1,
                 const RCP<const Communicator>& comm = Teuchos::null) {
    d.A *= unitA;
    d.b *= unitA * unitX;
    d.x0 *= unitX;
    d.lower *= unitX;
    d.semiAxes *= unitX;
    const auto map = d.makeMap(comm);
    A = rcp(new DenseOperator(map, d.A));
    Q = rcp(new DenseOperator(map, d.Q));
    x = rcp(new MultiVector(map, 1));
    b = rcp(new MultiVector(map, 1));
    x0 = rcp(new MultiVector(map, 1));
    scatter(d.b, *b);
    scatter(d.x0, *x0);
    scatter(d.x0, *x);
    set = d.makeSet(map);
    program = rcp(new Program(A, x, b, set, Q, x0));
    manager.setProblem(program);
  }
  Belos::ReturnType solve(double tolerance) {
    const auto p = rcp(new Teuchos::ParameterList(*manager.getCurrentParameters()));
    p->set("Convergence Tolerance", tolerance);
    manager.setParameters(p);
    return manager.solve();
  }
};

/// Semi-axes from 0 to large, with ratios up to 1e6 and one-sided zeros.
DenseProblem makeHardProblem(unsigned seed) {
  DenseProblem d = makeRandomProblem(24, 30, 12, 1e-3, seed);
  for (int i = 0; i < d.groups; ++i) switch (i % 6) {
      case 0: d.semiAxes.col(i) << 0.0, 0.0; break;
      case 1: d.semiAxes.col(i) << 0.3, 0.0; break;
      case 2: d.semiAxes.col(i) << 1.0, 1e-6; break;
      case 3: d.semiAxes.col(i) << 5e-7, 0.5; break;
      case 4: d.semiAxes.col(i) << 0.4, 0.2; break;
      default: d.semiAxes.col(i) << 50.0, 50.0;
    }
  return d;
}

TEUCHOS_UNIT_TEST(SmalseSolMgr, MatchesAdmmWithEqualityBoundsAndEllipses) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const DenseProblem d = makeHardProblem(seed);
    const DenseVector reference = solveByAdmm(d, d.semiAxes, d.x0);
    TEST_COMPARE((d.Q * (reference - d.x0)).norm(), <=, 1e-12);
    for (const char* expansion : {"Fixed", "Projected CG", "Automatic"}) {
      Setup s(d);
      const auto p = rcp(new Teuchos::ParameterList);
      p->set("Expansion", std::string(expansion));
      s.manager.setParameters(p);
      TEST_EQUALITY(s.solve(1e-11), Belos::Converged);
      TEST_EQUALITY(s.manager.outcome() == Outcome::Converged, true);
      const DenseVector x = gather(*s.x);
      const MpgpCounts c = s.manager.counts();
      out << expansion << ": error " << (x - reference).norm() / reference.norm() << ", outer "
          << s.manager.getNumIters() << ", applications " << c.hessianApplications << ", cg " << c.cg << ", expansion "
          << c.expansion << ", proportioning " << c.proportioning << "\n";
      TEST_COMPARE((x - reference).norm(), <=, 1e-7 * reference.norm());
      TEST_COMPARE((d.Q * (x - d.x0)).norm(), <=, 1e-9);
      TEST_COMPARE((x - d.project(x, d.semiAxes)).norm(), <=, 1e-14 * x.norm());
      TEST_EQUALITY(c.hessianApplications, s.A->applications);
      TEST_ASSERT(c.cg > 10 && c.expansion > 0 && c.proportioning > 0 && s.manager.getNumIters() > 3);
      int slip = 0, bound = 0;
      for (int i = 0; i < d.groups; ++i) {
        bound += x[3 * i] == d.lower[i];
        slip += i % 6 == 4 && std::hypot(x[3 * i + 1] / 0.4, x[3 * i + 2] / 0.2) > 1 - 1e-9;
      }
      TEST_ASSERT(bound > 0 && bound < d.groups && slip > 0);
    }
  }
}

DenseProblem makeCoulombProblem() {
  DenseProblem d = makeRandomProblem(20, 25, 10, 1e-2, 7);
  d.lower.setZero();
  for (int i = 0; i < d.groups; ++i) d.b[3 * i] += 0.5;  // presses most of them together
  d.b -= (d.Q * d.b).eval();
  d.semiAxes.setZero();
  return d;
}

/// The fixed point by an outer loop around the dense reference.
DenseVector solveCoulombByAdmm(const DenseProblem& d, double f1, double f2) {
  DenseVector x = d.x0;
  DenseMatrix axes = d.semiAxes;
  for (int k = 0; k < 60; ++k) {
    x = solveByAdmm(d, axes, x);
    DenseMatrix next(2, d.groups);
    for (int i = 0; i < d.groups; ++i) next.col(i) << f1 * x[3 * i], f2 * x[3 * i];
    const double change = (next - axes).norm();
    axes = next;
    if (change <= 1e-12) break;
  }
  return x;
}

TEUCHOS_UNIT_TEST(SmalseSolMgr, ConnectedIteratesReachTheCoulombFixedPoint) {
  const DenseProblem d = makeCoulombProblem();
  const DenseVector reference = solveCoulombByAdmm(d, 0.9, 0.6);
  for (const bool follow : {false, true}) {
    Setup s(d);
    const auto update = rcp(new CoulombUpdate);
    update->set = s.set;
    update->follow = follow;
    s.manager.setFeasibleSetUpdate(update);
    TEST_EQUALITY(s.solve(1e-10), Belos::Converged);
    const DenseVector x = gather(*s.x);
    int open = 0, slip = 0, stick = 0;
    for (int i = 0; i < d.groups; ++i) {
      const double ratio = std::hypot(x[3 * i + 1] / 0.9, x[3 * i + 2] / 0.6) / std::max(x[3 * i], 1e-300);
      if (x[3 * i] <= 0)
        ++open;
      else
        ++(ratio > 1 - 1e-6 ? slip : stick);
    }
    out << "error " << (x - reference).norm() / reference.norm() << ", updates " << update->calls << ", applications "
        << s.manager.counts().hessianApplications << ", open " << open << " slip " << slip << " stick " << stick
        << "\n";
    TEST_COMPARE((x - reference).norm(), <=, 1e-7 * reference.norm());
    TEST_ASSERT(update->calls > 5 && open > 0 && slip > 3 && stick > 0);
    TEST_EQUALITY(s.manager.counts().hessianApplications, s.A->applications);
  }
}

TEUCHOS_UNIT_TEST(SmalseSolMgr, UnitsChangeNeitherCountsNorResult) {
  const DenseProblem d = makeCoulombProblem();
  std::vector<int> counts;
  DenseVector first;
  for (const auto& [unitA, unitX] : {std::pair{1.0, 1.0}, {1e-9, 1e3}, {1e12, 1e-6}, {1e-18, 1e-18}}) {
    Setup s(d, unitA, unitX);
    const auto update = rcp(new CoulombUpdate);
    update->set = s.set;
    s.manager.setFeasibleSetUpdate(update);
    TEST_EQUALITY(s.solve(1e-8), Belos::Converged);
    counts.push_back(s.manager.counts().hessianApplications);
    const DenseVector x = gather(*s.x) / unitX;
    if (first.size() == 0) first = x;
    TEST_COMPARE((x - first).norm(), <=, 1e-6 * first.norm());
    TEST_COMPARE(std::abs(counts.back() - counts.front()), <=, 2);
  }
  out << "applications " << counts[0] << " " << counts[1] << " " << counts[2] << " " << counts[3] << "\n";
}

TEUCHOS_UNIT_TEST(SmalseSolMgr, WarmRestartGoesOnWithoutANewNorm) {
  const DenseProblem d = makeHardProblem(2);
  Setup once(d), twice(d);
  TEST_EQUALITY(once.solve(1e-9), Belos::Converged);
  TEST_EQUALITY(twice.solve(1e-4), Belos::Converged);
  const int before = twice.A->applications;
  TEST_EQUALITY(twice.solve(1e-4), Belos::Converged);  // solved already: nothing to do
  TEST_EQUALITY(twice.A->applications, before);
  TEST_EQUALITY(twice.solve(1e-9), Belos::Converged);
  TEST_EQUALITY(twice.manager.counts().hessianApplications, twice.A->applications);
  TEST_COMPARE(twice.A->applications, <=, int(1.3 * once.A->applications));
  out << "once " << once.A->applications << ", in two calls " << before << " + " << twice.A->applications - before
      << "\n";
  TEST_COMPARE((gather(*twice.x) - gather(*once.x)).norm(), <=, 1e-6);
}

TEUCHOS_UNIT_TEST(SmalseSolMgr, AGivenNormIsNotComputedAgain) {
  const DenseProblem d = makeHardProblem(2);
  Setup first(d), second(d);
  TEST_EQUALITY(first.solve(1e-9), Belos::Converged);
  const OperatorNorm norm = first.manager.operatorNorm();
  TEST_COMPARE(norm.applications, >, 0);
  second.manager.setOperatorNorm(norm);
  TEST_EQUALITY(second.solve(1e-9), Belos::Converged);
  TEST_COMPARE(second.manager.counts().hessianApplications, <=, first.manager.counts().hessianApplications - norm.applications);
  TEST_EQUALITY(second.manager.counts().hessianApplications, second.A->applications);
  TEST_COMPARE((gather(*second.x) - gather(*first.x)).norm(), <=, 1e-6 * gather(*first.x).norm());
}

TEUCHOS_UNIT_TEST(SmalseSolMgr, OuterTestReplacesTheBuiltInOne) {
  const DenseProblem d = makeHardProblem(1);
  Setup s(d);
  int calls = 0;
  double last = 0;
  // natural residual of the pair (x, gradient), balance included
  s.manager.setOuterTest([&](const MultiVector& x, const MultiVector& g) {
    ++calls;
    const DenseVector xv = gather(x), gv = gather(g);
    const DenseVector natural = xv - d.project(xv - gv, d.semiAxes);
    // the gradient is A x - b + mu, mu in Im Q, without an application
    const DenseVector r = d.A * xv - d.b;
    TEST_COMPARE((gv - r - d.Q * gv).norm(), <=, 1e-9);
    return last = natural.norm() + (d.Q * (xv - d.x0)).norm();
  });
  TEST_EQUALITY(s.solve(1e-7), Belos::Converged);
  TEST_COMPARE(last, <=, 1e-7);
  TEST_EQUALITY(s.manager.achievedTol(), last);
  TEST_ASSERT(calls > s.manager.getNumIters());  // asked inside as well
}

TEUCHOS_UNIT_TEST(SmalseSolMgr, LimitAndStagnationAreReportedNotThrown) {
  const DenseProblem d = makeHardProblem(1);
  Setup s(d);
  const auto p = rcp(new Teuchos::ParameterList);
  p->set("Maximum Hessian Multiplications", 40);
  s.manager.setParameters(p);
  TEST_EQUALITY(s.solve(1e-9), Belos::Unconverged);
  TEST_EQUALITY(s.manager.outcome() == Outcome::MultiplicationLimit, true);
  TEST_COMPARE(s.A->applications, <=, 44);
  Setup t(d);
  TEST_EQUALITY(t.solve(0.0), Belos::Unconverged);
  TEST_EQUALITY(t.manager.outcome() == Outcome::Stagnated, true);
  TEST_COMPARE(t.manager.achievedTol(), <, 1e-12);
  out << "round-off " << t.manager.achievedTol() << " after " << t.A->applications << "\n";
}

TEUCHOS_UNIT_TEST(SmalseSolMgr, ResultDoesNotDependOnRanks) {
  // the same problem on all ranks together and on each rank alone
  const auto alone = rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF));
  const DenseProblem hard = makeHardProblem(3), coulomb = makeCoulombProblem();
  for (const bool connected : {false, true}) {
    const DenseProblem& d = connected ? coulomb : hard;
    Setup together(d), single(d, 1, 1, alone);
    for (Setup* s : {&together, &single}) {
      if (connected) {
        const auto update = rcp(new CoulombUpdate);
        update->set = s->set;
        s->manager.setFeasibleSetUpdate(update);
      }
      TEST_EQUALITY(s->solve(1e-10), Belos::Converged);
    }
    const DenseVector x = gather(*together.x), y = gather(*single.x);
    TEST_COMPARE((x - y).norm(), <=, 1e-8 * y.norm());
    const int n = together.A->applications, m = single.A->applications;
    out << "applications together " << n << ", alone " << m << ", difference " << (x - y).norm() / y.norm() << "\n";
    TEST_COMPARE(std::abs(n - m), <=, int(0.02 * m) + 2);
    TEST_FLOATING_EQUALITY(together.manager.operatorNorm().value, single.manager.operatorNorm().value, 1e-10);
  }
}

TEUCHOS_UNIT_TEST(SmalseSolMgr, BelosFactoryCreatesIt) {
  registerSmalseSolMgr();
  Belos::SolverFactory<double, MultiVector, Operator> factory;
  const auto p = rcp(new Teuchos::ParameterList);
  p->set("Gamma", 2.0);
  const auto solver = factory.create("Haptos SMALSE", p);
  TEST_ASSERT(Teuchos::rcp_dynamic_cast<Manager>(solver) != Teuchos::null);
  TEST_EQUALITY(solver->getCurrentParameters()->get<double>("Gamma"), 2.0);
  const DenseProblem d = makeHardProblem(1);
  Setup s(d);
  solver->setProblem(s.program);
  TEST_EQUALITY(solver->solve(), Belos::Converged);
  const auto plain = rcp(new Belos::LinearProblem<double, MultiVector, Operator>(s.A, s.x, s.b));
  TEST_THROW(solver->setProblem(plain), std::invalid_argument);
}

TEUCHOS_UNIT_TEST(SmalseSolMgr, RefusesWrongParameters) {
  Manager m;
  for (const char* name : {"Gamma", "Rho Factor", "Beta", "Convergence Tolerance"}) {
    const auto p = rcp(new Teuchos::ParameterList);
    p->set(name, -1.0);
    TEST_THROW(m.setParameters(p), InputError);
  }
  const auto p = rcp(new Teuchos::ParameterList);
  p->set("Expansion", std::string("Optimal"));
  TEST_THROW(m.setParameters(p), InputError);
  const auto refusal = [&m](const char* name, auto value) {
    const auto list = rcp(new Teuchos::ParameterList);
    list->set(name, value);
    try {
      m.setParameters(list);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  TEST_ASSERT(has(refusal("Gama", 1.0), "'Gamma'"));
  TEST_ASSERT(has(refusal("Gamma", std::string("1")), "double"));
  TEST_ASSERT(has(refusal("Expansion", std::string("Projected GC")), "'Projected CG'"));
  TEST_ASSERT(has(refusal("Inner Reduction", 1.0), "0 <= value < 1"));
  TEST_EQUALITY(m.getCurrentParameters()->get<double>("Gamma"), 1.0);  // what was refused changed nothing
}

TEUCHOS_UNIT_TEST(SmalseSolMgr, OldNamesAreTakenWithAWarning) {
  std::ostringstream warnings;
  const auto before = Teuchos::VerboseObjectBase::getDefaultOStream();
  Teuchos::VerboseObjectBase::setDefaultOStream(Teuchos::fancyOStream(Teuchos::rcpFromRef<std::ostream>(warnings)));
  const auto p = rcp(new Teuchos::ParameterList);
  p->set("M0", 2.0);
  p->set("Eta0", 0.2);
  p->set("Alpha Factor", 1.5);
  p->set("Expansion", std::string("Fixed"));
  Manager m;
  m.setParameters(p);
  Teuchos::VerboseObjectBase::setDefaultOStream(before);
  for (const char* name : {"'M Factor'", "'Eta Factor'", "'Step Length'", "'Fixed Step'"})
    TEST_ASSERT(warnings.str().find(name) != std::string::npos);
  TEST_EQUALITY(m.options().mFactor, 2.0);
  TEST_EQUALITY(m.options().etaFactor, 0.2);
  TEST_EQUALITY(m.options().stepLength, 1.5);
  TEST_ASSERT(m.options().expansion == Expansion::FixedStep);
  TEST_EQUALITY(m.getCurrentParameters()->get<double>("Step Length"), 1.5);
  TEST_ASSERT(!m.getCurrentParameters()->isParameter("M0"));
  m.setParameters(p);  // the list that came back is valid itself
}

TEUCHOS_UNIT_TEST(SmalseSolMgr, ValidParametersAreThoseOfTheInput) {
  const auto valid = Manager().getValidParameters();
  for (const auto& option : SmalseOptions::table()) {
    TEST_ASSERT(valid->isParameter(option.spec.name));
    TEST_EQUALITY(valid->getEntry(option.spec.name).docString(), option.spec.meaning);
    TEST_ASSERT(*valueOf(valid->getEntry(option.spec.name)) == *option.spec.defaultValue);
  }
  SmalseSolMgrOptions changed;
  changed.expansion = Expansion::ProjectedCg;
  changed.innerReduction = 0;
  Manager m;
  m.setOptions(changed);
  TEST_EQUALITY(m.getCurrentParameters()->get<std::string>("Expansion"), std::string("Projected CG"));
  TEST_EQUALITY(m.options().innerReduction, 0.0);
}

}  // namespace
