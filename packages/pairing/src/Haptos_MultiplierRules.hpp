// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "Haptos_MortarPairs.hpp"

namespace Haptos {

/// \brief Whether supports prescribe the motion of a node along its normal.
/// \param held its components
bool isNormalHeld(const std::array<char, 3>& held, const std::array<double, 3>& normal);

/// \brief Whether supports take a node its multiplier: of a tie all three components must be held, of a contact its normal.
bool isHeldFor(const ContactSpec& spec, const std::array<char, 3>& held, const std::array<double, 3>& normal);

/// \brief Where pairs node to node go round in a circle, as where three bodies meet: the jump of one is the sum of the others', and forces may go round.
///
/// Pairs without friction hold along their normal only, and count where all of these are alike.
/// \return [interfaces] nodes of both sides of those pairs that close one, ascending
std::vector<std::vector<std::int64_t>> nodesThatCloseCircles(const std::vector<ContactSpec>& specs, const std::vector<ContactInterface>& interfaces);

/// \brief Bars nodes of mortar interfaces from carrying multipliers where rows would depend on each other, and notes how many: nodes of both
/// sides (crack tips), nodes that another interface holds already (a tie before contact, then the larger covered area; node-to-node
/// pairs stay as they are), secondary nodes that are primary elsewhere where this goes around in a circle, and nodes that supports hold,
/// and those of `closing`.  Serial.
/// Patches of one interface, which meet at creases, are to each other as interfaces are.
/// \param closing as `nodesThatCloseCircles` gives it \param drafts in the order of interfaces, each with the position of its own
void barDependentNodes(const ContactSurroundings& around, const std::vector<std::vector<std::int64_t>>& closing, std::vector<MortarDraft>& drafts,
                       std::vector<ContactInterface>& interfaces);

}  // namespace Haptos
