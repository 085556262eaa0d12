// SPDX-License-Identifier: BSD-3-Clause
// Groups of pairs, and coarse jumps beside them, for Krylov methods on contact rows, against dense formulas.
#include <Teuchos_UnitTestHarness.hpp>

#include "DirectionScene.hpp"
#include "Haptos_CountedOperator.hpp"
#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_Rendezvous.hpp"

namespace {

using namespace HaptosTest;

constexpr Eigen::Index kSoft = 12, kRows = 3 * kGroups;

// M with energies of 0.5 to 1.5, but for the first columns of an orthonormal W, which cost 1e-7 to 3e-2; the motions J of a floating body cost none.
struct SoftMatrix {
  DenseMatrix M, soft;

  explicit SoftMatrix(const Scene& t, bool isFloating) {
    DenseMatrix start = DenseMatrix::NullaryExpr(kRows, kRows, [](Eigen::Index i, Eigen::Index j) { return std::sin(double(1 + i) * double(3 + j)); });
    const Eigen::Index k = isFloating ? 6 : 0;
    if (isFloating) start.leftCols(k) = t.GT.topRows(kRows).rightCols(k);
    const DenseMatrix W = orthonormalBasis(start);
    DenseVector energies = DenseVector::LinSpaced(kRows, 0.5, 1.5);
    energies.head(k).setZero();
    for (Eigen::Index i = 0; i < kSoft; ++i) energies[k + i] = std::pow(10.0, 0.5 * double(i) - 7);
    M = W * energies.asDiagonal() * W.transpose();
    soft = W.middleCols(k, kSoft);
  }
};

// Pair i, wherever it is: closed pairs stick or slide, others are open.
std::pair<Eigen::Matrix3d, Eigen::Matrix3d> blocksOf(int i) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Identity(), B = Eigen::Matrix3d::Zero();
  if (i % 4 == 1) A.setZero(), B.setIdentity();
  if (i % 4 == 2) A.row(0).setZero(), B << 1, 0, 0, 0.1, 0.3, 0.05, 0.2, 0.05, 0.4;
  return {A, B};
}
Eigen::Matrix3d resistance(int i) { return Eigen::Vector3d(std::pow(10.0, i % 4 - 3), 1e-3, 1e-2).asDiagonal(); }

// This rank's pairs of three groups by their numbers among all: a group has also a pair of the next.
SchwarzPreconditioner::Groups groupsOf(const Scene& t, const DenseMatrix& M) {
  constexpr int kSize = kGroups / 3;
  SchwarzPreconditioner::Groups groups{std::vector<PairGroup>(3), {}};
  std::vector<std::vector<int>> numbers(3);
  for (std::size_t k = 0; k < t.dual.pairs.size(); ++k) {
    const int i = int(t.setup.map->getGlobalElement(t.dual.pairs[k].normal)) / 3;
    for (const auto& [g, isOwn] : {std::pair(i / kSize, true), {(i / kSize + 2) % 3, false}}) {
      if (!isOwn && i % kSize != 0) continue;
      groups.members[std::size_t(g)].pairs.push_back(int(k));
      groups.members[std::size_t(g)].isOwn.push_back(isOwn);
      numbers[std::size_t(g)].push_back(i);
    }
  }
  for (auto& mine : numbers) {
    std::vector<int> rows;
    for (const int i : gatheredOnAll(t.vectors.comm(), mine)) rows.insert(rows.end(), {3 * i, 3 * i + 1, 3 * i + 2});
    groups.M.push_back(M(rows, rows));
  }
  return groups;
}

// P r by dense formulas, with own pairs of a group and one of the next.
DenseVector schwarzOf(const DenseMatrix& G, const DenseVector& r) {
  constexpr int kSize = kGroups / 3;
  DenseVector z(r.size());
  for (int g = 0; g < 3; ++g) {
    std::vector<int> rows;
    for (int k = 0; k < 3 * (kSize + 1); ++k) rows.push_back((3 * kSize * g + k) % int(r.size()));
    const DenseMatrix part = G(rows, rows);
    const DenseVector known = r(rows), solution = Testing::luSolve(part, known);
    z.segment(3 * kSize * g, 3 * kSize) = solution.head(3 * kSize);
  }
  return z;
}

TEUCHOS_UNIT_TEST(SchwarzPreconditioner, SolvesGroupsAndKeepsThoseOfOwnPairs) {
  const Scene t(false);
  const DenseMatrix M = t.contactM();
  const ContactNumbering numbering(t.vectors);
  SchwarzPreconditioner schwarz(numbering, groupsOf(t, M));
  const auto blocksWith = [&](double factor) {  // of the pairs of the second group
    ContactMatrix::Blocks A, B;
    for (const PairLaw& pair : t.dual.pairs) {
      const int i = int(t.setup.map->getGlobalElement(pair.normal)) / 3;
      A.push_back(blocksOf(i).first);
      B.push_back((i == 6 ? factor : 1) * blocksOf(i).second);
    }
    return numbering.blocksOfAll(A, B);
  };
  const auto matrixWith = [&](double scaling, double factor) {
    DenseMatrix G(kRows, kRows);
    for (int i = 0; i < kGroups; ++i) {
      G.middleRows<3>(3 * i) = blocksOf(i).first * scaling * M.middleRows<3>(3 * i);
      G.block<3, 3>(3 * i, 3 * i) += (i == 6 ? factor : 1) * blocksOf(i).second;
    }
    return G;
  };
  const DenseVector r = numbers(kRows, 0.8), other = numbers(kRows, 0.2);
  const auto error = [&](const SchwarzPreconditioner& schwarz, const DenseMatrix& G) {
    Eigen::MatrixXd both(3 * t.vectors.numPairs(), 2);
    both << t.contactPart(r), t.contactPart(other);
    const Eigen::MatrixXd z = schwarz.apply(both);
    const auto differs = [&](const DenseVector& x, const Eigen::VectorXd& mine) { return t.vectors.norm(mine - t.contactPart(schwarzOf(G, x))) / x.norm(); };
    return std::max({differs(r, z.col(0)), differs(other, z.col(1)), differs(r, schwarz.apply(t.contactPart(r)))});
  };
  TEST_ASSERT(schwarz.renew(1, blocksWith(1)));
  TEST_COMPARE(error(schwarz, matrixWith(1, 1)), <, 1e-6);
  TEST_ASSERT(!schwarz.renew(1, blocksWith(1.05)));  // little has changed
  TEST_COMPARE(error(schwarz, matrixWith(1, 1)), <, 1e-6);
  TEST_ASSERT(schwarz.renew(1, blocksWith(2)));
  TEST_COMPARE(error(schwarz, matrixWith(1, 2)), <, 1e-6);
  TEST_ASSERT(schwarz.renew(3, blocksWith(2)));  // another M
  TEST_COMPARE(error(schwarz, matrixWith(3, 2)), <, 1e-6);
  TEST_ASSERT(!schwarz.renew(3, blocksWith(2)));
}

// A row of no multiplier has nothing in M, and open pairs nothing in B: the others are solved as without it.
TEUCHOS_UNIT_TEST(SchwarzPreconditioner, RowsOfNoMultiplierHarmNoGroup) {
  const Scene t(false);
  constexpr Eigen::Index kNone = 7;
  DenseMatrix M = t.contactM();
  M.row(kNone).setZero(), M.col(kNone).setZero();
  const ContactNumbering numbering(t.vectors);
  SchwarzPreconditioner schwarz(numbering, groupsOf(t, M));
  const std::size_t mine = t.dual.pairs.size();
  schwarz.renew(1, numbering.blocksOfAll(ContactMatrix::Blocks(mine, Eigen::Matrix3d::Identity()), ContactMatrix::Blocks(mine, Eigen::Matrix3d::Zero())));
  DenseMatrix G = M;
  G(kNone, kNone) = 1;
  const DenseVector r = numbers(kRows, 0.8), wanted = schwarzOf(G, r);
  TEST_COMPARE(t.vectors.norm(schwarz.apply(t.contactPart(r)) - t.contactPart(wanted)), <, 1e-6 * wanted.norm());
}

ContactMatrix::Blocks resistances(const Scene& t) {
  ContactMatrix::Blocks K;
  for (const PairLaw& pair : t.dual.pairs) K.push_back(resistance(int(t.setup.map->getGlobalElement(pair.normal)) / 3));
  return K;
}

// The symmetric form of the same groups; the first pair of each is one of two groups.
DenseVector symmetricSchwarzOf(const DenseMatrix& G, const DenseVector& r) {
  constexpr int kSize = kGroups / 3;
  DenseVector D = DenseVector::Ones(r.size()), z = DenseVector::Zero(r.size());
  for (int g = 0; g < 3; ++g) D.segment<3>(3 * kSize * g).setConstant(std::sqrt(0.5));
  for (int g = 0; g < 3; ++g) {
    std::vector<int> rows;
    for (int k = 0; k < 3 * (kSize + 1); ++k) rows.push_back((3 * kSize * g + k) % int(r.size()));
    const DenseVector known = D(rows).cwiseProduct(r(rows)), solution = Testing::luSolve(DenseMatrix(G(rows, rows)), known);
    z(rows) += D(rows).cwiseProduct(solution);
  }
  return z;
}

TEUCHOS_UNIT_TEST(SchwarzPreconditioner, SymmetricFormSharesPairsOfSeveralGroups) {
  const Scene t(false);
  const DenseMatrix M = t.contactM();
  const ContactNumbering numbering(t.vectors);
  const Eigen::MatrixXd blocks = numbering.blocksOfAll(ContactMatrix::Blocks(t.dual.pairs.size(), Eigen::Matrix3d::Identity()), resistances(t));
  SchwarzPreconditioner restricted(numbering, groupsOf(t, M));
  restricted.renew(1, blocks);
  auto schwarz = restricted.withForm(SchwarzPreconditioner::Form::Symmetric);
  const DenseVector r = numbers(kRows, 0.8);
  for (const double scaling : {1.0, 3.0}) {
    TEST_ASSERT(schwarz.renew(scaling, blocks));
    DenseMatrix G = scaling * M;
    for (int i = 0; i < kGroups; ++i) G.block<3, 3>(3 * i, 3 * i) += resistance(i);
    const DenseVector wanted = symmetricSchwarzOf(G, r);
    const Eigen::MatrixXd z = schwarz.apply(t.contactPart(r).replicate(1, 2));
    TEST_COMPARE(t.vectors.norm(z.col(0) - t.contactPart(wanted)), <, 1e-6 * wanted.norm());
    TEST_COMPARE(t.vectors.norm(z.col(1) - t.contactPart(wanted)), <, 1e-6 * wanted.norm());
    TEST_COMPARE(t.vectors.norm(schwarz.apply(t.contactPart(r)) - t.contactPart(wanted)), <, 1e-6 * wanted.norm());
  }
}

// Round-off may leave a group's matrix indefinite: its pairs are solved one by one then, as conjugate gradients want what is positive.
TEUCHOS_UNIT_TEST(SchwarzPreconditioner, SymmetricFormOfWhatIsNotPositiveIsThatOfPairs) {
  const Scene t(false);
  DenseMatrix M = DenseMatrix::Constant(kRows, kRows, 10.0);
  for (int i = 0; i < kGroups; ++i) M.block<3, 3>(3 * i, 3 * i) = Eigen::Matrix3d(Eigen::Vector3d(1, 2, 3).asDiagonal());
  const ContactNumbering numbering(t.vectors);
  SchwarzPreconditioner schwarz(numbering, groupsOf(t, M), SchwarzPreconditioner::Form::Symmetric);
  schwarz.renew(1, numbering.blocksOfAll(ContactMatrix::Blocks(t.dual.pairs.size(), Eigen::Matrix3d::Identity()), resistances(t)));
  const DenseVector r = numbers(kRows, 0.8);
  DenseVector wanted(kRows);
  for (int i = 0; i < kGroups; ++i)
    wanted.segment<3>(3 * i) = r.segment<3>(3 * i).cwiseQuotient(Eigen::Vector3d(1, 2, 3) + resistance(i).diagonal());
  TEST_COMPARE(t.vectors.norm(schwarz.apply(t.contactPart(r)) - t.contactPart(wanted)), <, 1e-6 * wanted.norm());
}

using Smooth = std::function<Eigen::MatrixXd()>;
using Groups = std::function<SchwarzPreconditioner::Groups()>;

ContactMatrix matrixOf(const Scene& t, const SoftMatrix& m, bool isFloating, const Smooth& smooth, const Groups& groups,
                       const SubspaceNewtonOptions::Condensed& options, RCP<const CountedOperator>* counted = nullptr, bool haveMatrices = true) {
  const auto contactPart = [&](const DenseVector& x) { return t.contactPart(x); };
  DenseMatrix whole = DenseMatrix::Zero(t.GT.rows(), t.GT.rows());
  whole.topLeftCorner(kRows, kRows) = m.M;
  Eigen::MatrixXd kernel(3 * t.vectors.numPairs(), isFloating ? 6 : 0);
  for (Eigen::Index j = 0; j < kernel.cols(); ++j) kernel.col(j) = contactPart(t.GT.topRows(kRows).rightCols(6).col(j));
  const RCP<const CountedOperator> M = rcp(new CountedOperator(contactBlockOf(rcp(new DenseOperator(t.setup.map, whole)), t.dual.pairs)));
  if (counted) *counted = M;
  ContactMatrix::Parts parts{M, contactPart(m.M.diagonal()), {}, kernel, smooth};
  if (groups) {
    const auto made = std::make_shared<SchwarzPreconditioner::Groups>();
    parts.groups = [groups, made] { return (*made = groups()).members; };
    if (haveMatrices) parts.ofGroups = [made](const auto&) { return made->M; };
  }
  return ContactMatrix(parts, t.vectors, ContactMatrix::Kind::Products, options);
}

// Errors of (M + K) d = b and of (A M + B) d = b, relative; the matrix was scaled.
Eigen::Vector2d errorsOf(const ContactMatrix& matrix, const Scene& t, const SoftMatrix& m, double scaling, bool isTwice) {
  const DenseVector expected = numbers(kRows, 0.4);
  DenseVector symmetric = scaling * (m.M * expected), general = symmetric;
  for (int i = 0; i < kGroups; ++i) {
    const auto [A, B] = blocksOf(i);
    general.segment<3>(3 * i) = (A * general.segment<3>(3 * i) + B * expected.segment<3>(3 * i)).eval();
    symmetric.segment<3>(3 * i) += resistance(i) * expected.segment<3>(3 * i);
  }
  ContactMatrix::Blocks A, B, K;
  for (const PairLaw& pair : t.dual.pairs) {
    const int i = int(t.setup.map->getGlobalElement(pair.normal)) / 3;
    A.push_back(blocksOf(i).first);
    B.push_back(blocksOf(i).second);
    K.push_back(resistance(i));
  }
  const Eigen::VectorXd b = t.contactPart(general);
  const Eigen::VectorXd x = ContactMatrix::Symmetric(matrix, K).solve(t.contactPart(symmetric)), y = matrix.solve(A, B, b, 1e-10);
  const Eigen::VectorXd again = matrix.solve(A, B, b, 1e-10);  // with the coarse space as it is
  const auto error = [&](const Eigen::VectorXd& z) { return t.vectors.norm(z - t.contactPart(expected)) / expected.norm(); };
  return Eigen::Vector2d(error(x), isTwice ? std::max(error(y), error(again)) : error(y));
}

Eigen::Vector2d errors(const Scene& t, const SoftMatrix& m, bool isFloating, const Smooth& smooth, const SubspaceNewtonOptions::Condensed& options,
                       bool hasGroups = true) {
  return errorsOf(matrixOf(t, m, isFloating, smooth, hasGroups ? [&] { return groupsOf(t, m.M); } : Groups(), options), t, m, 1, bool(smooth));
}

// This rank's rows.
Eigen::MatrixXd contactColumns(const Scene& t, const DenseMatrix& X) {
  Eigen::MatrixXd mine(3 * t.vectors.numPairs(), X.cols());
  for (Eigen::Index j = 0; j < X.cols(); ++j) mine.col(j) = t.contactPart(X.col(j));
  return mine;
}

// Of Krylov methods that are soon at their bound, and too few for a dense matrix.
SubspaceNewtonOptions::Condensed fewSteps(bool isFloating) {
  SubspaceNewtonOptions::Condensed options;
  options.pathLinearTolerance = 1e-10;
  options.linearSteps = isFloating ? 20 : 10;
  options.rowsOfStep = 1;
  options.groupRows = 0;
  return options;
}

// Few steps do where soft jumps are solved for by themselves, and do not where they are not; a space that is of no use is given up for the dense matrix.
TEUCHOS_UNIT_TEST(ContactCoarse, FewStepsSolveWhatSoftJumpsMakeHard) {
  for (const bool isFloating : {false, true}) {
    const Scene t(isFloating);
    const SoftMatrix m(t, isFloating);
    auto options = fewSteps(isFloating);
    const auto columns = [&](const DenseMatrix& X) { return [&t, X] { return contactColumns(t, X); }; };
    DenseMatrix dependent(kRows, 2 * kSoft);  // with half of them twice
    dependent << m.soft, m.soft * DenseMatrix::Constant(kSoft, kSoft, 0.3);
    TEST_COMPARE(errors(t, m, isFloating, columns(dependent), options).maxCoeff(), <, 1e-6);
    TEST_COMPARE(errors(t, m, isFloating, {}, options).minCoeff(), >, 1e-3);
    const auto useless = columns(DenseMatrix::Identity(kRows, 2));
    TEST_COMPARE(errors(t, m, isFloating, useless, options).minCoeff(), >, 1e-3);
    options.rowsOfStep = 40;
    options.coarseTrials = 100;
    TEST_COMPARE(errors(t, m, isFloating, useless, options).minCoeff(), >, 1e-3);
    TEST_COMPARE(errors(t, m, isFloating, {}, options, false).maxCoeff(), <, 1e-6);  // with nothing else the dense matrix comes at once
    options.groupRows = kRows + 1;  // and where rows are few
    TEST_COMPARE(errors(t, m, isFloating, useless, options).maxCoeff(), <, 1e-6);
    options.groupRows = 0;
    options.coarseTrials = 1;
    TEST_COMPARE(errors(t, m, isFloating, useless, options).maxCoeff(), <, 1e-6);
    TEST_COMPARE(errors(t, m, isFloating, columns(DenseMatrix::Zero(kRows, 2)), options).maxCoeff(), <, 1e-6);
  }
}

// What couples the pairs of a group is nothing that pairs one by one could resolve: groups do, in symmetric systems and in others.
TEUCHOS_UNIT_TEST(SchwarzPreconditioner, FewStepsSolveWhatGroupsMakeHard) {
  const Scene t(false);
  SoftMatrix m(t, false);
  constexpr Eigen::Index kSize = kRows / 3;
  const auto basisOf = [](Eigen::Index g) {
    return orthonormalBasis(DenseMatrix::NullaryExpr(kSize, kSize, [g](Eigen::Index i, Eigen::Index j) { return std::sin(double(1 + i + g) * double(3 + j)); }));
  };
  const DenseVector energies = DenseVector::LinSpaced(kSize, -5, 0).unaryExpr([](double x) { return std::pow(10.0, x); });
  m.M.setZero();
  for (Eigen::Index g = 0; g < 3; ++g) m.M.block(kSize * g, kSize * g, kSize, kSize) = basisOf(g) * energies.asDiagonal() * basisOf(g).transpose();
  auto options = fewSteps(false);
  options.linearSteps = 20;
  const Groups groups = [&] { return groupsOf(t, m.M); };
  const auto errorOfSecond = [&](const Groups& some, bool haveMatrices = true) {  // groups come once GMRES wants them
    const ContactMatrix matrix = matrixOf(t, m, false, {}, some, options, nullptr, haveMatrices);
    errorsOf(matrix, t, m, 1, false);
    return errorsOf(matrix, t, m, 1, false);
  };
  TEST_COMPARE(errorOfSecond({}).minCoeff(), >, 1e-3);
  TEST_COMPARE(errorOfSecond(groups).minCoeff(), <, 1e-6);
  TEST_COMPARE(errorOfSecond(groups).maxCoeff(), >, 1e-3);  // conjugate gradients are left without them where products read next to nothing
  options.groupFactor = 0;
  TEST_COMPARE(errorOfSecond(groups).maxCoeff(), <, 1e-6);
  TEST_COMPARE(errorOfSecond(groups, false).maxCoeff(), <, 1e-6);  // parts of the matrix, made for them
}

// They cost products with M, which need not be made again.
TEUCHOS_UNIT_TEST(ContactCoarse, AScaledMatrixKeepsItsGroupsAndItsCoarseSpace) {
  constexpr double kScaling = 0.4;
  for (const bool isFloating : {false, true}) {
    const Scene t(isFloating);
    const SoftMatrix m(t, isFloating);
    int numSmooth = 0, numGroups = 0;
    const auto smooth = [&] {
      ++numSmooth;
      return contactColumns(t, m.soft);
    };
    const auto groups = [&] {
      ++numGroups;
      return groupsOf(t, m.M);
    };
    ContactMatrix matrix = matrixOf(t, m, isFloating, smooth, groups, fewSteps(isFloating));
    TEST_COMPARE(errorsOf(matrix, t, m, 1, true).maxCoeff(), <, 1e-6);
    matrix.scale(kScaling);
    TEST_COMPARE(errorsOf(matrix, t, m, kScaling, true).maxCoeff(), <, 1e-6);
    TEST_EQUALITY(numSmooth, 1);
    TEST_EQUALITY(numGroups, 1);
  }
}

// Error of (A M + B) d = b with the law of other pairs, and what is resisted more or less.
double errorWithLawOf(const ContactMatrix& matrix, const Scene& t, const SoftMatrix& m, int shift, double factor, double tolerance) {
  const DenseVector expected = numbers(kRows, 0.4);
  DenseVector general = m.M * expected;
  const auto lawOf = [&](int i) {
    auto [A, B] = blocksOf(i + shift);
    return std::pair<Eigen::Matrix3d, Eigen::Matrix3d>(A, factor * B);
  };
  for (int i = 0; i < kGroups; ++i) {
    const auto [A, B] = lawOf(i);
    general.segment<3>(3 * i) = (A * general.segment<3>(3 * i) + B * expected.segment<3>(3 * i)).eval();
  }
  ContactMatrix::Blocks A, B;
  for (const PairLaw& pair : t.dual.pairs) {
    const auto [Ai, Bi] = lawOf(int(t.setup.map->getGlobalElement(pair.normal)) / 3);
    A.push_back(Ai);
    B.push_back(Bi);
  }
  return t.vectors.norm(matrix.solve(A, B, t.contactPart(general), tolerance) - t.contactPart(expected)) / expected.norm();
}

// No column of M Z is made for a law that differs a little; for another one they are, before steps come to their bound.
TEUCHOS_UNIT_TEST(ContactCoarse, CoarseJumpsServeUntilStepsCostAsMuch) {
  const Scene t(false);
  const SoftMatrix m(t, false);
  auto options = fewSteps(false);
  options.linearSteps = 14;
  RCP<const CountedOperator> M;
  const ContactMatrix matrix = matrixOf(t, m, false, [&] { return contactColumns(t, m.soft); }, [&] { return groupsOf(t, m.M); }, options, &M);
  const auto productsOf = [&](int shift, double factor, double tolerance) {
    const long before = M->applications();
    const double error = errorWithLawOf(matrix, t, m, shift, factor, tolerance);
    const long products = M->applications() - before;
    if (tolerance < 1e-9) TEST_COMPARE(error, <, 1e-6);
    return products;
  };
  const long first = productsOf(0, 1, 1e-10), again = productsOf(0, 1, 1e-10), near = productsOf(0, 1.2, 1e-8), far = productsOf(1, 1, 1e-10);
  out << first << " " << again << " " << near << " " << far << "\n";
  TEST_COMPARE(first, >, again + kSoft);
  TEST_COMPARE(near, <=, again);
  TEST_COMPARE(far, >, again + kSoft);  // as many columns
}

}  // namespace
