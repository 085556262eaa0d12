// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <vector>

namespace Haptos {

/// \brief Lists of indices, one after the other: list i is items[offsets[i]] .. items[offsets[i + 1] - 1].
struct IndexLists {
  std::vector<std::int64_t> offsets;
  std::vector<int> items;

  const int* begin(int list) const { return items.data() + offsets[std::size_t(list)]; }
  const int* end(int list) const { return items.data() + offsets[std::size_t(list) + 1]; }
  int size(int list) const { return int(end(list) - begin(list)); }
};

}  // namespace Haptos
