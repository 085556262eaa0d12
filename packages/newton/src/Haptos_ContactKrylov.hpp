// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>

#include "Haptos_DualVectors.hpp"

namespace Haptos {

/// \brief A linear system on contact values [3 pairs], which are spread over the ranks, with a preconditioner.
struct ContactEquations {
  using Map = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;
  Map matrix, preconditioner;
  double tolerance;  ///< of the residual, relative
  int steps;         ///< at most

  /// \brief Conjugate gradients: matrix and preconditioner symmetric and positive; the residual in the preconditioner's norm.
  /// Collective: one reduction a step.
  Eigen::VectorXd solveByCg(const DualVectors& vectors, const Eigen::VectorXd& b) const;

  /// \brief GMRES, preconditioned from the right, without restart.  Collective: two reductions a step.
  Eigen::VectorXd solveByGmres(const DualVectors& vectors, const Eigen::VectorXd& b) const;
};

}  // namespace Haptos
