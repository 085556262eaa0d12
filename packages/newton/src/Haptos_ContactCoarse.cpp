// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactCoarse.hpp"

#include <cmath>
#include <memory>

#include "Haptos_ContactNumbering.hpp"
#include "Haptos_StackedQr.hpp"

namespace Haptos {
namespace {

// T such that the columns of Y T are nearly orthonormal; combinations that are next to nothing are left out.
Eigen::MatrixXd basisOf(const DualVectors& vectors, const Eigen::MatrixXd& Y) {
  constexpr double kNothing = 1e-10;  // of the largest square
  Eigen::MatrixXd gram = Y.transpose() * Y;
  vectors.sum(gram);
  if (gram.size() == 0) return gram;
  const SymmetricEigen eigen(gram);
  const Eigen::Index rank = (eigen.values.array() > kNothing * eigen.values.maxCoeff()).count();
  return eigen.vectors.rightCols(rank) * eigen.values.tail(rank).cwiseSqrt().cwiseInverse().asDiagonal();
}

// Pairs of this rank whose blocks differ by more than a tenth.
int numChanged(const ContactCoarse::Blocks& before, const ContactCoarse::Blocks& now) {
  int count = 0;
  for (std::size_t i = 0; i < now.size(); ++i) count += hasBlockChanged(before[i], now[i]);
  return count;
}

}  // namespace

ContactCoarse::ContactCoarse(const DualVectors& vectors, const Eigen::MatrixXd& jumps, const Eigen::VectorXd& diagonal, const Eigen::MatrixXd& kernel,
                             const Product& M)
    : vectors_(vectors), diagonal_(diagonal) {
  const Eigen::VectorXd root = diagonal.cwiseSqrt();
  const Eigen::MatrixXd scaledKernel = root.asDiagonal() * kernel, N = scaledKernel * orthonormalizer(vectors.comm(), scaledKernel);
  Eigen::MatrixXd X = root.asDiagonal() * jumps, known = N.transpose() * X;
  vectors.sum(known);
  X -= N * known;
  Q_ = root.cwiseInverse().asDiagonal() * (X * basisOf(vectors, X));
  MQ_ = M(Q_);
}

// Q^T D Q stays 1.
ContactCoarse ContactCoarse::scaled(double factor) const {
  ContactCoarse result = *this;
  result.diagonal_ *= factor;
  result.Q_ /= std::sqrt(factor);
  result.MQ_ *= std::sqrt(factor);
  return result;
}

// Columns that depend on others are left to these.
void ContactCoarse::appendTo(KnownMotions& known, const Blocks& K) const {
  constexpr double kNothing = 1e-12;
  if (known.motions.cols() == 0) known = {Eigen::MatrixXd(Q_.rows(), 0), Eigen::MatrixXd(Q_.rows(), 0)};
  Eigen::MatrixXd answered = known.images.transpose() * Q_;
  vectors_.sum(answered);
  const Eigen::MatrixXd Q = Q_ - known.motions * answered, GQ = MQ_ + multiplyBlocks(K, Q);
  Eigen::MatrixXd energies = Q.transpose() * GQ;
  if (energies.size() == 0) return;
  vectors_.sum(energies);
  const Eigen::VectorXd scale = energies.diagonal().cwiseSqrt().cwiseInverse();
  const auto factor = std::make_shared<const PivotedCholesky>(scale.asDiagonal() * energies * scale.asDiagonal(), kNothing);
  const Eigen::Index before = known.motions.cols(), count = Q.cols();
  known.motions.conservativeResize(Eigen::NoChange, before + count);
  known.images.conservativeResize(Eigen::NoChange, before + count);
  known.motions.rightCols(count) = Q;
  known.images.rightCols(count) = GQ;
  known.solve = [factor, scale](const Eigen::VectorXd& g) {
    Eigen::VectorXd a = g;
    a.tail(scale.size()) = scale.cwiseProduct(factor->solve(scale.cwiseProduct(g.tail(scale.size()))).col(0));
    return a;
  };
}

// Z is what takes products.  Any is good that is about what the law lets of Q.
void TwoLevelPreconditioner::renew(const ContactCoarse::Blocks& A, const ContactCoarse::Blocks& B, const ContactCoarse::Blocks& inverse) {
  constexpr double kFew = 0.2;  // of the pairs
  ContactCoarse::Blocks free;
  const Eigen::VectorXd& D = coarse_.diagonal();
  const DualVectors& vectors = coarse_.vectors();
  for (std::size_t i = 0; i < A.size(); ++i) free.push_back(inverse[i] * A[i] * D.segment<3>(3 * Eigen::Index(i)).asDiagonal());
  Eigen::Vector2d changed(isMade_ ? double(numChanged(free_, free)) : 0.0, double(free.size()));
  vectors.sum(changed);
  if (!isMade_ || changed[0] > kFew * changed[1]) {
    isMade_ = true;  // also on a rank without pairs
    Z_ = multiplyBlocks(free, coarse_.Q());
    Z_ *= basisOf(vectors, D.cwiseSqrt().asDiagonal() * Z_);  // pairs that stick leave nothing of some
    MZ_ = M_(Z_);
    free_ = std::move(free);
  }
  step_ = first_(multiplyBlocks(A, MZ_) + multiplyBlocks(B, Z_));
  Eigen::MatrixXd C = Z_.transpose() * (D.asDiagonal() * step_);
  vectors.sum(C);
  factor_ = DenseFactor(std::move(C), DenseFactor::Kind::Lu);
  step_ = Z_ - step_;
}

Eigen::VectorXd TwoLevelPreconditioner::apply(const Eigen::VectorXd& r) const {
  Eigen::VectorXd z = first_(r), y = Eigen::VectorXd::Zero(Z_.cols());
  addTransposedProduct(1, Z_, coarse_.diagonal().cwiseProduct(z), y);
  coarse_.vectors().sum(y);
  addProduct(1, step_, factor_.solve(y), z);
  return z;
}

}  // namespace Haptos
