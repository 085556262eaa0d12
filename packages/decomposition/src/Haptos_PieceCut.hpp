// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "Haptos_Communication.hpp"
#include "Haptos_DualGraph.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {

/// \brief A side-connected piece of a body, to be cut; it knows nothing of the rest of the mesh.
struct PieceToCut {
  DualGraph graph;                               ///< of its elements, by their place in the piece
  std::vector<std::array<double, 3>> centroids;  ///< [elements of the piece]
  int parts = 1;                                 ///< at most one per element
  int seed = 1;                                  ///< METIS'
};

struct PartsOfPiece {
  std::vector<int> part;  ///< [elements of the piece] 0 .. parts - 1, none of them empty
  int mended = 0;         ///< fragments that were left disconnected and went to a neighbour
};

/// \brief METIS' k-way parts, made round (`roundParts`) and connected (`mendParts`).  Serial; the same on any rank.
PartsOfPiece cutPiece(const PieceToCut& piece);

/// \brief The pieces of all ranks; all but `ofElement` is the same on all.
struct PiecesToCut {
  std::vector<int> ofElement;        ///< [this rank's elements] piece
  std::vector<std::int64_t> sizes;   ///< [pieces] elements
  std::vector<int> parts;            ///< [pieces] one of a single part is not cut
  int seed = 1;
};

/// \brief `cutPiece` of every piece, each on one rank, the largest first, to the rank with least to do.  Collective.
///
/// A rank holds the pieces that it cuts, element by element with their neighbours, and its own range.
/// \param centroids [this rank's elements]
/// \param elementsCut grows by the elements that this rank cut
/// \return of this rank's elements; the fragments mended on all ranks
/// \throws CollectiveError on all ranks if one of them fails.
PartsOfPiece cutOnRanks(const Communicator& comm, const ElementRange& own, const DualGraph& graph,
                        const Coordinates& centroids, const PiecesToCut& pieces, std::int64_t& elementsCut);

}  // namespace Haptos
