// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "DenseContact.hpp"
#include "Haptos_ContactMatrix.hpp"

namespace HaptosTest {

inline constexpr int kGroups = 12, kGluing = 20;
inline constexpr double kPenalty = 1.7;  // r

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
  /// This rank's part of contact values [3 x kGroups]
  Eigen::VectorXd contactPart(const DenseVector& x) const {
    DenseVector all = DenseVector::Zero(GT.rows());
    all.head(3 * kGroups) = x;
    return vectors.contact(local(all));
  }
  DenseMatrix contactM() const { return setup.d.M.topLeftCorner(3 * kGroups, 3 * kGroups); }
  /// (M (s_E, 0))_c
  DenseVector forcesOfGluing() const { return setup.d.M.topRightCorner(3 * kGroups, kGluing) * s.tail(kGluing); }
  double difference(const Eigen::VectorXd& mine, const DenseVector& expected) const { return (global(mine) - expected).norm() / expected.norm(); }
};

// M between contact rows as products and as a matrix; what Krylov methods leave is asked to be small here.
inline ContactMatrix contactMatrix(const Scene& t, ContactMatrix::Kind kind, SubspaceNewtonOptions::Condensed options = {}, ExactContactMap exact = {}) {
  options.linearTolerance = options.pathLinearTolerance = 1e-13;
  ContactMatrix::Parts parts{t.dual.contactM, t.vectors.contact(t.local(t.setup.d.M.diagonal()))};
  parts.exact = std::move(exact);
  return {std::move(parts), t.vectors, kind, options};
}

/// M between contact rows as one that can be factored with anything: by dense formulas on every rank.
inline ExactContactMap exactMap(const Scene& t) {
  const auto onAll = [&t](const Eigen::VectorXd& contact) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(t.vectors.numRows());
    t.vectors.setContact(x, contact);
    return DenseVector(t.global(x).head(3 * kGroups));
  };
  ExactContactMap map;
  map.multiply = [&t, onAll](const Eigen::VectorXd& x) { return t.contactPart(t.contactM() * onAll(x)); };
  map.solverWith = [&t, onAll](const std::vector<Eigen::Matrix3d>& D) -> ExactContactMap::Map {
    DenseMatrix MD = t.contactM();
    for (int column = 0; column < 3; ++column) {
      Eigen::VectorXd mine(3 * Eigen::Index(D.size()));
      for (std::size_t i = 0; i < D.size(); ++i) mine.segment<3>(3 * Eigen::Index(i)) = D[i].col(column);
      const DenseVector all = onAll(mine);
      for (int row = 0; row < 3 * kGroups; ++row) MD(row, row - row % 3 + column) += all[row];
    }
    return [&t, onAll, MD](const Eigen::VectorXd& y) { return t.contactPart(Testing::ldltSolve(MD, onAll(y))); };
  };
  return map;
}

inline constexpr auto kKinds = {ContactMatrix::Kind::Dense, ContactMatrix::Kind::Products};

}  // namespace HaptosTest
