// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_RowGram.hpp"

#include <Eigen/Core>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_TpetraCompat.hpp"

namespace Haptos {
namespace {

// Gluing rows and, last, e.
Eigen::MatrixXd orthonormalBasis(int mu) {
  Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(mu, mu);
  for (int j = 1; j < mu; ++j) {
    const double norm = std::sqrt(double(j) * (j + 1));
    for (int i = 0; i < j; ++i) Q(j - 1, i) = 1.0 / norm;
    Q(j - 1, j) = -j / norm;
  }
  if (mu > 0) Q.row(mu - 1).setConstant(1.0 / std::sqrt(double(mu)));
  return Q;
}

}  // namespace

RowGram::RowGram(const MultiplierMap& multipliers, bool stiffnessScaling)
    : pairs_(multipliers, stiffnessScaling), numRows_(Eigen::Index(multipliers.kinds().size())) {
  const auto& nodes = multipliers.nodeRows();
  blockOf_.assign(std::size_t(numRows_), -1);
  std::size_t coupled = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const NodeRows& node = nodes[i];
    const bool isCoupled = coupled < pairs_.nodes().size() && pairs_.nodes()[coupled] == int(i);
    blocks_.push_back({node.gluing, node.copies, node.dirichlet, G_.size(), isCoupled ? int(coupled++) : -1});
    mostCopies_ = std::max(mostCopies_, std::size_t(node.copies));
    forEachRow(blocks_.back(), [&](int row) { blockOf_[std::size_t(row)] = int(i); });
    const Eigen::MatrixXd Q = orthonormalBasis(node.copies);
    Eigen::VectorXd K = Eigen::VectorXd::Ones(node.copies);
    if (stiffnessScaling) K = Eigen::Map<const Eigen::VectorXd>(multipliers.copyStiffness().data() + node.first, node.copies);
    const Eigen::MatrixXd H = Q * K.asDiagonal() * Q.transpose();
    const int m = node.copies - 1;
    if (m < 0) continue;
    const Eigen::MatrixXd G = H.topLeftCorner(m, m) - H.col(m).head(m) * H.row(m).head(m) / H(m, m);
    G_.insert(G_.end(), G.data(), G.data() + G.size());
    G_.insert(G_.end(), H.col(m).data(), H.col(m).data() + node.copies);
  }
}

template <class Visit>
void RowGram::forEachRow(const Block& block, Visit&& visit) {
  for (int i = 0; i < 3 * (block.copies - 1); ++i) visit(block.gluing + i);
  for (const int row : block.dirichlet)
    if (row >= 0) visit(row);
}

// z := q^T x_g of the nodes that pairs act on; prescribed components stay 0
template <int Width>
void RowGram::collectMeans(const double* x, Eigen::MatrixXd& z) const {
  for (const Block& block : blocks_) {
    if (block.coupled < 0) continue;
    const double* h = edge(block);
    const int m = block.copies - 1;
    for (int d = 0; d < 3; ++d) {
      if (block.dirichlet[std::size_t(d)] >= 0) continue;
      double sum[Width] = {};
      for (int j = 0; j < m; ++j)
        for (int v = 0; v < Width; ++v) sum[v] += h[j] * x[(block.gluing + 3 * j + d) * Width + v];
      for (int v = 0; v < Width; ++v) z(3 * block.coupled + d, v) = sum[v] / (h[m] * std::sqrt(double(block.copies)));
    }
  }
}

// y_g := G x_g, all three components at once
template <int Width>
void RowGram::applyGluing(const Block& block, const double* x, double* y) const {
  constexpr int kNode = 3 * Width;
  const int m = block.copies - 1;
  const double* G = G_.data() + block.at;
  for (int i = 0; i < m; ++i, G += m) {
    double sum[kNode] = {};
    for (int j = 0; j < m; ++j)
      for (int d = 0; d < kNode; ++d) sum[d] += G[j] * x[kNode * j + d];
    for (int d = 0; d < kNode; ++d) y[block.gluing * Width + kNode * i + d] = sum[d];
  }
}

// What e adds: with pairs y_g += q g; with a Dirichlet row H_gg = G + H_ge H_eg / h_ee, and its own product.
template <int Width>
void RowGram::addMean(const Block& block, const Eigen::MatrixXd& g, const double* gluing, const double* x, double* y) const {
  const int m = block.copies - 1;
  const double* h = edge(block);
  for (int d = 0; d < 3; ++d) {
    const int dirichlet = block.dirichlet[std::size_t(d)];
    double factor[Width];
    for (int v = 0; v < Width; ++v) {
      factor[v] = block.coupled < 0 ? 0.0 : g(3 * block.coupled + d, v) / (h[m] * std::sqrt(double(block.copies)));
      if (dirichlet < 0) continue;
      double product = h[m] * x[dirichlet * Width + v];
      for (int j = 0; j < m; ++j) product += h[j] * gluing[(3 * j + d) * Width + v];
      y[dirichlet * Width + v] = product;
      factor[v] = product / h[m];
    }
    for (int i = 0; i < m; ++i)
      for (int v = 0; v < Width; ++v) y[(block.gluing + 3 * i + d) * Width + v] += h[i] * factor[v];
  }
}

// Gluing and Dirichlet rows of a node, with what contact rows leave them; y may be x.
template <int Width>
void RowGram::applyNode(const Block& block, const Eigen::MatrixXd& g, std::vector<double>& gluing, const double* x, double* y) const {
  if (block.copies == 0) {  // no element has the node
    for (int row : block.dirichlet)
      if (row >= 0) std::fill_n(y + row * Width, Width, 0.0);
    return;
  }
  if (block.copies > 1) std::copy_n(x + block.gluing * Width, 3 * (block.copies - 1) * Width, gluing.data());
  applyGluing<Width>(block, gluing.data(), y);
  if (!block.gluesOnly()) addMean<Width>(block, g, gluing.data(), x, y);
}

// Contact rows first, from their own matrix with the gluing rows eliminated; then node by node the gluing and Dirichlet rows.
void RowGram::applyTo(const double* x, double* y) const {
  const auto& rows = pairs_.rows();
  Eigen::MatrixXd contact(Eigen::Index(rows.size()), 1), g = Eigen::MatrixXd::Zero(3 * Eigen::Index(pairs_.nodes().size()), 1);
  for (std::size_t i = 0; i < rows.size(); ++i) contact(Eigen::Index(i), 0) = x[rows[i]];
  collectMeans<1>(x, g);
  pairs_.solve(contact, g);
  std::vector<double> gluing(3 * mostCopies_);
  for (const Block& block : blocks_) applyNode<1>(block, g, gluing, x, y);
  for (std::size_t i = 0; i < rows.size(); ++i) y[rows[i]] = contact(Eigen::Index(i), 0);
}

// Nodes on which no pair acts are by themselves; of the others every one may feel any pair.
void RowGram::apply(RowPanel& y) const {
  std::vector<int> touched;
  std::vector<char> isTouched(blocks_.size(), 0);
  bool feelsPairs = false;
  for (const int row : y.filled()) {
    if (row >= numRows_) continue;  // of another rank
    const int b = blockOf_[std::size_t(row)];
    if (b < 0 || blocks_[std::size_t(b)].coupled >= 0) feelsPairs = true;
    else if (!isTouched[std::size_t(b)]) touched.push_back(b), isTouched[std::size_t(b)] = 1;
  }
  if (pairs_.isWhereSolved(feelsPairs)) applyPairs(y);
  std::vector<double> gluing(3 * mostCopies_ * RowPanel::kColumns);
  for (const int b : touched) {
    const Block& block = blocks_[std::size_t(b)];
    forEachRow(block, [&](int row) { y.fill(std::size_t(row)); });
    applyNode<RowPanel::kColumns>(block, {}, gluing, y.data(), y.data());
  }
}

// Rows of pairs, and of the nodes that they act on.
void RowGram::applyPairs(RowPanel& y) const {
  constexpr int kColumns = RowPanel::kColumns;
  const auto& rows = pairs_.rows();
  Eigen::MatrixXd contact(Eigen::Index(rows.size()), kColumns), g = Eigen::MatrixXd::Zero(3 * Eigen::Index(pairs_.nodes().size()), kColumns);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (int v = 0; v < kColumns; ++v) contact(Eigen::Index(i), v) = y[std::size_t(rows[i])][v];
  collectMeans<kColumns>(y.data(), g);
  pairs_.solve(contact, g);
  std::vector<double> gluing(3 * mostCopies_ * kColumns);
  for (const Block& block : blocks_) {
    if (block.coupled < 0) continue;
    applyNode<kColumns>(block, g, gluing, y.data(), y.data());
    forEachRow(block, [&](int row) { y.fillIfAny(std::size_t(row)); });
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (int v = 0; v < kColumns; ++v) y.data()[rows[i] * kColumns + v] = contact(Eigen::Index(i), v);
    y.fillIfAny(std::size_t(rows[i]));
  }
}

Eigen::VectorXd RowGram::multiply(const Eigen::VectorXd& x) const {
  Eigen::VectorXd y(numRows_);
  applyTo(x.data(), y.data());
  return y;
}

void RowGram::apply(const MultiVector& x, MultiVector& y) const {
  for (std::size_t v = 0; v < x.getNumVectors(); ++v) {
    const auto in = x.getData(v);
    const auto out = y.getDataNonConst(v);
    applyTo(in.getRawPtr(), out.getRawPtr());
  }
}

// Of the inverse, block by block as `applyTo` multiplies.
Eigen::VectorXd RowGram::diagonal() const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(numRows_);
  for (std::size_t i = 0; i < pairs_.rows().size(); ++i) result[pairs_.rows()[i]] = pairs_.rowDiagonal()[Eigen::Index(i)];
  for (const Block& block : blocks_) {
    const int mu = block.copies, m = mu - 1;
    for (int d = 0; d < 3 && mu > 0; ++d) {
      const double* G = G_.data() + block.at;
      const double* h = edge(block);
      const int dirichlet = block.dirichlet[std::size_t(d)];
      if (dirichlet >= 0) result[dirichlet] = h[m];
      for (int i = 0; i < m; ++i) {
        double value = G[i * m + i];
        const double q = h[i] / h[m];
        if (dirichlet >= 0) value += h[i] * q;
        if (dirichlet < 0 && block.coupled >= 0) value += q * q / mu * pairs_.nodeDiagonal()[3 * block.coupled + d];
        result[block.gluing + 3 * i + d] = value;
      }
    }
  }
  return result;
}

}  // namespace Haptos
