// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_Mesh.hpp"

namespace Haptos {

/// \brief What becomes of a hexahedron: itself, two wedges, six pyramids around its centre, or six tetrahedra around a diagonal.
///
/// A pyramid whose base lies at wedges is cut in two tetrahedra, as their side is.
enum class Cell { Hexahedron, Wedges, Pyramids, Tetrahedra };

/// \brief Order of the elements: corners only, or mid-nodes too (serendipity hexahedra, or Hex27).
enum class ElementOrder { Linear, Quadratic, FullQuadratic };

/// \brief The bodies of a mesh of HEX8 with other elements, all edges straight.
///
/// A block of several kinds of elements becomes several blocks; the first keeps its name and number, others are named after it
/// ("upper_wedge").  Side sets stay; new nodes follow on the old ones, ordered by those that they lie between, so that congruent
/// parts stay congruent; node sets keep the nodes that they have.
/// \param cells [elements of the mesh]; tetrahedra fit to each other only
Mesh withCells(const Mesh& hexahedra, const std::vector<Cell>& cells, ElementOrder order);

/// \brief The same with elements of one topology.
Mesh withElements(const Mesh& hexahedra, Topology topology);

/// \brief A box of hexahedra, whose inner nodes are moved by up to `distortion` times the mesh width, the same in every run.
Mesh distortedBox(const BoxSpec& box, double distortion);

}  // namespace Haptos
