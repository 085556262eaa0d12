// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "Haptos_CoarseProblem.hpp"

namespace Haptos {

/// \brief The 6 x 6 blocks (s, t), s >= t, of a symmetric matrix on coarse unknowns; rows first in a block.
class CoarseBlocks {
 public:
  static constexpr int kModes = 6;
  using Block = std::array<double, kModes * kModes>;

  /// \brief Block (row, column), row >= column, made 0 where it is new.
  Block& at(int row, int column) {
    return blocks_.try_emplace((std::uint64_t(row) << 32) | std::uint64_t(column), Block{}).first->second;
  }

  /// \brief Adds C^T diag(q) C; q [rows of C], or empty for 1.
  void addGram(const CoarseRows& C, const std::vector<double>& q);

  /// \brief Adds up the ranks' blocks in the order of the ranks, so that every rank gets the same digits.  Collective.
  CoarseBlocks sumOverRanks(const Communicator& comm) const;

  double largestDiagonal() const;

  /// \brief visit(row, column, value) for every entry of the blocks with s >= t, each block whole.
  template <class Visit>
  void forEach(Visit&& visit) const {
    for (const auto& [key, block] : blocks_)
      for (int a = 0; a < kModes; ++a)
        for (int b = 0; b < kModes; ++b)
          visit(kModes * int(key >> 32) + a, kModes * int(key & 0xffffffffu) + b, block[std::size_t(a * kModes + b)]);
  }

  void add(const CoarseBlocks& other);

  /// \brief The whole matrix [size x size] and `scale` w w^T for every hold.
  Eigen::SparseMatrix<double> toMatrix(Eigen::Index size, const CoarseProblem::Holds& holds, double scale) const;

 private:
  std::unordered_map<std::uint64_t, Block> blocks_;
};

}  // namespace Haptos
