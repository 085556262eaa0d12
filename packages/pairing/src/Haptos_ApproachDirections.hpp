// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

#include "Haptos_ContactSurface.hpp"

namespace Haptos {

constexpr double smoothTurn = 0.35;       ///< sine; above it a node lies on an edge, its normal is no surface normal
constexpr double approachCosine = 0.766;  ///< 40 degrees between a nodal normal and the direction of approach

/// \brief Directions along which curved surfaces some way apart may have been meshed alike (a sphere over a plane, its mirror image).
///
/// They lie between the mean normals, along either of them.  None of its own where a surface has edges or bends away from the
/// direction: there only the nodal normals count.
std::vector<std::array<double, 3>> approachDirections(const ContactSurface& secondary, const ContactSurface& primary);

}  // namespace Haptos
