// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SmallSystem.hpp"

#include <cmath>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_StackedQr.hpp"

namespace Haptos {

// || Q R y + s_E ||^2 + || J y + phi ||^2 over all rows.  Q has orthonormal columns: the first part is || R y + Q^T s_E ||^2 and what
// lies outside of Q, which no y changes.  [J -phi] has 3 rows a pair on its rank: its triangle [T t; 0 tau] has the same products,
// so || J y + phi || = || (T y - t, tau) || with m + 1 rows, tau among them so that `residual` is that of the law.
SmallSystem::SmallSystem(const RecycledSubspace& subspace, const LawLinearization& law, const Eigen::VectorXd& gluing,
                         const Communicator& comm) {
  constexpr double kUnfelt = 1e-13;  // of a column: round-off of a jump of length 1
  const Eigen::Index m = subspace.size();
  Eigen::MatrixXd J(law.phi.size(), m + 1);
  J << law.multiply(subspace.Vc(), subspace.Sc()), -law.phi;
  J = stackedQr(comm, J);
  M_.resize(2 * m + 1, m);
  rhs_.resize(2 * m + 1);
  M_ << Eigen::MatrixXd(subspace.R().triangularView<Eigen::Upper>()), J.leftCols(m);
  rhs_ << -gluing, J.rightCols(1);
  scale_ = M_.colwise().norm().transpose();
  for (Eigen::Index j = 0; j < m; ++j) {  // jumps have length 1: a motion that the law of the day does not feel is left alone
    if (scale_[j] > kUnfelt) continue;
    scale_[j] = 1;
    M_.col(j).setZero();
  }
  for (Eigen::Index j = 0; j < m; ++j) M_.col(j) /= scale_[j];
}

// Pairs become dependent where the law lets go of what told them apart: then the step of least length.
Eigen::VectorXd SmallSystem::solve(double damping) const {
  constexpr double kRankTolerance = 1e-12;  // pivots of columns of length 1
  const Eigen::Index m = M_.cols();
  if (damping == 0) return solveLeastSquares(M_, rhs_, kRankTolerance).cwiseQuotient(scale_);
  // [M; sqrt(damping) I] y = [rhs; 0]
  Eigen::MatrixXd damped(M_.rows() + m, m);
  damped << M_, std::sqrt(damping) * Eigen::MatrixXd::Identity(m, m);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(damped.rows());
  b.head(M_.rows()) = rhs_;
  return solveLeastSquares(damped, b, kRankTolerance).cwiseQuotient(scale_);
}

double SmallSystem::residual(const Eigen::VectorXd& y) const { return (M_ * y.cwiseProduct(scale_) - rhs_).norm(); }

}  // namespace Haptos
