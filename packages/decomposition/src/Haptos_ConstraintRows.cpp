// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ConstraintRows.hpp"

#include <array>
#include <cmath>

namespace Haptos {

std::vector<PlacedPair> placedPairs(const std::vector<ContactInterface>& interfaces) {
  std::vector<PlacedPair> placed;
  for (std::size_t k = 0; k < interfaces.size(); ++k)
    for (std::size_t i = 0; i < interfaces[k].pairs.size(); ++i) placed.push_back({int(k), int(i), interfaces[k].pairs[i]});
  return placed;
}

// Sum over the elements at a node of E h, h the mean distance of their nodes from the centre: how stiff a node is, in the unit of K.
std::vector<double> nodalStiffness(const Subdomain& sub, const std::vector<double>& youngsModulus) {
  std::vector<double> weights(std::size_t(sub.numNodes()), 0.0);
  for (const auto& group : sub.groups) {
    const int n = nodesPerElement(group.topology);
    for (std::size_t e = 0; e * n < group.connectivity.size(); ++e) {
      const int* nodes = group.connectivity.data() + e * n;
      std::array<double, 3> centre{0, 0, 0};
      for (int i = 0; i < n; ++i)
        for (int d = 0; d < 3; ++d) centre[d] += sub.coordinates[nodes[i]][d] / n;
      double h = 0;
      for (int i = 0; i < n; ++i) {
        const auto& x = sub.coordinates[nodes[i]];
        h += std::hypot(x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]) / n;
      }
      for (int i = 0; i < n; ++i) weights[nodes[i]] += youngsModulus[group.material] * h;
    }
  }
  return weights;
}

}  // namespace Haptos
