// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_GivenPairs.hpp"

#include <algorithm>
#include <cstdint>
#include <string>

#include "Haptos_GivenMatrix.hpp"

namespace Haptos {

void requirePrimaryNodes(const haptos_pairs& given) {
  const std::int64_t *starts = given.primary_starts, count = given.count;
  if (starts == nullptr || count == 0) return;
  requireStarts(starts, count, "The primary_starts of pairs");
  const std::string end = std::to_string(starts[count]);
  require(given.primary != nullptr || starts[count] == 0, "The primary_starts of pairs name " + end + " primary nodes, but primary is NULL.");
  // A pair without primary nodes would be taken for one with a rigid obstacle, which is asked for by name: primary == NULL.
  const std::int64_t pair = std::adjacent_find(starts, starts + count + 1) - starts;
  require(given.primary == nullptr || pair > count,
          "Pair " + std::to_string(pair) + " of those that are added together has no primary node; pairs with a rigid obstacle are added by themselves, "
          "with primary NULL.");
}

PairInput pairOf(const haptos_pairs& given, int i) {
  PairInput pair;
  pair.interface = given.interface;
  pair.secondary = given.secondary[i];
  const std::int64_t first = given.primary_starts ? given.primary_starts[i] : i, last = given.primary_starts ? given.primary_starts[i + 1] : i + 1;
  for (std::int64_t k = first; given.primary != nullptr && k < last; ++k)
    // Weights may be left out: then all nodes of the primary count alike, and one node alone has weight 1.
    pair.primary.emplace_back(given.primary[k], given.weights ? given.weights[k] : 1.0 / double(last - first));
  for (std::size_t d = 0; d < 3; ++d) {
    pair.normal[d] = given.normals[3 * i + int(d)];
    pair.axis[d] = given.axes ? given.axes[3 * i + int(d)] : d == 0 ? 1.0 : 0.0;
  }
  pair.gap = given.gaps ? given.gaps[i] : 0;
  pair.area = given.areas ? given.areas[i] : 1;
  return pair;
}

}  // namespace Haptos
