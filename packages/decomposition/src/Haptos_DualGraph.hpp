// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "Haptos_Mesh.hpp"

namespace Haptos {

/// \brief Elements that share a whole side, as a graph in CSR form; serial, on the reader.
struct DualGraph {
  std::vector<std::int64_t> offsets;    ///< [numElements + 1]
  std::vector<std::int64_t> neighbours; ///< element indices, ascending in every row
  std::vector<double> couplings;        ///< [neighbours] area of the shared side / distance of the centroids [length]
};

/// \brief Mean of the nodes of every element, [numElements].
std::vector<std::array<double, 3>> elementCentroids(const Mesh& mesh);

/// \throws InputError if more than two elements share a side.
DualGraph buildDualGraph(const Mesh& mesh);

/// \brief Connected components of the elements for which `colour` is equal.
///
/// \param colour [numElements]; empty: all alike
/// \return component of every element, numbered by their first element.
std::vector<int> connectedComponents(const DualGraph& graph, const std::vector<int>& colour, int& count);

/// \brief Bodies: sets of elements connected through shared nodes.
struct Bodies {
  int count = 0;
  std::vector<int> ofElement;       ///< [numElements], numbered by their first element
  std::vector<std::string> names;   ///< [count]: the blocks that a body is made of
};
Bodies findBodies(const Mesh& mesh);

}  // namespace Haptos
