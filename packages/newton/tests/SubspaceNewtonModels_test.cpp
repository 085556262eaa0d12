// SPDX-License-Identifier: BSD-3-Clause
// The manager with a better M to be had: when it asks for it, and what it makes of it.
#include <Teuchos_UnitTestHarness.hpp>
#include <array>
#include <cmath>
#include <vector>

#include "ManagerScene.hpp"

namespace {

using namespace HaptosTest;
using Manager = SubspaceNewtonSolMgr;

// The inverse of F between balanced multipliers: G M = 0.
DenseMatrix balancedInverse(const DenseContact& d) {
  const DenseMatrix inverse = Testing::inverse(d.F), W = inverse * d.GT;
  return inverse - W * Testing::pseudoInverse(d.GT.transpose() * W) * W.transpose();
}

// A diagonal M.
void takeM(const DenseVector& diagonal, const Setup& t, ContactOperators& o) {
  o.M = rcp(new DenseOperator(t.map, DenseMatrix(diagonal.asDiagonal())));
  o.diagonalOfM = t.vectorOf(diagonal);
}

ContactOperators::Deflated inverseOfF(const Setup& t, double size = 1) { return {rcp(new DenseOperator(t.map, size * balancedInverse(t.d))), {}}; }

// With a model that is F itself the law is solved within it; a poor M leads to the model by a plateau.
TEUCHOS_UNIT_TEST(SubspaceNewtonSolMgr, ModelOfTheDirection) {
  for (const bool floating : {false, true})
    for (const bool atOnce : {true, false}) {
      Setup t(makeContact(40, 30, floating, 4));
      ContactOperators o = t.operators();
      int made = 0;
      o.makeDeflatedM = [&](ContactOperators::Price) -> ContactOperators::Deflated {
        ++made;
        return inverseOfF(t);
      };
      o.needsDeflatedM = atOnce;
      if (!atOnce) takeM(DenseVector::LinSpaced(t.d.F.rows(), 1.0, 1000.0), t, o);
      Manager manager;
      manager.setParameters(withTolerance(1e-9));
      manager.setProblem(rcp(new ContactProblem(o, t.lambda)));
      TEST_EQUALITY(manager.solve(), Belos::Converged);
      const Kkt kkt = measure(t, manager);
      out << (floating ? "floating" : "held") << (atOnce ? ", at once" : ", after a plateau") << ", error " << kkt.error << ", applications "
          << t.F->applications << ", open " << kkt.open << " slip " << kkt.slip << " stick " << kkt.stick << "\n";
      TEST_EQUALITY(made, 1);
      TEST_COMPARE(kkt.error, <=, 1e-6);
      TEST_ASSERT(kkt.open > 0 && kkt.slip > 3 && kkt.stick > 0);
      TEST_EQUALITY(t.F->applications <= 6, atOnce);
    }
}

// With three times F's inverse in its place every full step goes three times too far.
TEUCHOS_UNIT_TEST(SubspaceNewtonSolMgr, ModelThatGoesTooFarIsScaled) {
  for (const bool floating : {false, true}) {
    std::vector<int> applications;
    for (const double size : {1.0, 3.0, 100.0}) {
      Setup t(makeContact(40, 30, floating, 4));
      ContactOperators o = t.operators();
      o.makeDeflatedM = [&](ContactOperators::Price) -> ContactOperators::Deflated { return inverseOfF(t, size); };
      o.needsDeflatedM = true;
      Manager manager;
      manager.setParameters(withTolerance(1e-9));
      manager.setProblem(rcp(new ContactProblem(o, t.lambda)));
      TEST_EQUALITY(manager.solve(), Belos::Converged);
      TEST_COMPARE(measure(t, manager).error, <=, 1e-6);
      applications.push_back(int(t.F->applications));
      out << (floating ? "floating" : "held") << ", " << size << ": applications " << applications.back() << "\n";
    }
    TEST_COMPARE(applications[1], <=, applications[0] + 8);
    TEST_COMPARE(applications[2], <=, applications[0] + 10);
  }
}

// A better M that is too dear is not asked for again where the way leads on without it, and is where it ends, or where the answer is far after
// twenty multiplications and those of the step that was under way.  Directions of an M whose entries spread over 1e8 leave round-off of 1e-16 x 1e8 in the
// pairs, as motions of subdomains that no direction takes off.
TEUCHOS_UNIT_TEST(SubspaceNewtonSolMgr, DearModelIsTheLastResort) {
  for (const bool floating : {false, true})
    for (const double range : {1.0, 1e4, 1e8}) {
      Setup t(makeContact(40, 30, floating, 4));
      ContactOperators o = t.operators();
      std::vector<ContactOperators::Price> asked;
      long askedAt = 0;
      o.makeDeflatedM = [&](ContactOperators::Price price) -> ContactOperators::Deflated {
        asked.push_back(price);
        askedAt = t.F->applications;
        if (price == ContactOperators::Price::Usual) return {};
        return inverseOfF(t);
      };
      o.needsDeflatedM = true;
      if (range > 1) takeM(DenseVector::LinSpaced(t.d.F.rows(), 0.0, std::log(range)).array().exp(), t, o);
      Manager manager;
      manager.setParameters(withTolerance(1e-9));
      manager.setProblem(rcp(new ContactProblem(o, t.lambda)));
      TEST_EQUALITY(manager.solve(), Belos::Converged);
      const Kkt kkt = measure(t, manager);
      out << (floating ? "floating" : "held") << ", range " << range << ": error " << kkt.error << ", applications " << t.F->applications << ", asked "
          << asked.size() << " times, last at " << askedAt << "\n";
      TEST_COMPARE(kkt.error, <=, 1e-6);
      TEST_EQUALITY(asked.size(), range > 1 ? 2u : 1u);
      if (range > 1) TEST_COMPARE(t.F->applications, <=, 70);
      TEST_ASSERT(asked.front() == ContactOperators::Price::Usual && (range == 1) == (asked.back() == ContactOperators::Price::Usual));
    }
}

// Long ellipses ask for condensed directions, not for a better M: where that is dear one for little comes first, and the other where it does not do.
TEUCHOS_UNIT_TEST(SubspaceNewtonSolMgr, LittleModelComesFirst) {
  using Price = ContactOperators::Price;
  for (const bool floating : {false, true})
    for (const bool isPoor : {false, true}) {
      Setup t(makeContact(40, 30, floating, 4, {0.8, 0.02}));
      ContactOperators o = t.operators();
      std::vector<Price> asked;
      o.makeDeflatedM = [&](Price price) -> ContactOperators::Deflated {
        asked.push_back(price);
        if (price != Price::Little || !isPoor) return inverseOfF(t);
        const Eigen::Index n = t.d.F.rows();
        const DenseMatrix P = DenseMatrix::Identity(n, n) - t.d.GT * Testing::pseudoInverse(t.d.GT.transpose() * t.d.GT) * t.d.GT.transpose();
        const DenseVector diagonal = DenseVector::LinSpaced(n, 0.0, std::log(1e3)).array().exp();
        return {rcp(new DenseOperator(t.map, P * diagonal.asDiagonal() * P)), {}};
      };
      o.isDeflatedMDear = true;
      Manager manager;
      manager.setParameters(withTolerance(1e-9));
      manager.setProblem(rcp(new ContactProblem(o, t.lambda)));
      TEST_EQUALITY(manager.solve(), Belos::Converged);
      const Kkt kkt = measure(t, manager);
      out << (floating ? "floating" : "held") << (isPoor ? ", poor" : ", good") << ": error " << kkt.error << ", applications " << t.F->applications << "\n";
      TEST_COMPARE(kkt.error, <=, 1e-6);
      TEST_COMPARE(t.F->applications, <=, isPoor ? 40 : 8);
      TEST_ASSERT(asked == (isPoor ? std::vector{Price::Little, Price::Usual} : std::vector{Price::Little}));
    }
}

// A model of a body that one direction leaves free may slide it along there as far as it likes: that must not turn what friction holds.
TEUCHOS_UNIT_TEST(SubspaceNewtonSolMgr, OneCoefficientMayBeZero) {
  for (const std::array<double, 2> friction : {std::array{0.0, 0.4}, {0.8, 0.0}}) {
    Setup t(makeContact(40, 30, true, 4, friction));
    ContactOperators o = t.operators();
    o.makeDeflatedM = [&](ContactOperators::Price) -> ContactOperators::Deflated { return inverseOfF(t); };
    o.needsDeflatedM = true;
    Manager manager;
    manager.setParameters(withTolerance(1e-9));
    manager.setProblem(rcp(new ContactProblem(o, t.lambda)));
    TEST_EQUALITY(manager.solve(), Belos::Converged);
    const Kkt kkt = measure(t, manager);
    out << "error " << kkt.error << ", applications " << t.F->applications << ", open " << kkt.open << " slip " << kkt.slip << " stick " << kkt.stick << "\n";
    TEST_COMPARE(kkt.error, <=, 1e-6);
    TEST_ASSERT(kkt.open > 0 && kkt.slip > 3);
    TEST_COMPARE(t.F->applications, <=, 6);
  }
}

// Condensed directions try one r after the other, and end where a round of them was for nothing.
TEUCHOS_UNIT_TEST(SubspaceNewtonSolMgr, RoundsOfPenaltiesEnd) {
  for (const bool floating : {false, true}) {
    Setup t(makeContact(12, 20, floating, 1));
    ContactOperators o = t.operators();
    o.makeDeflatedM = [&](ContactOperators::Price) -> ContactOperators::Deflated { return inverseOfF(t); };
    o.needsDeflatedM = true;
    Manager manager;
    manager.setParameters(withTolerance(0.0));
    manager.setProblem(rcp(new ContactProblem(o, t.lambda)));
    TEST_EQUALITY(manager.solve(), Belos::Unconverged);
    out << (floating ? "floating" : "held") << ": " << t.F->applications << " applications, residual " << manager.achievedTol() << "\n";
    TEST_ASSERT(manager.isLOADetected());
    TEST_COMPARE(t.F->applications, <, 200);
    TEST_COMPARE(manager.achievedTol(), <, 1e-12);
  }
}

}  // namespace
