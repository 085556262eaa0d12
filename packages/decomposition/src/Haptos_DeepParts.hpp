// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

#include "Haptos_DualGraph.hpp"

namespace Haptos {

/// \brief Parts of a partition whose elements have their centroids in one plane take elements of their neighbours until they have not.
///
/// Of interest to quadratic elements with one pressure each (TETRA10 near incompressibility): the motion 2 (b.x) x - |x|^2 b has
/// no deviatoric strain and div u = 6 b.x, of zero mean in each of those elements where b is normal to the plane.  It costs such a part no energy and is no
/// rigid motion.  One cell of a brick cut in six tetrahedra is a part like that.  A neighbour stays connected and does not become flat by that; a part
/// without such a neighbour stays as it is.
/// Serial; the result depends on the arguments only.
/// \param needsDepth [elements] whether it is such an element: a part with any other is left alone; empty: none is
/// \param part [elements] is changed
void deepenParts(const DualGraph& graph, const std::vector<std::array<double, 3>>& centroids, const std::vector<char>& needsDepth,
                 std::vector<int>& part);

}  // namespace Haptos
