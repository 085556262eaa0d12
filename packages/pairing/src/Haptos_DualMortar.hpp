// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <utility>
#include <vector>

#include "Haptos_SurfaceOverlap.hpp"

namespace Haptos {

/// \brief The row of a kept node j:  (1 / w_j) (sum D_jn u_n - sum M_jl u_l), by positions in the two surfaces.
struct MortarRow {
  int node;
  double w = 0;                                            ///< int phi_j [area]
  std::vector<std::pair<int, double>> secondary, primary;  ///< D_jn / w_j, M_jl / w_j; ascending, each adds up to 1
  std::array<double, 3> gap{};                             ///< int phi_j (x_p - x_s) / w_j
  bool isShared = false;                                   ///< it stands for neighbours too that have no multiplier
};

/// \brief Which secondary nodes carry a multiplier: those that are covered, but not `isBarred`, and on a covered face that
/// would be left without one its free node of largest int N.
/// \param isBarred [secondary nodes]
/// \return [secondary nodes]
std::vector<char> keptNodes(const ContactSurface& secondary, const SurfaceOverlap& overlap, const std::vector<char>& isBarred);

/// \brief Rows of the kept nodes with dual shape functions on the covered part of every face, ascending in the node:
///
///   N' = C N,  M' = int N' N'^T,  d' = int N',  phi = diag(d') M'^-1 N',  D = int phi N^T,  M = int phi N_p^T,  w = d'
///
/// C has a row a kept node; a node without a multiplier leaves its shape function to those of the face in equal parts.  Hence
/// sum phi = 1 and int phi_j N'_k = 0 for j != k (Wohlmuth 2000; Cichosz and Bischoff 2011).  A face without kept nodes has none.
std::vector<MortarRow> dualMortarRows(const ContactSurface& secondary, const ContactSurface& primary, const SurfaceOverlap& overlap,
                                      const std::vector<char>& isKept);

}  // namespace Haptos
