// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "Haptos_ContactPairs.hpp"
#include "Haptos_DualMortar.hpp"

namespace Haptos {

/// \brief An interface that is joined by mortar, while it is decided which of its nodes carry multipliers.  Serial.
struct MortarDraft {
  const ContactSpec* spec;
  ContactSurface secondary, primary;
  SurfaceOverlap overlap;
  std::vector<Bar> bars;       ///< [secondary nodes]
  std::string exchange;        ///< what the secondary side is, where it is not the user's; else empty
};

bool hasMiddles(const ContactSurface& surface);  ///< whether it has quadratic faces

std::vector<NodeWeight> onMesh(const ContactSurface& surface, const std::vector<std::pair<int, double>>& entries);

/// \brief Rows opposite a rigid obstacle.
std::vector<MortarRow> rowsOfWholeSurface(const ContactSurface& surface, bool linearOnly);

/// \brief Adds pairs, notes and moves of nodes to the interface.
///
/// The gap is that of the node itself along its normal; the mean of the row where it stands for neighbours too, or where the normal
/// meets nothing.  Rows along axes that are held on both sides are pinned.  The secondary nodes of a tied interface
/// are to be moved onto the primary surface, so that turning both bodies together costs no stress; not by more than a quarter of
/// the element size, which is noted.
void addMortarPairs(const ContactSurroundings& around, const MortarDraft& draft, ContactInterface& interface);

}  // namespace Haptos
