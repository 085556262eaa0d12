// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace Haptos {

/// \brief Coarse unknowns of a subdomain, where all subdomains have as many: its rigid motions.
constexpr int kCoarseModes = 6;

/// Rows: owned dual rows of this rank; columns: all coarse unknowns, 6 x subdomain + mode (global).
using CoarseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// \name Products with coarse rows C [m x l], which mostly have all six columns of a subdomain: those are taken at once.
/// @{
/// \brief C^T x [l]; rows where x is 0 are passed over.
Eigen::VectorXd multiplyTransposed(const CoarseRows& C, const Eigen::Ref<const Eigen::VectorXd>& x);
/// \brief C a [m]
Eigen::VectorXd multiply(const CoarseRows& C, const Eigen::Ref<const Eigen::VectorXd>& a);
/// @}

}  // namespace Haptos
