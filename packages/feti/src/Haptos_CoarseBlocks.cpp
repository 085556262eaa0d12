// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CoarseBlocks.hpp"

#include <Teuchos_Assert.hpp>
#include <Teuchos_Comm.hpp>
#include <algorithm>

#include "Haptos_ByteBuffer.hpp"
#include "Haptos_Clones.hpp"
#include "Haptos_Exchange.hpp"

namespace Haptos {
namespace {

constexpr int kModes = CoarseBlocks::kModes;
using Block = CoarseBlocks::Block;
using BlockMap = CoarseBlocks::Map;

std::uint64_t blockKey(int row, int column) { return (std::uint64_t(row) << 32) | std::uint64_t(column); }

// Finds blocks in a map; rows near each other mostly touch the same ones, several hundred where subdomains are small.
class RecentBlocks {
 public:
  explicit RecentBlocks(BlockMap& blocks) : blocks_(blocks), recent_(kEntries) {}
  Block& at(int row, int column) {
    const std::uint64_t key = blockKey(row, column);
    Entry& entry = recent_[std::size_t(31 * row + column) % kEntries];
    if (entry.block == nullptr || entry.key != key) entry = {key, &blocks_.try_emplace(key, Block{}).first->second};
    return *entry.block;
  }

 private:
  static constexpr std::size_t kEntries = 1024;
  struct Entry {
    std::uint64_t key = 0;
    Block* block = nullptr;  // a map keeps its elements where they are
  };
  BlockMap& blocks_;
  std::vector<Entry> recent_;
};

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

void addBlock(BlockMap& blocks, std::uint64_t key, const Block& block, double factor = 1) {
  Block& sum = blocks.try_emplace(key, Block{}).first->second;
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += factor * block[i];
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

// A row's entries in one subdomain.
struct Piece {
  int subdomain;
  std::array<double, kModes> values;
};

void takePieces(const CoarseRows& C, Eigen::Index row, std::vector<Piece>& pieces) {
  pieces.clear();
  for (CoarseRows::InnerIterator it(C, row); it; ++it) {
    const int subdomain = int(it.col()) / kModes;
    if (pieces.empty() || pieces.back().subdomain != subdomain) pieces.push_back({subdomain, {}});
    pieces.back().values[std::size_t(int(it.col()) - kModes * subdomain)] = it.value();
  }
}

// block += weight a b^T
HAPTOS_INLINE void addProduct(double weight, const std::array<double, kModes>& a, const std::array<double, kModes>& b, Block& block) {
  for (std::size_t i = 0; i < kModes; ++i) {
    const double wa = weight * a[i];
    for (std::size_t j = 0; j < kModes; ++j) block[i * kModes + j] += wa * b[j];
  }
}

HAPTOS_CLONES void addProducts(double weight, const std::vector<Piece>& pieces, RecentBlocks& blocks) {
  for (std::size_t i = 0; i < pieces.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j)
      addProduct(weight, pieces[i].values, pieces[j].values, blocks.at(pieces[i].subdomain, pieces[j].subdomain));
}

}  // namespace

CoarseBlocks::CoarseBlocks(const CoarseRows& C, const std::vector<double>& q) {
  RecentBlocks recent(blocks_);
  std::vector<Piece> pieces;
  for (Eigen::Index row = 0; row < C.rows(); ++row) {
    const double weight = q.empty() ? 1.0 : q[std::size_t(row)];
    if (weight == 0) continue;  // its blocks, too, are left out
    takePieces(C, row, pieces);
    addProducts(weight, pieces, recent);
  }
}

CoarseBlocks::CoarseBlocks(const std::vector<Eigen::SparseVector<double>>& vectors) {
  for (const auto& w : vectors)
    for (Eigen::SparseVector<double>::InnerIterator i(w); i; ++i)
      for (Eigen::SparseVector<double>::InnerIterator j(w); j; ++j) {
        const int s = int(i.index()) / kModes, t = int(j.index()) / kModes;
        if (s < t) continue;
        Block& block = blocks_.try_emplace(blockKey(s, t), Block{}).first->second;
        block[std::size_t((i.index() % kModes) * kModes + j.index() % kModes)] += i.value() * j.value();
      }
}

CoarseBlocks CoarseBlocks::onHolders(const CoarsePlacement& placement, Eigen::Index subdomains) const {
  const Communicator& comm = placement.comm();
  if (comm.getSize() == 1) return *this;
  std::vector<BlockMap> parts(std::size_t(comm.getSize()));
  for (const auto& [key, block] : blocks_)
    parts[std::size_t((long long)(row(key)) * comm.getSize() / subdomains)].emplace(key, block);  // subdomains are dealt in this order
  std::vector<Bytes> messages;
  for (const auto& part : parts) messages.push_back(part.empty() ? Bytes{} : packBlocks(part));
  auto received = exchangeAll(comm, messages);
  received.erase(std::remove(received.begin(), received.end(), Bytes{}), received.end());
  CoarseBlocks result;
  result.blocks_ = sumBlocks(placement.gather(packBlocks(sumBlocks(received))));
  return result;
}

void CoarseBlocks::add(const CoarseBlocks& other, double factor) {
  for (const auto& [key, block] : other.blocks_) addBlock(blocks_, key, block, factor);
}

double CoarseBlocks::largestDiagonal() const {
  double largest = 0;
  for (const auto& [key, block] : blocks_)
    if (row(key) == column(key))
      for (int a = 0; a < kModes; ++a) largest = std::max(largest, block[std::size_t(a * kModes + a)]);
  return largest;
}

CoarseMatrix::CoarseMatrix(const std::vector<const CoarseBlocks*>& patterns, Eigen::Index size)
    : rowsOfColumn_(std::size_t(size / kModes)), matrix_(size, size) {
  for (const CoarseBlocks* pattern : patterns)
    for (const auto& [key, block] : pattern->blocks()) {
      const int s = CoarseBlocks::row(key), t = CoarseBlocks::column(key);
      rowsOfColumn_[std::size_t(t)].push_back(s);
      if (s != t) rowsOfColumn_[std::size_t(s)].push_back(t);
    }
  std::size_t entries = 0;
  for (auto& rows : rowsOfColumn_) {
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    entries += rows.size() * kModes * kModes;
  }
  matrix_.resizeNonZeros(Eigen::Index(entries));
  std::fill_n(matrix_.valuePtr(), entries, 0.0);
  int at = 0;
  for (int column = 0; column < int(size); ++column) {
    matrix_.outerIndexPtr()[column] = at;
    for (int s : rowsOfColumn_[std::size_t(column / kModes)])
      for (int a = 0; a < kModes; ++a) matrix_.innerIndexPtr()[at++] = kModes * s + a;
  }
  matrix_.outerIndexPtr()[size] = at;
}

void CoarseMatrix::addBlock(int s, int t, const Block& block) {
  const auto& rows = rowsOfColumn_[std::size_t(t)];
  const auto found = std::lower_bound(rows.begin(), rows.end(), s);
  TEUCHOS_ASSERT(found != rows.end() && *found == s);
  for (int b = 0; b < kModes; ++b) {
    double* to = matrix_.valuePtr() + matrix_.outerIndexPtr()[kModes * t + b] + kModes * (found - rows.begin());
    for (int a = 0; a < kModes; ++a) to[a] += block[std::size_t(a * kModes + b)];
  }
}

void CoarseMatrix::set(const std::vector<const CoarseBlocks*>& parts) {
  std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0);
  for (const CoarseBlocks* part : parts)
    for (const auto& [key, block] : part->blocks()) {
      const int s = CoarseBlocks::row(key), t = CoarseBlocks::column(key);
      addBlock(s, t, block);
      if (s == t) continue;
      Block transposed;
      for (int a = 0; a < kModes; ++a)
        for (int b = 0; b < kModes; ++b) transposed[std::size_t(b * kModes + a)] = block[std::size_t(a * kModes + b)];
      addBlock(t, s, transposed);
    }
}

}  // namespace Haptos
