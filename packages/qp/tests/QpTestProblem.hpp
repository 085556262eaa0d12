// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Small problems shared by the tests: dense, replicated on every rank, handed out row by row.
#include <Eigen/Core>
#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Operator.hpp>
#include <Tpetra_Vector.hpp>
#include <random>

#include "DenseAlgebra.hpp"
#include "Haptos_BoundEllipseSet.hpp"
#include "Haptos_EllipseProjection.hpp"
#include "Haptos_QuadraticProgram.hpp"

namespace HaptosTest {

using namespace Haptos;
using Teuchos::rcp;
using DenseVector = Eigen::VectorXd;
using DenseMatrix = Eigen::MatrixXd;

/// All entries of x on every rank.
inline DenseVector gather(const MultiVector& x) {
  const auto map = x.getMap();
  const auto view = x.getData(0);
  DenseVector mine = DenseVector::Zero(Eigen::Index(map->getGlobalNumElements())), all = mine;
  for (int i = 0; i < int(view.size()); ++i) mine[map->getGlobalElement(i)] = view[i];
  Teuchos::reduceAll(*map->getComm(), Teuchos::REDUCE_SUM, int(mine.size()), mine.data(), all.data());
  return all;
}

inline void scatter(const DenseVector& all, MultiVector& x) {
  auto view = x.getDataNonConst(0);
  for (int i = 0; i < int(view.size()); ++i) view[i] = all[x.getMap()->getGlobalElement(i)];
}

/// A dense symmetric matrix as an operator; counts its applications.
class DenseOperator : public Operator {
 public:
  DenseOperator(const RCP<const Map>& map, const DenseMatrix& a) : map_(map), a_(a) {}
  RCP<const Map> getDomainMap() const override { return map_; }
  RCP<const Map> getRangeMap() const override { return map_; }
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp = Teuchos::NO_TRANS, double alpha = 1,
             double beta = 0) const override {
    applications += int(x.getNumVectors());
    if (beta == 0) y.putScalar(0);
    for (std::size_t v = 0; v < x.getNumVectors(); ++v) {
      Vector ax(map_);
      scatter(a_ * gather(*x.getVector(v)), ax);
      y.getVectorNonConst(v)->update(alpha, ax, beta);
    }
  }
  mutable int applications = 0;

 private:
  RCP<const Map> map_;
  DenseMatrix a_;
};

/// min 1/2 x^T A x - b^T x, Q (x - x0) = 0; groups of three entries (bound, pair), then free ones.
/// Entry 3 i: bound; entries 3 i + 1, 3 i + 2: ellipse with the semi-axes of column i.
struct DenseProblem {
  DenseMatrix A, Q;
  DenseVector b, x0, lower;
  DenseMatrix semiAxes;  // 2 x groups
  int groups = 0;
  int size() const { return int(b.size()); }

  DenseVector project(const DenseVector& x, const DenseMatrix& axes) const {
    DenseVector y = x;
    for (int i = 0; i < groups; ++i) {
      y[3 * i] = std::max(x[3 * i], lower[i]);
      bool moved = false;
      const auto p = projectOntoEllipse({x[3 * i + 1], x[3 * i + 2]}, {axes(0, i), axes(1, i)}, moved);
      y[3 * i + 1] = p[0];
      y[3 * i + 2] = p[1];
    }
    return y;
  }

  /// Contiguous groups on the ranks, so that a pair stays together.
  RCP<const Map> makeMap(RCP<const Communicator> comm = Teuchos::null) const {
    if (comm.is_null()) comm = Tpetra::getDefaultComm();
    std::vector<GlobalOrdinal> mine;
    for (int i = 0; i < groups; ++i)
      if (i % comm->getSize() == comm->getRank())
        for (int k = 0; k < 3; ++k) mine.push_back(3 * i + k);
    for (int j = 3 * groups; j < size(); ++j)
      if (j % comm->getSize() == comm->getRank()) mine.push_back(j);
    return rcp(new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(), mine.data(), LocalOrdinal(mine.size()),
                       0, comm));
  }

  RCP<BoundEllipseSet> makeSet(const RCP<const Map>& map) const {
    std::vector<BoundEllipseSet::Bound> bounds;
    std::vector<BoundEllipseSet::Ellipse> ellipses;
    for (int i = 0; i < groups; ++i) {
      const int row = map->getLocalElement(3 * i);
      if (row < 0) continue;
      bounds.push_back({row, lower[i]});
      ellipses.push_back({{row + 1, row + 2}, {semiAxes(0, i), semiAxes(1, i)}});
    }
    return rcp(new BoundEllipseSet(map, bounds, ellipses));
  }
};

/// A = P R P with condition number about 1/smallest on Im P; Q of the given rank.
inline DenseProblem makeRandomProblem(int groups, int freeEntries, int equalities, double smallest, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  DenseProblem d;
  d.groups = groups;
  const int n = 3 * groups + freeEntries;
  const auto random = [&](int r, int c) {
    return DenseMatrix(DenseMatrix::NullaryExpr(r, c, [&] { return normal(rng); }));
  };
  const DenseMatrix U = Testing::squareQ(random(n, n));
  DenseVector w(n);
  for (int i = 0; i < n; ++i) w[i] = std::pow(smallest, unit(rng));
  d.A = U * w.asDiagonal() * U.transpose();
  d.Q = DenseMatrix::Zero(n, n);
  if (equalities > 0) {
    const DenseMatrix V = Testing::thinQ(random(n, equalities));
    d.Q = V * V.transpose();
    const DenseMatrix P = DenseMatrix::Identity(n, n) - d.Q;
    d.A = P * d.A * P;
  }
  d.A = (d.A + d.A.transpose()).eval() / 2;
  d.b = random(n, 1);
  d.b -= d.Q * d.b;
  d.lower = DenseVector::Constant(groups, -0.2);
  d.semiAxes = DenseMatrix::Constant(2, groups, 0.5);
  d.x0 = d.Q * (0.02 * random(n, 1));
  return d;
}

}  // namespace HaptosTest
