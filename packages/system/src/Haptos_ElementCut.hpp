// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

#include "Haptos_Communication.hpp"
#include "Haptos_Partition.hpp"

namespace Haptos {

/// \brief An element with its stiffness [3 nodes x 3 nodes] and the places of its nodes.
struct ElementMatrix {
  int body;
  std::vector<std::int64_t> nodes;  ///< ids
  std::vector<double> K;
  std::vector<std::array<double, 3>> places;

  auto parts() { return std::tie(body, nodes, K, places); }  ///< see ByteWriter
};

/// \brief Elements of one subdomain.
struct ElementPart {
  int body = 0;
  std::vector<ElementMatrix> elements;
};

/// \brief Cuts elements of all ranks into subdomains and sends these to ranks, in the order of their numbers; by METIS, body by body.
///
/// Elements are neighbours where they share three nodes (or all but one of the smaller one's, if it has less).  No rank learns of
/// more than its share of them but where METIS cuts a piece as a whole (`PartitionOptions`).  The cut depends neither on the number of
/// ranks nor on who brought which element, if their nodes tell them apart.  Collective.
/// \throws InputError on all ranks if a body is in pieces that share no side, or by `partitionGraph`
std::vector<ElementPart> cutElements(const Communicator& comm, const std::vector<ElementMatrix>& elements, const PartitionOptions& options);

}  // namespace Haptos
