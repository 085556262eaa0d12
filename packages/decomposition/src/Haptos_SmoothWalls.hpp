// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_DualGraph.hpp"

namespace Haptos {

/// \brief Takes teeth and necks off the walls between the parts of a partition: threshold dynamics.
///
/// What is 1 on a part and 0 elsewhere walks some steps along the couplings between elements; then every element goes to the part of which
/// most has come to it, and that again.  Walls move by their curvature: teeth of a few elements go, and what is flat stays.  In the end elements
/// that are coupled more to another part than to their own go there.  No part becomes more than a fifth smaller or larger than their mean by that;
/// it may be left with small fragments.
/// Serial; the result depends on the arguments only.  Sources: merriman-bence-osher-1994, esedoglu-otto-2015.
/// \param part [elements] is changed
void smoothWalls(const DualGraph& graph, std::vector<int>& part);

}  // namespace Haptos
