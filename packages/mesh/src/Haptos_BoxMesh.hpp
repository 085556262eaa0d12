// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "Haptos_MeshShare.hpp"

namespace Haptos {

/// \brief A box of nx x ny x nz cells, one element block.
///
/// Nodes and cells are ordered with x fastest, then y, then z.  With tetrahedra every cell is cut in
/// six along its diagonal from the lower to the upper corner (Kuhn's subdivision), the same in every
/// cell, so that neighbouring cells agree on their common face.
struct BoxSpec {
  std::string blockName;
  std::int64_t blockId = 0;  ///< 0: position of the box, from 1
  std::array<double, 3> lower{0, 0, 0};
  std::array<double, 3> upper{1, 1, 1};
  std::array<int, 3> divisions{1, 1, 1};
  Topology topology = Topology::Hex8;  ///< Tet4: six tetrahedra a cell
  /// Names of the side sets of the faces x-, x+, y-, y+, z-, z+; empty: none.  A name used for
  /// several faces or boxes gives one side set.
  std::array<std::string, 6> sideSetNames;
  /// Moves every node (grading, skewing); must keep the orientation.  Empty: as it is.
  std::function<std::array<double, 3>(const std::array<double, 3>&)> map;
};

/// \brief One mesh of separate boxes, each with its own nodes; side sets are numbered from 1.
/// \throws InputError  no box, a division below 1, an upper corner not above the lower one, block
///         numbers used twice, or more than 2^31 - 1 nodes or elements.
Mesh makeBoxes(const std::vector<BoxSpec>& boxes);

/// \brief What `rank` of `ranks` has of it, made without the rest.  Serial; throws as `makeBoxes`, alike on all ranks.
MeshShare shareBoxes(const std::vector<BoxSpec>& boxes, int rank, int ranks);

/// \brief The benchmark of two beams, [0,2] x [0,1] x [-1,0] below and [0,2] x [0,1] x [0,1] above.
struct TwoBeamsSpec {
  int subdomainsPerEdge = 1;         ///< k: each body has 2k x k x k bricks
  int elementsPerSubdomainEdge = 1;  ///< p = H/h: each brick has p^3 hexahedra
};

/// \brief Blocks `lower` (1) and `upper` (2), side sets `lower_contact`, `upper_contact`, `lower_clamp`,
/// `upper_clamp`, `upper_top`, `lower_bottom` and `upper_end`.
/// \throws InputError  a number below 1 or a mesh of more than 2^31 - 1 nodes.
Mesh makeTwoBeams(const TwoBeamsSpec& spec);

/// \brief What `rank` of `ranks` has of it, made without the rest.  Serial; throws as `makeTwoBeams`, alike on all ranks.
MeshShare shareTwoBeams(const TwoBeamsSpec& spec, int rank, int ranks);

/// \brief Brick of an element of `makeTwoBeams(spec)`: 0 .. 4k^3 - 1, lower body first, x fastest.
///
/// Since nodes and elements are numbered with x fastest, then y, then z, all bricks have the same
/// local order when their nodes and elements are sorted by index: their matrices are congruent.
int brickOfElement(const TwoBeamsSpec& spec, std::int64_t element);

/// \brief The bricks of all elements.
std::vector<int> brickSubdomains(const TwoBeamsSpec& spec);

}  // namespace Haptos
