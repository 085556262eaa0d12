// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CoarseBlocks.hpp"

#include <Teuchos_Comm.hpp>
#include <algorithm>

#include "Haptos_ByteBuffer.hpp"
#include "Haptos_Exchange.hpp"

namespace Haptos {

void CoarseBlocks::addGram(const CoarseRows& C, const std::vector<double>& q) {
  for (Eigen::Index row = 0; row < C.rows(); ++row) {
    const double weight = q.empty() ? 1.0 : q[std::size_t(row)];
    const int begin = C.outerIndexPtr()[row], end = C.outerIndexPtr()[row + 1];
    const int* column = C.innerIndexPtr();
    const double* value = C.valuePtr();
    for (int i = begin; i < end;) {
      const int s = column[i] / kModes;
      int iEnd = i;
      while (iEnd < end && column[iEnd] / kModes == s) ++iEnd;
      for (int j = begin; j < iEnd;) {
        const int t = column[j] / kModes;
        int jEnd = j;
        while (jEnd < end && column[jEnd] / kModes == t) ++jEnd;
        Block& block = at(s, t);
        for (int a = i; a < iEnd; ++a)
          for (int b = j; b < jEnd; ++b)
            block[(column[a] % kModes) * kModes + column[b] % kModes] += weight * value[a] * value[b];
        j = jEnd;
      }
      i = iEnd;
    }
  }
}

CoarseBlocks CoarseBlocks::sumOverRanks(const Communicator& comm) const {
  if (comm.getSize() == 1) return *this;
  std::vector<std::uint64_t> keys;
  std::vector<Block> values;
  for (const auto& [key, block] : blocks_) {
    keys.push_back(key);
    values.push_back(block);
  }
  ByteWriter writer;
  writer.write(keys);
  writer.write(values);
  CoarseBlocks total;
  for (const auto& message : gatherOnAll(comm, writer.take())) {
    ByteReader reader(message);
    const auto theirKeys = reader.readVector<std::uint64_t>();
    const auto theirBlocks = reader.readVector<Block>();
    for (std::size_t k = 0; k < theirKeys.size(); ++k) {
      Block& sum = total.blocks_.try_emplace(theirKeys[k], Block{}).first->second;
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += theirBlocks[k][i];
    }
  }
  return total;
}

void CoarseBlocks::add(const CoarseBlocks& other) {
  for (const auto& [key, block] : other.blocks_) {
    Block& sum = blocks_.try_emplace(key, Block{}).first->second;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += block[i];
  }
}

double CoarseBlocks::largestDiagonal() const {
  double largest = 0;
  forEach([&](int row, int column, double value) {
    if (row == column) largest = std::max(largest, value);
  });
  return largest;
}

Eigen::SparseMatrix<double> CoarseBlocks::toMatrix(Eigen::Index size, const CoarseProblem::Holds& holds, double scale) const {
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(2 * kModes * kModes * blocks_.size());
  forEach([&](int row, int column, double value) {
    triplets.emplace_back(row, column, value);
    if (row / kModes != column / kModes) triplets.emplace_back(column, row, value);
  });
  for (const auto& w : holds)
    for (Eigen::SparseVector<double>::InnerIterator i(w); i; ++i)
      for (Eigen::SparseVector<double>::InnerIterator j(w); j; ++j)
        triplets.emplace_back(int(i.index()), int(j.index()), scale * i.value() * j.value());
  Eigen::SparseMatrix<double> A(size, size);
  A.setFromTriplets(triplets.begin(), triplets.end());
  return A;
}

}  // namespace Haptos
