// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "Haptos_Mesh.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {

/// \brief Elements of one subdomain that share block, topology and material.
///
/// Indices are local to the subdomain; `elementNumbers` are the user's and serve messages and output only.
struct ElementGroup {
  Topology topology = Topology::Hex8;
  std::vector<int> connectivity;  ///< [numElements x nodesPerElement], local node indices in Exodus order
  int material = 0;               ///< position in the list of materials
  std::vector<std::int64_t> elementNumbers;  ///< [numElements], or empty
  std::string blockName;

  int numElements() const { return int(connectivity.size()) / nodesPerElement(topology); }
  const int* nodes(int element) const {
    return connectivity.data() + std::size_t(element) * std::size_t(nodesPerElement(topology));
  }
};

/// \brief One side of one element of a group; both are 0-based, `side` is Exodus' number minus one.
struct GroupSide {
  int element;
  int side;
};

/// \brief `element 17 (HEX8) of block "upper"`, for messages.
std::string describeElement(const ElementGroup& group, int element);

}  // namespace Haptos
