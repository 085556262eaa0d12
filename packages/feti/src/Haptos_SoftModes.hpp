// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>

namespace Haptos {

/// \brief A slender subdomain's S in a form that keeps the digits of soft motions, and those motions.
///
/// S = L^T L, rigid motions exactly without energy, L from Cholesky's factor.  The energy of a soft motion w, S w = mu diag(S) w, is
/// |L w|^2 to its last digits, where w^T S w has lost eps / mu.
struct SoftSpectrum {
  Eigen::MatrixXd L;      ///< [n x n]
  /// Eigenvectors with mu < `softest`, orthogonal to the rigid motions in diag(S): bending and stretching, [n x m].  What
  /// is left of any motion w has |D w|_S^2 <= mu_max / softest |w|_S^2 for every weighting D of the nodes by numbers
  /// in [0, 1], and such weightings are what a preconditioner does to w.
  Eigen::MatrixXd modes;
  Eigen::VectorXd mu;     ///< [m] ascending
};

/// \param S [n x n], \param rigid [n x k] kernel of S, \param softest .05 left an eigenvalue of 175 on thin tetrahedra, .2 leaves 7; .3 costs more
/// than it saves in most scenes (decisions/016)
SoftSpectrum softSpectrum(const Eigen::MatrixXd& S, const Eigen::MatrixXd& rigid, double softest = 0.15);

}  // namespace Haptos
