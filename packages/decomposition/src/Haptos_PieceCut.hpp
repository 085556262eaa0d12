// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

#include "Haptos_Communication.hpp"
#include "Haptos_DualGraph.hpp"

namespace Haptos {

/// \brief A side-connected piece of a body, to be cut; it knows nothing of the rest of the mesh.
struct PieceToCut {
  DualGraph graph;                               ///< of its elements, by their place in the piece
  std::vector<std::array<double, 3>> centroids;  ///< [elements of the piece]
  int parts = 1;                                 ///< at most one per element
  int seed = 1;                                  ///< METIS'
};

/// \brief METIS' k-way parts, made round (`roundParts`).  Serial; the same on any rank.
/// \return [elements of the piece] 0 .. parts - 1, none of them empty; a part may have lost small fragments.
std::vector<int> cutPiece(const PieceToCut& piece);

/// \brief `cutPiece` of every piece, each on one rank, shared out by elements.  Collective.
/// \param pieces on rank 0 only
/// \return on rank 0 [pieces], elsewhere empty.
/// \throws CollectiveError on all ranks if one of them fails.
std::vector<std::vector<int>> cutOnRanks(const Communicator& comm, const std::vector<PieceToCut>& pieces);

}  // namespace Haptos
