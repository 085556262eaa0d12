// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

#include "Haptos_CouplingGram.hpp"
#include "Haptos_RowPanel.hpp"

namespace Haptos {

/// \brief (B W B^T)^-1 on the owned rows, with W = 1 / (stiffness weight k_i of the node in the subdomain).
///
/// At a node the gluing rows Q and e = (1, .., 1) / sqrt(mu) are an orthonormal basis, H = [Q; e^T] K [Q; e^T]^T with K = diag(k_i)
/// is the inverse of that basis' Gram matrix.  A prescribed component has the Dirichlet row e: y = H x.  Rows of pairs act on
/// e alone, as C / sqrt(mu); the gluing rows of the others are eliminated, which leaves S (`CouplingGram`):
///
///   q = H_ge / (h_ee sqrt(mu)),   y_c = S^-1 (x_c + C q^T x_g),   y_g = G x_g + q C^T y_c,   G = H_gg - H_ge H_eg / h_ee
///
/// An empty (pinned) row gives zero.  Source: Rixen and Farhat 1999 (scaling); decision 023-rows-of-pairs-on-nodes.
class RowGram {
 public:
  /// Collective.
  explicit RowGram(const MultiplierMap& multipliers, bool stiffnessScaling = true);

  /// \brief y := (B W B^T)^-1 x; may be done in place.  Collective where rows of pairs meet across ranks, else nothing communicates.
  void apply(const MultiVector& x, MultiVector& y) const;
  /// \brief y := (B W B^T)^-1 y on the owned rows, which come first in y: node by node where y is filled, and all pairs if any is.
  void apply(RowPanel& y) const;
  /// \brief The same for one vector of the owned rows.
  Eigen::VectorXd multiply(const Eigen::VectorXd& x) const;

  const CouplingGram& pairs() const { return pairs_; }

  /// \brief Of the inverse, [owned rows]; as CouplingGram has it where pairs act.
  Eigen::VectorXd diagonal() const;

 private:
  // One node: from `at` on G, [copies - 1] squared, and the last row of H, [copies].
  struct Block {
    int gluing, copies;
    std::array<int, 3> dirichlet;
    std::size_t at;
    int coupled;  // position among CouplingGram's nodes; -1: no pair acts on it
    bool gluesOnly() const { return coupled < 0 && dirichlet[0] < 0 && dirichlet[1] < 0 && dirichlet[2] < 0; }
  };

  const double* edge(const Block& block) const { return G_.data() + block.at + std::size_t(block.copies - 1) * std::size_t(block.copies - 1); }
  // Vectors side by side, `Width` of them: one, or a panel.
  template <int Width>
  void collectMeans(const double* x, Eigen::MatrixXd& z) const;
  template <int Width>
  void applyGluing(const Block& block, const double* x, double* y) const;
  template <int Width>
  void addMean(const Block& block, const Eigen::MatrixXd& g, const double* gluing, const double* x, double* y) const;
  template <int Width>
  void applyNode(const Block& block, const Eigen::MatrixXd& g, std::vector<double>& gluing, const double* x, double* y) const;
  void applyTo(const double* x, double* y) const;
  void applyPairs(RowPanel& y) const;
  template <class Visit>
  static void forEachRow(const Block& block, Visit&& visit);

  CouplingGram pairs_;
  std::vector<Block> blocks_;
  std::vector<int> blockOf_;  // [owned rows] position in blocks_; -1: of a pair
  std::vector<double> G_;
  std::size_t mostCopies_ = 1;
  Eigen::Index numRows_;
};

}  // namespace Haptos
