// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Haptos_ContactPairs.hpp"
#include "Haptos_DualMortar.hpp"
#include "Haptos_PointwiseGap.hpp"

namespace Haptos {

/// \brief A patch without creases of an interface that is joined by mortar, while it is decided which of its nodes carry multipliers.  Serial.
struct MortarDraft {
  const ContactSpec* spec;
  ContactSurface secondary;
  std::shared_ptr<const ContactSurface> primary;  ///< one for all patches of the interface
  SurfaceOverlap overlap;
  std::vector<Bar> bars;       ///< [secondary nodes]
  std::size_t interface = 0;   ///< its position
};

bool hasMiddles(const ContactSurface& surface);  ///< whether it has quadratic faces

std::vector<NodeWeight> onMesh(const ContactSurface& surface, const std::vector<std::pair<int, double>>& entries);

/// \brief What the row makes of pointwise gaps, as it does of displacements: sum D_jn g_n / w_j; the node's own where a gap is missing.
///
/// On closed curved faces u_n = g_n, and the row of a middle is (5 u_m - u_c1 - u_c2) / 3: with g_m alone it would stay open by
/// kappa h^2 / 12, and corners would carry what middles do not.  Never below 0 and all g_n, so that surfaces that just touch are not pressed.
/// \param gapAt of a secondary node (its position)
std::optional<double> gapOfRow(const MortarRow& row, const std::function<std::optional<double>(int)>& gapAt);

/// \brief Rows opposite a rigid obstacle.
std::vector<MortarRow> rowsOfWholeSurface(const ContactSurface& surface, bool linearOnly);

/// \brief Adds the pairs of a patch, notes and moves of nodes to the interface.
///
/// The gap is that of the row's nodes along their normals (`gapOfRow`); the mean of the row where it stands for neighbours too
/// and facets are not smoothed, or where the normal meets nothing.  Rows along axes that are held on both sides are pinned.  The secondary nodes of a tied interface
/// are to be moved onto the primary surface, so that turning both bodies together costs no stress; not by more than a quarter of
/// the element size, which is noted.
/// \param gaps of the interface's primary surface
void addMortarPairs(const ContactSurroundings& around, const MortarDraft& draft, PointwiseGap& gaps, ContactInterface& interface);

}  // namespace Haptos
