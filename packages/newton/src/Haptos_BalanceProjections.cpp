// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_BalanceProjections.hpp"

#include <Eigen/Dense>

namespace Haptos {
namespace {

// Scales rows of G^T: `keep` is 1 on gluing rows and 0 on contact rows.
CoarseRows keepGluingRows(const CoarseRows& rows, const DualVectors& vectors) {
  Eigen::VectorXd keep = Eigen::VectorXd::Zero(rows.rows());
  for (int row : vectors.gluingRows()) keep[row] = 1;
  CoarseRows result = keep.asDiagonal() * rows;
  result.prune([](Eigen::Index, Eigen::Index, double value) { return value != 0.0; });
  return result;
}

}  // namespace

GluingBalance::GluingBalance(const ContactOperators& dual, const DualVectors& vectors)
    : dual_(dual), vectors_(vectors), gluingRows_(keepGluingRows(*dual.GT, vectors)), coarseSize_(dual.GT->cols()) {
  const UnheldMotions floating = findUnheldMotions(vectors.comm(), gluingRows_, dual.motions);
  for (int pivot : floating.pivots) holds_.push_back(dual.holds[std::size_t(pivot)]);
  EE_ = std::make_unique<CoarseProblem>(dual.GGT->placement(), gluingRows_, std::vector<double>{}, holds_);
  const Eigen::MatrixXd Z = dual.motions * floating.basis;
  Zk_ = Eigen::MatrixXd(Z.rows(), Z.cols());
  if (Z.cols() > 0) Zk_ = Eigen::HouseholderQR<Eigen::MatrixXd>(Z).householderQ() * Eigen::MatrixXd::Identity(Z.rows(), Z.cols());
  jumps_ = *dual.GT * Zk_;
  H_.resize(3 * vectors.numPairs(), Zk_.cols());
  for (Eigen::Index j = 0; j < Zk_.cols(); ++j) H_.col(j) = vectors.contact(jumps_.col(j));
  load_ = Zk_.transpose() * dual.e;
}

Eigen::VectorXd GluingBalance::applyG(const Eigen::VectorXd& v) const {
  Eigen::VectorXd g = dual_.GT->transpose() * v;
  vectors_.sum(g);
  return g;
}

void GluingBalance::balance(Eigen::VectorXd& v, const Eigen::VectorXd& target) const {
  const Eigen::VectorXd mine = dual_.GT->transpose() * v;
  v -= gluingRows_ * Eigen::VectorXd(EE_->solveSum(mine, target));
}

void GluingBalance::removeRigidPart(Eigen::VectorXd& s) const {
  Eigen::VectorXd a = EE_->solveSum(Eigen::VectorXd(gluingRows_.transpose() * s));
  a -= Zk_ * (Zk_.transpose() * a);
  s -= *dual_.GT * a;
}

namespace {

// The rows of G^T that contact can make active.
CoarseRows keepContactRows(const CoarseRows& rows, const std::vector<PairLaw>& pairs) {
  Eigen::VectorXd keep = Eigen::VectorXd::Zero(rows.rows());
  for (const PairLaw& pair : pairs)
    for (int row : {pair.normal, pair.tangential[0], pair.tangential[1]})
      if (row >= 0) keep[row] = 1;
  CoarseRows result = keep.asDiagonal() * rows;
  result.prune([](Eigen::Index, Eigen::Index, double value) { return value != 0.0; });
  return result;
}

CoarseProblem::Holds weakened(CoarseProblem::Holds holds) {
  constexpr double kWeakHold = 1e-9;  // floating motions are held by active contact rows; this only keeps K regular
  for (auto& hold : holds) hold *= std::sqrt(kWeakHold);
  return holds;
}

}  // namespace

ActiveCoarseProjection::ActiveCoarseProjection(const ContactOperators& dual, const CoarseRows& gluingRows,
                                               const std::vector<PairLaw>& pairs, const Eigen::VectorXd& weights,
                                               const CoarseProblem::Holds& holds)
    : gluingRows_(gluingRows),
      contactRows_(keepContactRows(*dual.GT, pairs)),
      weights_(weights),
      q_(weights.data(), weights.data() + weights.size()),
      active_(contactRows_),
      coarse_(dual.GGT->placement(), gluingRows, contactRows_, q_, weakened(holds)) {}

void ActiveCoarseProjection::renew(const std::vector<PairLaw>& pairs, const LawLinearization& law,
                                   const std::vector<TangentialModes>& modes) {
  std::vector<Eigen::Triplet<double>> triplets;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (law.closed[i]) triplets.emplace_back(pairs[i].normal, pairs[i].normal, 1.0);
    if (!law.tangential[i]) continue;
    const Eigen::Matrix2d Y = modes[i].E * modes[i].theta.cwiseSqrt().asDiagonal() * modes[i].E.transpose();
    for (int a = 0; a < 2; ++a)
      for (int b = 0; b < 2; ++b)
        if (Y(a, b) != 0.0) triplets.emplace_back(pairs[i].tangential[a], pairs[i].tangential[b], Y(a, b));
  }
  CoarseRows Y(contactRows_.rows(), contactRows_.rows());
  Y.setFromTriplets(triplets.begin(), triplets.end());
  active_ = Y * contactRows_;
  coarse_.renew(active_, q_);
}

// G_A x on this rank
Eigen::VectorXd ActiveCoarseProjection::sumUp(const Eigen::VectorXd& x) const {
  Eigen::VectorXd g = gluingRows_.transpose() * x;
  g += active_.transpose() * x;
  return g;
}

Eigen::VectorXd ActiveCoarseProjection::spread(const Eigen::VectorXd& a) const {
  Eigen::VectorXd x = gluingRows_ * a;
  x += active_ * a;
  return x;
}

void ActiveCoarseProjection::projectDual(Eigen::VectorXd& residual) const {
  residual -= spread(coarse_.solveSum(sumUp(weights_.cwiseProduct(residual))));
}

void ActiveCoarseProjection::projectPrimal(Eigen::VectorXd& z) const { z -= carry(sumUp(z)); }

Eigen::VectorXd ActiveCoarseProjection::carry(const Eigen::VectorXd& mine) const {
  return weights_.cwiseProduct(spread(coarse_.solveSum(mine)));
}

}  // namespace Haptos
