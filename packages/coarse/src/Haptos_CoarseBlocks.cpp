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

using Block = CoarseBlocks::Block;
using BlockMap = CoarseBlocks::Map;

std::uint64_t blockKey(int row, int column) { return (std::uint64_t(row) << 32) | std::uint64_t(column); }

// Finds blocks in a map; rows near each other mostly touch the same ones, several hundred where subdomains are small.
// A table of the last found in each of 1024 places: the map is asked for few of them.
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

// Keys and values one after the other; their order is the map's, and of no account.
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

Block transposed(const Block& block) {
  Block result;
  for (int a = 0; a < kCoarseModes; ++a)
    for (int b = 0; b < kCoarseModes; ++b) result[std::size_t(b * kCoarseModes + a)] = block[std::size_t(a * kCoarseModes + b)];
  return result;
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

constexpr int kAlike = 3;  // the components of a node touch the same subdomains, as do the rows of a contact pair

// Rows of one pattern, all six columns of each of their subdomains, one behind the other.
struct AlikeRows {
  int rows, length;
  const int* columns;     // [length]
  const double* values;   // [rows x length]
  const double* weights;  // [rows]
};

// Whether columns come as six of a subdomain; else the row is padded with zeros, so that there is one kernel for all.
bool hasWholeSubdomains(const int* columns, int length) {
  bool whole = length % kCoarseModes == 0;
  for (int i = 0; i < length && whole; i += kCoarseModes) whole = columns[i] % kCoarseModes == 0 && columns[i + kCoarseModes - 1] == columns[i] + kCoarseModes - 1;
  return whole;
}

// A row with zeros where it has not all six columns of a subdomain.
class PaddedRow {
 public:
  AlikeRows pad(const AlikeRows& row) {
    columns_.clear();
    values_.clear();
    for (int i = 0; i < row.length; ++i) {
      const int first = row.columns[i] / kCoarseModes * kCoarseModes;
      if (columns_.empty() || columns_.back() < first) {
        for (int m = 0; m < kCoarseModes; ++m) columns_.push_back(first + m);
        values_.resize(columns_.size(), 0.0);
      }
      values_[values_.size() - kCoarseModes + std::size_t(row.columns[i] - first)] = row.values[i];
    }
    return {1, int(columns_.size()), columns_.data(), values_.data(), row.weights};
  }

 private:
  std::vector<int> columns_;
  std::vector<double> values_;
};

// block += sum of weight a b^T over the rows, summed in registers first: the block is read and written once for all of them
HAPTOS_INLINE void addProduct(const AlikeRows& C, const double* a, const double* b, Block& block) {
  Block sum{};
  for (int r = 0; r < C.rows; ++r, a += C.length, b += C.length)
    for (std::size_t i = 0; i < kCoarseModes; ++i) {
      const double wa = C.weights[r] * a[i];
      for (std::size_t j = 0; j < kCoarseModes; ++j) sum[i * kCoarseModes + j] += wa * b[j];
    }
  for (std::size_t i = 0; i < sum.size(); ++i) block[i] += sum[i];
}

// All blocks (s, t), s >= t, of C^T diag(q) C that these rows meet; columns ascend, so the lower triangle is j <= i.
HAPTOS_CLONES void addProducts(const AlikeRows& C, RecentBlocks& blocks) {
  for (int i = 0; i < C.length; i += kCoarseModes)
    for (int j = 0; j <= i; j += kCoarseModes)
      addProduct(C, C.values + i, C.values + j, blocks.at(C.columns[i] / kCoarseModes, C.columns[j] / kCoarseModes));
}

}  // namespace

// sum over rows i of q_i c_i c_i^T, c_i the row's six numbers of each of its subdomains; up to three rows of one pattern at once.
CoarseBlocks::CoarseBlocks(const CoarseRows& C, const std::vector<double>& q) {
  TEUCHOS_ASSERT(C.isCompressed() && (q.empty() || Eigen::Index(q.size()) == C.rows()));
  static constexpr double kOnes[kAlike] = {1, 1, 1};
  const int* starts = C.outerIndexPtr();
  const auto weights = [&](Eigen::Index row) { return q.empty() ? kOnes : q.data() + row; };
  const auto alike = [&](Eigen::Index a, Eigen::Index b) {
    const int* columns = C.innerIndexPtr();
    return *weights(b) != 0 && starts[a + 1] - starts[a] == starts[b + 1] - starts[b] &&
           std::equal(columns + starts[a], columns + starts[a + 1], columns + starts[b]);
  };
  RecentBlocks recent(blocks_);
  PaddedRow padded;
  for (Eigen::Index row = 0, next = 1; row < C.rows(); row = next++) {
    if (*weights(row) == 0) continue;  // its blocks, too, are left out
    const int length = starts[row + 1] - starts[row];
    AlikeRows rows{1, length, C.innerIndexPtr() + starts[row], C.valuePtr() + starts[row], weights(row)};
    if (hasWholeSubdomains(rows.columns, length)) {
      while (next < C.rows() && next < row + kAlike && alike(row, next)) ++next;
      rows.rows = int(next - row);
    } else {
      rows = padded.pad(rows);
    }
    addProducts(rows, recent);
  }
}

// Entries of w w^T in the lower triangle of blocks, the whole of a diagonal block.
CoarseBlocks::CoarseBlocks(const std::vector<Eigen::SparseVector<double>>& vectors) {
  for (const auto& w : vectors)
    for (Eigen::SparseVector<double>::InnerIterator i(w); i; ++i)
      for (Eigen::SparseVector<double>::InnerIterator j(w); j; ++j) {
        const int s = int(i.index()) / kCoarseModes, t = int(j.index()) / kCoarseModes;
        if (s < t) continue;
        Block& block = blocks_.try_emplace(blockKey(s, t), Block{}).first->second;
        block[std::size_t((i.index() % kCoarseModes) * kCoarseModes + j.index() % kCoarseModes)] += i.value() * j.value();
      }
}

// Blocks to their owners, who add them up, sums to the holders: all of those get the same numbers.
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
  result.blocks_ = sumBlocks(received);
  if (!placement.isShared()) result.blocks_ = sumBlocks(placement.gather(packBlocks(result.blocks_)));
  return result;
}

void CoarseBlocks::add(const CoarseBlocks& other, double factor) {
  for (const auto& [key, block] : other.blocks_) addBlock(blocks_, key, block, factor);
}

void CoarseBlocks::add(int s, int t, const Block& block) {
  if (s >= t) addBlock(blocks_, blockKey(s, t), block);
  else addBlock(blocks_, blockKey(t, s), transposed(block));
}

// y_s += A_st a_t, y_t += A_st^T a_s
Eigen::VectorXd CoarseBlocks::multiply(const Eigen::VectorXd& a) const {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(a.size());
  for (const auto& [key, block] : blocks_) {
    const Eigen::Map<const Eigen::Matrix<double, kCoarseModes, kCoarseModes, Eigen::RowMajor>> A(block.data());
    const int s = kCoarseModes * row(key), t = kCoarseModes * column(key);
    y.segment<kCoarseModes>(s) += A * a.segment<kCoarseModes>(t);
    // what lies above the diagonal is not kept
    if (s != t) y.segment<kCoarseModes>(t) += A.transpose() * a.segment<kCoarseModes>(s);
  }
  return y;
}

// Of a semidefinite matrix the largest entry at all.
double CoarseBlocks::largestDiagonal() const {
  double largest = 0;
  for (const auto& [key, block] : blocks_)
    if (row(key) == column(key))
      for (int a = 0; a < kCoarseModes; ++a) largest = std::max(largest, block[std::size_t(a * kCoarseModes + a)]);
  return largest;
}

// The pattern of all parts together: it stays, so that the analysis of the first factor serves all later values.
CoarseMatrix::CoarseMatrix(const std::vector<const CoarseBlocks*>& patterns, Eigen::Index size)
    : rowsOfColumn_(std::size_t(size / kCoarseModes)), matrix_(size, size) {
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
    entries += rows.size() * kCoarseModes * kCoarseModes;
  }
  matrix_.resizeNonZeros(Eigen::Index(entries));
  std::fill_n(matrix_.valuePtr(), entries, 0.0);
  int at = 0;
  for (int column = 0; column < int(size); ++column) {
    matrix_.outerIndexPtr()[column] = at;
    for (int s : rowsOfColumn_[std::size_t(column / kCoarseModes)])
      for (int a = 0; a < kCoarseModes; ++a) matrix_.innerIndexPtr()[at++] = kCoarseModes * s + a;
  }
  matrix_.outerIndexPtr()[size] = at;
}

// Six columns of block row s: a block's column is contiguous in each, `found` of its rows lie before it.
void CoarseMatrix::addBlock(int s, int t, const Block& block) {
  const auto& rows = rowsOfColumn_[std::size_t(t)];
  const auto found = std::lower_bound(rows.begin(), rows.end(), s);
  TEUCHOS_ASSERT(found != rows.end() && *found == s);
  for (int b = 0; b < kCoarseModes; ++b) {
    double* to = matrix_.valuePtr() + matrix_.outerIndexPtr()[kCoarseModes * t + b] + kCoarseModes * (found - rows.begin());
    for (int a = 0; a < kCoarseModes; ++a) to[a] += block[std::size_t(a * kCoarseModes + b)];
  }
}

// Blocks of the lower triangle and their transposes, into both triangles: sparse solvers are given whole columns.
void CoarseMatrix::set(const std::vector<const CoarseBlocks*>& parts) {
  std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0);
  for (const CoarseBlocks* part : parts)
    for (const auto& [key, block] : part->blocks()) {
      const int s = CoarseBlocks::row(key), t = CoarseBlocks::column(key);
      addBlock(s, t, block);
      if (s == t) continue;
      addBlock(t, s, transposed(block));
    }
}

}  // namespace Haptos
