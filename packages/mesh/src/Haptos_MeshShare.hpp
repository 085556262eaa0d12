// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <vector>

#include "Haptos_Communication.hpp"
#include "Haptos_EvenRanges.hpp"
#include "Haptos_Mesh.hpp"

namespace Haptos {

/// \brief What one rank holds of a mesh: one contiguous range of its elements and one of its nodes.
///
/// `part` is the mesh with all its blocks and sets, but only this rank's members in them:
///
/// - `title`, `wideIntegers`, number, order, ids, names and topologies of blocks and sets are the same on all ranks, so that
///   `findBlock`, `listSideSets` and their like answer as for the whole mesh;
/// - `coordinates`, `nodeNumbers` and the values of `nodalFields` are those of the nodes `firstNode()` .. `endNode()` - 1;
/// - `connectivity` and `elementNumbers` are those of the elements `firstElement()` .. `endElement()` - 1, counted over all
///   blocks in their order; `connectivity` holds nodes by their index in the whole mesh, whoever holds them;
/// - side sets hold the sides of these elements (`ElementSide::element` counts in the whole mesh), node sets those of their
///   nodes (index in the whole mesh) that lie in this rank's range; each in the order of the whole set.
///
/// The share of one rank alone is the whole mesh.  Memory: O(mesh / ranks) and what lies on the surface.
struct MeshShare {
  Mesh part;
  int rank = 0;
  EvenRanges nodes, elements;             ///< of the whole mesh, over the ranks
  std::vector<std::int64_t> blockStarts;  ///< [blocks + 1] first element of every block in the whole mesh; the total
  std::vector<std::int64_t> sideSetSizes, nodeSetSizes;                 ///< [sets] of the whole mesh
  std::vector<std::vector<std::int64_t>> sidePositions, nodePositions;  ///< [sets][members here] place in the whole set

  auto parts() { return std::tie(part, rank, nodes, elements, blockStarts, sideSetSizes, nodeSetSizes, sidePositions, nodePositions); }

  std::int64_t firstNode() const { return nodes.begin(rank); }
  std::int64_t endNode() const { return nodes.begin(rank + 1); }
  std::int64_t firstElement() const { return elements.begin(rank); }
  std::int64_t endElement() const { return elements.begin(rank + 1); }

  /// First of this rank's elements in a block, in the whole mesh: of those in part.blocks[block].connectivity.
  std::int64_t firstElementOf(std::size_t block) const { return clipped(blockStarts[block]); }
  /// \param block a block of the whole mesh  \return how many of its elements lie here.
  std::int64_t numElementsOf(std::size_t block) const { return clipped(blockStarts[block + 1]) - clipped(blockStarts[block]); }

 private:
  std::int64_t clipped(std::int64_t element) const { return std::clamp(element, firstElement(), endElement()); }
};

/// \brief The share that `rank` of `ranks` has of a mesh held whole here.  Serial.
MeshShare sliceOfMesh(const Mesh& whole, int rank, int ranks);

/// \brief Every rank's share of a mesh that rank 0 holds whole.  Collective.
/// \param whole read on rank 0 only
MeshShare scatterMesh(const Communicator& comm, const Mesh& whole);

}  // namespace Haptos
