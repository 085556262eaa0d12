// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_RecycledSubspace.hpp"

#include <Eigen/Core>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_Map.hpp>

#include "DenseAlgebra.hpp"

namespace {

using namespace Haptos;

constexpr int kPairs = 2, kGluing = 7;  // of every rank

// Rows of a rank: its pairs (N, T1, T2), then its gluing rows.
struct Rows {
  RCP<const Map> map;
  std::vector<PairLaw> pairs;
  DualVectors vectors;

  static std::vector<int> gluingRows() {
    std::vector<int> rows;
    for (int i = 0; i < kGluing; ++i) rows.push_back(3 * kPairs + i);
    return rows;
  }
  Rows()
      : map(Teuchos::rcp(new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(), 3 * kPairs + kGluing, 0, Tpetra::getDefaultComm()))),
        pairs{{0, {1, 2}, {0.3, 0.2}, 0, FrictionLaw::Coulomb, false}, {3, {4, 5}, {0.3, 0.2}, 0, FrictionLaw::Coulomb, false}},
        vectors(map, pairs, gluingRows()) {}

  Eigen::VectorXd make(int seed) const {
    Eigen::VectorXd x(vectors.numRows());
    for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = std::sin(1.3 * seed + 2.1 * double(i * i) + 5.7 * map->getComm()->getRank());
    return x;
  }
};

// (lambda, s) of pair j as the subspace gives it back.
std::array<Eigen::VectorXd, 2> pairOf(const RecycledSubspace& subspace, const DualVectors& vectors, Eigen::Index j) {
  std::array<Eigen::VectorXd, 2> pair{Eigen::VectorXd::Zero(vectors.numRows()), Eigen::VectorXd::Zero(vectors.numRows())};
  subspace.addCombination(Eigen::VectorXd::Unit(subspace.size(), j), pair[0], pair[1]);
  return pair;
}

}  // namespace

TEUCHOS_UNIT_TEST(RecycledSubspace, KeepsPairsScaledByTheirJumps) {
  const Rows rows;
  RecycledSubspace subspace(rows.vectors);
  const double unit = 1e-9;
  for (int j = 0; j < 6; ++j) {
    const Eigen::VectorXd s = unit * rows.make(100 + j);
    TEST_FLOATING_EQUALITY(subspace.add(rows.make(j), s), rows.vectors.norm(s), 1e-14);
  }
  Eigen::MatrixXd S(kGluing, 6);
  for (int j = 0; j < 6; ++j) {
    const double size = rows.vectors.norm(unit * rows.make(100 + j));
    const auto [v, s] = pairOf(subspace, rows.vectors, j);
    TEST_ASSERT((v - rows.make(j) / size).norm() <= 1e-13 * v.norm());
    TEST_ASSERT((s - unit * rows.make(100 + j) / size).norm() <= 1e-13);
    S.col(j) = rows.vectors.gluing(s);
  }
  Eigen::MatrixXd SS = S.transpose() * S;
  rows.vectors.sum(SS);
  const Eigen::MatrixXd R = subspace.R();
  TEST_ASSERT((R.transpose() * R - SS).norm() <= 1e-13);

  const Eigen::VectorXd gluing = rows.vectors.gluing(rows.make(50));
  const auto projected = subspace.projectGluing(gluing);
  const Eigen::VectorXd least = Testing::ldltSolve(SS, [&] {
    Eigen::MatrixXd b = S.transpose() * gluing;
    rows.vectors.sum(b);
    return b;
  }());
  const double outside = rows.vectors.norm(gluing - S * least);
  TEST_COMPARE(std::abs(std::sqrt(projected.outside2()) - outside), <=, 1e-7 * std::sqrt(projected.norm2));
}

// A pair whose gluing part is in the span adds nothing to R but its contact values; a pair without jumps is left out.
TEUCHOS_UNIT_TEST(RecycledSubspace, SeesDependentPairs) {
  const Rows rows;
  RecycledSubspace subspace(rows.vectors);
  const Eigen::VectorXd a = rows.make(1), b = a + 1e-9 * rows.make(2);  // hardly independent
  subspace.add(rows.make(10), a);
  subspace.add(rows.make(11), b);
  Eigen::VectorXd sum = 3 * a - 2 * b;
  rows.vectors.setContact(sum, rows.vectors.contact(rows.make(3)));
  subspace.add(rows.make(12), sum);
  TEST_EQUALITY(subspace.size(), 3);
  TEST_ASSERT(subspace.R()(1, 1) > 1e-10);
  TEST_EQUALITY(subspace.R()(2, 2), 0.0);
  TEST_EQUALITY(subspace.add(rows.make(13), Eigen::VectorXd::Zero(rows.vectors.numRows())), 0.0);
  TEST_EQUALITY(subspace.size(), 3);
  const auto [v, s] = pairOf(subspace, rows.vectors, 2);
  TEST_ASSERT((s * rows.vectors.norm(sum) - sum).norm() <= 1e-12 * sum.norm());
}

TEUCHOS_UNIT_TEST(RecycledSubspace, DropsTheOldestButThePermanent) {
  const Rows rows;
  RecycledSubspace subspace(rows.vectors, 9);
  subspace.add(rows.make(0), rows.make(100));
  subspace.makePermanent();
  for (int j = 1; j <= 9; ++j) subspace.add(rows.make(j), rows.make(100 + j));
  TEST_ASSERT(subspace.isFull());
  subspace.dropOldest();
  TEST_EQUALITY(subspace.size(), 5);
  TEST_EQUALITY(subspace.compressions(), 1);
  TEST_EQUALITY(subspace.largestSize(), 10);
  for (int j = 0; j < 5; ++j) {
    const int from = j == 0 ? 0 : 5 + j;
    const auto [v, s] = pairOf(subspace, rows.vectors, j);
    const double size = rows.vectors.norm(rows.make(100 + from));
    TEST_ASSERT((v - rows.make(from) / size).norm() <= 1e-12 * v.norm());
    TEST_ASSERT((s - rows.make(100 + from) / size).norm() <= 1e-12);
  }
}

// Room is made before it is needed, and kept for the next pairs.
TEUCHOS_UNIT_TEST(RecycledSubspace, KeepsItsRoom) {
  const Rows rows;
  RecycledSubspace subspace(rows.vectors), small(rows.vectors, 6);
  subspace.add(rows.make(0), rows.make(100));
  small.add(rows.make(0), rows.make(100));
  const double first = subspace.memoryMb();
  TEST_COMPARE(small.memoryMb(), <, first);
  for (int j = 1; j < 16; ++j) subspace.add(rows.make(j), rows.make(100 + j));
  TEST_EQUALITY(subspace.memoryMb(), first);
  for (int j = 16; j < 20; ++j) subspace.add(rows.make(j), rows.make(100 + j));
  const double grown = subspace.memoryMb();
  TEST_COMPARE(grown, >, first);
  subspace.clear();
  TEST_EQUALITY(subspace.memoryMb(), grown);
  const Eigen::VectorXd s = rows.make(200);
  TEST_FLOATING_EQUALITY(subspace.add(rows.make(7), s), rows.vectors.norm(s), 1e-14);
  const auto pair = pairOf(subspace, rows.vectors, 0);
  TEST_COMPARE((pair[1] - s / rows.vectors.norm(s)).norm(), <=, 1e-13);
}
