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
/// down to single subdomains.  Bodies in contact thereby come to the same ranks.  Serial, on the reader; the result depends
/// on the arguments only, in particular not on the number of ranks.
/// \param interfaces pairs of contact weigh more than shared nodes: they are exchanged within an iteration, too
/// \param partition its numbers are changed, nothing else
void orderSubdomains(const Mesh& mesh, const std::vector<ContactInterface>& interfaces, Partition& partition);

/// \brief Work of a subdomain, in any unit: a factor and its solves grow a little faster than the nodes.
double workOfSubdomain(int numNodes);

}  // namespace Haptos
