// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <numeric>
#include <vector>

namespace Haptos {

/// \brief Disjoint sets of 0 .. n - 1 (union-find); each is known by its lowest member.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }

  int lowest(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(int a, int b) {
    a = lowest(a), b = lowest(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }
  /// [n] number of the set, by lowest members; `count`: how many there are
  std::vector<int> numbered(int& count) {
    std::vector<int> result(parent_.size());
    count = 0;
    for (int i = 0; i < int(parent_.size()); ++i) {
      const int root = lowest(i);
      result[i] = root == i ? count++ : result[root];
    }
    return result;
  }

 private:
  std::vector<int> parent_;
};

}  // namespace Haptos
