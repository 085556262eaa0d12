// SPDX-License-Identifier: BSD-3-Clause
// What a direction is balanced by and started from, against dense formulas.
#include <Teuchos_UnitTestHarness.hpp>

#include "DenseContact.hpp"
#include "Haptos_Continuation.hpp"
#include "Haptos_FoundationStart.hpp"
#include "Haptos_SubspaceDescent.hpp"

namespace {

using namespace HaptosTest;

constexpr int kGroups = 8, kGluing = 20;

DenseVector leastChange(const DenseMatrix& GT, const DenseVector& missing) {
  return GT * Testing::leastNormSolve(GT.transpose() * GT, missing);
}

TEUCHOS_UNIT_TEST(GluingBalance, ChangesGluingRowsByTheLeast) {
  Parts t(kGroups, kGluing, false);
  const DenseVector v = numbers(t.GT.rows(), 0.4), target = numbers(t.GT.cols(), 1.7);
  Eigen::VectorXd balanced = t.local(v);
  t.balance.balance(balanced, target);
  const DenseVector expected = v + leastChange(t.gluingGT, target - t.GT.transpose() * v);
  TEST_COMPARE((t.global(balanced) - expected).norm(), <, 1e-10 * expected.norm());
  TEST_COMPARE((t.balance.applyG(balanced) - target).norm(), <, 1e-10 * target.norm());
}

TEUCHOS_UNIT_TEST(GluingBalance, RigidPartsLeaveNoGluingJump) {
  for (const bool floating : {false, true}) {
    Parts t(kGroups, kGluing, floating);
    const DenseVector s = numbers(t.GT.rows(), 0.9);
    Eigen::VectorXd freed = t.local(s);
    t.balance.removeRigidPart(freed);
    const DenseVector after = t.global(freed), change = after - s;
    TEST_COMPARE((t.gluingGT.transpose() * after).norm(), <, 1e-10 * s.norm());
    const DenseVector a = Testing::qrSolve(t.GT, change);
    TEST_COMPARE((t.GT * a - change).norm(), <, 1e-10 * change.norm());  // a rigid motion of something
    if (floating) TEST_COMPARE((t.setup.d.Z.transpose() * a).norm(), <, 1e-9 * a.norm());  // but not of what contact alone holds
    TEST_COMPARE(change.norm(), >, 1e-2 * s.norm());
  }
}

// contactChangesGGT: the matrix of the gluing rows is G G^T without what contact rows added; kept promises save a factor, no more.
TEUCHOS_UNIT_TEST(GluingBalance, SharesTheEliminationOfGGT) {
  for (const bool floating : {false, true}) {
    Parts t(kGroups, kGluing, floating);
    const DenseVector v = numbers(t.GT.rows(), 0.4), s = numbers(t.GT.rows(), 0.9), target = numbers(t.GT.cols(), 1.7);
    const auto results = [&](const GluingBalance& balance) {
      Eigen::VectorXd balanced = t.local(v), freed = t.local(s);
      balance.balance(balanced, target);
      balance.removeRigidPart(freed);
      return std::array{t.global(balanced), t.global(freed)};
    };
    const Eigen::VectorXd& isGluing = t.balance.isGluing();
    std::vector<double> gluing(isGluing.data(), isGluing.data() + isGluing.size()), contact, all(gluing.size(), 1.0);
    for (double one : gluing) contact.push_back(1.0 - one);
    ContactOperators dual = t.dual;
    dual.contactChangesGGT = true;
    const auto differences = [&](const std::vector<double>& fixed, const std::vector<double>& changing) {
      dual.GGT = rcp(new CoarseProblem(t.dual.GGT->placement(), {*dual.GT, fixed}, {*dual.GT, changing}, dual.holds, CoarseProblem::Factor::Now));
      const auto found = results(GluingBalance(dual, t.vectors)), wanted = results(t.balance);
      return std::array{(found[0] - wanted[0]).norm() / wanted[0].norm(), (found[1] - wanted[1]).norm() / wanted[1].norm()};
    };
    for (double difference : differences(gluing, contact)) TEST_COMPARE(difference, <, 1e-10);
    for (double difference : differences(all, contact)) TEST_COMPARE(difference, >, 1e-3);  // a promise that is not kept
  }
}

TEUCHOS_UNIT_TEST(GluingBalance, FloatingMotionsAreThoseOfContact) {
  Parts held(kGroups, kGluing, false), t(kGroups, kGluing, true);
  TEST_EQUALITY(held.balance.numFloating(), 0);
  TEST_EQUALITY(t.balance.numFloating(), 6);
  DenseMatrix HH = t.balance.H().transpose() * t.balance.H();
  t.vectors.sum(HH);
  const DenseMatrix contactGT = t.GT.topRows(3 * kGroups) * t.setup.d.Z;
  // the same span: eigenvalues do not depend on the basis as long as it is orthonormal
  const DenseVector ours = Testing::symmetricEigenvalues(HH), dense = Testing::symmetricEigenvalues(contactGT.transpose() * contactGT);
  TEST_COMPARE((ours - dense).norm(), <, 1e-10 * dense.norm());
}

// Without friction along T1 a slide along it is felt by nothing, and is a motion all the same.
TEUCHOS_UNIT_TEST(GluingBalance, MotionsThatNoForceAnswersAreLeftAlone) {
  Setup setup(makeContact(kGroups, kGluing, true, 5, {0.0, 0.4}));
  const ContactOperators& dual = setup.problem->operators();
  const DualVectors vectors(setup.map, dual.pairs, dual.gluingRows);
  const GluingBalance balance(dual, vectors);
  TEST_EQUALITY(balance.numFloating(), 5);
  Eigen::MatrixXd all = balance.contactMotions(), sums = all.transpose() * all;
  TEST_EQUALITY(all.cols(), 6);
  vectors.sum(sums);
  TEST_COMPARE(Testing::symmetricEigenvalues(sums)[0], >, 0.1);  // independent
  // the rows that friction answers, of values 1
  Eigen::MatrixXd rows = carriedRows(Eigen::MatrixXd::Ones(3 * vectors.numPairs(), 1), dual.pairs);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) TEST_EQUALITY(rows(i, 0), i % 3 == 1 ? 0.0 : 1.0);
}

// With all pairs open the projection knows gluing rows alone; with all stuck every row.
TEUCHOS_UNIT_TEST(ActiveCoarseProjection, ResidualsLoseTheirRigidPart) {
  Parts t(kGroups, kGluing, false);
  const DenseVector diagonal = numbers(t.GT.rows(), 2.1).cwiseAbs() + DenseVector::Constant(t.GT.rows(), 0.1);
  const Eigen::VectorXd weights = t.local(diagonal), r = Eigen::VectorXd::Ones(t.vectors.numPairs());
  ActiveCoarseProjection projection(t.dual, t.balance, t.vectors, weights);
  for (const bool stuck : {false, true}) {
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(3 * t.vectors.numPairs());
    for (Eigen::Index i = 0; i < forces.size(); i += 3) forces[i] = stuck ? 5.0 : -5.0;
    const auto law = linearizeLaw(t.dual.pairs, forces, Eigen::VectorXd::Zero(forces.size()), r);
    std::vector<TangentialModes> modes;
    for (const auto& dP : law.dP) modes.push_back(TangentialModes::of(dP, 1.0, 1.0));
    projection.renew(law, modes);
    const DenseVector residual = numbers(t.GT.rows(), 0.2);
    Eigen::VectorXd mine = t.local(residual);
    projection.projectDual(mine);
    const DenseVector after = t.global(mine);
    const DenseMatrix& active = stuck ? t.GT : t.gluingGT;
    TEST_COMPARE((active.transpose() * diagonal.cwiseProduct(after)).norm(), <, 1e-5 * residual.norm());  // single precision
    const DenseVector change = after - residual, a = Testing::qrSolve(active, change);
    TEST_COMPARE((active * a - change).norm(), <, 1e-9 * residual.norm());
    TEST_COMPARE(change.norm(), >, 1e-2 * residual.norm());
  }
}

// Bodies on springs at the pairs: the forces obey the law and carry what acts on the motions.
TEUCHOS_UNIT_TEST(FoundationStart, ForcesObeyTheLawAndCarryTheLoad) {
  Parts t(kGroups, kGluing, true);
  const Eigen::VectorXd x = Eigen::VectorXd::Zero(3 * t.vectors.numPairs()), r = Eigen::VectorXd::Constant(t.vectors.numPairs(), 3.0);
  const FoundationState state = solveFoundation(t.dual.pairs, x, r, t.balance);
  TEST_COMPARE(state.residual, <, 1e-10);
  Eigen::VectorXd carried = t.balance.H().transpose() * state.forces;
  t.vectors.sum(carried);
  TEST_COMPARE((carried - t.balance.load()).norm(), <, 1e-9 * t.balance.load().norm());
  double slipping = 0;
  for (std::size_t i = 0; i < t.dual.pairs.size(); ++i) {
    const Eigen::Vector3d P = state.forces.segment<3>(3 * Eigen::Index(i));
    const auto& F = t.dual.pairs[i].coefficients;
    TEST_COMPARE(P[0], >=, 0.0);
    const double use = P[0] > 0 ? std::hypot(P[1] / (F[0] * P[0]), P[2] / (F[1] * P[0])) : P.norm();
    TEST_COMPARE(use, <=, 1 + 1e-9);
    slipping += use > 1 - 1e-9;
    // and they are the law's answer to the springs
    const Eigen::Vector3d spring = 3.0 * (t.balance.H() * state.a).segment<3>(3 * Eigen::Index(i));
    const auto law = linearizeLaw({t.dual.pairs[i]}, spring, Eigen::Vector3d::Zero(), Eigen::VectorXd::Ones(1));
    TEST_COMPARE((spring - law.phi - P).norm(), <, 1e-9 * (1 + P.norm()));
  }
  out << t.vectors.sum(slipping) << " pairs at the limit of friction\n";
}

TEUCHOS_UNIT_TEST(Continuation, EllipsesAreRoundedFromOutside) {
  const auto comm = Tpetra::getDefaultComm();
  std::vector<PairLaw> pairs;
  pairs.push_back({0, {1, 2}, {0.4, 0.1}, 0, FrictionLaw::Coulomb, false});
  pairs.push_back({3, {4, 5}, {0.0, 0.3}, 0, FrictionLaw::Coulomb, false});
  TEST_FLOATING_EQUALITY(largestAxisRatio(pairs, *comm), 4.0, 1e-14);
  if (comm->getRank() == comm->getSize() - 1) pairs[0].coefficients = {1e-3, 0.4};  // one rank's pair is everybody's
  TEST_FLOATING_EQUALITY(largestAxisRatio(pairs, *comm), 400.0, 1e-12);
  pairs[0].coefficients = {1e-3, 0.4};

  const auto levels = axisRatioLevels(pairs, 400, 10, 4);
  TEST_EQUALITY(levels.size(), 3);  // at most 10, 40, 160
  double most = 10;
  for (const auto& level : levels) {
    TEST_FLOATING_EQUALITY(level[0].coefficients[0], 0.4 / most, 1e-12);
    TEST_EQUALITY(level[0].coefficients[1], 0.4);
    TEST_EQUALITY(level[1].coefficients[0], 0.0);  // no friction stays none
    TEST_EQUALITY(level[1].coefficients[1], 0.3);
    most *= 4;
  }
  TEST_EQUALITY(scaledCoefficients(pairs, 1.5)[0].coefficients[1], 0.4 * 1.5);
  TEST_ASSERT(axisRatioLevels(pairs, 9, 10, 4).empty());
}

TEUCHOS_UNIT_TEST(ContinuationPolicy, LevelsLeadToTheTrueLaw) {
  const auto comm = Tpetra::getDefaultComm();
  const SubspaceNewtonOptions::Continuation options;
  std::vector<PairLaw> round{{0, {1, 2}, {0.4, 0.1}, 0, FrictionLaw::Coulomb, false}}, thin = round;
  thin[0].coefficients = {0.4, 1e-3};
  const auto coefficients = [](const FrictionLevels& levels, int c) {
    std::vector<double> values;
    for (const auto& law : levels.laws) values.push_back(law[0].coefficients[std::size_t(c)]);
    return values;
  };
  const auto sameAs = [&](const std::vector<double>& found, const std::vector<double>& wanted) {
    TEST_EQUALITY(found.size(), wanted.size());
    for (std::size_t i = 0; i < std::min(found.size(), wanted.size()); ++i) TEST_FLOATING_EQUALITY(found[i], wanted[i], 1e-12);
  };
  const ContinuationPolicy ofRound(round, options, *comm), ofThin(thin, options, *comm);
  sameAs(coefficients(ofRound.first(true), 0), {0.6});
  sameAs(coefficients(ofRound.detour(0), 0), {0.6, 0.48});
  sameAs(coefficients(ofRound.detour(1), 0), {0.8, 0.64, 0.52, 0.46, 0.428});
  sameAs(coefficients(ofRound.detour(9), 0), {0.8, 0.64, 0.52, 0.46, 0.428});
  sameAs(coefficients(ofThin.first(true), 1), {0.04, 0.01, 0.0025, 0.0015});
  sameAs(coefficients(ofThin.first(false), 1), {0.0015});
  sameAs(coefficients(ofThin.detour(0), 1), {0.2, 0.08, 0.032, 0.0128, 0.00512, 0.002048});
  TEST_EQUALITY(ofThin.first(true).tolerance, options.levelTolerance);
  TEST_EQUALITY(ofThin.detour(0).patience, options.detourPatience);
}

// Independent of each other for different j, which `numbers` are not: sines of one frequency span two dimensions.
DenseVector wave(Eigen::Index n, int j) {
  return DenseVector::NullaryExpr(n, [j](Eigen::Index i) { return std::sin(0.7 + j + (1.3 + 0.37 * j) * double(i)); });
}

// Pairs, a state and its law on all ranks; the residual in the span as a dense vector of all rows.
struct Span {
  Parts parts{kGroups, kGluing, false};
  RecycledSubspace subspace{parts.vectors};
  Eigen::VectorXd r = Eigen::VectorXd::Constant(parts.vectors.numPairs(), 1.3);
  NewtonState state{parts.local(numbers(parts.GT.rows(), 0.8)), parts.local(numbers(parts.GT.rows(), 1.9))};
  LawLinearization law = lawAt(state);

  explicit Span(int pairs) {
    for (int j = 0; j < pairs; ++j)
      subspace.add(parts.local(wave(parts.GT.rows(), 2 * j)), parts.local(wave(parts.GT.rows(), 2 * j + 1)));
  }
  LawLinearization lawAt(const NewtonState& at) const {
    return linearizeLaw(parts.dual.pairs, parts.vectors.contact(at.lambda), parts.vectors.contact(at.s), r);
  }
  NewtonState at(const Eigen::VectorXd& y) const {
    NewtonState moved = state;
    subspace.addCombination(y, moved.lambda, moved.s);
    return moved;
  }
  /// (s_E, contact values)
  DenseVector residual(const Eigen::VectorXd& s, const Eigen::VectorXd& contact) const {
    Eigen::VectorXd all = s;
    parts.vectors.setContact(all, contact);
    return parts.global(all);
  }
};

TEUCHOS_UNIT_TEST(SmallSystem, IsTheLinearisedLawOfAllRanks) {
  constexpr int kPairs = 5;
  const Span t(kPairs);
  const auto projected = t.subspace.projectGluing(t.parts.vectors.gluing(t.state.s));
  const SmallSystem system(t.subspace, t.law, projected.inside, t.parts.vectors.comm());
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(t.state.s.size());
  DenseMatrix M(t.parts.GT.rows(), kPairs);
  for (int j = 0; j < kPairs; ++j) {
    Eigen::VectorXd v = zero, s = zero;
    t.subspace.addCombination(Eigen::VectorXd::Unit(kPairs, j), v, s);
    M.col(j) = t.residual(s, t.law.multiply(t.parts.vectors.contact(v), t.parts.vectors.contact(s)));
  }
  const DenseVector b = -t.residual(t.state.s, t.law.phi), wanted = Testing::leastNormSolve(M, b);
  const Eigen::VectorXd y = system.solve();
  TEST_COMPARE((y - wanted).norm(), <, 1e-10 * wanted.norm());
  TEST_FLOATING_EQUALITY(std::hypot(std::sqrt(projected.outside2()), system.residual(y)), (M * y - b).norm(), 1e-10);
  // damped steps are shorter, the more the harder
  TEST_COMPARE(system.solve(1.0).norm(), <, system.solve(1e-2).norm());
  TEST_COMPARE(system.solve(1e-2).norm(), <, y.norm());
}

TEUCHOS_UNIT_TEST(SubspaceDescent, LowersTheResidualOfTheLawItself) {
  const Span t(6);
  const SubspaceNewtonOptions::Steps options;
  const auto normAt = [&](const Eigen::VectorXd& y) {
    const NewtonState moved = t.at(y);
    return t.residual(moved.s, t.lawAt(moved).phi).norm();
  };
  const double before = normAt(Eigen::VectorXd::Zero(6));
  SubspaceDescent descent({t.subspace, t.parts.vectors, t.parts.dual.pairs, t.r, options}, t.state, t.law, before);
  descent.run(false, before);
  const double after = normAt(descent.y());
  TEST_COMPARE(after, <, 0.99 * before);
  const Eigen::VectorXd phi = descent.takeLaw().phi;
  TEST_COMPARE(t.parts.vectors.norm(phi - t.lawAt(t.at(descent.y())).phi), <, 1e-10 * before);
  // from a step that goes up it comes to what it reaches without, or to less; from its own end it does not go back
  for (const Eigen::VectorXd& planned : {Eigen::VectorXd(Eigen::VectorXd::Constant(6, 1e3 * before)), Eigen::VectorXd(descent.y())}) {
    SubspaceDescent other({t.subspace, t.parts.vectors, t.parts.dual.pairs, t.r, options, true}, t.state, t.law, before);
    other.runFrom(planned, false, before);
    TEST_COMPARE(normAt(other.y()), <=, (1 + 1e-10) * after);
  }
}

// Where nothing leads on a plan is taken as it is, but for one that goes up too far.
TEUCHOS_UNIT_TEST(SubspaceDescent, TakesThePlanWhereItStays) {
  const Span t(6);
  SubspaceNewtonOptions::Steps options;
  options.gaussNewtonSteps = 0;
  const double before = t.residual(t.state.s, t.law.phi).norm();
  const auto growth = [&](const Eigen::VectorXd& y) {
    const NewtonState moved = t.at(y);
    return t.residual(moved.s, t.lawAt(moved).phi).norm() / before;
  };
  Eigen::VectorXd plan = Eigen::VectorXd::Constant(6, 1e-3 * before);
  while (growth(plan) < 1.5) plan *= 1.1;
  for (const bool isFloating : {false, true})
    for (const double ascent : {3.0, 1.2}) {
      options.ascent = ascent;
      SubspaceDescent descent({t.subspace, t.parts.vectors, t.parts.dual.pairs, t.r, options, isFloating}, t.state, t.law, before);
      descent.runFrom(plan, false, before);
      TEST_EQUALITY(descent.y(), ascent > 2 ? plan : Eigen::VectorXd(Eigen::VectorXd::Zero(6)));
    }
}

// Contact jumps stay within reach, of a planned step, too.
TEUCHOS_UNIT_TEST(SubspaceDescent, FloatingBodiesDoNotGoOff) {
  const Span t(6);
  SubspaceNewtonOptions::Steps options;
  options.farthest = 1e-3;  // nothing is within reach
  const double before = t.residual(t.state.s, t.law.phi).norm();
  for (const bool isFloating : {false, true}) {
    SubspaceDescent descent({t.subspace, t.parts.vectors, t.parts.dual.pairs, t.r, options, isFloating}, t.state, t.law, before);
    descent.runFrom(Eigen::VectorXd::Zero(6), false, before);
    TEST_EQUALITY(descent.y().norm() == 0.0, isFloating);
  }
}

}  // namespace
