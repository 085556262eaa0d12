// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "Haptos_ElementShape.hpp"

namespace Haptos {

/// \brief One element block: connectivity [numElements x nodesPerElement], 0-based node indices of the mesh.
struct ElementBlock {
  std::int64_t id = 0;
  std::string name;  ///< may be empty
  Topology topology = Topology::Hex8;
  std::vector<std::int64_t> connectivity;

  auto parts() { return std::tie(id, name, topology, connectivity); }  ///< see ByteWriter, here and below
  std::size_t numElements() const { return connectivity.size() / std::size_t(nodesPerElement(topology)); }
};

/// \brief One side of one element; `element` counts over all blocks in their order (0-based), `side` is
/// 0-based.
struct ElementSide {
  std::int64_t element;
  int side;
};

struct SideSet {
  std::int64_t id = 0;
  std::string name;
  std::vector<ElementSide> sides;

  auto parts() { return std::tie(id, name, sides); }
};

struct NodeSet {
  std::int64_t id = 0;
  std::string name;
  std::vector<std::int64_t> nodes;  ///< 0-based node indices of the mesh

  auto parts() { return std::tie(id, name, nodes); }
};

/// \brief A value a node, as the mesh file has them under a name.
struct NodalField {
  std::string name;
  std::vector<double> values;  ///< [numNodes]; empty where nobody asked for them

  auto parts() { return std::tie(name, values); }
};

/// \brief A whole mesh as one rank holds it: nodes, element blocks, side sets, node sets.
///
/// All indices are 0-based positions; the numbers that the file gives to nodes and elements (its
/// number maps) are kept beside them for messages and output.  Lengths are in the user's unit.
struct Mesh {
  std::string title;
  std::vector<std::array<double, 3>> coordinates;  ///< [numNodes]
  std::vector<ElementBlock> blocks;
  std::vector<SideSet> sideSets;
  std::vector<NodeSet> nodeSets;
  std::vector<std::int64_t> nodeNumbers;     ///< [numNodes], the file's node number map (1..n by default)
  std::vector<std::int64_t> elementNumbers;  ///< [numElements], the file's element number map
  bool wideIntegers = false;                 ///< the file held 64-bit ids
  std::vector<NodalField> nodalFields;       ///< at the file's last time step

  auto parts() {
    return std::tie(title, coordinates, blocks, sideSets, nodeSets, nodeNumbers, elementNumbers, wideIntegers, nodalFields);
  }
  std::size_t numNodes() const { return coordinates.size(); }
  std::size_t numElements() const;
};

/// \brief Where an element lies: its block and the position in that block.
struct ElementLocation {
  int block;
  std::int64_t position;
};

/// \brief First element (over all blocks) of every block, and the total at the end: [numBlocks + 1].
std::vector<std::int64_t> blockOffsets(const Mesh& mesh);
ElementLocation locateElement(const std::vector<std::int64_t>& offsets, std::int64_t element);

/// \brief Mesh nodes of a side in the order of its `SideNodes`, outward by the right-hand rule.
std::vector<std::int64_t> nodesOfSide(const Mesh& mesh, const std::vector<std::int64_t>& offsets,
                                      ElementSide side);

/// \brief Sets and blocks are named by their Exodus name or by their number ("12").
///
/// A name goes before a number: a set called "12" is found before the set numbered 12.
///
/// \return position in `mesh.blocks` / `sideSets` / `nodeSets`, or -1.
/// \throws InputError if more than one block or set bears that name.
int findBlock(const Mesh& mesh, const std::string& nameOrNumber);
int findSideSet(const Mesh& mesh, const std::string& nameOrNumber);
int findNodeSet(const Mesh& mesh, const std::string& nameOrNumber);

int findNodalField(const Mesh& mesh, const std::string& name);  ///< position in `mesh.nodalFields`, or -1

/// \brief "node 17 (0.5, 0.25, 0)": the file's number and the place of a node, for messages.
std::string describeNode(const Mesh& mesh, std::int64_t node);

/// \brief "lower (1), upper (2)": what exists, for error messages; "none" if there is nothing.
std::string listBlocks(const Mesh& mesh);
std::string listSideSets(const Mesh& mesh);
std::string listNodeSets(const Mesh& mesh);
std::string listNodalFields(const Mesh& mesh);

}  // namespace Haptos
