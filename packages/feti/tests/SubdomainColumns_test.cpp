// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SubdomainColumns.hpp"

#include <Teuchos_UnitTestHarness.hpp>

namespace {

using namespace Haptos;
using Dense = Eigen::MatrixXd;

// Three subdomains of 5, 4 and 6 unknowns among 20; columns reach one or two of them, some of their unknowns or all.
const std::vector<std::vector<Eigen::Index>> kUnknowns{{0, 1, 2, 4, 5}, {7, 8, 9, 10}, {13, 14, 15, 16, 18, 19}};

Dense someColumns(int seed) {
  std::srand(unsigned(seed));
  Dense A = Dense::Zero(20, 9);
  for (Eigen::Index j = 0; j < A.cols(); ++j)
    for (std::size_t i = 0; i < kUnknowns.size(); ++i)
      for (std::size_t k = 0; k < kUnknowns[i].size(); ++k)
        if (i == std::size_t(j) / 3 || (i == (std::size_t(j) / 3 + 1) % 3 && (k + std::size_t(j / 3)) % 2 == 0)) A(kUnknowns[i][k], j) = Dense::Random(1, 1)(0, 0);
  A(4, 1) = 0;      // fewer than its neighbours have
  A(8, 5) = 1e-17;  // round-off
  return A;
}

Dense withoutRoundOff(const Dense& A) { return (A.array().abs() < 1e-14).select(0.0, A); }

// Some columns of a matrix on all unknowns, as pieces
void append(const Dense& A, const std::vector<std::vector<Eigen::Index>>& unknowns, SubdomainColumns& blocks) {
  std::vector<SubdomainColumns::Piece> pieces;
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    SubdomainColumns::Piece piece{i, {}, {}, A(unknowns[i], Eigen::all)};
    for (std::size_t k = 0; k < unknowns[i].size(); ++k) piece.rows.push_back(Eigen::Index(k));
    for (Eigen::Index j = 0; j < A.cols(); ++j) piece.columns.push_back(j);
    pieces.push_back(piece);
  }
  blocks.append(A.cols(), pieces);
}

// Columns first, first + 1, ... on the rows of unknowns, which have `size`
Dense columnsOf(const SubdomainColumns& blocks, const std::vector<std::vector<Eigen::Index>>& unknowns, Eigen::Index size, Eigen::Index first, Eigen::Index width) {
  std::vector<Eigen::Index> all;
  for (const auto& mine : unknowns) all.insert(all.end(), mine.begin(), mine.end());
  RowPanel t(all.size());
  blocks.copyTo(first, width, t);
  Dense A = Dense::Zero(size, width);
  for (std::size_t k = 0; k < all.size(); ++k)
    for (Eigen::Index v = 0; v < width; ++v) A(all[k], v) = t[k][v];
  return A;
}

struct Columns {
  Dense A;
  SubdomainColumns blocks{kUnknowns};
  explicit Columns(int seed) : A(withoutRoundOff(someColumns(seed))) {
    const Dense all = someColumns(seed);
    append(all.leftCols(4), kUnknowns, blocks);
    append(all.rightCols(5), kUnknowns, blocks);
  }
};

double difference(const Dense& a, const Dense& b) { return a.size() == 0 ? 0.0 : (a - b).cwiseAbs().maxCoeff(); }

}  // namespace

TEUCHOS_UNIT_TEST(SubdomainColumns, ProductsAreThoseOfTheMatrix) {
  const Columns t(3), u(4);
  TEST_EQUALITY(t.blocks.cols(), 9);
  Dense x = Dense::Random(20, 3);
  TEST_COMPARE(difference(columnsOf(t.blocks, kUnknowns, 20, 3, 4), t.A.middleCols(3, 4)), <=, 1e-16);
  TEST_COMPARE(difference(t.blocks.transposedTimes(x), t.A.transpose() * x), <=, 1e-14);
  TEST_COMPARE(difference(t.blocks.transposedTimes(x.leftCols(1)), t.A.transpose() * x.leftCols(1)), <=, 1e-14);
  TEST_COMPARE(difference(t.blocks.gram(u.blocks), t.A.transpose() * u.A), <=, 1e-14);
  const Dense a = Dense::Random(9, 3), wanted = x - t.A * a;
  t.blocks.subtractProduct(a, x);
  TEST_COMPARE(difference(x, wanted), <=, 1e-14);
}

TEUCHOS_UNIT_TEST(SubdomainColumns, RestIsThatOfEverySubdomain) {
  const Columns t(3), u(4);
  const Dense a = Dense::Random(9, 9), wanted = u.A - t.A * a;
  for (std::size_t i = 0; i < kUnknowns.size(); ++i) {
    const Dense rest = t.blocks.rest(i, u.blocks, a);
    TEST_EQUALITY(rest.rows(), Eigen::Index(kUnknowns[i].size()));
    for (std::size_t k = 0; k < kUnknowns[i].size(); ++k) TEST_COMPARE(difference(rest.row(Eigen::Index(k)), wanted.row(kUnknowns[i][k])), <=, 1e-14);
  }
}

// C is symmetric and mixes the unknowns of a subdomain; there are columns of A, of C A and of X that do not reach all subdomains.
TEUCHOS_UNIT_TEST(SubdomainColumns, EnergyIsThatOfTheRest) {
  const Columns A(1), X(3);
  SubdomainColumns CA(kUnknowns), CX(kUnknowns);
  Dense C = Dense::Zero(20, 20);
  for (const auto& mine : kUnknowns) {
    const Dense B = Dense::Random(Eigen::Index(mine.size()), Eigen::Index(mine.size()));
    C(mine, mine) = B + B.transpose();
  }
  append(C * A.A, kUnknowns, CA);
  append(C * X.A, kUnknowns, CX);
  const Dense a = Dense::Random(9, 9), T = X.A - A.A * a;
  Dense M = Dense::Ones(9, 9), expected = M;
  for (std::size_t i = 0; i < kUnknowns.size(); ++i) {
    A.blocks.addEnergy(i, CA, X.blocks, CX, a, M);
    const Dense Ti = T(kUnknowns[i], Eigen::all);
    expected += Ti.transpose() * C(kUnknowns[i], kUnknowns[i]) * Ti;
    TEST_COMPARE((M - expected).norm(), <, 1e-13 * expected.norm());
  }
}

// Columns that decay, and end in round-off each elsewhere, are one block, as are those without a zero or two; what lies elsewhere is another.
TEUCHOS_UNIT_TEST(SubdomainColumns, ColumnsOfNearlyTheSameRowsAreOneBlock) {
  std::vector<Eigen::Index> unknowns(60);
  for (std::size_t k = 0; k < unknowns.size(); ++k) unknowns[k] = Eigen::Index(k);
  Dense A = Dense::Zero(60, 40);
  for (Eigen::Index j = 0; j < 30; ++j) A.col(j).segment(2 + j % 3, 22 - j % 4) = Dense::Random(22 - j % 4, 1);
  for (Eigen::Index j = 30; j < 40; ++j) A.col(j).segment(35, 20) = Dense::Random(20, 1);
  SubdomainColumns blocks({unknowns});
  append(A.leftCols(17), {unknowns}, blocks);
  append(A.rightCols(23), {unknowns}, blocks);
  TEST_EQUALITY(blocks.numBlocks(0), 2u);
  const Dense x = Dense::Random(60, 2);
  TEST_EQUALITY(difference(columnsOf(blocks, {unknowns}, 60, 0, 30), A.leftCols(30)), 0.0);
  TEST_EQUALITY(difference(columnsOf(blocks, {unknowns}, 60, 30, 10), A.rightCols(10)), 0.0);
  TEST_COMPARE(difference(blocks.transposedTimes(x), A.transpose() * x), <=, 1e-13);
}

// What is shared is not appended twice.
TEUCHOS_UNIT_TEST(SubdomainColumns, SharedSubdomainsAreTheOtherMatrix) {
  SubdomainColumns half(kUnknowns), rest(kUnknowns);
  rest.share(1, half);
  const Dense A = withoutRoundOff(someColumns(3)), C = withoutRoundOff(someColumns(4));
  append(A, kUnknowns, half);
  append(C, kUnknowns, rest);
  Dense wanted = C;
  for (Eigen::Index row : kUnknowns[1]) wanted.row(row) = A.row(row);
  TEST_COMPARE(difference(columnsOf(rest, kUnknowns, 20, 0, 9), wanted), <=, 1e-16);
}
