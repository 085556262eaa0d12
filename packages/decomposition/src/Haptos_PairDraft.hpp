// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "Haptos_NodeDirectory.hpp"
#include "Haptos_RowShare.hpp"

namespace Haptos {

/// \brief A pair at the rank that makes its rows.
struct PairDraft {
  static constexpr double kRoundOff = 1e-12;  ///< of a unit vector: such entries would only hide an empty row

  PlacedPair placed;
  std::vector<std::pair<int, double>> nodes;  ///< record, weight (> 0 on the secondary side); every node once
  std::array<std::array<double, 3>, 3> axes;  ///< of the rows
  RowShare::Pair share;

  bool acts(std::size_t row, std::size_t component, const NodeRecord& record) const {
    return !record.isPrescribed[component] && std::abs(axes[row][component]) >= kRoundOff;
  }
};

/// \brief Sets `nodes`; a node on both sides counts with both weights.
void findNodes(const NodeDirectory& directory, PairDraft& draft);

/// \brief Sets axes, right-hand sides and which rows are empty.
void makeRows(const NodeDirectory& directory, const InterfaceRows& interface, PairDraft& draft);

}  // namespace Haptos
