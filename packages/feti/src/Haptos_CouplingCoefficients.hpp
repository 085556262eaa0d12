// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>

#include "Haptos_MultiplierMap.hpp"

namespace Haptos {

/// \brief visit(node, component, coefficient) for a row of a coupling: axis x weight, prescribed components left out.
template <class Axis, class Visit>
void forEachCoefficient(const Axis& axis, const std::vector<PairNode>& nodes, Visit&& visit) {
  for (const PairNode& node : nodes)
    for (int d = 0; d < 3; ++d)
      if (!node.isPrescribed[std::size_t(d)] && std::abs(axis[std::size_t(d)]) >= 1e-12) visit(node, d, axis[std::size_t(d)] * node.weight);
}

}  // namespace Haptos
