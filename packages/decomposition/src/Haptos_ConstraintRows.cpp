// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ConstraintRows.hpp"

namespace Haptos {

std::vector<PlacedPair> placedPairs(const std::vector<ContactInterface>& interfaces) {
  std::vector<PlacedPair> placed;
  for (std::size_t k = 0; k < interfaces.size(); ++k)
    for (std::size_t i = 0; i < interfaces[k].pairs.size(); ++i) placed.push_back({int(k), int(i), interfaces[k].pairs[i]});
  return placed;
}

}  // namespace Haptos
