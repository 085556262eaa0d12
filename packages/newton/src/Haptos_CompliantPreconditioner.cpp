// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CompliantPreconditioner.hpp"

#include <Tpetra_Operator.hpp>
#include <cmath>

#include "Haptos_ContactKrylov.hpp"

namespace Haptos {

CompliantPreconditioner::CompliantPreconditioner(const ContactOperators& dual, const DualVectors& vectors, double tolerance,
                                                 int maximumSteps)
    : dual_(dual), vectors_(vectors), tolerance_(tolerance), maximumSteps_(maximumSteps) {}

void CompliantPreconditioner::prepare(const std::vector<PairLaw>& pairs, const LawLinearization& law,
                                      const std::vector<TangentialModes>& modes) {
  constexpr double kRigid = 1e-12;  // of 1 - theta: sticking
  // Modes that the law holds (theta = 0) take no part; those that stick have C = 0 and M serves them; what lies between has
  // C^-1 = r sigma / (1 - sigma) and, in E^T M E, about k on the diagonal.
  const Eigen::Index n = 3 * Eigen::Index(pairs.size());
  rotations_.assign(pairs.size(), Eigen::Matrix2d::Identity());
  isCompliant_ = inverseC_ = Eigen::VectorXd::Zero(n);
  diagonal_ = scale_ = Eigen::VectorXd::Ones(n);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!law.tangential[i]) continue;
    rotations_[i] = modes[i].E;
    for (int m = 0; m < 2; ++m) {
      const Eigen::Index at = 3 * Eigen::Index(i) + 1 + m;
      const double theta = modes[i].theta[m];
      if (modes[i].isHeld(m) || theta <= 0) continue;
      scale_[at] = std::sqrt(theta);
      if (theta >= 1 - kRigid) continue;
      isCompliant_[at] = 1;
      inverseC_[at] = modes[i].inverseCompliance(m);
      diagonal_[at] = inverseC_[at] + modes[i].stiffness;
    }
  }
  isNeeded_ = vectors_.sum(isCompliant_.sum()) > 0;
}

// E^T x or E x, contact values [3 pairs]
Eigen::VectorXd CompliantPreconditioner::turned(Eigen::VectorXd x, Turn turn) const {
  for (std::size_t i = 0; i < rotations_.size(); ++i) {
    const Eigen::Matrix2d& E = rotations_[i];
    auto tangential = x.segment<2>(3 * Eigen::Index(i) + 1);
    tangential = turn == Turn::ToModes ? (E.transpose() * tangential).eval() : (E * tangential).eval();
  }
  return x;
}

// (C^-1 + E^T M E) q = b by conjugate gradients, preconditioned by the diagonal of the matrix.
Eigen::VectorXd CompliantPreconditioner::solveCompliance(const Eigen::VectorXd& b) const {
  return ContactEquations{[&](const Eigen::VectorXd& p) -> Eigen::VectorXd {
                            const Eigen::VectorXd MEp = vectors_.applyOnContact(*dual_.contactM, turned(p, Turn::FromModes));
                            return inverseC_.cwiseProduct(p) + turned(MEp, Turn::ToModes).cwiseProduct(isCompliant_);
                          },
                          [&](const Eigen::VectorXd& r) -> Eigen::VectorXd { return r.cwiseQuotient(diagonal_); }, tolerance_,
                          maximumSteps_}
      .solveByCg(vectors_, b)
      .x;
}

// By Woodbury (M^-1 + E C E^T)^-1 r = M (r - E q), where q = C E^T z is the jump of the springs.  On modes the vector that
// comes in is r_theta = sqrt(theta) r, the one that goes out z_theta = z / sqrt(theta).
Eigen::VectorXd CompliantPreconditioner::apply(const Eigen::VectorXd& r) const {
  if (!isNeeded_) return vectors_.apply(*dual_.M, r);
  Eigen::VectorXd w = r;
  const Eigen::VectorXd rhs = turned(vectors_.contact(r), Turn::ToModes).cwiseQuotient(scale_);
  vectors_.setContact(w, turned(rhs, Turn::FromModes));
  const Eigen::VectorXd ETMw = turned(vectors_.applyToContact(*dual_.contactRowsOfM, w), Turn::ToModes);
  const Eigen::VectorXd q = solveCompliance(ETMw.cwiseProduct(isCompliant_));
  vectors_.setContact(w, turned(rhs - q, Turn::FromModes));
  Eigen::VectorXd z = vectors_.apply(*dual_.M, w);
  // E^T z = C^-1 q holds exactly; the difference M (r - E q) would lose it where C is large.
  Eigen::VectorXd modes = turned(vectors_.contact(z), Turn::ToModes);
  for (Eigen::Index i = 0; i < modes.size(); ++i)
    if (isCompliant_[i] != 0) modes[i] = inverseC_[i] * q[i];
  vectors_.setContact(z, turned(modes.cwiseQuotient(scale_), Turn::FromModes));
  return z;
}

}  // namespace Haptos
