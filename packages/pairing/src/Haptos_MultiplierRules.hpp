// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <string>
#include <vector>

#include "Haptos_MortarPairs.hpp"

namespace Haptos {

/// \brief Whether supports prescribe the motion of a node along its normal.
/// \param held its components
bool isNormalHeld(const std::array<char, 3>& held, const std::array<double, 3>& normal);

/// \brief Bars nodes of mortar interfaces from carrying multipliers where rows would depend on each other, and notes how many: nodes of both
/// sides (crack tips), nodes that another interface holds already (a tie before contact, then the larger covered area; node-to-node
/// pairs stay as they are), secondary nodes that are primary elsewhere where this goes around in a circle, and nodes that supports hold.
/// Serial.
/// Patches of one interface, which meet at creases, are to each other as interfaces are.
/// \param drafts in the order of interfaces, each with the position of its own
void barDependentNodes(const ContactSurroundings& around, std::vector<MortarDraft>& drafts, std::vector<ContactInterface>& interfaces);

}  // namespace Haptos
