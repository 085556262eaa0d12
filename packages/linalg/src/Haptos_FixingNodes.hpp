// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/SparseCore>
#include <array>
#include <vector>

namespace Haptos {

/// \brief A few well-spread nodes in every connected piece of a subdomain, enough to hold it.
///
/// Farthest-point sampling in coordinates scaled to unit inertia (a needle becomes a cube), `perPiece` nodes a
/// piece; nodes are added where those do not hold a column of the kernel firmly (pieces that hang together by a
/// hinge).  Depends on the input only; equal for congruent subdomains numbered alike.
///
/// \param K           n x n, n = 3 x nodes, node-major xyz; its pattern tells the pieces.
/// \param kernel      n x k, orthonormal columns spanning the kernel of K, k >= 0.
/// \param coordinates one per node; any unit of length.
/// \return local node numbers, ascending; none if k = 0.
///
/// Source: Brzobohaty, Dostal, Kozubek, Kovar, Markopoulos, Int. J. Numer. Meth. Engng. 88 (2011) 493.
std::vector<int> chooseFixingNodes(const Eigen::SparseMatrix<double>& K, const Eigen::MatrixXd& kernel,
                                   const std::vector<std::array<double, 3>>& coordinates, int perPiece = 8);

/// \brief Unknowns that hold the kernel, chosen from its entries alone: for matrices without node-major order.
///
/// Several rounds of pivoted QR of kernel^T, k unknowns each.  \return ascending; none if k = 0.
std::vector<int> chooseFixingUnknowns(const Eigen::MatrixXd& kernel, int rounds = 4);

/// \brief K_reg = K + N (R_f^T N)^-1 N^T,  N = W R_f,  with R_f the rows `unknowns` of the kernel R and zero elsewhere.
///
/// Positive definite, and its inverse is a generalised inverse of K without error: K K_reg^-1 K = K, for any positive
/// diagonal W.  W = rho I is the published choice; here W is K's own diagonal, so that the result follows the units of
/// K and, under stiffness contrast, soft rows keep soft entries: at contrast 1e8 the backward error of single rows is
/// then 1e-15, where one rho for all gives 1e-7.  Couplings between unknowns that no column of the kernel relates
/// (other pieces) are left out of the pattern.
///
/// \throws std::runtime_error if the kernel has dependent columns on `unknowns`.
Eigen::SparseMatrix<double> regularizeByFixing(const Eigen::SparseMatrix<double>& K, const Eigen::MatrixXd& kernel,
                                               const std::vector<int>& unknowns);

}  // namespace Haptos
