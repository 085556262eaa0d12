// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CoarseProblem.hpp"

#include <Teuchos_Comm.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <climits>
#include <cstdint>
#include <unordered_map>

#include "Haptos_ByteBuffer.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Exchange.hpp"

namespace Haptos {
namespace {

constexpr int kModes = 6;
using Block = std::array<double, kModes * kModes>;
using BlockMap = std::unordered_map<std::uint64_t, Block>;

std::uint64_t blockKey(int row, int column) { return (std::uint64_t(row) << 32) | std::uint64_t(column); }

// Blocks (s, t), s >= t, of C^T diag(q) C.
BlockMap accumulateBlocks(const CoarseRows& C, const std::vector<double>& q) {
  BlockMap blocks;
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

Bytes packBlocks(const BlockMap& blocks) {
  std::vector<std::uint64_t> keys;
  std::vector<Block> values;
  for (const auto& [key, block] : blocks) {
    keys.push_back(key);
    values.push_back(block);
  }
  ByteWriter writer;
  writer.write(keys);
  writer.write(values);
  return writer.take();
}

void addBlock(BlockMap& blocks, std::uint64_t key, const Block& block) {
  Block& sum = blocks.try_emplace(key, Block{}).first->second;
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += block[i];
}

// Adds up the messages' blocks in the order of the messages, so that the digits do not depend on arrival.
BlockMap sumBlocks(const std::vector<Bytes>& messages) {
  BlockMap total;
  for (const auto& message : messages) {
    ByteReader reader(message);
    const auto keys = reader.readVector<std::uint64_t>();
    const auto blocks = reader.readVector<Block>();
    for (std::size_t k = 0; k < keys.size(); ++k) addBlock(total, keys[k], blocks[k]);
  }
  return total;
}

// The blocks of A on the holders of a factor; each block is added up by one rank, mostly one that touches it.
BlockMap assembleBlocks(const CoarsePlacement& placement, const BlockMap& mine, Eigen::Index subdomains) {
  const Communicator& comm = placement.comm();
  if (comm.getSize() == 1) return mine;
  std::vector<BlockMap> parts(comm.getSize());
  for (const auto& [key, block] : mine) {
    const long long row = (long long)(key >> 32);
    parts[std::size_t(row * comm.getSize() / subdomains)].emplace(key, block);  // subdomains are dealt in this order
  }
  std::vector<Bytes> messages;
  for (const auto& part : parts) messages.push_back(part.empty() ? Bytes{} : packBlocks(part));
  auto received = exchangeAll(comm, messages);
  received.erase(std::remove(received.begin(), received.end(), Bytes{}), received.end());
  return sumBlocks(placement.gather(packBlocks(sumBlocks(received))));
}

// Adds what a scope lasts and sends to the costs.
class Measured {
 public:
  Measured(double& seconds, CommunicationCounts& sent) : seconds_(seconds), sent_(sent) {}
  ~Measured() {
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    sent_ += communicationSoFar() - before_;
  }

 private:
  double& seconds_;
  CommunicationCounts& sent_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  CommunicationCounts before_ = communicationSoFar();
};

Eigen::SparseMatrix<double> toMatrix(const BlockMap& blocks, Eigen::Index size, const CoarseProblem::Holds& holds) {
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

class CoarseBlocks {
 public:
  explicit CoarseBlocks(BlockMap blocks) : blocks(std::move(blocks)) {}
  const BlockMap blocks;
};

CoarseProblem::Blocks CoarseProblem::assemble(const CoarsePlacement& placement, const CoarseRows& C, const std::vector<double>& q) {
  const Measured measured(placement.costs().setUpSeconds, placement.costs().setUpSent);
  return std::make_shared<CoarseBlocks>(assembleBlocks(placement, accumulateBlocks(C, q), C.cols() / kModes));
}

CoarseProblem::CoarseProblem(Placement placement, const CoarseRows& C, const std::vector<double>& q, const Holds& holds,
                             const Blocks& common)
    : placement_(std::move(placement)) {
  CoarseCosts& costs = placement_->costs();
  const Measured measured(costs.setUpSeconds, costs.setUpSent);
  BlockMap blocks = assembleBlocks(*placement_, accumulateBlocks(C, q), C.cols() / kModes);
  if (common)
    for (const auto& [key, block] : common->blocks) addBlock(blocks, key, block);
  const auto factor = [&] {
    factor_ = std::make_unique<LocalSolverFactor>(toMatrix(blocks, C.cols(), holds), LocalSolverMethod::Automatic);
    costs.factorEntries = std::max(costs.factorEntries, factor_->factorEntries());
  };
  if (costs.setUps++ == 0 && placement_->holds()) costs.blocks = blocks.size();
  if (placement_->isReplicated()) {
    factor();  // fails on all ranks or on none
    return;
  }
  CaughtError error;
  try {
    if (placement_->holds()) factor();
  } catch (...) {
    error = describeCurrentException();
  }
  broadcastAndThrow(placement_->comm(), error, 0);  // rank 0 is a holder, and all holders have the same matrix
}

CoarseProblem::CoarseProblem(const Communicator& comm, const CoarseRows& C, const std::vector<double>& q, const Holds& holds)
    : CoarseProblem(std::make_shared<CoarsePlacement>(Teuchos::rcpFromRef(comm), C.cols(), CoarseOptions{INT_MAX, 1}), C, q, holds) {}

Eigen::MatrixXd CoarseProblem::solveOnHolders(const Eigen::MatrixXd& b, Eigen::Index rows, Eigen::Index columns) const {
  Eigen::MatrixXd x(rows, columns);
  if (factor_) factor_->solve(b, x);
  placement_->broadcast(x);
  solves_ += long(columns);
  placement_->costs().solves += long(columns);
  return x;
}

Eigen::MatrixXd CoarseProblem::solve(const Eigen::MatrixXd& b) const {
  const Measured measured(placement_->costs().solveSeconds, placement_->costs().solveSent);
  return solveOnHolders(b, b.rows(), b.cols());
}

Eigen::MatrixXd CoarseProblem::solveSum(const Eigen::MatrixXd& mine, const Eigen::MatrixXd& shift) const {
  const Measured measured(placement_->costs().solveSeconds, placement_->costs().solveSent);
  Eigen::MatrixXd b = placement_->sum(mine);
  if (placement_->holds() && shift.size() > 0) b -= shift;
  return solveOnHolders(b, mine.rows(), mine.cols());
}

}  // namespace Haptos
