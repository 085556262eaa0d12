// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SetMembers.hpp"

#include <Teuchos_Comm.hpp>
#include <algorithm>
#include <numeric>

#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

// By set and by place in it.
template <class RankOf>
std::vector<SetMember> sendSorted(const Communicator& comm, const std::vector<SetMember>& members, const RankOf& rankOf) {
  auto mine = sendItems(comm, members, rankOf);
  std::sort(mine.begin(), mine.end(), [](const SetMember& a, const SetMember& b) {
    return a.set != b.set ? a.set < b.set : a.position < b.position;
  });
  return mine;
}

// Each at the rank in whose range its index lies.
std::vector<SetMember> dealMembers(const Communicator& comm, const std::vector<SetMember>& members, const EvenRanges& ranges) {
  return sendSorted(comm, members, [&](const SetMember& m) { return ranges.owner(m.index); });
}

// Each at the rank in whose range its place lies, counted over all sets.
std::vector<SetMember> inOrder(const Communicator& comm, const std::vector<SetMember>& members, const std::vector<std::int64_t>& sizes) {
  std::vector<std::int64_t> starts(sizes.size() + 1, 0);
  std::partial_sum(sizes.begin(), sizes.end(), starts.begin() + 1);
  const EvenRanges ranges{starts.back(), comm.getSize()};
  return sendSorted(comm, members, [&](const SetMember& m) { return ranges.owner(starts[std::size_t(m.set)] + m.position); });
}

}  // namespace

// Positions ascend in each set, as members come sorted.
void dealSides(const Communicator& comm, const std::vector<SetMember>& members, MeshShare& share) {
  share.sidePositions.resize(share.part.sideSets.size());
  for (const auto& m : dealMembers(comm, members, share.elements)) {
    share.part.sideSets[std::size_t(m.set)].sides.push_back({m.index, m.side});
    share.sidePositions[std::size_t(m.set)].push_back(m.position);
  }
}

void dealSetNodes(const Communicator& comm, const std::vector<SetMember>& members, MeshShare& share) {
  share.nodePositions.resize(share.part.nodeSets.size());
  for (const auto& m : dealMembers(comm, members, share.nodes)) {
    share.part.nodeSets[std::size_t(m.set)].nodes.push_back(m.index);
    share.nodePositions[std::size_t(m.set)].push_back(m.position);
  }
}

// The way back, for writing.
std::vector<SetMember> sidesInOrder(const Communicator& comm, const MeshShare& share) {
  std::vector<SetMember> members;
  for (std::size_t s = 0; s < share.sidePositions.size(); ++s)
    for (std::size_t i = 0; i < share.sidePositions[s].size(); ++i) {
      const ElementSide& side = share.part.sideSets[s].sides[i];
      members.push_back({share.sidePositions[s][i], side.element, int(s), side.side});
    }
  return inOrder(comm, members, share.sideSetSizes);
}

std::vector<SetMember> setNodesInOrder(const Communicator& comm, const MeshShare& share) {
  std::vector<SetMember> members;
  for (std::size_t s = 0; s < share.nodePositions.size(); ++s)
    for (std::size_t i = 0; i < share.nodePositions[s].size(); ++i)
      members.push_back({share.nodePositions[s][i], share.part.nodeSets[s].nodes[i], int(s), 0});
  return inOrder(comm, members, share.nodeSetSizes);
}

}  // namespace Haptos
