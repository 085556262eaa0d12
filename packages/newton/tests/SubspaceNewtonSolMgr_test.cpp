// SPDX-License-Identifier: BSD-3-Clause
// Only Belos' interface and dense operators: no mesh, no FETI.
#include "Haptos_SubspaceNewtonSolMgr.hpp"

#include <BelosSolverFactory_Tpetra.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Vector.hpp>
#include <utility>

#include "Haptos_DualVectors.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_RemoteRows.hpp"
#include "Haptos_SubspaceNewtonOptions.hpp"
#include "ManagerScene.hpp"

namespace {

using namespace HaptosTest;
using Manager = SubspaceNewtonSolMgr;

// Jumps h - F lambda in the place of h, counted.
void giveJumps(ContactOperators& o, int& asked) {
  o.jumpsOf = [&asked, h = std::exchange(o.h, Teuchos::null), F = o.F](const Vector& lambda) {
    ++asked;
    const auto s = rcp(new Vector(*h, Teuchos::Copy));
    F->apply(lambda, *s, Teuchos::NO_TRANS, -1.0, 1.0);
    return s;
  };
}

TEUCHOS_UNIT_TEST(SubspaceNewtonSolMgr, SolvesDenseContactThroughBelos) {
  for (const bool floating : {false, true})
    for (unsigned seed = 1; seed <= 3; ++seed) {
      registerSubspaceNewtonSolMgr();
      Belos::SolverFactory<double, MultiVector, Operator> factory;
      const auto solver = factory.create("Haptos Subspace Newton", withTolerance(1e-10));
      Setup t(makeContact(40, 30, floating, seed));
      solver->setProblem(t.problem);
      TEST_EQUALITY(solver->solve(), Belos::Converged);
      const auto manager = Teuchos::rcp_dynamic_cast<Manager>(solver, true);
      const Kkt kkt = measure(t, *manager);
      out << (floating ? "floating" : "held") << ", error " << kkt.error << ", applications " << t.F->applications << ", open "
          << kkt.open << " slip " << kkt.slip << " stick " << kkt.stick << "\n";
      TEST_COMPARE(kkt.error, <=, 1e-7);
      TEST_COMPARE(solver->achievedTol(), <=, 1e-10);
      TEST_EQUALITY(manager->hessianApplications(), long(t.F->applications));
      TEST_ASSERT(kkt.open > 0 && kkt.slip > 3 && kkt.stick > 0);
      TEST_ASSERT(solver->getNumIters() > 5 && manager->subspace().memoryMb > 0);
      TEST_ASSERT(manager->outcome() == Outcome::Converged);
    }
}

// M between contact rows is taken from M or given on those rows alone, whatever the order of a pair's rows.
TEUCHOS_UNIT_TEST(SubspaceNewtonSolMgr, ContactBlockTakenOrGiven) {
  const DenseContact d = makeContact(40, 30, false, 3);
  const Setup taken(d);
  Manager manager;
  manager.setParameters(withTolerance(1e-10));
  manager.setProblem(taken.problem);
  TEST_EQUALITY(manager.solve(), Belos::Converged);
  for (const bool swapped : {false, true}) {
    Setup t(d);
    ContactOperators o = t.operators();
    const Eigen::Index n = 3 * d.layout.groups;
    o.contactM = rcp(new DenseOperator(mapOfRows(*t.map, contactRows(o.pairs)), d.M.topLeftCorner(n, n)));
    for (auto& pair : o.pairs) {
      if (!swapped) continue;
      std::swap(pair.tangential[0], pair.tangential[1]);
      std::swap(pair.coefficients[0], pair.coefficients[1]);
    }
    Manager other;
    other.setParameters(withTolerance(1e-10));
    other.setProblem(rcp(new ContactProblem(o, t.lambda)));
    TEST_EQUALITY(other.solve(), Belos::Converged);
    TEST_COMPARE(std::abs(t.F->applications - taken.F->applications), <=, 1);
    TEST_COMPARE((gather(*t.lambda) - gather(*taken.lambda)).norm(), <=, 1e-7);
  }
}

// Whoever has h - F lambda need not give h.
TEUCHOS_UNIT_TEST(SubspaceNewtonSolMgr, JumpsOfTheStartTakenOrGiven) {
  const DenseContact d = makeContact(40, 30, false, 3);
  Setup taken(d), given(d);
  ContactOperators o = given.operators();
  int asked = 0;
  giveJumps(o, asked);
  Manager a, b;
  for (Manager* manager : {&a, &b}) manager->setParameters(withTolerance(1e-10));
  a.setProblem(taken.problem);
  b.setProblem(rcp(new ContactProblem(o, given.lambda)));
  TEST_EQUALITY(a.solve(), Belos::Converged);
  TEST_EQUALITY(b.solve(), Belos::Converged);
  TEST_COMPARE(asked, >, 0);
  TEST_EQUALITY(a.hessianApplications(), b.hessianApplications());
  TEST_COMPARE((gather(*taken.lambda) - gather(*given.lambda)).norm(), <=, 1e-12 * gather(*taken.lambda).norm());
  o.jumpsOf = nullptr;
  TEST_THROW(ContactProblem(o, given.lambda), std::logic_error);
}

// Taken silently, it would cost applications only.
TEUCHOS_UNIT_TEST(SubspaceNewtonSolMgr, ContactBlockInAnotherOrderIsRefused) {
  const DenseContact d = makeContact(40, 30, false, 3);
  Setup t(d);
  ContactOperators o = t.operators();
  std::vector<int> rows = contactRows(o.pairs);
  std::reverse(rows.begin(), rows.end());
  const Eigen::Index n = 3 * d.layout.groups;
  o.contactM = rcp(new DenseOperator(mapOfRows(*t.map, rows), d.M.topLeftCorner(n, n)));
  TEST_THROW(ContactProblem(o, t.lambda), std::logic_error);
}

TEUCHOS_UNIT_TEST(SubspaceNewtonSolMgr, UnitsChangeNothing) {
  const DenseContact d = makeContact(30, 24, false, 5);
  int first = 0;
  for (const auto& [length, force] : {std::pair{1.0, 1.0}, {1e3, 1e-3}, {1e-6, 1e6}}) {
    Setup t(d, length, force);
    Manager manager;
    manager.setParameters(withTolerance(1e-9));
    manager.setProblem(t.problem);
    TEST_EQUALITY(manager.solve(), Belos::Converged);
    TEST_COMPARE(measure(t, manager, length, force).error, <=, 1e-6);
    if (first == 0) first = t.F->applications;
    TEST_COMPARE(std::abs(t.F->applications - first), <=, 2);
  }
}

TEUCHOS_UNIT_TEST(SubspaceNewtonSolMgr, StatusTestDecidesAndObserverSeesEveryStep) {
  Setup t(makeContact(40, 30, false, 2));
  Manager manager;
  manager.setParameters(withTolerance(1e-5));
  manager.setProblem(t.problem);
  double last = 0;
  int finals = 0, levels = 0, applications = 0;
  manager.setStatusTest([&](const Vector& lambda, const Vector& s) {
    TEST_ASSERT(lambda.getMap()->isSameAs(*s.getMap()));
    const DenseVector x = gather(lambda), jump = gather(s);
    last = jump.tail(30).lpNorm<Eigen::Infinity>();
    return last += (t.d.GT.transpose() * x - t.d.e).norm();
  });
  manager.setObserver([&](const SubspaceNewtonRecord& r, const Vector&) {
    ++(r.isFinalLevel ? finals : levels);
    TEST_COMPARE(r.hessianApplications, >=, applications);
    applications = int(r.hessianApplications);
  });
  TEST_EQUALITY(manager.solve(), Belos::Converged);
  TEST_COMPARE(last, <=, 1e-5);
  TEST_EQUALITY(manager.achievedTol(), last);
  TEST_ASSERT(finals > 1 && levels > 1);
}

// A test that sees an error which no direction feels, until jumps are made from the multipliers once more.
TEUCHOS_UNIT_TEST(SubspaceNewtonSolMgr, StateIsMadeAnewWhereTheTestDoesNotFeelSteps) {
  const DenseContact d = makeContact(40, 30, false, 2);
  Setup plain(d), deaf(d);
  ContactOperators o = deaf.operators();
  int made = 0;
  giveJumps(o, made);
  Manager a, b;
  for (Manager* manager : {&a, &b}) manager->setParameters(withTolerance(1e-5));
  a.setProblem(plain.problem);
  b.setProblem(rcp(new ContactProblem(o, deaf.lambda)));
  const auto error = [](const Vector&, const Vector& s) { return gather(s).tail(30).lpNorm<Eigen::Infinity>(); };
  a.setStatusTest(error);
  b.setStatusTest([&](const Vector& lambda, const Vector& s) { return made < 2 ? 0.01 : error(lambda, s); });
  TEST_EQUALITY(a.solve(), Belos::Converged);
  TEST_EQUALITY(b.solve(), Belos::Converged);
  TEST_EQUALITY(made, 3);  // at the start, on the way, for the answer
  out << a.hessianApplications() << " and " << b.hessianApplications() << " applications\n";
  TEST_COMPARE(b.hessianApplications(), <=, a.hessianApplications() + 4);
}

TEUCHOS_UNIT_TEST(SubspaceNewtonSolMgr, GoesOnWhereItWas) {
  Setup once(makeContact(40, 30, false, 3)), twice(makeContact(40, 30, false, 3));
  Manager a, b;
  for (auto [manager, setup] : {std::pair{&a, &once}, {&b, &twice}}) manager->setProblem(setup->problem);
  a.setParameters(withTolerance(1e-10));
  b.setParameters(withTolerance(1e-4));
  TEST_EQUALITY(a.solve(), Belos::Converged);
  TEST_EQUALITY(b.solve(), Belos::Converged);
  const int before = twice.F->applications;
  b.setParameters(withTolerance(1e-10));
  TEST_EQUALITY(b.solve(), Belos::Converged);
  TEST_COMPARE(twice.F->applications, >, before);
  TEST_COMPARE(twice.F->applications, <=, once.F->applications + 8);
  TEST_COMPARE(measure(twice, b).error, <=, 1e-7);
  out << "once " << once.F->applications << ", in two calls " << before << " + " << twice.F->applications - before << "\n";

  Setup other(makeContact(40, 30, false, 3));  // from another method's result
  Manager c;
  c.setParameters(withTolerance(1e-10));
  c.setProblem(other.problem);
  c.startFrom(*twice.lambda->getVector(0), *b.jumps());
  TEST_EQUALITY(c.solve(), Belos::Converged);
  TEST_COMPARE(other.F->applications, <=, 6);
}

TEUCHOS_UNIT_TEST(SubspaceNewtonSolMgr, FewPairsGiveTheSameAnswer) {
  for (const bool floating : {false, true}) {
    Setup all(makeContact(40, 30, floating, 2)), few(makeContact(40, 30, floating, 2));
    Manager a, b;
    const auto p = withTolerance(1e-10);
    p->set("Maximum Recycled Pairs", 20);
    b.setParameters(p);
    a.setParameters(withTolerance(1e-10));
    for (auto [manager, setup] : {std::pair{&a, &all}, {&b, &few}}) {
      manager->setProblem(setup->problem);
      TEST_EQUALITY(manager->solve(), Belos::Converged);
    }
    TEST_COMPARE(measure(few, b).error, <=, 1e-7);
    const DenseVector x = gather(*all.lambda);
    TEST_COMPARE((gather(*few.lambda) - x).norm(), <=, 1e-6 * x.norm());
    TEST_EQUALITY(a.subspace().compressions, 0);
    TEST_COMPARE(b.subspace().compressions, >, 1);
    TEST_EQUALITY(b.subspace().largestSize, 20 + (floating ? 6 : 0));  // floating motions are not counted
    TEST_COMPARE(b.subspace().memoryMb, <, a.subspace().memoryMb);
    out << "all pairs " << all.F->applications << " applications, " << a.subspace().largestSize << " pairs; few "
        << few.F->applications << ", dropped " << b.subspace().compressions << " times\n";
    TEST_COMPARE(few.F->applications, <=, 4 * all.F->applications);
  }
}

TEUCHOS_UNIT_TEST(SubspaceNewtonSolMgr, LimitAndStagnationAreReportedNotThrown) {
  Setup t(makeContact(40, 30, false, 1));
  Manager manager;
  const auto p = withTolerance(1e-10);
  p->set("Maximum Hessian Multiplications", 6);
  manager.setParameters(p);
  manager.setProblem(t.problem);
  TEST_EQUALITY(manager.solve(), Belos::Unconverged);
  TEST_ASSERT(manager.outcome() == Outcome::MultiplicationLimit);
  TEST_COMPARE(t.F->applications, <=, 7);
  Setup u(makeContact(40, 30, false, 1));
  Manager never;
  never.setParameters(withTolerance(0.0));
  never.setProblem(u.problem);
  TEST_EQUALITY(never.solve(), Belos::Unconverged);
  TEST_ASSERT(never.isLOADetected());
  TEST_COMPARE(never.achievedTol(), <, 1e-12);
}

TEUCHOS_UNIT_TEST(SubspaceNewtonSolMgr, RefusesWrongParametersAndProblems) {
  Manager m;
  for (const char* name : {"First Axis Ratio", "First Factor", "Level Tolerance", "Floating Penalty", "Convergence Tolerance"}) {
    const auto p = rcp(new Teuchos::ParameterList);
    p->set(name, -1.0);
    TEST_THROW(m.setParameters(p), InputError);
  }
  const auto q = rcp(new Teuchos::ParameterList);
  q->set("Patients", 1);
  try {
    m.setParameters(q);
    TEST_ASSERT(false);
  } catch (const InputError& e) {
    TEST_ASSERT(std::string(e.what()).find("'Patience'") != std::string::npos);
  }
  const auto old = rcp(new Teuchos::ParameterList);
  old->set("Maximum Pairs", 50);
  m.setParameters(old);
  TEST_EQUALITY(m.options().maximumPairs, 50);
  auto options = m.options();
  options.continuation.aim = 0.2;  // no parameter
  options.continuation.patience = 7;
  m.setOptions(options);
  TEST_EQUALITY(m.options().continuation.aim, 0.2);
  TEST_EQUALITY(m.getCurrentParameters()->get<int>("Patience"), 7);
  options.continuation.patience = 0;
  TEST_THROW(m.setOptions(options), InputError);
  TEST_EQUALITY(m.options().continuation.patience, 7);  // what was refused changed nothing
  Setup t(makeContact(10, 12, false, 1));
  const auto plain = rcp(new Belos::LinearProblem<double, MultiVector, Operator>(t.F, t.lambda, t.vectorOf(t.d.h)));
  TEST_THROW(m.setProblem(plain), std::invalid_argument);
  TEST_THROW(m.solve(), std::invalid_argument);
}

}  // namespace
