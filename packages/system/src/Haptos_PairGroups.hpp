// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <vector>

#include "Haptos_ContactOperators.hpp"

namespace Haptos {

class MultiplierMap;

/// \brief Groups of pairs that lie together on the contact surfaces, with an overlap of about half of what is a group's own; each of one interface.
///
/// \param places [owned pairs].  \return Groups that do not depend on the ranks, but for the order of their pairs.  Collective.
std::vector<PairGroup> groupsOfPairs(const MultiplierMap& multipliers, const std::vector<Eigen::Vector3d>& places);

}  // namespace Haptos
