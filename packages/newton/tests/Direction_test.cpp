// SPDX-License-Identifier: BSD-3-Clause
// Directions and the preconditioners they come from, against dense formulas.
#include <Teuchos_UnitTestHarness.hpp>

#include "DirectionScene.hpp"
#include "Haptos_ConePath.hpp"
#include "Haptos_CountedOperator.hpp"
#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_DirectionChoice.hpp"

namespace {

using namespace HaptosTest;

TEUCHOS_UNIT_TEST(Scene, HasAllStates) {
  const Scene t(false);
  int open = 0, stick = 0, slip = 0;
  for (std::size_t i = 0; i < std::size_t(kGroups); ++i) {
    const auto modes = TangentialModes::of(t.wholeLaw.dP[i], kPenalty, 1.0);
    open += !t.wholeLaw.closed[i];
    stick += t.wholeLaw.closed[i] && !modes.isPartial(0) && !modes.isPartial(1);
    slip += t.wholeLaw.closed[i] && modes.isHeld(0) && modes.isPartial(1) && !modes.isHeld(1);
  }
  out << open << " open, " << stick << " stick, " << slip << " slip\n";
  TEST_ASSERT(open > 0 && stick > 0 && slip > 2);
}

// (M^-1 + C)^-1 in the variables of the coarse projections: r = r_theta / sqrt(theta), z_theta = z / sqrt(theta).
TEUCHOS_UNIT_TEST(CompliantPreconditioner, IsTheInverseOfFlexibilityAndCompliance) {
  const Scene t(false);
  constexpr double kStiffness = 0.9;
  const Eigen::Index n = t.GT.rows();
  DenseMatrix C = DenseMatrix::Zero(n, n), root = DenseMatrix::Identity(n, n);
  std::vector<TangentialModes> modes;
  for (const auto& dP : t.law.dP) modes.push_back(TangentialModes::of(dP, kPenalty, kStiffness));
  for (std::size_t i = 0; i < std::size_t(kGroups); ++i) {
    if (!t.wholeLaw.tangential[i]) continue;
    const TangentialModes m = TangentialModes::of(t.wholeLaw.dP[i], kPenalty, kStiffness);
    const Eigen::Index at = 3 * Eigen::Index(i) + 1;
    Eigen::Vector2d scale(1, 1), compliance(0, 0);
    for (int k = 0; k < 2; ++k) {
      if (m.isHeld(k)) continue;
      scale[k] = std::sqrt(m.theta[k]);
      compliance[k] = (1 - m.sigma[k]) / (kPenalty * m.sigma[k]);
    }
    root.block<2, 2>(at, at) = m.E * scale.asDiagonal() * m.E.transpose();
    C.block<2, 2>(at, at) = m.E * compliance.asDiagonal() * m.E.transpose();
  }
  TEST_COMPARE(C.norm(), >, 0.1);
  const DenseVector b = numbers(n, 2.6);
  const DenseMatrix flexibility = Testing::inverse(t.setup.d.M) + C;
  const DenseVector expected = Testing::inverse(root) * Testing::luSolve(flexibility, Testing::inverse(root) * b);
  for (double tolerance : {1e-3, 1e-11}) {
    CompliantPreconditioner preconditioner(t.dual, t.vectors, tolerance, 40);
    preconditioner.prepare(t.dual.pairs, t.law, modes);
    TEST_COMPARE(t.difference(preconditioner.apply(t.local(b)), expected), <, 10 * tolerance);
  }
  // where nothing gives way it is M
  CompliantPreconditioner stuck(t.dual, t.vectors, 1e-3, 40);
  LawLinearization sticks = t.law;
  for (auto& dP : sticks.dP) dP.setIdentity();
  for (std::size_t i = 0; i < modes.size(); ++i) modes[i] = TangentialModes::of(sticks.dP[i], kPenalty, kStiffness);
  stuck.prepare(t.dual.pairs, sticks, modes);
  TEST_COMPARE(t.difference(stuck.apply(t.local(b)), t.setup.d.M * b), <, 1e-13);
}

TEUCHOS_UNIT_TEST(CondensedContact, SolvesTheLawItself) {
  for (const auto kind : kKinds) {
    const Scene t(false);
    const ContactMatrix matrix = contactMatrix(t, kind);
    SubspaceNewtonOptions::Condensed options;
    options.reduction = 1e-9;
    CondensedContact condensed(t.dual.M, matrix, options);
    const CondensedContact::Step step = condensed.solveLaw(t.dual.pairs, t.r, t.myLambda, t.myS);
    const auto after = linearizeLaw(t.dual.pairs, t.vectors.contact(t.myLambda + step.z), t.vectors.contact(t.myS) - step.sigma, t.r);
    TEST_COMPARE(t.vectors.norm(after.phi), <, 1e-8 * t.wholeLaw.phi.norm());
    // the step is the response to the jumps that it closes
    Eigen::VectorXd jumps = t.myS;
    t.vectors.setContact(jumps, step.sigma);
    TEST_COMPARE(t.difference(step.z, t.setup.d.M * t.global(jumps)), <, 1e-12);
  }
}

// After one step of Newton's a path is followed to the end if the step left more of the law than asked, and none if not.
TEUCHOS_UNIT_TEST(CondensedContact, FollowsAPathOnlyWhereNewtonLeavesTooMuch) {
  const Scene t(false);
  const auto leftWith = [&](double pathFrom) {
    const ContactMatrix matrix = contactMatrix(t, ContactMatrix::Kind::Dense);  // a factor of before would change digits
    SubspaceNewtonOptions::Condensed options;
    options.reduction = 1e-8, options.newtonSteps = 1, options.pathFrom = pathFrom;
    return CondensedContact(t.dual.M, matrix, options).solveLaw(t.dual.pairs, t.r, t.myLambda, t.myS).left;
  };
  const double left = leftWith(1);
  TEST_COMPARE(left, >, 1e-4);
  TEST_EQUALITY(leftWith(1.01 * left), left);
  TEST_COMPARE(leftWith(0.99 * left), <, 1e-5);
}

// With a stiff r phi is hardly more than the jumps, and steps that descend are short: another r comes to the end in as many, without a path.
TEUCHOS_UNIT_TEST(CondensedContact, TriesOtherPenaltiesBeforeAPath) {
  const Scene t(false);
  const Eigen::VectorXd stiff = 1e5 * t.r;
  const auto leftWith = [&](double factor) {
    const ContactMatrix matrix = contactMatrix(t, ContactMatrix::Kind::Dense);
    SubspaceNewtonOptions::Condensed options;
    options.reduction = options.pathFrom = 1e-8, options.pathSteps = 0;
    options.newtonSteps = options.patientSteps = 10, options.otherPenalties = {factor, factor};
    return CondensedContact(t.dual.M, matrix, options).solveLaw(t.dual.pairs, stiff, t.myLambda, t.myS).left;
  };
  const double left = leftWith(1), otherLeft = leftWith(1e-4);
  out << "left " << left << ", with another r " << otherLeft << "\n";
  TEST_COMPARE(left, >, 1e-6);
  TEST_COMPARE(otherLeft, <, 1e-8);
}

// Other penalties did not come to the end, and a path did: it comes first in the next model, as if there were no others.
TEUCHOS_UNIT_TEST(CondensedContact, WhatSolvedTheLastModelComesFirst) {
  const Scene t(false);
  const Eigen::VectorXd stiff = 1e5 * t.r;
  const auto productsOfTwo = [&](int patientSteps) {
    const auto M = rcp(new CountedOperator(contactBlockOf(t.dual.M, t.dual.pairs)));
    SubspaceNewtonOptions::Condensed options;
    options.reduction = options.pathFrom = 1e-6, options.newtonSteps = 0, options.patientSteps = patientSteps, options.otherPenalties = {1, 1};
    options.rowsOfStep = 1;  // products are counted: no dense matrix
    const ContactMatrix matrix({M, Eigen::VectorXd::Ones(3 * t.vectors.numPairs())}, t.vectors, ContactMatrix::Kind::Products, options);
    CondensedContact condensed(t.dual.M, matrix, options);
    TEST_COMPARE(condensed.solveLaw(t.dual.pairs, stiff, t.myLambda, t.myS).left, <, 1e-6);
    const long first = M->applications();
    TEST_COMPARE(condensed.solveLaw(t.dual.pairs, stiff, t.myLambda, 3 * t.myS).left, <, 1e-6);
    return std::pair(first, M->applications() - first);
  };
  const auto [first, second] = productsOfTwo(8);
  const auto [firstAlone, secondAlone] = productsOfTwo(0);
  out << "products " << first << ", then " << second << "; without other penalties " << firstAlone << ", then " << secondAlone << "\n";
  TEST_COMPARE(first, >, firstAlone);
  TEST_EQUALITY(second, secondAlone);
  // steps that creep are not followed to the last one, which would be five times as many
  const long patient = productsOfTwo(40).first;
  out << "with up to 40 steps " << patient << "\n";
  TEST_COMPARE(patient - firstAlone, <, 4 * (first - firstAlone));
}

// The next model begins where the last one was solved: what is solved already is solved closer, and costs less than from where nothing moves.
TEUCHOS_UNIT_TEST(CondensedContact, BeginsWhereTheLastModelWasSolved) {
  const Scene t(false);
  const auto M = rcp(new CountedOperator(contactBlockOf(t.dual.M, t.dual.pairs)));
  const ContactMatrix matrix({M, Eigen::VectorXd::Ones(3 * t.vectors.numPairs())}, t.vectors, ContactMatrix::Kind::Products, {});
  CondensedContact condensed(t.dual.M, matrix, {});
  const auto residualOfStep = [&](const CondensedContact::Step& step) {
    return t.vectors.norm(linearizeLaw(t.dual.pairs, t.vectors.contact(t.myLambda + step.z), t.vectors.contact(t.myS) - step.sigma, t.r).phi);
  };
  const double first = residualOfStep(condensed.solveLaw(t.dual.pairs, t.r, t.myLambda, t.myS));
  const long cold = M->applications();
  const double second = residualOfStep(condensed.solveLaw(t.dual.pairs, t.r, t.myLambda, t.myS));
  out << "products " << cold << ", then " << M->applications() - cold << ", residuals " << first << ", " << second << "\n";
  TEST_COMPARE(second, <=, 1e-2 * first);
  TEST_COMPARE(2 * (M->applications() - cold), <, cold);
}

// Whatever M leaves of G M: motions that contact alone holds are balanced by contact rows, the others by gluing rows.
TEUCHOS_UNIT_TEST(CondensedDirection, IsBalancedByAnyM) {
  for (const bool floating : {false, true}) {
    const Scene t(floating);
    const Eigen::VectorXd diagonal = t.vectors.contact(t.local(t.setup.d.M.diagonal()));
    CondensedDirection condensed({t.dual.M, t.dual.contactM}, t.dual, t.balance, diagonal, t.r, {});
    const DenseVector any = numbers(t.GT.rows(), 0.2);
    TEST_COMPARE((t.GT.transpose() * t.setup.d.M * any).norm(), >, 1e-2 * (t.setup.d.M * any).norm());  // M does not do it
    const Eigen::VectorXd v = condensed.compute(t.dual.pairs, t.law, {t.myLambda, t.myS, t.law.phi}).v;
    TEST_COMPARE(t.balance.applyG(v).norm(), <, 1e-11 * t.vectors.norm(v));
  }
}

// W l-wards, its root, and what two steps promise: in the coordinates x = root y = root^-1 l the first one to x o x = 0, the second one to
// x o x = target e but for the product of the first one.
TEUCHOS_UNIT_TEST(ConePoint, ScalesAndCorrects) {
  const auto product = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return Eigen::Vector3d(a.dot(b), a[0] * b[1] + b[0] * a[1], a[0] * b[2] + b[0] * a[2]);
  };
  for (const double length : {1.0, 1e-7}) {
    ConePoint p;
    p.l << 2.0, 1.5, -0.9;
    p.y = length * Eigen::Vector3d(0.7, -0.2, 0.6);
    p.scale();
    TEST_COMPARE((p.W * p.y - p.l).norm(), <=, 1e-13 * p.l.norm());
    TEST_COMPARE((p.root * p.root - p.W).norm(), <=, 1e-13 * p.W.norm());
    TEST_COMPARE((p.root * p.inverseRoot - Eigen::Matrix3d::Identity()).norm(), <=, 1e-13);
    const Eigen::Vector3d x = p.root * p.y;
    const auto left = [&] { return product(x, p.inverseRoot * p.rest); };  // of x o (root^-1 dl + root dy)
    p.aim(0);
    TEST_COMPARE((left() + product(x, x)).norm(), <=, 1e-13 * x.squaredNorm());
    p.dy = length * Eigen::Vector3d(0.1, 0.3, -0.2);
    p.dl = p.rest - p.W * p.dy;
    const double target = 0.3 * p.l.dot(p.y);
    p.aim(target);
    p.correct();
    const Eigen::Vector3d expected = target * Eigen::Vector3d(1, 0, 0) - product(x, x) - product(p.inverseRoot * p.dl, p.root * p.dy);
    TEST_COMPARE((left() - expected).norm(), <=, 1e-12 * x.squaredNorm());
  }
}

// From no start, at axis ratios that Newton's method fears, with coefficients 0 and Tresca's law: all law is obeyed at the end.
TEUCHOS_UNIT_TEST(ConePath, EndsWhereTheLawHolds) {
  struct Case {
    std::array<double, 2> coefficients;
    FrictionLaw law;
  };
  for (const Case& c : {Case{{0.8, 0.4}, FrictionLaw::Coulomb}, Case{{0.5, 5e-7}, FrictionLaw::Coulomb}, Case{{0.0, 0.5}, FrictionLaw::Coulomb},
                        Case{{0.5, 0.05}, FrictionLaw::Tresca}, Case{{0.0, 0.0}, FrictionLaw::Coulomb}}) {
    const Scene t(false);
    const ContactMatrix matrix = contactMatrix(t, ContactMatrix::Kind::Products);
    std::vector<PairLaw> pairs = t.dual.pairs;
    for (PairLaw& pair : pairs) pair.coefficients = c.coefficients, pair.law = c.law, pair.slipForce = 0.5;
    const Eigen::VectorXd lambda = t.vectors.contact(t.myLambda), s = t.vectors.contact(t.myS);
    const auto residual = [&](const Eigen::VectorXd& sigma) {
      return t.vectors.norm(linearizeLaw(pairs, lambda + matrix.multiply(sigma), s - sigma, t.r).phi);
    };
    const double start = residual(Eigen::VectorXd::Zero(s.size()));
    for (const SlipTerm slip : {SlipTerm::Value, SlipTerm::Derivative}) {
      const Eigen::VectorXd sigma = ConePath({}).follow({pairs, matrix, lambda, s, slip}, residual, 1e-4 * start);
      out << "ratio " << c.coefficients[0] << " : " << c.coefficients[1] << ", residual " << residual(sigma) / start << "\n";
      TEST_COMPARE(residual(sigma), <=, 1e-4 * start);
    }
  }
}

// Forces that differ by 1e-4 have a path that is the same but for its end; another law has another one.
TEUCHOS_UNIT_TEST(ConePath, BeginsWhereTheLastOneIsStillGood) {
  const Scene t(false);
  const auto M = rcp(new CountedOperator(t.dual.contactM));
  SubspaceNewtonOptions::Condensed options;
  options.rowsOfStep = 0;              // products to the end
  options.pathLinearTolerance = 1e-8;  // with 1e-6 a path leaves 4e-6 or 1.1e-5 of the law, as reductions round
  const ContactMatrix matrix({M, t.vectors.contact(t.local(t.setup.d.M.diagonal()))}, t.vectors, ContactMatrix::Kind::Products, options);
  std::vector<PairLaw> pairs = t.dual.pairs, other = pairs;
  for (PairLaw& pair : pairs) pair.coefficients = {0.5, 5e-3};
  for (PairLaw& pair : other) pair.coefficients = {5e-3, 0.5};
  const Eigen::VectorXd lambda = t.vectors.contact(t.myLambda), s = t.vectors.contact(t.myS);
  ConePath path({});
  const auto steps = [&](const std::vector<PairLaw>& law, const Eigen::VectorXd& forces, bool fromStages) {
    const long before = M->applications();
    const auto residual = [&](const Eigen::VectorXd& sigma) {
      return t.vectors.norm(linearizeLaw(law, forces + matrix.multiply(sigma), s - sigma, t.r).phi);
    };
    const double target = 1e-5 * residual(Eigen::VectorXd::Zero(s.size()));
    const Eigen::VectorXd sigma = path.follow({law, matrix, forces, s, SlipTerm::Value}, residual, target, fromStages);
    const long products = M->applications() - before;
    TEST_COMPARE(residual(sigma), <=, target);
    return products;
  };
  TEST_ASSERT(!path.hasStages());
  const int cold = steps(pairs, lambda, true), near = steps(pairs, (1 + 1e-4) * lambda, true), again = steps(pairs, (1 + 1e-4) * lambda, false);
  const int otherLaw = steps(other, lambda, true), otherCold = steps(other, lambda, false);
  out << "products with M: " << cold << ", from stages " << near << ", without them " << again << ", another law " << otherLaw << "\n";
  TEST_ASSERT(path.hasStages());
  TEST_COMPARE(2 * near, <=, again);
  TEST_EQUALITY(otherLaw, otherCold);
}

// What the law decides is so, and nothing is out of balance.
TEUCHOS_UNIT_TEST(BalancedDirection, IsBalancedAndFollowsTheLaw) {
  for (const bool floating : {false, true}) {
    const Scene t(floating);
    BalancedDirection balanced(t.dual, t.local(t.setup.d.M.diagonal()), t.vectors, t.balance, {});
    const DirectionPoint point{t.myLambda, t.myS, t.law.phi};
    const Direction direction = balanced.compute(t.dual.pairs, t.law, point);
    TEST_ASSERT(!direction.isWhole);
    const DenseVector v = t.global(direction.v);
    TEST_COMPARE((t.GT.transpose() * v).norm(), <, 1e-8 * v.norm());
    if (floating) continue;  // there open pairs, too, may have to hold the body
    for (int i = 0; i < kGroups; ++i) {
      const Eigen::Vector3d before = t.lambda.segment<3>(3 * i), change = v.segment<3>(3 * i);
      if (!t.wholeLaw.closed[std::size_t(i)]) TEST_COMPARE((before + change).norm(), <, 1e-12 * t.lambda.norm());
    }
  }
}

// Whatever a pair's own units, r is measured by the stiffness of normal rows.
TEUCHOS_UNIT_TEST(DirectionChoice, PenaltyIsTheMedianOfNormalStiffnesses) {
  const Scene t(false);
  DirectionChoice directions(t.dual, t.local(t.setup.d.M.diagonal()), t.vectors, t.balance, {});
  std::vector<double> normal;
  for (int i = 0; i < kGroups; ++i) normal.push_back(t.setup.d.M(3 * i, 3 * i));
  std::sort(normal.begin(), normal.end());
  const double median = 0.5 * (normal[kGroups / 2 - 1] + normal[kGroups / 2]);
  for (double value : directions.pairStiffness()) TEST_FLOATING_EQUALITY(value, median, 1e-13);
  TEST_ASSERT(!directions.mayCondense() && !directions.condense() && !directions.isCondensed());  // nobody offers a better M
}

}  // namespace
