// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_PairDraft.hpp"

#include <algorithm>

namespace Haptos {

// Nodes on both sides cancel as far as their weights do: the jump of such a node is no jump.
void findNodes(const NodeDirectory& directory, PairDraft& draft) {
  for (const auto* side : {&draft.placed.pair.secondary, &draft.placed.pair.primary})
    for (const auto& [node, weight] : *side) {
      const int record = directory.find(node);
      const double signedWeight = side == &draft.placed.pair.secondary ? weight : -weight;
      const auto known = std::find_if(draft.nodes.begin(), draft.nodes.end(), [&](const auto& n) { return n.first == record; });
      if (known == draft.nodes.end()) draft.nodes.emplace_back(record, signedWeight);
      else known->second += signedWeight;
    }
}

// c of a row is its gap minus what prescribed displacements contribute to the jump.
void makeRows(const NodeDirectory& directory, const InterfaceRows& interface, PairDraft& draft) {
  const PlacedPair& placed = draft.placed;
  const LocalFrame& frame = placed.pair.frame;
  draft.axes = {frame.normal, frame.t1, frame.t2};
  if (interface.tied) draft.axes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (std::size_t a = 0; a < 3; ++a)
    if (placed.pair.isPinned[a]) draft.axes[a] = {0, 0, 0};
  RowShare::Pair& share = draft.share;
  share.interface = placed.interface;
  share.position = placed.position;
  share.isTied = interface.tied;
  share.c = {interface.tied ? 0.0 : placed.pair.gap, 0.0, 0.0};
  share.pinned = {1, 1, 1};
  for (const auto& [index, weight] : draft.nodes) {
    const NodeRecord& record = directory.records()[std::size_t(index)];
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t d = 0; d < 3; ++d) {
        if (record.isPrescribed[d]) share.c[a] -= weight * draft.axes[a][d] * record.prescribed[d];
        else if (weight != 0 && draft.acts(a, d, record)) share.pinned[a] = 0;
      }
  }
}

}  // namespace Haptos
