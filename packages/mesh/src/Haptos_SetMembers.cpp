// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SetMembers.hpp"

#include <Teuchos_Comm.hpp>
#include <algorithm>

#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

// By set and by place in it, each at the rank in whose range its index lies.
std::vector<SetMember> dealMembers(const Communicator& comm, const std::vector<SetMember>& members, const EvenRanges& ranges) {
  auto mine = sendItems(comm, members, [&](const SetMember& m) { return ranges.owner(m.index); });
  std::sort(mine.begin(), mine.end(), [](const SetMember& a, const SetMember& b) {
    return a.set != b.set ? a.set < b.set : a.position < b.position;
  });
  return mine;
}

}  // namespace

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

}  // namespace Haptos
