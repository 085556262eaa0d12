// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <tuple>
#include <vector>

#include "Haptos_MultiplierMap.hpp"

namespace Haptos {

/// \brief A coupling where all that meet it at nodes are, with one number a row.
struct HeldCoupling {
  std::array<GlobalOrdinal, 3> rows;  ///< -1: none
  std::array<double, 3> values;
  bool isContact;
  std::array<std::array<double, 3>, 3> axes;
  std::vector<PairNode> nodes;

  auto parts() { return std::tie(rows, values, isContact, axes, nodes); }
};

/// \brief Whether rows on these nodes, none of them met elsewhere, can be obeyed whatever others ask for, as `node` is free in all components and has a tenth
/// of the largest weight: with less its force is nearly that of the other nodes.
bool hasToItself(const std::vector<PairNode>& nodes, std::int64_t node);

/// \brief Couplings, each on the lowest rank of those that meet; without those of one rank alone that have a node to themselves, which are
/// most, and depend on no others.  \param values [owned rows].  Collective.
std::vector<HeldCoupling> heldCouplings(const MultiplierMap& multipliers, const Vector& values);

}  // namespace Haptos
