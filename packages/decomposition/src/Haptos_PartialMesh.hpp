// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <vector>

#include "Haptos_Communication.hpp"
#include "Haptos_MeshShare.hpp"

namespace Haptos {

/// \brief Some elements of a mesh, as a mesh of their own on one rank.
///
/// `mesh` has all blocks and sets of the whole at their places, with these elements and their sides only, and with the
/// numbers that messages name; its nodes and elements are positions in `nodes` and `elements`.  Node sets are empty.
struct PartialMesh {
  Mesh mesh;
  std::vector<std::int64_t> nodes;     ///< [mesh.numNodes()] index in the whole mesh, ascending
  std::vector<std::int64_t> elements;  ///< [mesh.numElements()] index in the whole mesh, ascending
};

/// \brief Which of the elements of all ranks are this one's.
struct ElementRange {
  EvenRanges elements;
  int rank = 0;

  std::int64_t firstElement() const { return elements.begin(rank); }
  std::size_t numElements() const { return std::size_t(elements.count(rank)); }
};

/// \brief The elements of this rank's range, and who else has elements at their nodes.
struct OwnElements : ElementRange {
  PartialMesh part;
  std::vector<char> isShared;  ///< [part.nodes] other ranks have elements there, too
  std::vector<char> isUsed;    ///< [nodes of this rank's range] some rank has elements there
  EvenRanges nodes;            ///< of the whole mesh, over the ranks
};

/// \brief Fetches what the elements of a share lack of their nodes.  Collective.
OwnElements completeElements(const Communicator& comm, const MeshShare& share);

/// \brief A mesh held whole by one rank alone, which has its numbers of nodes and elements.  Serial.
OwnElements wholeMesh(const Mesh& mesh);

/// \brief Elements that came from all ranks, with a number each.
struct SentElements {
  PartialMesh part;
  std::vector<int> tags;  ///< [part.elements]
};

/// \brief Sends every element to a rank, with its nodes and its sides in side sets.  Collective.
///
/// \param from together, in the order of the ranks, ascending
/// \param rankOf [from.elements]; -1: nowhere
/// \param tags [from.elements] goes with the element
SentElements sendElements(const Communicator& comm, const PartialMesh& from, const std::vector<int>& rankOf, const std::vector<int>& tags);

}  // namespace Haptos
