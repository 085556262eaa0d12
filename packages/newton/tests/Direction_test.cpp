// SPDX-License-Identifier: BSD-3-Clause
// Directions and the preconditioners they come from, against dense formulas.
#include <Teuchos_UnitTestHarness.hpp>

#include "DenseContact.hpp"
#include "Haptos_ConePath.hpp"
#include "Haptos_CountedOperator.hpp"
#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_DirectionChoice.hpp"

namespace {

using namespace HaptosTest;

constexpr int kGroups = 12, kGluing = 20;
constexpr double kPenalty = 1.7;  // r

/// A state with open, sticking and slipping pairs, seen by this rank and as a whole.
struct Scene : Parts {
  DenseVector lambda, s;
  Eigen::VectorXd myLambda, myS, r;
  LawLinearization law, wholeLaw;  // of this rank's pairs, of all

  explicit Scene(bool floating) : Parts(kGroups, kGluing, floating), lambda(numbers(GT.rows(), 0.3)), s(0.4 * numbers(GT.rows(), 1.1)) {
    for (int i = 0; i < kGroups; ++i) {
      lambda[3 * i] = i % 4 == 0 ? -1.0 : 1.0 + 0.2 * i;
      lambda.segment<2>(3 * i + 1) *= i % 4 == 1 ? 0.05 : 3.0;
      s.segment<3>(3 * i) *= i % 4 == 1 ? 0.05 : 1.0;
    }
    myLambda = local(lambda);
    myS = local(s);
    r = Eigen::VectorXd::Constant(vectors.numPairs(), kPenalty);
    law = linearizeLaw(dual.pairs, vectors.contact(myLambda), vectors.contact(myS), r);
    std::vector<PairLaw> all;
    for (int i = 0; i < kGroups; ++i) all.push_back({3 * i, {3 * i + 1, 3 * i + 2}, setup.d.friction, 0, FrictionLaw::Coulomb, false});
    wholeLaw = linearizeLaw(all, lambda.head(3 * kGroups), s.head(3 * kGroups), Eigen::VectorXd::Constant(kGroups, kPenalty));
  }
  DenseMatrix contactM() const { return setup.d.M.topLeftCorner(3 * kGroups, 3 * kGroups); }
  /// (M (s_E, 0))_c
  DenseVector forcesOfGluing() const { return setup.d.M.topRightCorner(3 * kGroups, kGluing) * s.tail(kGluing); }
  double difference(const Eigen::VectorXd& mine, const DenseVector& expected) const { return (global(mine) - expected).norm() / expected.norm(); }
};

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

// M between contact rows as products and as a matrix; what Krylov methods leave is asked to be small here.
ContactMatrix contactMatrix(const Scene& t, ContactMatrix::Kind kind, SubspaceNewtonOptions::Condensed options = {}) {
  options.linearTolerance = options.pathLinearTolerance = 1e-13;
  return {{t.dual.contactM, t.vectors.contact(t.local(t.setup.d.M.diagonal()))}, t.vectors, kind, options};
}

constexpr auto kKinds = {ContactMatrix::Kind::Dense, ContactMatrix::Kind::Products};

TEUCHOS_UNIT_TEST(CondensedContact, SolvesTheLinearisedLaw) {
  for (const auto kind : kKinds) {
    const Scene t(false);
    const ContactMatrix matrix = contactMatrix(t, kind);
    SubspaceNewtonOptions::Condensed options;
    options.linearTolerance = 1e-13;
    CondensedContact condensed(t.dual.M, matrix, options);
    const DenseMatrix Mcc = t.contactM();
    const DenseMatrix I = DenseMatrix::Identity(3 * kGroups, 3 * kGroups);
    const DenseVector rhs = -t.wholeLaw.phi - t.wholeLaw.multiply(t.forcesOfGluing(), DenseVector::Zero(3 * kGroups));
    const DenseVector sigma = Testing::luSolve(t.wholeLaw.multiply(Mcc, -I), rhs);
    DenseVector jumps = t.s;
    jumps.head(3 * kGroups) = sigma;
    TEST_COMPARE(t.difference(condensed.solveLinearized(t.law, t.myS, t.law.phi), t.setup.d.M * jumps), <, 1e-9);
  }
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
    for (const auto target : {NewtonDirection::Target::Law, NewtonDirection::Target::Linearization}) {
      const Eigen::VectorXd v = condensed.compute(t.dual.pairs, t.law, {t.myLambda, t.myS, t.law.phi}, target).v;
      TEST_COMPARE(t.balance.applyG(v).norm(), <, 1e-11 * t.vectors.norm(v));
    }
  }
}

TEUCHOS_UNIT_TEST(ContactMatrix, SolvesWithWhatPairsAdd) {
  const Scene t(false);
  const DenseMatrix Mcc = t.contactM();
  const DenseVector b = numbers(3 * kGroups, 0.7);
  // of pair i, wherever it is: A not symmetric, K symmetric and positive
  const auto blockA = [](int i) -> Eigen::Matrix3d {
    return Eigen::Matrix3d::NullaryExpr([&](int r, int c) { return double(r == c) + 0.1 * std::sin(1.0 + i + 2 * r + 5 * c); });
  };
  const auto blockK = [&](int i) -> Eigen::Matrix3d { return std::pow(10.0, i % 5 - 2) * blockA(i) * blockA(i).transpose(); };
  DenseMatrix AMB = Mcc, MK = Mcc;
  for (int i = 0; i < kGroups; ++i) {
    AMB.middleRows<3>(3 * i) = (blockA(i) * AMB.middleRows<3>(3 * i)).eval();
    AMB.block<3, 3>(3 * i, 3 * i) += blockK(i);
    MK.block<3, 3>(3 * i, 3 * i) += blockK(i);
  }
  DenseVector rhs = DenseVector::Zero(t.GT.rows()), general = rhs, symmetric = rhs;
  rhs.head(3 * kGroups) = b;
  general.head(3 * kGroups) = Testing::luSolve(AMB, b);
  symmetric.head(3 * kGroups) = Testing::ldltSolve(MK, b);
  ContactMatrix::Blocks A, K;
  for (const PairLaw& pair : t.dual.pairs) {
    const int i = int(t.setup.map->getGlobalElement(pair.normal)) / 3;
    A.push_back(blockA(i));
    K.push_back(blockK(i));
  }
  const auto asRows = [&](const Eigen::VectorXd& contact) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(t.vectors.numRows());
    t.vectors.setContact(x, contact);
    return x;
  };
  for (const auto kind : kKinds) {
    const ContactMatrix matrix = contactMatrix(t, kind);
    const Eigen::VectorXd mine = t.vectors.contact(t.local(rhs));
    TEST_COMPARE(t.difference(asRows(matrix.solve(A, K, mine, 1e-13)), general), <, 1e-10);
    TEST_COMPARE(t.difference(asRows(matrix.solveSymmetric(K, mine)), symmetric), <, 1e-10);
  }
  // Krylov methods that give up: the matrix is factored, if its rows are worth that many steps.
  for (const int rowsOfStep : {40, 1}) {
    SubspaceNewtonOptions::Condensed few;
    few.linearSteps = 3;
    few.rowsOfStep = rowsOfStep;
    const Eigen::VectorXd mine = t.vectors.contact(t.local(rhs));
    const double errorOfGeneral = t.difference(asRows(contactMatrix(t, ContactMatrix::Kind::Products, few).solve(A, K, mine, 1e-13)), general);
    const double errorOfSymmetric = t.difference(asRows(contactMatrix(t, ContactMatrix::Kind::Products, few).solveSymmetric(K, mine)), symmetric);
    TEST_EQUALITY(std::max(errorOfGeneral, errorOfSymmetric) < 1e-10, rowsOfStep == 40);
  }
}

// A body that friction holds along one axis only, by 1e-9 of what M is, goes far along the other: no residual tells of it.
TEUCHOS_UNIT_TEST(ContactMatrix, SolvesForMotionsThatMDoesNotFeel) {
  const Scene t(true);
  const Eigen::Index n = 3 * kGroups;
  const DenseMatrix J = t.GT.topRows(n).rightCols(6), N = orthonormalBasis(J), P = DenseMatrix::Identity(n, n) - N * N.transpose();
  DenseMatrix M = DenseMatrix::Zero(t.GT.rows(), t.GT.rows());
  M.topLeftCorner(n, n) = P * t.contactM() * P;
  const auto contactPart = [&](const DenseVector& x) -> Eigen::VectorXd {
    DenseVector all = DenseVector::Zero(t.GT.rows());
    all.head(n) = x;
    return t.vectors.contact(t.local(all));
  };
  const Eigen::Vector3d held(1, 0.5, 1e-9);
  const ContactMatrix::Blocks one(t.dual.pairs.size(), Eigen::Matrix3d::Identity()), K(t.dual.pairs.size(), held.asDiagonal());
  const DenseVector expected = numbers(n, 0.4) + 1e3 * J.col(1);
  const DenseVector b = M.topLeftCorner(n, n) * expected + held.replicate(kGroups, 1).cwiseProduct(expected);
  SubspaceNewtonOptions::Condensed options;
  options.pathLinearTolerance = 1e-6;
  options.rowsOfStep = 0;  // by Krylov methods alone
  DenseMatrix noisy = M;   // as one that was made in single precision
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) noisy(i, j) *= 1 + 1e-8 * std::sin(3.0 * double(i + j) + double(i * j));
  const auto errors = [&](const Eigen::MatrixXd& kernel, ContactMatrix::Kind kind = ContactMatrix::Kind::Products) -> Eigen::Vector2d {
    const auto& made = kind == ContactMatrix::Kind::Dense ? noisy : M;
    const ContactMatrix matrix({contactBlockOf(rcp(new DenseOperator(t.setup.map, made)), t.dual.pairs), contactPart(t.contactM().diagonal()), {}, kernel},
                               t.vectors, kind, options);
    const Eigen::VectorXd symmetric = matrix.solveSymmetric(K, contactPart(b)), general = matrix.solve(one, K, contactPart(b), 1e-6);
    TEST_COMPARE(matrix.kernelPart(contactPart(P * expected)).norm(), <, 1e-10 * expected.norm());
    return Eigen::Vector2d(t.vectors.norm(symmetric - contactPart(expected)), t.vectors.norm(general - contactPart(expected))) / expected.norm();
  };
  Eigen::MatrixXd kernel(3 * t.vectors.numPairs(), 6);
  for (Eigen::Index j = 0; j < 6; ++j) kernel.col(j) = contactPart(J.col(j));
  TEST_COMPARE(errors(kernel).maxCoeff(), <, 1e-4);
  TEST_COMPARE(errors(kernel.leftCols(0)).minCoeff(), >, 0.1);
  TEST_COMPARE(errors(kernel, ContactMatrix::Kind::Dense).maxCoeff(), <, 1e-4);
  TEST_COMPARE(errors(kernel.leftCols(0), ContactMatrix::Kind::Dense).minCoeff(), >, 0.1);

  // Two pairs say how their normals move: the motions that these leave are still the kernel's, and 1e-12 holds one of them.
  const Eigen::Vector3d hardly(1, 0.5, 1e-12);
  const DenseVector bent = numbers(n, 0.4), far = bent + 1e6 * J.col(1);
  DenseVector rhs = M.topLeftCorner(n, n) * bent + hardly.replicate(kGroups, 1).cwiseProduct(far);
  for (Eigen::Index at : {0, 3}) rhs[at] = far[at];
  ContactMatrix::Blocks A = one, B(t.dual.pairs.size(), hardly.asDiagonal());
  for (std::size_t i = 0; i < t.dual.pairs.size(); ++i)
    if (t.setup.map->getGlobalElement(t.dual.pairs[i].normal) / 3 < 2) A[i].row(0).setZero(), B[i](0, 0) = 1;
  const ContactMatrix matrix({contactBlockOf(rcp(new DenseOperator(t.setup.map, noisy)), t.dual.pairs), contactPart(t.contactM().diagonal()), {}, kernel},
                             t.vectors, ContactMatrix::Kind::Dense, options);
  const Eigen::VectorXd x = matrix.solve(A, B, contactPart(rhs), 1e-6);
  TEST_COMPARE(t.vectors.norm(x - contactPart(far)), <, 1e-4 * far.norm());

  // Along an axis without friction, at 0.3 here, a body stays where it is, and the rest is solved for.
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.bottomRightCorner<2, 2>() << std::cos(0.3), -std::sin(0.3), std::sin(0.3), std::cos(0.3);
  const Eigen::Matrix3d free = turn * Eigen::Vector3d(1, 0.5, 0).asDiagonal() * turn.transpose();
  const ContactMatrix::Blocks Kfree(t.dual.pairs.size(), free);
  const auto resisted = [&](const DenseVector& x) {
    DenseVector y = x;
    for (Eigen::Index i = 0; i < y.size(); i += 3) y.segment<3>(i) = free * x.segment<3>(i);
    return y;
  };
  const DenseVector load = M.topLeftCorner(n, n) * bent + resisted(bent);
  for (const Eigen::VectorXd& y : {matrix.solveSymmetric(Kfree, contactPart(load)), matrix.solve(one, Kfree, contactPart(load), 1e-6)}) {
    TEST_COMPARE(t.vectors.norm(matrix.multiply(y - contactPart(bent))), <, 1e-6 * load.norm());
    TEST_COMPARE(t.vectors.norm(y), <, 10 * bent.norm());
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

// Rows that pairs solve by themselves, as closed normals and sticking pairs have them, are left out of direct solves.
TEUCHOS_UNIT_TEST(ContactMatrix, LeavesOutWhatPairsSolveByThemselves) {
  const Scene t(false);
  DenseMatrix AMB = t.contactM();
  const auto blocks = [](int i) {  // open, sticking, sliding
    Eigen::Matrix3d A = (1.0 + i) * Eigen::Matrix3d::Identity(), B = Eigen::Matrix3d::Zero();
    if (i % 3 == 1) A.setZero(), B.diagonal() << -1, -2, -3;
    if (i % 3 == 2) A.row(0).setZero(), B << -1, 0, 0, 0.2, -0.7, 0.1, 0.3, 0.1, -0.5;
    return std::pair(A, B);
  };
  for (int i = 0; i < kGroups; ++i) {
    const auto [A, B] = blocks(i);
    AMB.middleRows<3>(3 * i) = (A * AMB.middleRows<3>(3 * i)).eval();
    AMB.block<3, 3>(3 * i, 3 * i) += B;
  }
  DenseVector rhs = DenseVector::Zero(t.GT.rows()), solution = rhs;
  rhs.head(3 * kGroups) = numbers(3 * kGroups, 0.7);
  solution.head(3 * kGroups) = Testing::luSolve(AMB, rhs.head(3 * kGroups));
  ContactMatrix::Blocks A, B;
  for (const PairLaw& pair : t.dual.pairs) {
    const auto [Ai, Bi] = blocks(int(t.setup.map->getGlobalElement(pair.normal)) / 3);
    A.push_back(Ai);
    B.push_back(Bi);
  }
  Eigen::VectorXd x = Eigen::VectorXd::Zero(t.vectors.numRows());
  t.vectors.setContact(x, contactMatrix(t, ContactMatrix::Kind::Dense).solve(A, B, t.vectors.contact(t.local(rhs)), 1e-13));
  TEST_COMPARE(t.difference(x, solution), <, 1e-10);
}

// Forces that differ by 1e-4 have a path that is the same but for its end; another law has another one.
TEUCHOS_UNIT_TEST(ConePath, BeginsWhereTheLastOneIsStillGood) {
  const Scene t(false);
  const ContactMatrix matrix = contactMatrix(t, ContactMatrix::Kind::Products);
  std::vector<PairLaw> pairs = t.dual.pairs, other = pairs;
  for (PairLaw& pair : pairs) pair.coefficients = {0.5, 5e-3};
  for (PairLaw& pair : other) pair.coefficients = {5e-3, 0.5};
  const Eigen::VectorXd lambda = t.vectors.contact(t.myLambda), s = t.vectors.contact(t.myS);
  ConePath path({});
  const auto steps = [&](const std::vector<PairLaw>& law, const Eigen::VectorXd& forces, bool fromStages) {
    int calls = 0;
    const auto residual = [&](const Eigen::VectorXd& sigma) {
      return t.vectors.norm(linearizeLaw(law, forces + matrix.multiply(sigma), s - sigma, t.r).phi);
    };
    const auto counted = [&](const Eigen::VectorXd& sigma) { return ++calls, residual(sigma); };
    const double target = 1e-5 * residual(Eigen::VectorXd::Zero(s.size()));
    const Eigen::VectorXd sigma = path.follow({law, matrix, forces, s, SlipTerm::Value}, counted, target, fromStages);
    TEST_COMPARE(residual(sigma), <=, target);
    return calls;
  };
  TEST_ASSERT(!path.hasStages());
  const int cold = steps(pairs, lambda, true), near = steps(pairs, (1 + 1e-4) * lambda, true), again = steps(pairs, (1 + 1e-4) * lambda, false);
  const int otherLaw = steps(other, lambda, true), otherCold = steps(other, lambda, false);
  out << "evaluations of the law: " << cold << ", from stages " << near << ", without them " << again << ", another law " << otherLaw << "\n";
  TEST_ASSERT(path.hasStages());
  TEST_COMPARE(2 * near, <=, again);
  TEST_EQUALITY(otherLaw, otherCold);
}

// Products that cost as much as the matrix end in it, where a factorisation costs less than those of a solve.
TEUCHOS_UNIT_TEST(ContactMatrix, IsMadeWhereProductsHaveCostAsMuch) {
  const Scene t(false);
  const ContactMatrix::Blocks K(t.dual.pairs.size(), Eigen::Matrix3d::Identity());
  const Eigen::VectorXd b = t.vectors.contact(t.myLambda);
  for (const int rowsOfStep : {40, 1}) {
    SubspaceNewtonOptions::Condensed options;
    options.rowsOfStep = rowsOfStep;
    const auto M = rcp(new CountedOperator(contactBlockOf(t.dual.M, t.dual.pairs)));
    const ContactMatrix matrix({M, Eigen::VectorXd::Ones(b.size())}, t.vectors, ContactMatrix::Kind::Products, options);
    const Eigen::VectorXd first = matrix.solveSymmetric(K, b);
    long before = 0, last = M->applications();
    for (int k = 0; k < 3 * kGroups; ++k) {
      const Eigen::VectorXd x = matrix.solveSymmetric(K, b);
      TEST_COMPARE(t.vectors.norm(x - first), <=, 1e-5 * t.vectors.norm(first));
      before = std::exchange(last, M->applications());
    }
    TEST_EQUALITY(last == before, rowsOfStep == 40);
  }
}

TEUCHOS_UNIT_TEST(ContactMatrix, PairsFeelTheirComplianceWithTheOthersOpen) {
  const Scene t(false);
  const ContactMatrix matrix = contactMatrix(t, ContactMatrix::Kind::Dense);
  const DenseMatrix flexibility = Testing::inverse(t.contactM());
  Eigen::VectorXd stiffness = Eigen::VectorXd::Zero(t.vectors.numRows()), normal = Eigen::VectorXd::Zero(3 * t.vectors.numPairs());
  const Eigen::VectorXd felt = matrix.normalStiffness();
  for (Eigen::Index i = 0; i < felt.size(); ++i) normal[3 * i] = felt[i];
  t.vectors.setContact(stiffness, normal);
  DenseVector expected = DenseVector::Zero(t.GT.rows());
  for (int i = 0; i < kGroups; ++i) expected[3 * i] = 1 / flexibility(3 * i, 3 * i);
  TEST_COMPARE(t.difference(stiffness, expected), <, 1e-8);
}

// What the law decides is so, and nothing is out of balance.
TEUCHOS_UNIT_TEST(BalancedDirection, IsBalancedAndFollowsTheLaw) {
  for (const bool floating : {false, true}) {
    const Scene t(floating);
    BalancedDirection balanced(t.dual, t.local(t.setup.d.M.diagonal()), t.vectors, t.balance, {});
    const DirectionPoint point{t.myLambda, t.myS, t.law.phi};
    const Direction direction = balanced.compute(t.dual.pairs, t.law, point, NewtonDirection::Target::Law);
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
