// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_BalanceProjections.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace Haptos {
namespace {

Eigen::VectorXd solveOne(const CoarseProblem& problem, const Eigen::VectorXd& b) { return problem.solve(b); }

// Scales rows of G^T: `keep` is 1 on gluing rows and 0 on contact rows.
CoarseRows keepGluingRows(const CoarseRows& rows, const DualVectors& vectors) {
  Eigen::VectorXd keep = Eigen::VectorXd::Zero(rows.rows());
  for (int row : vectors.gluingRows()) keep[row] = 1;
  CoarseRows result = keep.asDiagonal() * rows;
  result.prune([](Eigen::Index, Eigen::Index, double value) { return value != 0.0; });
  return result;
}

}  // namespace

GluingBalance::GluingBalance(const DualProblem& dual, const BodyMotions& bodies, const DualVectors& vectors)
    : dual_(dual), vectors_(vectors), gluingRows_(keepGluingRows(dual.G->rows(), vectors)), coarseSize_(dual.G->dimension()) {
  const UnheldMotions floating = findUnheldMotions(vectors.comm(), gluingRows_, bodies);
  for (int pivot : floating.pivots) holds_.push_back(bodies.hold(pivot / 6, pivot % 6));
  EE_ = std::make_unique<CoarseProblem>(vectors.comm(), gluingRows_, std::vector<double>{}, holds_);
  const Eigen::MatrixXd Z = bodies.Z() * floating.basis;
  Zk_ = Eigen::MatrixXd(Z.rows(), Z.cols());
  if (Z.cols() > 0) Zk_ = Eigen::HouseholderQR<Eigen::MatrixXd>(Z).householderQ() * Eigen::MatrixXd::Identity(Z.rows(), Z.cols());
  jumps_ = dual.G->rows() * Zk_;
  H_.resize(3 * vectors.numPairs(), Zk_.cols());
  for (Eigen::Index j = 0; j < Zk_.cols(); ++j) H_.col(j) = vectors.contact(jumps_.col(j));
  load_ = Zk_.transpose() * dual.e;
}

Eigen::VectorXd GluingBalance::applyG(const Eigen::VectorXd& v) const {
  Eigen::VectorXd g = dual_.G->rows().transpose() * v;
  vectors_.sum(g);
  return g;
}

void GluingBalance::balance(Eigen::VectorXd& v, const Eigen::VectorXd& target) const {
  v -= gluingRows_ * solveOne(*EE_, applyG(v) - target);
}

void GluingBalance::removeRigidPart(Eigen::VectorXd& s) const {
  Eigen::VectorXd g = gluingRows_.transpose() * s;
  vectors_.sum(g);
  Eigen::VectorXd a = solveOne(*EE_, g);
  a -= Zk_ * (Zk_.transpose() * a);
  s -= dual_.G->rows() * a;
}

ActiveCoarseProjection::ActiveCoarseProjection(const DualProblem& dual, const DualVectors& vectors,
                                               const std::vector<PairLaw>& pairs, const Eigen::VectorXd& weights,
                                               const CoarseProblem::Holds& holds)
    : vectors_(vectors), weights_(weights), rows_(dual.G->rows()), active_(pairs.size(), Eigen::Matrix3d::Zero()) {
  constexpr double kWeakHold = 1e-9;  // floating motions are held by active contact rows; this only keeps K regular
  std::vector<int> touched;
  for (const auto& pair : pairs) {
    columns_.push_back(columnsOf(pair));
    touched.insert(touched.end(), columns_.back().subdomains.begin(), columns_.back().subdomains.end());
  }
  CoarseProblem::Holds weak = holds;
  for (auto& hold : weak) hold *= std::sqrt(kWeakHold);
  coarse_ = std::make_unique<ChangingCoarseProblem>(vectors.comm(), keepGluingRows(rows_, vectors),
                                                    std::vector<double>(weights.data(), weights.data() + weights.size()), weak,
                                                    std::move(touched));
}

ActiveCoarseProjection::PairColumns ActiveCoarseProjection::columnsOf(const PairLaw& pair) const {
  PairColumns columns;
  const int rows[3] = {pair.normal, pair.tangential[0], pair.tangential[1]};
  for (int a = 0; a < 3; ++a) {
    if (rows[a] < 0) continue;
    for (CoarseRows::InnerIterator it(rows_, rows[a]); it; ++it) {
      const int subdomain = int(it.col()) / 6;
      const auto found = std::find(columns.subdomains.begin(), columns.subdomains.end(), subdomain);
      const auto at = std::size_t(found - columns.subdomains.begin());
      if (found == columns.subdomains.end()) {
        columns.subdomains.push_back(subdomain);
        columns.blocks.push_back(Eigen::Matrix<double, 3, 6>::Zero());
      }
      columns.blocks[at](a, it.col() % 6) = it.value();
    }
  }
  return columns;
}

void ActiveCoarseProjection::update(const std::vector<PairLaw>& pairs, const LawLinearization& law,
                                    const std::vector<TangentialModes>& modes) {
  CoarseBlocks delta;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    Eigen::Matrix3d& Y = active_[i];
    Y.setZero();
    Eigen::Vector3d d = Eigen::Vector3d::Zero();
    if (law.closed[i]) {
      Y(0, 0) = 1;
      d[0] = weights_[pairs[i].normal];
    }
    if (law.tangential[i]) {
      Y.bottomRightCorner<2, 2>() = modes[i].E * modes[i].theta.cwiseSqrt().asDiagonal() * modes[i].E.transpose();
      for (int t = 0; t < 2; ++t) d[1 + t] = weights_[pairs[i].tangential[t]];
    }
    if (Y.isZero(0)) continue;
    const Eigen::Matrix3d YDY = Y * d.asDiagonal() * Y;
    const PairColumns& columns = columns_[i];
    for (std::size_t s = 0; s < columns.subdomains.size(); ++s)
      for (std::size_t t = 0; t < columns.subdomains.size(); ++t) {
        if (columns.subdomains[s] < columns.subdomains[t]) continue;
        Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> block(delta.at(columns.subdomains[s], columns.subdomains[t]).data());
        block.noalias() += columns.blocks[s].transpose() * YDY * columns.blocks[t];
      }
  }
  coarse_->update(delta);
}

// The rows of G_A out of those of G^T: gluing rows as they are, contact rows by their weights.
Eigen::VectorXd ActiveCoarseProjection::activeRows(const Eigen::VectorXd& x) const {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(x.size());
  for (int row : vectors_.gluingRows()) y[row] = x[row];
  Eigen::VectorXd contact = vectors_.contact(x);
  for (std::size_t i = 0; i < active_.size(); ++i) contact.segment<3>(3 * Eigen::Index(i)) = active_[i] * contact.segment<3>(3 * Eigen::Index(i)).eval();
  vectors_.setContact(y, contact);
  return y;
}

void ActiveCoarseProjection::projectDual(Eigen::VectorXd& residual) const {
  Eigen::VectorXd g = rows_.transpose() * activeRows(weights_.cwiseProduct(residual));
  vectors_.sum(g);
  residual -= activeRows(rows_ * coarse_->solve(g));
}

void ActiveCoarseProjection::projectPrimal(Eigen::VectorXd& z) const {
  Eigen::VectorXd g = rows_.transpose() * activeRows(z);
  vectors_.sum(g);
  z -= weights_.cwiseProduct(activeRows(rows_ * coarse_->solve(g)));
}

}  // namespace Haptos
