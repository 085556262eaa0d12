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
  std::vector<std::pair<int, double>> spread;              ///< C_jn, the mean over the faces at node n
  std::array<double, 3> gap{};                             ///< int phi_j (x_p - x_s) / w_j
  bool isShared = false;                                   ///< it stands for neighbours too that have no multiplier
};

/// \brief Where multipliers are.
struct MultiplierNodes {
  std::vector<char> isKept;  ///< [secondary nodes]
  std::vector<char> isFull;  ///< [secondary faces] quadratic, with multipliers at all nodes; else at corners alone
};

/// \brief Why a node shall not carry a multiplier.  A face all corners of which are Held has one all the same, as the primary
/// surface must not pass through it.
enum class Bar : char { None, Held, Taken };

/// \brief Corners that are covered, but not barred, and on a covered face that would be left without one its free (else held) corner of
/// largest int N; all nodes of quadratic faces that are covered as a whole.
/// \param bars [secondary nodes] \param linearOnly no face is full
MultiplierNodes chooseMultipliers(const ContactSurface& secondary, const SurfaceOverlap& overlap, const std::vector<Bar>& bars,
                                  bool linearOnly = false);

/// \brief Rows of the kept nodes with dual shape functions on the covered part of every face, ascending in the node:
///
///   N' = C N,  M' = int N' N'^T,  d' = int N',  phi = diag(d') M'^-1 N',  D = int phi N^T,  M = int phi N_p^T,  w = d'
///
/// C has a row a kept node, and its columns add up to 1, hence sum phi = 1 and int phi_j N'_k = 0 for j != k (Wohlmuth 2000; Cichosz and
/// Bischoff 2011).  On full faces of 6 and 8 nodes N' is N_c + alpha sum N_m at corners, (1 - 2 alpha) N_m at middles, alpha = 1/5, as
/// int N_c is not positive (Popp, Wohlmuth, Gee, Wall 2012); where corners alone carry multipliers, middles and centre are means
/// of corners.  A corner without a multiplier leaves its function to those of the face in equal parts.
std::vector<MortarRow> dualMortarRows(const ContactSurface& secondary, const ContactSurface& primary, const SurfaceOverlap& overlap,
                                      const MultiplierNodes& multipliers);

}  // namespace Haptos
