// SPDX-License-Identifier: BSD-3-Clause
// Contact problems of dense operators: no mesh, no FETI.
#pragma once
#include <Tpetra_Vector.hpp>
#include <random>

#include "../../qp/tests/QpTestProblem.hpp"
#include "Haptos_BalanceProjections.hpp"
#include "Haptos_ContactProblem.hpp"

namespace HaptosTest {

/// Pairs first (N, T1, T2 each), then gluing rows.  The first six columns of G^T act on gluing rows and a few pairs;
/// where the problem floats, six more act on pairs alone.
struct DenseContact {
  DenseProblem layout;  // only groups and size, for the map
  DenseMatrix F, M, GT;
  DenseMatrix Z;  // motions that float, if any
  DenseVector h, e;
  std::array<double, 2> friction;
};

inline DenseContact makeContact(int groups, int gluing, bool floating, unsigned seed, std::array<double, 2> friction = {0.8, 0.4}) {
  DenseContact d;
  d.layout = makeRandomProblem(groups, gluing, 0, 1e-2, seed);
  d.F = d.layout.A;
  d.friction = friction;
  std::mt19937 rng(seed + 100);
  std::normal_distribution<double> normal;
  const auto random = [&](Eigen::Index r, Eigen::Index c) {
    return DenseMatrix(DenseMatrix::NullaryExpr(r, c, [&] { return normal(rng); }));
  };
  const Eigen::Index n = d.F.rows(), contact = 3 * groups;
  // a preconditioner as good as the Dirichlet one: F^-1 of a matrix that is off by some 20 %
  const DenseMatrix E = 0.2 * random(n, n) / std::sqrt(double(n)), I = DenseMatrix::Identity(n, n);
  d.M = (I + E) * Testing::inverse(d.F) * (I + E).transpose();
  d.GT = DenseMatrix::Zero(n, floating ? 12 : 6);
  d.GT.bottomLeftCorner(gluing, 6) = random(gluing, 6);
  d.GT.topLeftCorner(contact, 6) = 0.1 * random(contact, 6);
  d.Z = DenseMatrix::Zero(d.GT.cols(), floating ? 6 : 0);
  if (floating) {
    d.Z.bottomRows(6).setIdentity();
    for (int i = 0; i < groups; ++i) {  // rigid motions of a plane: translations, tilts, spin
      const double x = normal(rng), y = normal(rng);
      d.GT.block<1, 6>(3 * i, 6) << 0, 0, 1, y, -x, 0;
      d.GT.block<1, 6>(3 * i + 1, 6) << 1, 0, 0, 0, 0, -y;
      d.GT.block<1, 6>(3 * i + 2, 6) << 0, 1, 0, 0, 0, x;
    }
  }
  DenseVector inside = random(n, 1);  // multipliers well inside the cones carry the load
  for (int i = 0; i < groups; ++i) {
    inside[3 * i] = 2.0;
    for (int t = 0; t < 2; ++t) inside[3 * i + 1 + t] *= friction[std::size_t(t)] > 0 ? 0.1 : 0.0;
  }
  d.e = d.GT.transpose() * inside;
  DenseVector push = random(n, 1);
  for (int i = 0; i < groups; ++i) push.segment<2>(3 * i + 1) *= 0.2;  // so that some pairs stick
  d.h = d.F * inside + push;
  return d;
}

/// The problem on the map, and what a solve needs.
struct Setup {
  DenseContact d;
  RCP<const Map> map;
  RCP<DenseOperator> F;
  CoarseRows GT;
  RCP<MultiVector> lambda;
  RCP<ContactProblem> problem;

  explicit Setup(const DenseContact& dense, double unitLength = 1, double unitForce = 1) : d(dense) {
    d.F *= unitLength / unitForce;
    d.M *= unitForce / unitLength;
    d.h *= unitLength;
    d.e *= unitForce;
    map = d.layout.makeMap();
    F = rcp(new DenseOperator(map, d.F));
    lambda = rcp(new MultiVector(map, 1));
    problem = rcp(new ContactProblem(operators(), lambda));
  }

  RCP<Vector> vectorOf(const DenseVector& values) const {
    const auto v = rcp(new Vector(map));
    scatter(values, *v);
    return v;
  }

  ContactOperators operators() {
    ContactOperators o;
    o.F = rcp(new CountedOperator(F));
    o.h = vectorOf(d.h);
    o.M = rcp(new DenseOperator(map, d.M));
    o.diagonalOfM = vectorOf(d.M.diagonal());
    std::vector<Eigen::Triplet<double>> entries;
    const int rows = int(map->getNodeNumElements());
    for (int row = 0; row < rows; ++row)
      for (Eigen::Index j = 0; j < d.GT.cols(); ++j) entries.emplace_back(row, int(j), d.GT(map->getGlobalElement(row), j));
    GT.resize(rows, d.GT.cols());
    GT.setFromTriplets(entries.begin(), entries.end());
    o.GT = Teuchos::rcpFromRef(GT);
    o.GGT = rcp(new CoarseProblem(*map->getComm(), GT, {}, {}));
    o.e = d.e;
    o.motions = d.Z;
    for (Eigen::Index j = 0; j < d.Z.cols(); ++j) o.holds.emplace_back(d.Z.col(j).sparseView());
    for (int row = 0; row < rows; ++row) {
      const auto global = map->getGlobalElement(row);
      if (global >= 3 * d.layout.groups) o.gluingRows.push_back(row);
      else if (global % 3 == 0) o.pairs.push_back({row, {row + 1, row + 2}, d.friction, 0, FrictionLaw::Coulomb, false});
    }
    return o;
  }
};

/// Vectors and balance of a dense problem, and its G^T by kinds of rows.
struct Parts {
  Setup setup;
  const ContactOperators& dual;
  DualVectors vectors;
  GluingBalance balance;
  DenseMatrix GT, gluingGT;  // [rows x l], without contact rows

  Parts(int groups, int gluing, bool floating)
      : setup(makeContact(groups, gluing, floating, 5)),
        dual(setup.problem->operators()),
        vectors(setup.map, dual.pairs, dual.gluingRows),
        balance(dual, vectors),
        GT(setup.d.GT),
        gluingGT(GT) {
    gluingGT.topRows(3 * groups).setZero();
  }

  Eigen::VectorXd local(const DenseVector& all) const { return DualVectors::fromVector(*setup.vectorOf(all)); }
  DenseVector global(const Eigen::VectorXd& mine) const { return gather(*vectors.toVector(mine)); }
};

inline DenseVector numbers(Eigen::Index n, double phase) {
  return DenseVector::NullaryExpr(n, [phase](Eigen::Index i) { return std::sin(phase + 2.3 * double(i * i % 17)); });
}

}  // namespace HaptosTest
