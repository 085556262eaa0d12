// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ElementShape.hpp"

#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <cctype>

namespace Haptos {
namespace {

/// \brief What topologies of the same corners have in common; a triangle leaves the fourth corner of its side -1.
struct Family {
  std::array<const char*, 4> names;  // which Exodus files use, without digits
  int numCorners, numSides, numEdges;
  std::array<std::array<int, 2>, 12> edges;
  std::array<std::array<int, 4>, 6> sides;
};

constexpr Family hexahedra{{"HEX", "HEXAHEDRON", "", ""},
                           8, 6, 12,
                           {{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 5}, {2, 6}, {3, 7}, {4, 5}, {5, 6}, {6, 7}, {7, 4}}},
                           {{{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {0, 4, 7, 3}, {0, 3, 2, 1}, {4, 5, 6, 7}}}};
constexpr Family tetrahedra{{"TETRA", "TET", "TETRAHEDRON", ""},
                            4, 4, 6,
                            {{{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}},
                            {{{0, 1, 3, -1}, {1, 2, 3, -1}, {0, 3, 2, -1}, {0, 2, 1, -1}}}};
constexpr Family wedges{{"WEDGE", "WEDG", "PENTA", "PRISM"},
                        6, 5, 9,
                        {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 4}, {2, 5}, {3, 4}, {4, 5}, {5, 3}}},
                        {{{0, 1, 4, 3}, {1, 2, 5, 4}, {0, 3, 5, 2}, {0, 2, 1, -1}, {3, 4, 5, -1}}}};
constexpr Family pyramids{{"PYRAMID", "PYRA", "PYR", ""},
                          5, 5, 8,
                          {{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}}},
                          {{{0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {0, 4, 3, -1}, {0, 3, 2, 1}}}};

// The middle of an edge, whichever way it is walked.
constexpr int middleOf(const Family& family, int from, int to) {
  for (int i = 0; i < family.numEdges; ++i) {
    const auto& edge = family.edges[std::size_t(i)];
    if ((edge[0] == from && edge[1] == to) || (edge[0] == to && edge[1] == from)) return family.numCorners + i;
  }
  return -1;
}

constexpr SideNodes makeSide(const Family& family, std::size_t side, int centre, bool hasMidNodes) {
  const auto& corners = family.sides[side];
  SideNodes result;
  result.numCorners = corners[3] < 0 ? 3 : 4;
  const int n = result.numCorners;
  for (int i = 0; i < n; ++i) {
    result.nodes[std::size_t(i)] = corners[std::size_t(i)];
    if (hasMidNodes) result.nodes[std::size_t(n + i)] = middleOf(family, corners[std::size_t(i)], corners[std::size_t((i + 1) % n)]);
  }
  result.nodes[8] = centre;
  result.numNodes = centre > 0 ? 9 : hasMidNodes ? 2 * n : n;
  if (n == 3) result.shape = hasMidNodes ? SideShape::Triangle6 : SideShape::Triangle3;
  else result.shape = centre > 0 ? SideShape::Quad9 : hasMidNodes ? SideShape::Quad8 : SideShape::Quad4;
  return result;
}

/// \param centres nodes in the middle of the sides, if there are any
constexpr ElementShape makeShape(const char* name, int numNodes, const Family& family, const std::array<int, 6>& centres = {}) {
  ElementShape shape{name, numNodes, family.numCorners, family.numSides, family.numEdges};
  shape.edges = family.edges;
  for (std::size_t side = 0; side < std::size_t(family.numSides); ++side)
    shape.sides[side] = makeSide(family, side, centres[side], numNodes > family.numCorners);
  return shape;
}

struct Row {
  const Family& family;
  ElementShape shape;
};

// One row a topology, in the order of the enumeration.
constexpr std::array<Row, kNumTopologies> table{{
    {hexahedra, makeShape("HEX8", 8, hexahedra)},
    {tetrahedra, makeShape("TETRA4", 4, tetrahedra)},
    {hexahedra, makeShape("HEX20", 20, hexahedra)},
    {hexahedra, makeShape("HEX27", 27, hexahedra, {25, 24, 26, 23, 21, 22})},
    {tetrahedra, makeShape("TETRA10", 10, tetrahedra)},
    {wedges, makeShape("WEDGE6", 6, wedges)},
    {wedges, makeShape("WEDGE15", 15, wedges)},
    {pyramids, makeShape("PYRAMID5", 5, pyramids)},
    {pyramids, makeShape("PYRAMID13", 13, pyramids)},
}};

const Row& rowOf(Topology topology) { return table[std::size_t(topology)]; }

}  // namespace

const ElementShape& elementShape(Topology topology) { return rowOf(topology).shape; }
const char* topologyName(Topology topology) { return rowOf(topology).shape.name; }
int nodesPerElement(Topology topology) { return rowOf(topology).shape.numNodes; }
int sidesPerElement(Topology topology) { return rowOf(topology).shape.numSides; }

const SideNodes& sideNodes(Topology topology, int side) {
  TEUCHOS_ASSERT(side >= 0 && side < sidesPerElement(topology));
  return elementShape(topology).sides[std::size_t(side)];
}

// Exodus has no list of type names: codes write "HEX", "HEX8", "hexahedron".
bool isNameOf(Topology topology, const std::string& typeName, int numNodes) {
  std::string type;
  for (unsigned char c : typeName)
    if (c != ' ') type += char(std::toupper(c));
  const auto letters = type.find_last_not_of("0123456789") + 1;
  const std::string family = type.substr(0, letters), digits = type.substr(letters);
  const auto& names = rowOf(topology).family.names;
  return !family.empty() && std::find(names.begin(), names.end(), family) != names.end() && numNodes == nodesPerElement(topology) &&
         (digits.empty() || digits == std::to_string(numNodes));
}

std::string listTopologies() {
  std::string text;
  for (const Row& row : table) text += (text.empty() ? "" : ", ") + std::string(row.shape.name);
  return text;
}

}  // namespace Haptos
