// SPDX-License-Identifier: BSD-3-Clause
// M between contact rows: solves with what pairs add, by Krylov methods and directly, against dense formulas.
#include <Teuchos_UnitTestHarness.hpp>

#include "DirectionScene.hpp"
#include "Haptos_CountedOperator.hpp"
#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_DirectionChoice.hpp"

namespace {

using namespace HaptosTest;

// Of pair i, wherever it is: A not symmetric, K symmetric and positive.
Eigen::Matrix3d blockA(int i) {
  return Eigen::Matrix3d::NullaryExpr([&](int r, int c) { return double(r == c) + 0.1 * std::sin(1.0 + i + 2 * r + 5 * c); });
}
Eigen::Matrix3d blockK(int i) { return std::pow(10.0, i % 5 - 2) * blockA(i) * blockA(i).transpose(); }

TEUCHOS_UNIT_TEST(ContactMatrix, SolvesWithWhatPairsAdd) {
  const Scene t(false);
  const DenseMatrix Mcc = t.contactM();
  const DenseVector b = numbers(3 * kGroups, 0.7);
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
    TEST_COMPARE(t.difference(asRows(ContactMatrix::Symmetric(matrix, K).solve(mine)), symmetric), <, 1e-10);
  }
  // Krylov methods that give up: the matrix is factored, if its rows are worth that many steps.
  for (const int rowsOfStep : {40, 1}) {
    SubspaceNewtonOptions::Condensed few;
    few.linearSteps = 3;
    few.rowsOfStep = rowsOfStep;
    const Eigen::VectorXd mine = t.vectors.contact(t.local(rhs));
    const double errorOfGeneral = t.difference(asRows(contactMatrix(t, ContactMatrix::Kind::Products, few).solve(A, K, mine, 1e-13)), general);
    const double errorOfSymmetric = t.difference(asRows(ContactMatrix::Symmetric(contactMatrix(t, ContactMatrix::Kind::Products, few), K).solve(mine)), symmetric);
    TEST_EQUALITY(std::max(errorOfGeneral, errorOfSymmetric) < 1e-10, rowsOfStep == 40);
  }
}

// Where M + D is solved with for any D, M maybe scaled.
TEUCHOS_UNIT_TEST(ContactMatrix, SolvesByAnExactMap) {
  const Scene t(false);
  const DenseVector b = numbers(3 * kGroups, 0.7);
  ContactMatrix::Blocks A, K;
  for (const PairLaw& pair : t.dual.pairs) {
    const int i = int(t.setup.map->getGlobalElement(pair.normal)) / 3;
    A.push_back(blockA(i));
    K.push_back(blockK(i));
  }
  const auto difference = [&t](const Eigen::VectorXd& mine, const DenseVector& wanted) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(t.vectors.numRows());
    t.vectors.setContact(x, mine);
    DenseVector all = DenseVector::Zero(t.GT.rows());
    all.head(wanted.size()) = wanted;
    return t.difference(x, all);
  };
  for (const double scale : {1.0, 0.5}) {
    const DenseMatrix M = scale * t.contactM();
    DenseMatrix AMB = M, MK = M;
    for (int i = 0; i < kGroups; ++i) {
      AMB.middleRows<3>(3 * i) = (blockA(i) * M.middleRows<3>(3 * i)).eval();
      AMB.block<3, 3>(3 * i, 3 * i) += blockK(i);
      MK.block<3, 3>(3 * i, 3 * i) += blockK(i);
    }
    ContactMatrix matrix = contactMatrix(t, ContactMatrix::Kind::Products, {}, exactMap(t));
    matrix.scale(scale);
    const Eigen::VectorXd mine = t.contactPart(b);
    const DenseVector general = Testing::luSolve(AMB, b), symmetric = Testing::ldltSolve(MK, b);
    TEST_COMPARE(difference(matrix.solve(A, K, mine, 1e-13), general), <, 1e-10);
    const Eigen::VectorXd solved = ContactMatrix::Symmetric(matrix, K).solve(mine);
    TEST_COMPARE(difference(solved, symmetric), <, 1e-10);
    TEST_COMPARE(difference(matrix.multiply(solved), M * symmetric), <, 1e-10);          // known from the solve
    TEST_COMPARE(difference(matrix.multiply(2 * solved), 2 * M * symmetric), <, 1e-10);  // a product
  }
}

// A factor of before is the preconditioner of a system that hardly differs, whose solution then has the tolerance's digits, and no more; one with more pairs that
// changed is factored anew.
TEUCHOS_UNIT_TEST(ContactMatrix, AFactorServesWhereFewPairsChanged) {
  const Scene t(false);
  SubspaceNewtonOptions::Condensed options;
  options.changedPairs = 2;
  const ContactMatrix matrix = contactMatrix(t, ContactMatrix::Kind::Dense, options);
  const DenseVector b = numbers(3 * kGroups, 0.7);
  const auto error = [&](int changed, double factor, double slightly) {  // K of the first pairs times `factor`, of the others times `slightly`
    const auto blockOf = [&](int i) -> Eigen::Matrix3d { return (i < changed ? factor : slightly) * blockK(i); };
    DenseMatrix AMB = t.contactM();
    ContactMatrix::Blocks A, K;
    for (int i = 0; i < kGroups; ++i) {
      AMB.middleRows<3>(3 * i) = (blockA(i) * AMB.middleRows<3>(3 * i)).eval();
      AMB.block<3, 3>(3 * i, 3 * i) += blockOf(i);
    }
    DenseVector rhs = DenseVector::Zero(t.GT.rows()), expected = rhs;
    rhs.head(3 * kGroups) = b;
    expected.head(3 * kGroups) = Testing::luSolve(AMB, b);
    for (const PairLaw& pair : t.dual.pairs) {
      const int i = int(t.setup.map->getGlobalElement(pair.normal)) / 3;
      A.push_back(blockA(i));
      K.push_back(blockOf(i));
    }
    Eigen::VectorXd x = Eigen::VectorXd::Zero(t.vectors.numRows());
    t.vectors.setContact(x, matrix.solve(A, K, t.vectors.contact(t.local(rhs)), 1e-4));
    return t.difference(x, expected);
  };
  TEST_COMPARE(error(0, 1, 1), <, 1e-12);
  for (const auto& [changed, factor] : {std::pair(0, 1.0), {2, 3.0}}) {
    const double left = error(changed, factor, 1.05);
    TEST_ASSERT(left > 1e-9 && left < 1e-2);
  }
  TEST_COMPARE(error(3, 3, 1.05), <, 1e-12);
}

// Bodies that float: M does not feel their motions J, and a load along one of them is nothing that a solution could have, A being 1/2.
struct FloatingScene : Scene {
  DenseMatrix J, P, M;
  DenseVector expected, possible, impossible;
  ContactMatrix::Blocks A{dual.pairs.size(), Eigen::Matrix3d(0.5 * Eigen::Matrix3d::Identity())};

  FloatingScene() : Scene(true), J(GT.topRows(3 * kGroups).rightCols(6)) {
    const DenseMatrix N = orthonormalBasis(J);
    P = DenseMatrix::Identity(N.rows(), N.rows()) - N * N.transpose();
    M = DenseMatrix::Zero(GT.rows(), GT.rows());
    M.topLeftCorner(N.rows(), N.rows()) = P * contactM() * P;
    expected = P * numbers(N.rows(), 0.4);
    possible = 0.5 * M.topLeftCorner(N.rows(), N.rows()) * expected;
    impossible = 7 * J.col(2);
  }
  ContactMatrix matrix(ContactMatrix::Kind kind, const SubspaceNewtonOptions::Condensed& options) const {
    Eigen::MatrixXd kernel(3 * vectors.numPairs(), J.cols());
    for (Eigen::Index j = 0; j < J.cols(); ++j) kernel.col(j) = contactPart(J.col(j));
    return {{contactBlockOf(rcp(new DenseOperator(setup.map, M)), dual.pairs), contactPart(M.diagonal().head(3 * kGroups)), {}, kernel}, vectors, kind, options};
  }
};

// Where all pairs are open nothing holds a floating body, and its part of b is nothing that a solution can have: what is left is solved, in few products, or
// there is no step at all.
TEUCHOS_UNIT_TEST(ContactMatrix, SolvesWhatIsPossibleWhereBodiesAreFree) {
  const FloatingScene t;
  SubspaceNewtonOptions::Condensed options;
  options.rowsOfStep = 1;  // no dense matrix
  const ContactMatrix matrix = t.matrix(ContactMatrix::Kind::Products, options);
  const ContactMatrix::Blocks B(t.dual.pairs.size(), Eigen::Matrix3d::Zero());
  const Eigen::VectorXd d = matrix.solve(t.A, B, t.contactPart(t.possible + t.impossible), 1e-12);
  TEST_COMPARE(t.vectors.norm(d - t.contactPart(t.expected)), <, 1e-8 * t.expected.norm());
  TEST_EQUALITY(t.vectors.norm(matrix.solve(t.A, B, t.contactPart(t.impossible), 1e-12)), 0.0);
}

// The same where the matrix is dense and the factor of before held the bodies by three pairs: by it what is free goes as far as round-off lets it.
TEUCHOS_UNIT_TEST(ContactMatrix, WhatComesFreeGoesNowhereByTheFactorOfBefore) {
  const FloatingScene t;
  const ContactMatrix matrix = t.matrix(ContactMatrix::Kind::Dense, {});
  const auto solve = [&](double held, const DenseVector& b) {
    ContactMatrix::Blocks B(t.dual.pairs.size(), Eigen::Matrix3d::Zero());
    for (std::size_t i = 0; i < B.size(); ++i)
      if (t.setup.map->getGlobalElement(t.dual.pairs[i].normal) < 9) B[i] = held * Eigen::Matrix3d::Identity();
    return matrix.solve(t.A, B, t.contactPart(b), 1e-6);
  };
  TEST_ASSERT(t.vectors.norm(solve(1e-3, t.possible + t.impossible)) > 1e2 * t.expected.norm());
  TEST_COMPARE(t.vectors.norm(solve(0, t.possible + t.impossible) - t.contactPart(t.expected)), <, 1e-10 * t.expected.norm());
  TEST_EQUALITY(t.vectors.norm(solve(0, t.impossible)), 0.0);
  solve(1e3, t.possible);
  TEST_ASSERT(matrix.wasSmall());  // forces of few pairs are as good as before: they were no reason
}

// A body that friction holds along one axis only, by 1e-9 of what M is, goes far along the other: no residual tells of it.
TEUCHOS_UNIT_TEST(ContactMatrix, SolvesForMotionsThatMDoesNotFeel) {
  const FloatingScene t;
  const Eigen::Index n = 3 * kGroups;
  const DenseMatrix &J = t.J, &P = t.P, &M = t.M;
  const auto contactPart = [&](const DenseVector& x) { return t.contactPart(x); };
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
    const Eigen::VectorXd symmetric = ContactMatrix::Symmetric(matrix, K).solve(contactPart(b)), general = matrix.solve(one, K, contactPart(b), 1e-6);
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
  for (const Eigen::VectorXd& y : {ContactMatrix::Symmetric(matrix, Kfree).solve(contactPart(load)), matrix.solve(one, Kfree, contactPart(load), 1e-6)}) {
    TEST_COMPARE(t.vectors.norm(matrix.multiply(y - contactPart(bent))), <, 1e-6 * load.norm());
    TEST_COMPARE(t.vectors.norm(y), <, 10 * bent.norm());
  }
}

// A body slides along an axis without friction: neither M nor the law feels it, and it stays where it is, whatever solves the rest.
TEUCHOS_UNIT_TEST(ContactMatrix, LeavesFreeMotionsWhereTheyAre) {
  const Scene t(true);
  const Eigen::Index n = 3 * kGroups;
  DenseVector slide = DenseVector::Zero(n);
  for (Eigen::Index i = 2; i < n; i += 3) slide[i] = 1;
  const DenseMatrix P = DenseMatrix::Identity(n, n) - slide * slide.transpose() / slide.squaredNorm();
  DenseMatrix M = DenseMatrix::Zero(t.GT.rows(), t.GT.rows());
  M.topLeftCorner(n, n) = P * t.contactM() * P;
  const auto contactPart = [&](const DenseVector& x) { return t.contactPart(x); };
  const Eigen::Vector3d held(1, 0.5, 0);
  const DenseVector bent = P * numbers(n, 0.4), b = M.topLeftCorner(n, n) * bent + held.replicate(kGroups, 1).cwiseProduct(bent);
  const ContactMatrix::Blocks one(t.dual.pairs.size(), Eigen::Matrix3d::Identity()), K(t.dual.pairs.size(), held.asDiagonal());
  ContactMatrix::Blocks open = K;  // enough of them for a factor by forces
  for (std::size_t i = 0; i < open.size(); ++i)
    if (t.setup.map->getGlobalElement(t.dual.pairs[i].normal) / 3 > 3) open[i].setZero();
  DenseVector few = M.topLeftCorner(n, n) * bent;
  few.head<12>() += held.replicate(4, 1).cwiseProduct(bent.head<12>());
  for (const auto kind : kKinds) {
    SubspaceNewtonOptions::Condensed options;
    options.pathLinearTolerance = 1e-10;
    const ContactMatrix matrix({contactBlockOf(rcp(new DenseOperator(t.setup.map, M)), t.dual.pairs), contactPart(t.contactM().diagonal()), {},
                                Eigen::MatrixXd(contactPart(slide))},
                               t.vectors, kind, options);
    for (const Eigen::VectorXd& y : {ContactMatrix::Symmetric(matrix, K).solve(contactPart(b)), matrix.solve(one, K, contactPart(b), 1e-10),
                                     matrix.solve(one, open, contactPart(few), 1e-10)})
      TEST_COMPARE(t.vectors.norm(y - contactPart(bent)), <, 1e-6 * bent.norm());
  }
}

// Rows that pairs solve by themselves, as closed normals and sticking pairs have them, are left out of direct solves.
// Scaled as stiff and as soft as may be; a step that is given up has values that are not finite, and holds all.
TEUCHOS_UNIT_TEST(MotionsOfB, AreHeldOrFree) {
  const DenseMatrix turn = PivotedQr(DenseMatrix::NullaryExpr(3, 3, [](auto i, auto j) { return std::cos(1.0 + 3 * i + 5 * j); })).Q;
  for (const double size : {1e-9, 1.0, 1e9}) {
    const DenseMatrix images = size * DenseVector{{1, 1e-9, 1e-16}}.asDiagonal() * turn.transpose();
    const MotionsOfB motions(images);
    TEST_EQUALITY(motions.held.cols(), 2);
    TEST_EQUALITY(motions.free.cols(), 1);
    TEST_COMPARE((images * motions.free).norm(), <=, 1e-15 * size);
    TEST_COMPARE((motions.held.transpose() * motions.free).norm(), <=, 1e-14);
    TEST_EQUALITY(MotionsOfB(0.0 * images).free.cols(), 3);
    TEST_EQUALITY(MotionsOfB(std::numeric_limits<double>::quiet_NaN() * images).held, DenseMatrix(DenseMatrix::Identity(3, 3)));
  }
}

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

// Where most pairs are open their forces are known, and the others' are solved for: with and without motions that M does not feel, and with a row that it
// does not have.
TEUCHOS_UNIT_TEST(ContactMatrix, SolvesForForcesOfTheFewClosedPairs) {
  constexpr Eigen::Index kNotThere = 1;  // of an open pair
  const auto blocks = [](int i) {        // sticking, sliding, open
    Eigen::Matrix3d A = (1.0 + i) * Eigen::Matrix3d::Identity(), B = Eigen::Matrix3d::Zero();
    if (i % 4 == 1) A.setZero(), B.diagonal() << -1, -2, -3;
    if (i == 2) A.row(0).setZero(), B << -1, 0, 0, 0.2, -0.7, 0.1, 0.3, 0.1, -0.5;
    return std::pair(A, B);
  };
  for (const bool isFloating : {false, true}) {
    const Scene t(isFloating);
    const Eigen::Index n = 3 * kGroups;
    const DenseMatrix J = t.GT.topRows(n).rightCols(6), N = orthonormalBasis(J), P = DenseMatrix::Identity(n, n) - N * N.transpose();
    DenseMatrix M = DenseMatrix::Zero(t.GT.rows(), t.GT.rows());
    M.topLeftCorner(n, n) = isFloating ? DenseMatrix(P * t.contactM() * P) : t.contactM();
    if (!isFloating) M.row(kNotThere).setZero(), M.col(kNotThere).setZero();
    DenseMatrix AMB = M.topLeftCorner(n, n);
    DenseVector rhs = DenseVector::Zero(t.GT.rows()), solution = rhs;
    rhs.head(n) = numbers(n, 0.7);
    ContactMatrix::Blocks A, B;
    for (int i = 0; i < kGroups; ++i) {
      const auto [Ai, Bi] = blocks(i);
      AMB.middleRows<3>(3 * i) = (Ai * AMB.middleRows<3>(3 * i)).eval();
      AMB.block<3, 3>(3 * i, 3 * i) += Bi;
    }
    if (!isFloating) AMB(kNotThere, kNotThere) = 1, rhs[kNotThere] = 0;
    solution.head(n) = Testing::luSolve(AMB, rhs.head(n));
    for (const PairLaw& pair : t.dual.pairs) {
      const auto [Ai, Bi] = blocks(int(t.setup.map->getGlobalElement(pair.normal)) / 3);
      A.push_back(Ai);
      B.push_back(Bi);
    }
    const auto contactPart = [&](const DenseVector& x) { return t.vectors.contact(t.local(x)); };
    Eigen::MatrixXd kernel(3 * t.vectors.numPairs(), isFloating ? 6 : 0);
    for (Eigen::Index j = 0; j < kernel.cols(); ++j) {
      DenseVector motion = DenseVector::Zero(t.GT.rows());
      motion.head(n) = J.col(j);
      kernel.col(j) = contactPart(motion);
    }
    const ContactMatrix matrix({contactBlockOf(rcp(new DenseOperator(t.setup.map, M)), t.dual.pairs), contactPart(M.diagonal()), {}, kernel}, t.vectors,
                               ContactMatrix::Kind::Dense, {});
    Eigen::VectorXd x = Eigen::VectorXd::Zero(t.vectors.numRows());
    t.vectors.setContact(x, matrix.solve(A, B, contactPart(rhs), 1e-13));
    TEST_COMPARE(t.difference(x, solution), <, 1e-10);
    TEST_ASSERT(matrix.wasSmall());
  }
}

// Products that cost as much as the matrix end in it, where a factorisation costs less than those of a solve; those that read more than it does
// end in it sooner, and go on as products of the matrix.
TEUCHOS_UNIT_TEST(ContactMatrix, IsMadeWhereProductsHaveCostAsMuch) {
  const Scene t(false);
  const ContactMatrix::Blocks K(t.dual.pairs.size(), Eigen::Matrix3d::Identity());
  const Eigen::VectorXd b = t.vectors.contact(t.myLambda);
  const double rows = t.vectors.sum(double(b.size()));
  for (const auto& [rowsOfStep, entriesRead] : {std::pair(40, 0.0), {1, 0.0}, {1, 10 * rows * rows}}) {
    SubspaceNewtonOptions::Condensed options;
    options.rowsOfStep = rowsOfStep;
    const auto M = rcp(new CountedOperator(contactBlockOf(t.dual.M, t.dual.pairs)));
    const ContactMatrix matrix({M, Eigen::VectorXd::Ones(b.size()), {}, {}, {}, entriesRead}, t.vectors, ContactMatrix::Kind::Products, options);
    const Eigen::VectorXd first = ContactMatrix::Symmetric(matrix, K).solve(b);
    long before = 0, last = M->applications();
    for (int k = 0; k < 3 * kGroups; ++k) {
      const Eigen::VectorXd x = ContactMatrix::Symmetric(matrix, K).solve(b);
      TEST_COMPARE(t.vectors.norm(x - first), <=, 1e-5 * t.vectors.norm(first));
      before = std::exchange(last, M->applications());
    }
    TEST_EQUALITY(last == before, rowsOfStep == 40 || entriesRead > 0);
    if (entriesRead > 0) TEST_COMPARE(double(last), <, 2 * rows);  // a twelfth of the rows, what a solve takes, and the columns
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

}  // namespace
