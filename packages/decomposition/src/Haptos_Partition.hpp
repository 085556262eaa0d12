// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_DualGraph.hpp"
#include "Haptos_Options.hpp"
#include "Haptos_PieceCut.hpp"

namespace Haptos {

struct PartitionOptions : DecompositionOptions {
  std::vector<int> bricks;  ///< [numElements], only for PartitionMethod::Bricks
};

/// \brief Elements to subdomains: every subdomain lies in one body and is connected through sides.
struct Partition {
  int count = 0;
  std::vector<int> ofElement;        ///< [numElements] subdomain of an element
  std::vector<int> bodyOfSubdomain;  ///< [count]
  int mended = 0;                    ///< fragments that the cut left disconnected and that went to a neighbour
};

/// \brief Side-connected pieces of the bodies.  A body that is connected through nodes only (a hinge) has several.
struct BodyPieces {
  int count = 0;
  std::vector<int> ofElement;              ///< [numElements]
  std::vector<std::vector<int>> elements;  ///< [count] ascending
};

/// \brief What remains to be done for a partition: METIS cuts every piece by itself; nothing is left for the other methods.
struct PartitionPlan {
  BodyPieces pieces;
  std::vector<PieceToCut> cuts;  ///< [pieces.count], or empty; not needed once they are cut
};

/// \name A partition in three steps, of which the second, `cutPiece` of all `cuts`, may be shared by ranks (`cutOnRanks`).
///
/// The result depends on the mesh, the options and nothing else; in particular not on the number of ranks.  Pieces are
/// side-connected, so that six rigid motions are the whole kernel of every subdomain.  Bricks stay as they are.
/// @{
/// \throws InputError if more subdomains are asked for than there are elements, or fewer than needed.
PartitionPlan planPartition(const Mesh& mesh, const DualGraph& graph, const PartitionOptions& options);
/// \param partsOfPieces [pieces.count] what `cutPiece` returned, or empty
Partition finishPartition(const DualGraph& graph, const Bodies& bodies, const PartitionOptions& options, const PartitionPlan& plan,
                          const std::vector<std::vector<int>>& partsOfPieces);
/// @}

/// \brief All three steps, serial.
Partition partitionMesh(const Mesh& mesh, const DualGraph& graph, const Bodies& bodies, const PartitionOptions& options);

/// \brief Deals subdomains to ranks in contiguous groups of about equal weight.
/// \param weights [count], work of a subdomain
/// \return [count] rank of every subdomain, ascending; ranks may stay empty.
std::vector<int> dealToRanks(const std::vector<double>& weights, int ranks);

}  // namespace Haptos
