// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "Haptos_ByteBuffer.hpp"
#include "Haptos_ElementGroup.hpp"
#include "Haptos_Mesh.hpp"
#include "Haptos_Partition.hpp"

namespace Haptos {

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

/// \brief Cuts the mesh into subdomains; serial, on the reader.  A group's `material` is materialOfBlock[block].
std::vector<Subdomain> extractSubdomains(const Mesh& mesh, const Partition& partition, const std::vector<int>& materialOfBlock);

void pack(ByteWriter& writer, const Subdomain& subdomain);
Subdomain unpackSubdomain(ByteReader& reader);

}  // namespace Haptos
