// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "Haptos_Communication.hpp"
#include "Haptos_ElementGroup.hpp"
#include "Haptos_EvenRanges.hpp"
#include "Haptos_Mesh.hpp"

namespace Haptos {

struct OwnElements;
struct Partition;

/// \brief A side of one of the subdomain's elements that lies in a side set of the mesh.
struct SubdomainSide {
  int sideSet;  ///< position in the mesh's side sets
  int group;    ///< position in Subdomain::groups
  int element;  ///< position in the group
  int side;     ///< 0-based
};

/// \brief One subdomain as its rank holds it; degrees of freedom are 3 x local node + component.
struct Subdomain {
  int id = 0;    ///< global, 0-based
  int body = 0;  ///< global, 0-based
  int piece = 0; ///< the same, see `Bodies`
  std::vector<std::int64_t> nodes;                 ///< [numNodes] mesh node index, ascending
  std::vector<std::array<double, 3>> coordinates;  ///< [numNodes]
  std::vector<ElementGroup> groups;                ///< one per element block that has elements here
  std::vector<int> blockOfGroup;                   ///< [groups] position in the mesh's blocks
  std::vector<std::int64_t> elements;              ///< mesh element index, groups one after the other
  std::vector<SubdomainSide> sides;

  int numNodes() const { return int(nodes.size()); }
  int numDofs() const { return 3 * int(nodes.size()); }
};

/// \brief Nodes of subdomains, one after the other.
std::vector<std::int64_t> nodesOf(const std::vector<Subdomain>& subdomains);

/// \brief Cuts a mesh that is here as a whole into subdomains; serial.  A group's `material` is materialOfBlock[block].
std::vector<Subdomain> extractSubdomains(const Mesh& mesh, const Partition& partition, const std::vector<int>& materialOfBlock);

/// \brief Every rank gets the elements of its subdomains, and makes these.  Collective.
/// \param rankOf [partition.count] ascending
std::vector<Subdomain> dealSubdomains(const Communicator& comm, const OwnElements& own, const Partition& partition,
                                      const std::vector<int>& rankOf, const std::vector<int>& materialOfBlock);

/// \brief In how many subdomains of all ranks every node lies: [this rank's subdomains][nodes].  Collective.
/// \param nodes of the whole mesh; ranks meet where a node's range lies
std::vector<std::vector<int>> countCopies(const Communicator& comm, const EvenRanges& nodes, const std::vector<Subdomain>& subdomains);

}  // namespace Haptos
