// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_HeldCouplings.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <cmath>
#include <map>

#include "Haptos_ConstraintRows.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

// Of this rank's couplings, that use it.
std::map<std::int64_t, int> usesOfNodes(const std::vector<Coupling>& couplings) {
  std::map<std::int64_t, int> uses;
  for (const Coupling& coupling : couplings)
    for (const PairNode& node : coupling.nodes) uses[node.node] += node.weight != 0;
  return uses;
}

}  // namespace

bool hasToItself(const std::vector<PairNode>& nodes, std::int64_t node) {
  constexpr double kResists = 0.1;
  double largest = 0, own = 0;
  for (const PairNode& other : nodes) {
    largest = std::max(largest, std::abs(other.weight));
    const bool isFree = !other.isPrescribed[0] && !other.isPrescribed[1] && !other.isPrescribed[2];
    if (other.node == node && isFree) own = std::abs(other.weight);
  }
  return own > kResists * largest;
}

std::vector<HeldCoupling> heldCouplings(const MultiplierMap& multipliers, const Vector& values) {
  const Map& map = *multipliers.map();
  std::vector<std::vector<HeldCoupling>> outgoing(std::size_t(map.getComm()->getSize()));
  const auto data = values.getData(0);
  const auto uses = usesOfNodes(multipliers.couplings());
  for (const Coupling& coupling : multipliers.couplings()) {
    const auto isOwn = [&](const PairNode& node) { return uses.at(node.node) == 1 && hasToItself(coupling.nodes, node.node); };
    if (coupling.holder < 0 && std::any_of(coupling.nodes.begin(), coupling.nodes.end(), isOwn)) continue;
    HeldCoupling item{{-1, -1, -1}, {0, 0, 0}, false, coupling.axes, coupling.nodes};
    for (std::size_t a = 0; a < 3; ++a)
      if (const int row = coupling.rows[a]; row >= 0) {
        item.rows[a] = map.getGlobalElement(row);
        item.values[a] = data[row];
        item.isContact = !isEquality(multipliers.kinds()[std::size_t(row)]);
      }
    outgoing[std::size_t(coupling.holder < 0 ? map.getComm()->getRank() : coupling.holder)].push_back(std::move(item));
  }
  return joined(exchangeValues(*map.getComm(), outgoing));
}

}  // namespace Haptos
