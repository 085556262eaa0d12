// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_ContactOperators.hpp"
#include "Haptos_DualVectors.hpp"
#include "Haptos_LawLinearization.hpp"

namespace Haptos {

/// \brief z := (M^-1 + C)^-1 r, where C is the law's compliance of slip, on the tangential modes between stick and slip.
///
/// A slip mode obeys C dlambda - ds = rhs with C = (1 - sigma) / (r sigma) [length/force]: a spring in series with the
/// body, so that F + C is to be inverted and not F.  With E the rows of these modes
///
///   z = M (r - E q),   (C^-1 + E^T M E) q = E^T M r
///
/// q comes from conjugate gradients, preconditioned by its diagonal, on the contact rows alone.  Scaling M by the
/// shares theta = (1/k) / (C + 1/k) instead is right for short waves only and makes the counts grow with the contact's size.
///
/// Vectors are in the variables of the coarse projections, r_theta = sqrt(theta) r and z_theta = z / sqrt(theta).
class CompliantPreconditioner {
 public:
  /// References are kept.  \param tolerance of q, relative; \param maximumSteps of conjugate gradients
  CompliantPreconditioner(const ContactOperators& dual, const DualVectors& vectors, double tolerance, int maximumSteps);

  /// \param modes [pairs], valid where law.tangential.
  void prepare(const std::vector<PairLaw>& pairs, const LawLinearization& law, const std::vector<TangentialModes>& modes);

  /// \brief Collective: M, the contact rows of M, up to `maximumSteps` times its contact block with one reduction each.
  Eigen::VectorXd apply(const Eigen::VectorXd& r) const;

 private:
  enum class Turn { ToModes, FromModes };
  Eigen::VectorXd turned(Eigen::VectorXd x, Turn turn) const;
  Eigen::VectorXd solveCompliance(const Eigen::VectorXd& b) const;

  const ContactOperators& dual_;
  const DualVectors& vectors_;
  double tolerance_;
  int maximumSteps_;
  std::vector<Eigen::Matrix2d> rotations_;  // [pairs] modes in columns
  Eigen::VectorXd isCompliant_, inverseC_, diagonal_, scale_;  // [3 pairs], in modes; scale_ = sqrt(theta)
  bool isNeeded_ = false;
};

}  // namespace Haptos
