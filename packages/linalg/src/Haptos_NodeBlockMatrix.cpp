// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NodeBlockMatrix.hpp"

#include <algorithm>
#include <cstring>

#include "Haptos_Clones.hpp"

namespace Haptos {
namespace {

constexpr int kBlock = 9, kPadded = NodeBlockMatrix::kPadded;
typedef float Quad __attribute__((vector_size(16)));

HAPTOS_INLINE Quad load(const float* from) {
  Quad q;
  std::memcpy(&q, from, sizeof q);
  return q;
}

HAPTOS_INLINE void store(const Quad& q, float* to) { std::memcpy(to, &q, sizeof q); }

struct BlockView {
  int columns;
  const int *starts, *row;
  const float* entries;
};

// y += [ b0 b1 b2 ] (x0, x1, x2), a column of the block being the first three of four in a register; the fourth is the next
// column's first, times the same x: it goes to the padding of y, which nobody reads.
HAPTOS_INLINE void addBlock(const float* block, const Quad& x0, const Quad& x1, const Quad& x2, float* y) {
  store(load(y) + load(block) * x0 + load(block + 3) * x1 + load(block + 6) * x2, y);
}

/// Three entries of A^T x in the making: those of one column node.
struct ColumnSums {
  Quad sum[3] = {};

  HAPTOS_INLINE void addBlock(const float* block, const Quad& x) {
    for (int c = 0; c < 3; ++c) sum[c] += load(block + 3 * c) * x;
  }
  /// y += factor times them
  HAPTOS_INLINE void addTo(float* y, float factor) const {
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) y[c] += factor * sum[c][r];
  }
};

// y += A x; with `both` also the transposed blocks, but those of the diagonal, which come first in their columns.
template <bool both>
HAPTOS_INLINE void addColumns(const BlockView& A, const float* x, float* y) {
  for (int j = 0; j < A.columns; ++j) {
    const float* own = x + kPadded * j;
    const Quad x0 = Quad{} + own[0], x1 = Quad{} + own[1], x2 = Quad{} + own[2];
    ColumnSums sums;
    int k = A.starts[j];
    if (both) addBlock(A.entries + kBlock * std::size_t(k++), x0, x1, x2, y + kPadded * j);
    for (; k < A.starts[j + 1]; ++k) {
      const float* block = A.entries + kBlock * std::size_t(k);
      const int i = kPadded * A.row[k];
      addBlock(block, x0, x1, x2, y + i);
      if (both) sums.addBlock(block, load(x + i));
    }
    if (both) sums.addTo(y + kPadded * j, 1);
  }
}

HAPTOS_CLONES void addGeneral(const BlockView& A, const float* x, float* y) { addColumns<false>(A, x, y); }
HAPTOS_CLONES void addSymmetric(const BlockView& A, const float* x, float* y) { addColumns<true>(A, x, y); }

// y_j -= sum of A_ij^T x_i over the blocks of column j: sums stay in registers, y is written once a column
HAPTOS_CLONES void subtractTransposedColumns(const BlockView& A, const float* x, float* y) {
  for (int j = 0; j < A.columns; ++j) {
    ColumnSums sums;
    for (int k = A.starts[j]; k < A.starts[j + 1]; ++k)
      sums.addBlock(A.entries + kBlock * std::size_t(k), load(x + kPadded * A.row[k]));
    sums.addTo(y + kPadded * j, -1);
  }
}

// Whether the three columns of a node have entries in the same rows, those of whole nodes and its own among them, as stiffnesses mostly do.
bool areWholeNodes(const Eigen::SparseMatrix<double>& K, int node) {
  const int *starts = K.outerIndexPtr() + 3 * node, *rows = K.innerIndexPtr() + starts[0];
  const int count = starts[1] - starts[0];
  if (!K.isCompressed() || count % 3 != 0 || starts[2] - starts[1] != count || starts[3] - starts[2] != count) return false;
  for (int k = 0; k < count; k += 3)
    if (rows[k] % 3 != 0 || rows[k + 1] != rows[k] + 1 || rows[k + 2] != rows[k] + 2) return false;
  return std::equal(rows, rows + count, rows + count) && std::equal(rows, rows + count, rows + 2 * count) &&
         std::binary_search(rows, rows + count, 3 * node);
}

}  // namespace

// The blocks of a column as they lie in K, the diagonal one of a symmetric part first.
void NodeBlockMatrix::takeWholeNodes(const Eigen::SparseMatrix<double>& K, const std::vector<int>& rowOf, int node, int column) {
  const int* starts = K.outerIndexPtr() + 3 * node;
  const int count = starts[1] - starts[0], *rows = K.innerIndexPtr() + starts[0];
  const auto take = [&](int k, int row) {
    row_.push_back(row);
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) entries_.push_back(float(K.valuePtr()[starts[c] + k + r] / unit_));
  };
  const auto diagonal = [&](int row) { return symmetric_ && row == column; };
  for (const bool first : {true, false})
    for (int k = 0; k < count; k += 3) {
      const int row = rowOf[std::size_t(rows[k] / 3)];
      if (row >= 0 && (!symmetric_ || row >= column) && diagonal(row) == first) take(k, row);
    }
}

// Columns in turn; in each first the pattern (a row node once, whichever of its nine entries come), then the entries.
NodeBlockMatrix::NodeBlockMatrix(const Eigen::SparseMatrix<double>& K, const std::vector<int>& rowOf, const std::vector<int>& columns,
                                 int rows, double unit, bool symmetric)
    : rows_(rows), symmetric_(symmetric), unit_(unit) {
  using Entry = Eigen::SparseMatrix<double>::InnerIterator;
  std::vector<int> blockOf(std::size_t(rows), -1);  // of a row in this column, if it is not older than the column
  const auto isWanted = [&](int row, std::size_t column) { return row >= 0 && (!symmetric || row >= int(column)); };
  for (std::size_t j = 0; j < columns.size(); ++j) {
    const int first = int(row_.size());
    if (areWholeNodes(K, columns[j])) {
      takeWholeNodes(K, rowOf, columns[j], int(j));
      starts_.push_back(int(row_.size()));
      continue;
    }
    const auto addRow = [&](int row) {
      if (!isWanted(row, j) || blockOf[std::size_t(row)] >= first) return;
      blockOf[std::size_t(row)] = int(row_.size());
      row_.push_back(row);
    };
    if (symmetric) addRow(int(j));
    for (int c = 0; c < 3; ++c)
      for (Entry it(K, 3 * columns[j] + c); it; ++it) addRow(rowOf[std::size_t(it.row() / 3)]);
    entries_.resize(kBlock * row_.size(), 0.0f);
    for (int c = 0; c < 3; ++c)
      for (Entry it(K, 3 * columns[j] + c); it; ++it) {
        const int row = rowOf[std::size_t(it.row() / 3)];
        if (isWanted(row, j))
          entries_[std::size_t(kBlock * blockOf[std::size_t(row)] + 3 * c) + std::size_t(it.row() % 3)] = float(it.value() / unit);
      }
    starts_.push_back(int(row_.size()));
  }
  entries_.push_back(0.0f);
  entries_.shrink_to_fit();
  row_.shrink_to_fit();
}

// y += A x; of a symmetric part the kept triangle and its transpose in one pass, so that a block is read once for two products
void NodeBlockMatrix::add(const float* x, float* y) const {
  const BlockView A{numColumns(), starts_.data(), row_.data(), entries_.data()};
  if (symmetric_) addSymmetric(A, x, y);
  else addGeneral(A, x, y);
}

void NodeBlockMatrix::subtractTransposed(const float* x, float* y) const {
  subtractTransposedColumns({numColumns(), starts_.data(), row_.data(), entries_.data()}, x, y);
}

// A block of the kept triangle stands for its transpose, too.
Eigen::SparseMatrix<double> NodeBlockMatrix::columns(const std::vector<int>& unknowns) const {
  std::vector<int> position(std::size_t(3 * numColumns()), -1);
  for (std::size_t i = 0; i < unknowns.size(); ++i) position[std::size_t(unknowns[i])] = int(i);
  const auto isWanted = [&](int node) {
    const int* of = position.data() + 3 * std::size_t(node);
    return of[0] >= 0 || of[1] >= 0 || of[2] >= 0;
  };
  std::vector<Eigen::Triplet<double>> triplets;
  const auto add = [&](int row, int column, double value) {
    if (position[std::size_t(column)] >= 0) triplets.emplace_back(row, position[std::size_t(column)], value);
  };
  for (int j = 0; j < numColumns(); ++j)
    for (int k = starts_[std::size_t(j)]; k < starts_[std::size_t(j) + 1]; ++k) {
      const int i = row_[std::size_t(k)];
      const bool isTwice = symmetric_ && i != j;
      if (!isWanted(j) && !(isTwice && isWanted(i))) continue;
      for (int e = 0; e < kBlock; ++e) {  // row e % 3, column e / 3
        const double value = unit_ * double(entries_[std::size_t(kBlock * k + e)]);
        add(3 * i + e % 3, 3 * j + e / 3, value);
        if (isTwice) add(3 * j + e / 3, 3 * i + e % 3, value);
      }
    }
  Eigen::SparseMatrix<double> A(3 * rows_, Eigen::Index(unknowns.size()));
  A.setFromTriplets(triplets.begin(), triplets.end());
  return A;
}

}  // namespace Haptos
