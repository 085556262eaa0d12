// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "Haptos_Mesh.hpp"

namespace Haptos {

/// \brief One file of a decomposed mesh, as SEACAS' nem_spread and decomp write them: a mesh with its own indices.
struct ExodusPart {
  Mesh mesh;           ///< nodeNumbers and elementNumbers say which node or element of the whole mesh each is
  int numParts = 1;    ///< files that the file says there are
  std::int64_t numNodes = -1, numElements = -1;  ///< of the whole mesh as the file states them; -1: it does not
  std::vector<std::int64_t> originalNodes, originalElements;  ///< numbers before the decomposition; may be empty
};

/// \brief Serial; throws as `readExodus`, which refuses such files.
ExodusPart readExodusPart(const std::string& path, const std::vector<std::string>& fields = {});

}  // namespace Haptos
