// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>

#include "Haptos_DualVectors.hpp"

namespace Haptos {

/// \brief Motions whose images under a matrix are known, [3 pairs x k] each; a Krylov method leaves them to a direct solve.
///
/// Bodies that friction hardly holds move where the equations are small beside all others: no residual tells of it, an
/// exact solve in these few motions does.  Source: Nicolaides, SIAM J. Numer. Anal. 24 (1987) 355.
struct KnownMotions {
  Eigen::MatrixXd motions, images;
  std::function<Eigen::VectorXd(const Eigen::VectorXd&)> solve{};  ///< (motions^T images)^-1, the same on all ranks; empty: it is 1
};

/// \brief A linear system on contact values [3 pairs], which are spread over the ranks, with a preconditioner.
struct ContactEquations {
  using Map = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;
  Map matrix, preconditioner;
  double tolerance;  ///< of the residual, relative
  int steps;         ///< at most
  KnownMotions known{};

  struct Solution {
    Eigen::VectorXd x;
    bool isConverged;  ///< to the tolerance
    int products;      ///< with the matrix
  };

  /// \brief Conjugate gradients: matrix and preconditioner symmetric and positive; the residual in the preconditioner's norm.
  /// Collective: one reduction a step.
  Solution solveByCg(const DualVectors& vectors, const Eigen::VectorXd& b) const;

  /// \brief GMRES, preconditioned from the right, without restart; known: orthonormal images, `solve` is not asked.  Collective: two reductions a step.
  Solution solveByGmres(const DualVectors& vectors, const Eigen::VectorXd& b) const;
};

}  // namespace Haptos
