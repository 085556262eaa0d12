// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cstdint>

namespace Haptos {

/// \brief The indices 0 .. size - 1 in contiguous ranges, one a rank; their lengths differ by one at most.
struct EvenRanges {
  std::int64_t size = 0;
  int ranks = 1;

  /// First index of `rank`; begin(ranks) is `size`.
  std::int64_t begin(int rank) const { return size / ranks * rank + std::min<std::int64_t>(rank, size % ranks); }
  std::int64_t count(int rank) const { return begin(rank + 1) - begin(rank); }

  /// The rank in whose range `index` lies.
  int owner(std::int64_t index) const {
    const std::int64_t shorter = size / ranks, longerOnes = size % ranks, afterLonger = longerOnes * (shorter + 1);
    return int(index < afterLonger ? index / (shorter + 1) : longerOnes + (index - afterLonger) / shorter);
  }
};

}  // namespace Haptos
