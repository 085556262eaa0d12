// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/SparseCore>
#include <vector>

namespace Haptos {

/// \brief Unknowns of a sparse symmetric positive semidefinite matrix that others determine, or nearly so: those whose pivots are at most `tolerance` of
/// their diagonal entries once all others are eliminated, ascending; empty ones do not count.
///
/// Pivots that are small beside others wait.  In an order that is given beforehand many small ones may hide one of zero (Higham 2002, Accuracy and
/// Stability of Numerical Algorithms, 10.3.2).
std::vector<int> dependentUnknowns(const Eigen::SparseMatrix<double>& A, double tolerance);

}  // namespace Haptos
