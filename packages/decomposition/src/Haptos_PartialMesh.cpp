// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_PartialMesh.hpp"

#include <Teuchos_DefaultSerialComm.hpp>
#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

using Index = std::int64_t;

struct NodeData {
  Index index;
  std::array<double, 3> x;
  Index number;
};

// Ascending, each once.  Where they lie close together they are marked, not sorted.
std::vector<Index> eachOnce(std::vector<Index> values) {
  if (values.empty()) return values;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const Index first = *low, spread = *high - first + 1;
  // Marks take a byte for each number between the lowest and the highest, less than the list itself.
  if (spread > Index(values.size())) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    values.shrink_to_fit();
    return values;
  }
  std::vector<char> isThere(std::size_t(spread), 0);
  for (Index value : values) isThere[std::size_t(value - first)] = 1;
  values.clear();
  for (Index i = 0; i < spread; ++i)
    if (isThere[std::size_t(i)]) values.push_back(first + i);
  values.shrink_to_fit();
  return values;
}

// Position of a value that is there.
Index positionOf(const std::vector<Index>& ascending, Index value) {
  // Without holes the place is a difference; the search is for shares with holes.
  if (ascending.back() - ascending.front() + 1 == Index(ascending.size())) return value - ascending.front();
  return std::lower_bound(ascending.begin(), ascending.end(), value) - ascending.begin();
}

// Names and topologies, without any element, side or node.
Mesh emptyLike(const Mesh& mesh) {
  Mesh result;
  for (const auto& block : mesh.blocks) result.blocks.push_back({block.id, block.name, block.topology, {}});
  for (const auto& set : mesh.sideSets) result.sideSets.push_back({set.id, set.name, {}});
  for (const auto& set : mesh.nodeSets) result.nodeSets.push_back({set.id, set.name, {}});
  return result;
}

std::vector<std::vector<int>> elementsByRank(const std::vector<int>& rankOf, int ranks) {
  std::vector<std::vector<int>> result(static_cast<std::size_t>(ranks));
  for (std::size_t e = 0; e < rankOf.size(); ++e)
    if (rankOf[e] >= 0) result[std::size_t(rankOf[e])].push_back(int(e));
  return result;
}

struct SentSide {
  Index element;  // in the whole mesh
  int set, side;
};

std::vector<std::vector<SentSide>> sidesByRank(const PartialMesh& from, const std::vector<int>& rankOf, int ranks) {
  std::vector<std::vector<SentSide>> result(static_cast<std::size_t>(ranks));
  for (std::size_t set = 0; set < from.mesh.sideSets.size(); ++set)
    for (const auto& side : from.mesh.sideSets[set].sides)
      if (const int rank = rankOf[std::size_t(side.element)]; rank >= 0)
        result[std::size_t(rank)].push_back({from.elements[std::size_t(side.element)], int(set), side.side});
  return result;
}

// Elements on their way, block by block, and their nodes.
struct Parcel {
  struct Block {
    std::vector<Index> elements, numbers, connectivity;
    std::vector<int> tags;

    auto parts() { return std::tie(elements, numbers, connectivity, tags); }
  };
  std::vector<Block> blocks;
  std::vector<NodeData> nodes;

  auto parts() { return std::tie(blocks, nodes); }
};

Parcel packElements(const PartialMesh& from, const std::vector<int>& chosen, const std::vector<int>& tags) {
  Parcel parcel;
  std::vector<Index> used;
  std::size_t at = 0;
  Index first = 0;
  for (const auto& block : from.mesh.blocks) {
    const Index n = nodesPerElement(block.topology), end = first + Index(block.numElements());
    Parcel::Block& to = parcel.blocks.emplace_back();
    for (; at < chosen.size() && chosen[at] < end; ++at) {
      const auto e = std::size_t(chosen[at]);
      to.elements.push_back(from.elements[e]);
      to.numbers.push_back(from.mesh.elementNumbers[e]);
      to.tags.push_back(tags[e]);
      const Index* nodes = block.connectivity.data() + (Index(e) - first) * n;
      for (Index i = 0; i < n; ++i) to.connectivity.push_back(from.nodes[std::size_t(nodes[i])]);
      used.insert(used.end(), nodes, nodes + n);
    }
    first = end;
  }
  for (Index i : eachOnce(std::move(used)))
    parcel.nodes.push_back({from.nodes[std::size_t(i)], from.mesh.coordinates[std::size_t(i)], from.mesh.nodeNumbers[std::size_t(i)]});
  return parcel;
}

template <class T>
void append(std::vector<T>& all, const std::vector<T>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

// Nodes come as often as ranks sent them; connectivity in indices of the mesh becomes positions among those that are here.
void setNodes(std::vector<NodeData> nodes, PartialMesh& part) {
  std::sort(nodes.begin(), nodes.end(), [](const NodeData& a, const NodeData& b) { return a.index < b.index; });
  for (const NodeData& node : nodes) {
    if (!part.nodes.empty() && part.nodes.back() == node.index) continue;  // it came from several ranks
    part.nodes.push_back(node.index);
    part.mesh.coordinates.push_back(node.x);
    part.mesh.nodeNumbers.push_back(node.number);
  }
  for (auto& block : part.mesh.blocks)
    for (Index& node : block.connectivity) node = positionOf(part.nodes, node);
}

// What came from all ranks, block by block; parcels are let go on the way.
SentElements joinParcels(const Mesh& names, std::vector<Parcel>& parcels) {
  SentElements result;
  PartialMesh& part = result.part;
  part.mesh = emptyLike(names);
  for (std::size_t b = 0; b < names.blocks.size(); ++b)
    for (auto& parcel : parcels) {
      // Let go once it is copied: parcels and mesh never stand side by side as wholes.
      const auto block = std::exchange(parcel.blocks[b], {});
      append(part.elements, block.elements);
      append(part.mesh.elementNumbers, block.numbers);
      append(part.mesh.blocks[b].connectivity, block.connectivity);
      append(result.tags, block.tags);
    }
  std::vector<NodeData> nodes;
  for (auto& parcel : parcels) append(nodes, std::exchange(parcel.nodes, {}));
  setNodes(std::move(nodes), part);
  return result;
}

}  // namespace

// A share has elements of one range and nodes of another: what elements lack is asked of the ranks that read those nodes.  How many
// ask for a node tells whether it is shared, or in use at all.
OwnElements completeElements(const Communicator& comm, const MeshShare& share) {
  OwnElements own;
  PartialMesh& part = own.part;
  part.mesh = emptyLike(share.part);
  std::vector<Index> nodes;
  for (std::size_t b = 0; b < share.part.blocks.size(); ++b) {
    part.mesh.blocks[b].connectivity = share.part.blocks[b].connectivity;
    append(nodes, share.part.blocks[b].connectivity);
  }
  part.nodes = eachOnce(std::move(nodes));
  for (auto& block : part.mesh.blocks)
    for (Index& node : block.connectivity) node = positionOf(part.nodes, node);
  own.nodes = share.nodes;
  own.elements = share.elements;
  own.rank = share.rank;
  part.elements.resize(std::size_t(share.endElement() - share.firstElement()));
  std::iota(part.elements.begin(), part.elements.end(), share.firstElement());
  part.mesh.elementNumbers = share.part.elementNumbers;
  for (std::size_t set = 0; set < share.part.sideSets.size(); ++set)
    for (const auto& side : share.part.sideSets[set].sides)
      part.mesh.sideSets[set].sides.push_back({side.element - share.firstElement(), side.side});

  const RemoteValues remote(comm, share.nodes, part.nodes);
  // A rank asks for a node once, however many of its elements have it.
  std::vector<int> askers(share.part.coordinates.size(), 0);
  for (const auto& places : remote.asked())
    for (Index place : places) ++askers[std::size_t(place)];
  for (const int count : askers) own.isUsed.push_back(count > 0);
  part.mesh.coordinates = remote.fetch([&](Index place) { return share.part.coordinates[std::size_t(place)]; });
  part.mesh.nodeNumbers = remote.fetch([&](Index place) { return share.part.nodeNumbers[std::size_t(place)]; });
  own.isShared = remote.fetch([&](Index place) { return char(askers[std::size_t(place)] > 1); });
  return own;
}

// In order of elements on every rank, and ranks ascend with them: what comes in is in the order of the mesh.
SentElements sendElements(const Communicator& comm, const PartialMesh& from, const std::vector<int>& rankOf, const std::vector<int>& tags) {
  std::vector<Parcel> parcels;
  for (const auto& chosen : elementsByRank(rankOf, comm.getSize())) parcels.push_back(packElements(from, chosen, tags));
  parcels = exchangeEach(comm, std::move(parcels));
  SentElements result = joinParcels(from.mesh, parcels);
  for (const auto& side : joined(exchangeValues(comm, sidesByRank(from, rankOf, comm.getSize()))))
    result.part.mesh.sideSets[std::size_t(side.set)].sides.push_back({positionOf(result.part.elements, side.element), side.side});
  return result;
}

OwnElements wholeMesh(const Mesh& mesh) { return completeElements(Teuchos::SerialComm<int>(), sliceOfMesh(mesh, 0, 1)); }

}  // namespace Haptos
