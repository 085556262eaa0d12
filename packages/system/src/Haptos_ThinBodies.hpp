// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <vector>

#include "Haptos_Communication.hpp"
#include "Haptos_ConstraintRows.hpp"
#include "Haptos_EvenRanges.hpp"
#include "Haptos_IndexLists.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {

/// \brief A subdomain, as far as it matters how thin it is.
struct PartOfBody {
  int body;       ///< global, 0-based
  double aspect;  ///< see `aspectOfPart`
  const Coordinates& coordinates;
  std::function<IndexLists()> neighbours;  ///< of each node, those that K couples it with, itself included; asked for in thin bodies alone
};

/// \brief Multiplies what subdomains hold their nodes with by what nodes of thin bodies meet where pairs touch them (`stiffnessAlone`).  Collective.
///
/// Of bodies alone most of whose touched nodes lie in slender subdomains, so that it does not show how a body was cut.  All copies of a node have the same
/// factor: bodies are weighed against each other, gluing rows are what they were (decisions/058).
/// \param nodes ranges of the numbers of nodes \param parts [this rank's subdomains] \param pairs of this rank
/// \param weights [this rank's subdomains]
void weighThinBodies(const Communicator& comm, const EvenRanges& nodes, const std::vector<PartOfBody>& parts, const std::vector<PlacedPair>& pairs,
                     std::vector<SubdomainNodes>& weights);

}  // namespace Haptos
