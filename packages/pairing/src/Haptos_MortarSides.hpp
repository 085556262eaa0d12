// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "Haptos_ContactPairs.hpp"
#include "Haptos_ContactSurface.hpp"

namespace Haptos {

/// \brief Why the primary surface of a mortar interface is to carry the multipliers instead; empty: it is not.
///
/// In this order: the given one where friction is told at its nodes; the one whose multipliers resist more, as supports and what is covered leave them
/// on a surface, on a line, at a point or nowhere; the softer one; the finer one.  Serial.
std::string reasonToExchange(const Mesh& mesh, const ContactSpec& spec, const ContactSurroundings& around, const ContactSurface& secondary,
                             const ContactSurface& primary);

}  // namespace Haptos
