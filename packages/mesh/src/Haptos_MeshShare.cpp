// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_MeshShare.hpp"

#include <Teuchos_Assert.hpp>
#include <Teuchos_Comm.hpp>

#include "Haptos_Rendezvous.hpp"

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
  for (const auto& field : whole.nodalFields)
    share.part.nodalFields.push_back({field.name, slice(field.values, share.firstNode(), share.endNode())});
  sliceBlocks(whole, share);
  sliceSideSets(whole, share);
  sliceNodeSets(whole, share);
  return share;
}

// A mesh in memory is on rank 0 as a whole; what it sends is no larger than the mesh.
MeshShare scatterMesh(const Communicator& comm, const Mesh& whole) {
  std::vector<MeshShare> shares;
  if (comm.getRank() == 0)
    for (int r = 0; r < comm.getSize(); ++r) shares.push_back(sliceOfMesh(whole, r, comm.getSize()));
  return scattered(comm, shares);
}

}  // namespace Haptos
