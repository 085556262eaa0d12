// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CoarseProblem.hpp"

#include <Teuchos_Comm.hpp>
#include <array>
#include <cstdint>
#include <unordered_map>

#include "Haptos_ByteBuffer.hpp"
#include "Haptos_Exchange.hpp"

namespace Haptos {
namespace {

constexpr int kModes = 6;
using Block = std::array<double, kModes * kModes>;
using Blocks = std::unordered_map<std::uint64_t, Block>;

std::uint64_t blockKey(int row, int column) { return (std::uint64_t(row) << 32) | std::uint64_t(column); }

// Blocks (s, t), s >= t, of C^T diag(q) C.
Blocks accumulateBlocks(const CoarseRows& C, const std::vector<double>& q) {
  Blocks blocks;
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
        Block& block = blocks.try_emplace(blockKey(s, t), Block{}).first->second;
        for (int a = i; a < iEnd; ++a)
          for (int b = j; b < jEnd; ++b)
            block[(column[a] % kModes) * kModes + column[b] % kModes] += weight * value[a] * value[b];
        j = jEnd;
      }
      i = iEnd;
    }
  }
  return blocks;
}

// Adds up the ranks' blocks in the order of the ranks, so that every rank gets the same digits.
Blocks sumOverRanks(const Communicator& comm, const Blocks& mine) {
  if (comm.getSize() == 1) return mine;
  std::vector<std::uint64_t> keys;
  std::vector<Block> values;
  for (const auto& [key, block] : mine) {
    keys.push_back(key);
    values.push_back(block);
  }
  ByteWriter writer;
  writer.write(keys);
  writer.write(values);
  Blocks total;
  for (const auto& message : gatherOnAll(comm, writer.take())) {
    ByteReader reader(message);
    const auto theirKeys = reader.readVector<std::uint64_t>();
    const auto theirBlocks = reader.readVector<Block>();
    for (std::size_t k = 0; k < theirKeys.size(); ++k) {
      Block& sum = total.try_emplace(theirKeys[k], Block{}).first->second;
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += theirBlocks[k][i];
    }
  }
  return total;
}

Eigen::SparseMatrix<double> toMatrix(const Blocks& blocks, Eigen::Index size, const CoarseProblem::Holds& holds) {
  std::vector<Eigen::Triplet<double>> triplets;
  double scale = 0;
  for (const auto& [key, block] : blocks) {
    const int s = int(key >> 32), t = int(key & 0xffffffffu);
    for (int a = 0; a < kModes; ++a)
      for (int b = 0; b < kModes; ++b) {
        triplets.emplace_back(kModes * s + a, kModes * t + b, block[a * kModes + b]);
        if (s != t) triplets.emplace_back(kModes * t + b, kModes * s + a, block[a * kModes + b]);
      }
    if (s == t)
      for (int a = 0; a < kModes; ++a) scale = std::max(scale, block[a * kModes + a]);
  }
  for (const auto& w : holds)
    for (Eigen::SparseVector<double>::InnerIterator i(w); i; ++i)
      for (Eigen::SparseVector<double>::InnerIterator j(w); j; ++j)
        triplets.emplace_back(int(i.index()), int(j.index()), scale * i.value() * j.value());
  Eigen::SparseMatrix<double> A(size, size);
  A.setFromTriplets(triplets.begin(), triplets.end());
  return A;
}

}  // namespace

CoarseProblem::CoarseProblem(const Communicator& comm, const CoarseRows& C, const std::vector<double>& q, const Holds& holds) {
  auto A = toMatrix(sumOverRanks(comm, accumulateBlocks(C, q)), C.cols(), holds);
  factor_ = std::make_unique<LocalSolverFactor>(std::move(A), LocalSolverMethod::Automatic);
}

Eigen::MatrixXd CoarseProblem::solve(const Eigen::MatrixXd& b) const {
  Eigen::MatrixXd x(b.rows(), b.cols());
  factor_->solve(b, x);
  solves_ += long(b.cols());
  return x;
}

}  // namespace Haptos
