// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_PartialMesh.hpp"
#include "Haptos_Partition.hpp"

namespace Haptos {

/// \brief Guesses which subdomains are copies of others, before they are made: [count] the lowest with the same elements,
/// materials and nodes, all moved by one vector; itself where there is none lower.  Collective.
///
/// Copies on one rank share a factor, so it tells what a rank's subdomains cost.  Nothing else hangs on it: nodes are compared by
/// fingerprints, to 1e-6 of a subdomain, and the order in which a copy numbers its own is not.  The result does not depend on the number of ranks.
std::vector<int> findCopies(const Communicator& comm, const OwnElements& own, const Partition& partition,
                            const std::vector<int>& materialOfBlock);

/// \brief Deals subdomains to ranks in contiguous groups of about equal work, where copies on one rank share a factor.
/// \param work [count], of a subdomain without a copy
/// \param copyOf [count] see `findCopies`; without copies this is `dealToRanks` of `work`
std::vector<int> dealCopiesToRanks(const std::vector<double>& work, const std::vector<int>& copyOf, int ranks);

/// \brief [ranks] work of every rank.
std::vector<double> workOfRanks(const std::vector<double>& work, const std::vector<int>& copyOf, const std::vector<int>& rankOf, int ranks);

}  // namespace Haptos
