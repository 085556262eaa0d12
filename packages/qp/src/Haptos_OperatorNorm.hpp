// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_QuadraticProgram.hpp"

namespace Haptos {

/// \brief What `estimateOperatorNorm` found.
struct OperatorNorm {
  double value = 0;       ///< estimate of ||A||, in the unit of A, from above as a rule
  int applications = 0;   ///< Hessian multiplications spent
  bool decoupled = true;  ///< Q A = 0, so that ||A + rho Q|| = max(||A||, rho); otherwise the sum bounds it
};

/// \brief Estimates ||A|| of a quadratic program by Lanczos' method with full orthogonalisation.  Collective.
///
/// value = theta + |residual of theta|, theta the largest Ritz value; the residual is the margin of safety.  An upper
/// bound of ||A|| as soon as theta converges to the largest eigenvalue (Y. Zhou, R.-C. Li, Linear Algebra Appl. 435
/// (2011) 480-493).  Stops when the residual is below 2 % of theta or after `maxApplications`.  Not a proven bound:
/// where theta first settles on a smaller eigenvalue the value was seen 3 % too small.  The default steplength
/// 1.9 / value stays below 2 / ||A|| up to 5 %; beyond that `MpgpIter`, which watches every curvature that it meets,
/// takes back a step that raised the cost and raises the estimate.
/// The start vector depends on global indices only, not on the number of ranks.
template <class Scalar, class MV, class OP>
OperatorNorm estimateOperatorNorm(const QuadraticProgram<Scalar, MV, OP>& problem, int maxApplications = 10);

/// \brief Fills v with numbers in [-1, 1] made from the global indices by a hash.
void fillFromGlobalIndices(MultiVector& v);

extern template OperatorNorm estimateOperatorNorm(const QuadraticProgram<double, MultiVector, Operator>&, int);

}  // namespace Haptos
