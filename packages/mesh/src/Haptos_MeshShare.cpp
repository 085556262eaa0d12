// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_MeshShare.hpp"

#include <Teuchos_Assert.hpp>
#include <Teuchos_Comm.hpp>

#include "Haptos_ByteBuffer.hpp"
#include "Haptos_Exchange.hpp"

namespace Haptos {
namespace {

using Index = std::int64_t;

/// all[begin, end)
template <class T>
std::vector<T> slice(const std::vector<T>& all, Index begin, Index end) {
  if (all.empty()) return {};  // number maps may be left out
  return {all.begin() + begin, all.begin() + end};
}

/// Every block is there on every rank, with the elements of the rank's range, maybe none.
void sliceBlocks(const Mesh& whole, MeshShare& share) {
  for (std::size_t b = 0; b < whole.blocks.size(); ++b) {
    const auto& block = whole.blocks[b];
    const Index n = nodesPerElement(block.topology), first = share.firstElementOf(b) - share.blockStarts[b];
    share.part.blocks.push_back({block.id, block.name, block.topology,
                                 slice(block.connectivity, n * first, n * (first + share.numElementsOf(b)))});
  }
}

/// Sides go with their elements; where they stood in the set is kept for writing.
void sliceSideSets(const Mesh& whole, MeshShare& share) {
  for (const auto& set : whole.sideSets) {
    SideSet mine{set.id, set.name, {}};
    std::vector<Index> positions;
    for (std::size_t i = 0; i < set.sides.size(); ++i) {
      TEUCHOS_ASSERT(set.sides[i].element >= 0 && set.sides[i].element < share.elements.size);
      if (set.sides[i].element < share.firstElement() || set.sides[i].element >= share.endElement()) continue;
      mine.sides.push_back(set.sides[i]);
      positions.push_back(Index(i));
    }
    share.part.sideSets.push_back(std::move(mine));
    share.sidePositions.push_back(std::move(positions));
    share.sideSetSizes.push_back(Index(set.sides.size()));
  }
}

/// Nodes of sets go with the ranges of nodes.
void sliceNodeSets(const Mesh& whole, MeshShare& share) {
  for (const auto& set : whole.nodeSets) {
    NodeSet mine{set.id, set.name, {}};
    std::vector<Index> positions;
    for (std::size_t i = 0; i < set.nodes.size(); ++i) {
      TEUCHOS_ASSERT(set.nodes[i] >= 0 && set.nodes[i] < share.nodes.size);
      if (set.nodes[i] < share.firstNode() || set.nodes[i] >= share.endNode()) continue;
      mine.nodes.push_back(set.nodes[i]);
      positions.push_back(Index(i));
    }
    share.part.nodeSets.push_back(std::move(mine));
    share.nodePositions.push_back(std::move(positions));
    share.nodeSetSizes.push_back(Index(set.nodes.size()));
  }
}

Bytes pack(const MeshShare& share) {
  ByteWriter out;
  const Mesh& part = share.part;
  out.write(part.title);
  out.write(part.wideIntegers);
  out.write(share.rank);
  out.write(share.nodes);
  out.write(share.elements);
  out.write(share.blockStarts);
  out.write(part.coordinates);
  out.write(part.nodeNumbers);
  out.write(part.elementNumbers);
  for (const auto& block : part.blocks) {
    out.write(block.id);
    out.write(block.name);
    out.write(block.topology);
    out.write(block.connectivity);
  }
  const auto packSets = [&](const auto& sets, const auto& members, const auto& positions, const std::vector<Index>& sizes) {
    out.write(sizes);
    for (std::size_t s = 0; s < sets.size(); ++s) {
      out.write(sets[s].id);
      out.write(sets[s].name);
      out.write(members(sets[s]));
      out.write(positions[s]);
    }
  };
  packSets(part.sideSets, [](const SideSet& set) -> auto& { return set.sides; }, share.sidePositions, share.sideSetSizes);
  packSets(part.nodeSets, [](const NodeSet& set) -> auto& { return set.nodes; }, share.nodePositions, share.nodeSetSizes);
  return out.take();
}

template <class Set, class Member>
void unpackSets(ByteReader& in, std::vector<Set>& sets, std::vector<std::vector<Index>>& positions, std::vector<Index>& sizes) {
  sizes = in.readVector<Index>();
  for (std::size_t s = 0; s < sizes.size(); ++s) {
    const auto id = in.read<Index>();
    auto name = in.readString();
    sets.push_back({id, std::move(name), in.readVector<Member>()});
    positions.push_back(in.readVector<Index>());
  }
}

MeshShare unpackShare(const Bytes& bytes) {
  ByteReader in(bytes);
  MeshShare share;
  Mesh& part = share.part;
  part.title = in.readString();
  part.wideIntegers = in.read<bool>();
  share.rank = in.read<int>();
  share.nodes = in.read<EvenRanges>();
  share.elements = in.read<EvenRanges>();
  share.blockStarts = in.readVector<Index>();
  part.coordinates = in.readVector<std::array<double, 3>>();
  part.nodeNumbers = in.readVector<Index>();
  part.elementNumbers = in.readVector<Index>();
  part.blocks.resize(share.blockStarts.size() - 1);
  for (auto& block : part.blocks) {
    block.id = in.read<Index>();
    block.name = in.readString();
    block.topology = in.read<Topology>();
    block.connectivity = in.readVector<Index>();
  }
  unpackSets<SideSet, ElementSide>(in, part.sideSets, share.sidePositions, share.sideSetSizes);
  unpackSets<NodeSet, Index>(in, part.nodeSets, share.nodePositions, share.nodeSetSizes);
  return share;
}

}  // namespace

// Ranges of equal length in mesh order, of nodes and of elements: neither knows the other, nor any cut.
MeshShare sliceOfMesh(const Mesh& whole, int rank, int ranks) {
  MeshShare share;
  share.rank = rank;
  share.nodes = {Index(whole.numNodes()), ranks};
  share.elements = {Index(whole.numElements()), ranks};
  share.blockStarts = blockOffsets(whole);
  share.part.title = whole.title;
  share.part.wideIntegers = whole.wideIntegers;
  share.part.coordinates = slice(whole.coordinates, share.firstNode(), share.endNode());
  share.part.nodeNumbers = slice(whole.nodeNumbers, share.firstNode(), share.endNode());
  share.part.elementNumbers = slice(whole.elementNumbers, share.firstElement(), share.endElement());
  sliceBlocks(whole, share);
  sliceSideSets(whole, share);
  sliceNodeSets(whole, share);
  return share;
}

// A mesh in memory is on rank 0 as a whole; what it sends is no larger than the mesh.
MeshShare scatterMesh(const Communicator& comm, const Mesh& whole) {
  std::vector<Bytes> messages;
  if (comm.getRank() == 0)
    for (int r = 0; r < comm.getSize(); ++r) messages.push_back(pack(sliceOfMesh(whole, r, comm.getSize())));
  return unpackShare(scatterFromRoot(comm, messages));
}

}  // namespace Haptos
