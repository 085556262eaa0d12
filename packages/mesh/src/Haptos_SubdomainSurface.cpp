// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SubdomainSurface.hpp"

#include <algorithm>
#include <array>

namespace Haptos {

namespace {

struct Face {
  std::array<int, 4> corners;  // sorted; -1 first on triangles
  const SideNodes* side;
  const int* element;  // its nodes
};

std::vector<Face> sortedFaces(const std::vector<ElementGroup>& groups) {
  std::vector<Face> faces;
  for (const auto& group : groups)
    for (int e = 0; e < group.numElements(); ++e)
      for (int s = 0; s < sidesPerElement(group.topology); ++s) {
        const SideNodes& side = sideNodes(group.topology, s);
        Face face{{-1, -1, -1, -1}, &side, group.nodes(e)};
        for (int i = 0; i < side.numCorners; ++i) face.corners[std::size_t(i)] = face.element[side[i]];
        std::sort(face.corners.begin(), face.corners.end());
        faces.push_back(face);
      }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.corners < b.corners; });
  return faces;
}

}  // namespace

std::vector<int> surfaceNodes(const std::vector<ElementGroup>& groups, int numNodes) {
  const auto faces = sortedFaces(groups);
  std::vector<char> onSurface(std::size_t(numNodes), 0);
  for (std::size_t i = 0, j = 0; i < faces.size(); i = j) {
    while (j < faces.size() && faces[j].corners == faces[i].corners) ++j;
    if (j - i == 1)
      for (const int position : *faces[i].side) onSurface[std::size_t(faces[i].element[position])] = 1;
  }
  std::vector<int> nodes;
  for (int i = 0; i < numNodes; ++i)
    if (onSurface[std::size_t(i)]) nodes.push_back(i);
  return nodes;
}

std::vector<int> surfaceDofs(const std::vector<ElementGroup>& groups, int numNodes) {
  std::vector<int> dofs;
  for (int node : surfaceNodes(groups, numNodes))
    for (int d = 0; d < 3; ++d) dofs.push_back(3 * node + d);
  return dofs;
}

}  // namespace Haptos
