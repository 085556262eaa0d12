// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>

#include "Haptos_OperatorNorm_def.hpp"

namespace Haptos {

void fillFromGlobalIndices(MultiVector& v) {
  const auto map = v.getMap();
  auto view = v.getDataNonConst(0);
  for (std::size_t i = 0; i < std::size_t(view.size()); ++i) {
    std::uint64_t h = std::uint64_t(map->getGlobalElement(LocalOrdinal(i))) + 0x9e3779b97f4a7c15ULL;  // splitmix64
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ULL;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebULL;
    h ^= h >> 31;
    view[i] = 2.0 * double(h >> 11) / double(1ULL << 53) - 1.0;
  }
}

template OperatorNorm estimateOperatorNorm(const QuadraticProgram<double, MultiVector, Operator>&, int);

}  // namespace Haptos
