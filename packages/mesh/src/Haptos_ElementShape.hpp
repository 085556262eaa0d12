// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <string>

namespace Haptos {

/// \brief Element shapes, with Exodus' order of nodes and sides.
enum class Topology { Hex8, Tet4, Hex20, Hex27, Tet10, Wedge6, Wedge15, Pyramid5, Pyramid13 };
inline constexpr int kNumTopologies = 9;

/// \brief Shapes of sides.  Nodes: corners, then the middle of every edge (the first between corners 0 and 1), then the centre.
enum class SideShape { Triangle3, Triangle6, Quad4, Quad8, Quad9 };

/// \brief One side of an element.
struct SideNodes {
  SideShape shape = SideShape::Triangle3;
  int numCorners = 3, numNodes = 3;
  std::array<int, 9> nodes{};  ///< [numNodes] positions in the element's connectivity, corners outward by the right-hand rule

  constexpr const int* begin() const { return nodes.data(); }
  constexpr const int* end() const { return nodes.data() + numNodes; }
  constexpr const int* endOfCorners() const { return nodes.data() + numCorners; }
  constexpr int operator[](int i) const { return nodes[std::size_t(i)]; }
};

/// \brief All that is fixed about the elements of one topology (Exodus II manual, figures of node and side numbers), 0-based.
///
/// Nodes are corners, then the middles of the edges, then centres: Hex27 the element's (20) and those of the sides z-, z+, x-, x+,
/// y-, y+ (21 .. 26).
struct ElementShape {
  const char* name;  ///< as Exodus files have it: "HEX8", "TETRA4"
  int numNodes, numCorners, numSides, numEdges;
  std::array<std::array<int, 2>, 12> edges{};  ///< [numEdges] ends; the middle of edge i, if there is one, is node numCorners + i
  std::array<SideNodes, 6> sides{};            ///< [numSides]

  bool hasMidNodes() const { return numNodes > numCorners; }
};

const ElementShape& elementShape(Topology topology);

/// \brief Whether an Exodus file may call elements of so many nodes so: "HEX", "hex8", "TETRA4", "TET", "PENTA6".
bool isNameOf(Topology topology, const std::string& typeName, int numNodes);

/// \brief Exodus' name of a topology ("HEX8", "TETRA4").
const char* topologyName(Topology topology);
/// \brief "HEX8, TETRA4, ...", for messages.
std::string listTopologies();

int nodesPerElement(Topology topology);
int sidesPerElement(Topology topology);

/// \param side 0-based; Exodus' numbering minus one.
const SideNodes& sideNodes(Topology topology, int side);

}  // namespace Haptos
