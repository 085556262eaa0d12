// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_DualGraph.hpp"

namespace Haptos {

enum class PartitionMethod { Metis, Bricks, Block };

struct PartitionOptions {
  PartitionMethod method = PartitionMethod::Metis;
  int subdomains = 0;          ///< total over all bodies; 0 chooses
  int seed = 1;
  std::vector<int> bricks;     ///< [numElements], only for PartitionMethod::Bricks
};

/// \brief Elements to subdomains: every subdomain lies in one body and is connected through sides.
struct Partition {
  int count = 0;
  std::vector<int> ofElement;        ///< [numElements] subdomain of an element
  std::vector<int> bodyOfSubdomain;  ///< [count]
  int mended = 0;                    ///< fragments that the cut left disconnected and that went to a neighbour
};

/// \brief Cuts every body by itself (METIS k-way on the dual graph, or given bricks, or one part a body).
///
/// METIS' parts are made round (`roundParts`); bricks stay as they are.
///
/// The result depends on the mesh, the options and nothing else; in particular not on the number of ranks.
/// A body that is connected through nodes only (a hinge) is cut into its side-connected pieces first, so
/// that six rigid motions are the whole kernel of every subdomain.
/// \throws InputError if more subdomains are asked for than there are elements, or fewer than needed.
Partition partitionMesh(const Mesh& mesh, const DualGraph& graph, const Bodies& bodies, const PartitionOptions& options);

/// \brief Deals subdomains to ranks in contiguous groups of about equal weight.
/// \param weights [count], work of a subdomain
/// \return [count] rank of every subdomain, ascending; ranks may stay empty.
std::vector<int> dealToRanks(const std::vector<double>& weights, int ranks);

}  // namespace Haptos
