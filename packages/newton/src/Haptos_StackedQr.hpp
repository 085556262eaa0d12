// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>

#include "Haptos_Communication.hpp"

namespace Haptos {

/// \brief The triangle R of a QR factorisation of all ranks' rows, one below the other: R^T R = sum of A^T A.
///
/// \param A [rows of this rank x n], any number of rows, also none
/// \return R [n x n], upper triangular, the same digits on all ranks.  Collective: a binary tree of messages with
/// n (n + 1) / 2 numbers each and one broadcast, so the size of the result and what a rank sends do not grow with the
/// ranks.  Unlike A^T A it keeps all digits of small residuals.
/// Source: Demmel, Grigori, Hoemmen, Langou, SIAM J. Sci. Comput. 34 (2012) A206.
Eigen::MatrixXd stackedQr(const Communicator& comm, const Eigen::MatrixXd& A);

/// \brief T such that the columns of Y T are orthonormal over all ranks; combinations that leave up to `nothing` of the largest are left out.
/// Collective.
Eigen::MatrixXd orthonormalizer(const Communicator& comm, const Eigen::MatrixXd& Y, double nothing = 1e-13);

}  // namespace Haptos
