// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <functional>
#include <vector>

namespace Haptos {

class DualPreconditioner;

/// \brief How B_D^T B takes a subdomain's motion apart: column 0 is what is left to itself, the others what each neighbour gets.
///
/// With v_j the share of copy j in the mean of a node's copies (contact closed), the subdomain i keeps (1 - v_i) w, and moves its
/// neighbour j by -v_i w.  A neighbour's S is taken for that of i at that place, times k_j / k_i of the stiffness weights, so that column j is sqrt(v_i v_j).
using CopyWeights = Eigen::SparseMatrix<double>;  ///< [boundary unknowns x (1 + groups of neighbours)]

/// \brief The column of neighbours with this number.
int columnOfCopies(int subdomain);

/// \brief Of every local subdomain on the unknowns that rows touch.  Neighbours are told apart by their numbers modulo a prime, so that
/// nobody needs a list of them.  Collective.
std::vector<CopyWeights> copyWeights(const DualPreconditioner& M);

/// \brief Motions that cost far more when copies of nodes are moved apart: w^T A w = theta w^T S w, A the energy of P_D w (`NeighbourStiffness`).
struct SpectralModes {
  Eigen::VectorXd theta;  ///< descending
  Eigen::MatrixXd modes;  ///< [n x m]
};

/// \brief Those with theta above `least`: what is left of any motion w has w^T A w <= least |w|_S^2, whatever the elements
/// and materials are, and that bounds the condition of the deflated preconditioner [spillane-rixen-2013].
///
/// \param S, A [n x n] both triangles, \param rigid [n x k] kernel of S
SpectralModes spectralModes(const Eigen::MatrixXd& S, const Eigen::MatrixXd& A, const Eigen::MatrixXd& rigid, double least);

}  // namespace Haptos
