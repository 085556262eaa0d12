// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "Haptos_PartialMesh.hpp"

namespace Haptos {

/// \brief Elements that share a whole side, as a graph in CSR form: the rows of some elements.
struct DualGraph {
  std::vector<std::int64_t> offsets;    ///< [rows + 1]
  std::vector<std::int64_t> neighbours; ///< element indices, ascending in every row
  std::vector<double> couplings;        ///< [neighbours] area of the shared side / distance of the centroids [length]
};

/// \brief Mean of the nodes of every element, [numElements].
std::vector<std::array<double, 3>> elementCentroids(const Mesh& mesh);

/// \brief The rows of this rank's elements; neighbours are indices in the whole mesh.  Collective.
///
/// A side is known by its corners; one that elements of several ranks may have meets its like on the rank in whose range its
/// lowest node lies.
/// \throws InputError on all ranks if more than two elements share a side, or two its corners but not its other nodes.
DualGraph buildDualGraph(const Communicator& comm, const OwnElements& own);

}  // namespace Haptos
