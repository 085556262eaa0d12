// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "Haptos_Vec3.hpp"

namespace Haptos {

/// \brief One subdomain, in local unknowns, 3 x node + component.
struct PolynomialSubject {
  const Coordinates& x;                  ///< [length], of all nodes
  const Eigen::SparseMatrix<double>& K;  ///< both triangles
  const Eigen::MatrixXd& R;              ///< [unknowns x k] rigid motions, of which K feels nothing
  const std::vector<int>& boundary;      ///< unknowns that rows touch
};

/// \brief Fields of the third degree in the coordinates, on the boundary, that take next to nothing: u^T K u < softest u_b^T diag(K)_bb u_b.
///
/// Bending, torsion and stretching of a subdomain as a whole, without S and an eigenproblem of it: one of sixty rows at most.
/// \return [boundary x m], rigid motions taken out.  Decision: 042-spectral-modes.
Eigen::MatrixXd polynomialMotions(const PolynomialSubject& subject, double softest = 0.05);

}  // namespace Haptos
