// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

#include "Haptos_DualGraph.hpp"

namespace Haptos {

/// \brief Makes the parts of a partition round: a balanced Voronoi diagram of their own centres (Lloyd's iteration).
///
/// Element e, with centroid x, goes to that part p among its own and its neighbours' which minimises
///
///   |x - c_p|^2 - w_p,    c_p the centre of the part's elements, w_p raised while the part is too small.
///
/// A part keeps at least one element.  Parts may be left with small fragments.  Serial; the result depends on the
/// arguments only.  Sources: lloyd-1982, aurenhammer-1987.
/// \param centroids [elements]
/// \param wanted [parts] elements that each part should have
/// \param part [elements] is changed
void roundParts(const DualGraph& graph, const std::vector<std::array<double, 3>>& centroids, const std::vector<double>& wanted,
                std::vector<int>& part);

}  // namespace Haptos
