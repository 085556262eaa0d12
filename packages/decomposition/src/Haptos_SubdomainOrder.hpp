// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_ContactPair.hpp"
#include "Haptos_Mesh.hpp"
#include "Haptos_Partition.hpp"

namespace Haptos {

/// \brief Numbers the subdomains anew, so that any contiguous range of numbers is compact and has its share of the contact.
///
/// Ranks take such ranges (`dealToRanks`): this order settles what they send each other.  A graph whose edges count the nodes
/// and contact pairs that two subdomains share is bisected by METIS, work and contact nodes halved both, and each half again,
/// down to single subdomains.  Bodies in contact thereby come to the same ranks.  Collective; the graph, which is small, is
/// cut on rank 0.  The result depends on mesh, pairs and partition only, in particular not on the number of ranks.
/// \param interfaces read on rank 0; pairs of contact weigh more than shared nodes: they are exchanged within an iteration, too
/// \param partition its numbers are changed, nothing else
/// \return `countNodes` of the partition then
std::vector<int> orderSubdomains(const Communicator& comm, const OwnElements& own, const std::vector<ContactInterface>& interfaces,
                                 Partition& partition);

/// \brief [partition.count] nodes of every subdomain, the same on all ranks.  Collective.
std::vector<int> countNodes(const Communicator& comm, const OwnElements& own, const Partition& partition);

/// \brief Work of a subdomain, in any unit: a factor and its solves grow a little faster than the nodes.
double workOfSubdomain(int numNodes);

}  // namespace Haptos
