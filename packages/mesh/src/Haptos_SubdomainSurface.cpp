// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SubdomainSurface.hpp"

#include <algorithm>

namespace Haptos {

std::vector<int> surfaceNodes(const std::vector<ElementGroup>& groups, int numNodes) {
  std::vector<std::array<int, 4>> faces;  // sorted nodes; -1 first on triangles
  for (const auto& group : groups)
    for (int e = 0; e < group.numElements(); ++e)
      for (int side = 0; side < sidesPerElement(group.topology); ++side) {
        std::array<int, 4> face{-1, -1, -1, -1};
        const auto& local = sideNodes(group.topology, side);
        for (int i = 0; i < nodesPerSide(group.topology); ++i) face[i] = group.nodes(e)[local[i]];
        std::sort(face.begin(), face.end());
        faces.push_back(face);
      }
  std::sort(faces.begin(), faces.end());
  std::vector<char> onSurface(std::size_t(numNodes), 0);
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t j = i;
    while (j < faces.size() && faces[j] == faces[i]) ++j;
    if (j - i == 1)
      for (int node : faces[i])
        if (node >= 0) onSurface[node] = 1;
    i = j;
  }
  std::vector<int> nodes;
  for (int i = 0; i < numNodes; ++i)
    if (onSurface[i]) nodes.push_back(i);
  return nodes;
}

std::vector<int> surfaceDofs(const std::vector<ElementGroup>& groups, int numNodes) {
  std::vector<int> dofs;
  for (int node : surfaceNodes(groups, numNodes))
    for (int d = 0; d < 3; ++d) dofs.push_back(3 * node + d);
  return dofs;
}

}  // namespace Haptos
