// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ElementGroup.hpp"

namespace Haptos {

std::string describeElement(const ElementGroup& group, int element) {
  const bool numbered = std::size_t(element) < group.elementNumbers.size();
  const std::int64_t number = numbered ? group.elementNumbers[std::size_t(element)] : element + 1;
  return "element " + std::to_string(number) + " (" + topologyName(group.topology) + ") of block \"" +
         group.blockName + "\"";
}

}  // namespace Haptos
