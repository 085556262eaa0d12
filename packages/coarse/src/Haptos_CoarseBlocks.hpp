// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/SparseCore>
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "Haptos_CoarsePlacement.hpp"
#include "Haptos_CoarseRows.hpp"

namespace Haptos {

/// \brief The lower triangle of a symmetric coarse matrix in 6 x 6 blocks (s, t), s >= t, of coarse unknowns 6 s to 6 s + 5:
/// those of a subdomain, where all subdomains have six.
class CoarseBlocks {
 public:
  using Block = std::array<double, kCoarseModes * kCoarseModes>;  ///< by rows
  using Map = std::unordered_map<std::uint64_t, Block>;

  CoarseBlocks() = default;
  /// \brief C^T diag(q) C of this rank's rows; q empty: 1, q zero: the row is left out.
  CoarseBlocks(const CoarseRows& C, const std::vector<double>& q);
  /// \brief sum of w w^T over coarse vectors w.
  explicit CoarseBlocks(const std::vector<Eigen::SparseVector<double>>& vectors);

  /// \brief The sum over the ranks on the holders of a factor, the same digits on all of them; empty elsewhere.
  ///
  /// Every block has an owner, who adds up what the ranks have of it in the order of the ranks.  Where the ranks share a factor
  /// it stays there: the ranks' results are parts of the sum.  Collective.
  CoarseBlocks onHolders(const CoarsePlacement& placement, Eigen::Index subdomains) const;

  void add(const CoarseBlocks& other, double factor = 1);
  void add(int s, int t, const Block& block);  ///< in either triangle
  Eigen::VectorXd multiply(const Eigen::VectorXd& a) const;  ///< by the whole symmetric matrix, [l]
  double largestDiagonal() const;  ///< 0 without blocks
  const Map& blocks() const { return blocks_; }
  std::size_t size() const { return blocks_.size(); }

  static int row(std::uint64_t key) { return int(key >> 32); }
  static int column(std::uint64_t key) { return int(key & 0xffffffffu); }

 private:
  Map blocks_;
};

/// \brief Both triangles of a coarse matrix, compressed by columns, whose pattern stays.
class CoarseMatrix {
 public:
  CoarseMatrix() = default;
  /// \brief Of `size` unknowns, with zeros where one of the patterns has blocks.
  CoarseMatrix(const std::vector<const CoarseBlocks*>& patterns, Eigen::Index size);

  /// \brief Values := sum of the parts, whose blocks lie within the pattern.
  void set(const std::vector<const CoarseBlocks*>& parts);

  const Eigen::SparseMatrix<double>& matrix() const { return matrix_; }

 private:
  void addBlock(int s, int t, const CoarseBlocks::Block& block);

  std::vector<std::vector<int>> rowsOfColumn_;  // [subdomains] ascending block rows
  Eigen::SparseMatrix<double> matrix_;
};

}  // namespace Haptos
