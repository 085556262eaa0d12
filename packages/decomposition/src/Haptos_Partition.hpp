// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <vector>

#include "Haptos_Bodies.hpp"
#include "Haptos_DualGraph.hpp"
#include "Haptos_Options.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {

struct PartitionOptions : DecompositionOptions {
  std::vector<int> bricks;  ///< [this rank's elements], only for PartitionMethod::Bricks
  /// \name Elements that METIS gets at once: a piece up to `wholeUpTo` as a whole, a larger one in blocks of about `blockSize`.
  /// One rank holds some 500 bytes of each, and what METIS needs (doc/decisions).
  /// @{
  std::int64_t wholeUpTo = 100000, blockSize = 32768;
  /// @}
};

/// \brief Elements to subdomains: every subdomain lies in one body and is connected through sides.
struct Partition {
  int count = 0;
  std::vector<int> ofElement;        ///< [this rank's elements] subdomain of an element
  std::vector<int> pieceOfSubdomain, bodyOfSubdomain;  ///< [count]
  int mended = 0;                    ///< fragments that the cut left disconnected and that went to a neighbour
  std::int64_t elementsCut = 0;      ///< elements that this rank cut for others and itself
};

/// \brief Cuts the mesh of all ranks into subdomains.  Collective.
///
/// The result depends on the mesh, the options and nothing else; in particular not on the number of ranks.  METIS cuts every
/// side-connected piece by itself, so that six rigid motions are the whole kernel of every subdomain; a piece too large for that
/// is first cut into blocks by coordinates (`cutIntoBlocks`).  Bricks stay as they are.
/// \throws InputError on all ranks if more subdomains are asked for than there are elements, or fewer than needed.
Partition partitionMesh(const Communicator& comm, const OwnElements& own, const DualGraph& graph, const Bodies& bodies,
                        const PartitionOptions& options);

/// \brief The same by METIS of elements that need be no mesh: `total` subdomains, shared out to the pieces.  Collective.
///
/// \param graph, centroids of this rank's elements; `bodyOfSubdomain` stays empty
/// \throws InputError on all ranks as above
Partition partitionGraph(const Communicator& comm, const ElementRange& own, const DualGraph& graph,
                         const Coordinates& centroids, const Components& pieces, int total,
                         const PartitionOptions& options);

/// \brief Deals subdomains to ranks in contiguous groups of about equal weight.
/// \param weights [count], work of a subdomain
/// \return [count] rank of every subdomain, ascending; ranks may stay empty.
std::vector<int> dealToRanks(const std::vector<double>& weights, int ranks);

}  // namespace Haptos
