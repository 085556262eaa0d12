// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <BelosLinearProblem.hpp>
#include <BelosTpetraAdapter.hpp>  // the traits of MultiVector and Operator, before any use of them
#include <stdexcept>

#include "Haptos_FeasibleSet.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief The cost falls without end in a direction that neither the set nor the equality forbids: there is no solution.
class UnboundedCost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// \brief A convex quadratic program with a separable convex set and a linear equality.
///
///   minimise 1/2 x^T A x - b^T x   over x in Omega   subject to Q (x - x0) = 0
///
/// A is symmetric and positive semidefinite, Q an orthogonal projector (null: no equality) and x0 any point with
/// the right Q x0 (null: 0).  For TFETI: A = P F P, b = P (h - F x0), Q = G^T (G G^T)^-1 G, P = I - Q.
/// It is a Belos linear problem whose operator, left and right side are A, x and b, so that Belos' interfaces
/// carry it; x is both start and result.  All vectors have one column and the map of A's domain.
///
/// Override `applyHessian` where A and Q share work.
template <class Scalar, class MV, class OP>
class QuadraticProgram : public Belos::LinearProblem<Scalar, MV, OP> {
 public:
  QuadraticProgram(const RCP<const OP>& A, const RCP<MV>& x, const RCP<const MV>& b,
                   const RCP<FeasibleSet<MV>>& omega, const RCP<const OP>& Q = Teuchos::null,
                   const RCP<const MV>& x0 = Teuchos::null);

  /// \brief Ax := A x and Qx := Q x (0 without equality); one Hessian multiplication.  Collective.
  virtual void applyHessian(const MV& x, MV& Ax, MV& Qx) const;

  /// \brief Qx := Q x (0 without equality); no Hessian multiplication.  Collective.
  virtual void applyEqualityProjector(const MV& x, MV& Qx) const;

  virtual bool hasEquality() const { return !Q_.is_null(); }

  const RCP<FeasibleSet<MV>>& feasibleSet() const { return omega_; }
  const RCP<const MV>& particularPoint() const { return x0_; }

 private:
  RCP<FeasibleSet<MV>> omega_;
  RCP<const OP> Q_;
  RCP<const MV> x0_;
};

extern template class QuadraticProgram<double, MultiVector, Operator>;

}  // namespace Haptos
