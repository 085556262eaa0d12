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
  std::size_t coupled = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const NodeRows& node = nodes[i];
    const bool isCoupled = coupled < pairs_.nodes().size() && pairs_.nodes()[coupled] == int(i);
    blocks_.push_back({node.gluing, node.copies, node.dirichlet, H_.size(), isCoupled ? int(coupled++) : -1});
    mostCopies_ = std::max(mostCopies_, std::size_t(node.copies));
    const Eigen::MatrixXd Q = orthonormalBasis(node.copies);
    Eigen::VectorXd K = Eigen::VectorXd::Ones(node.copies);
    if (stiffnessScaling) K = Eigen::Map<const Eigen::VectorXd>(multipliers.copyStiffness().data() + node.first, node.copies);
    const Eigen::MatrixXd H = Q * K.asDiagonal() * Q.transpose();
    H_.insert(H_.end(), H.data(), H.data() + H.size());
  }
}

// z := q^T x_g of the nodes that pairs act on; prescribed components stay 0
void RowGram::collectMeans(const double* x, Eigen::VectorXd& z) const {
  for (const Block& block : blocks_) {
    if (block.coupled < 0) continue;
    const double* h = edge(block);
    const int m = block.copies - 1;
    for (int d = 0; d < 3; ++d) {
      if (block.dirichlet[std::size_t(d)] >= 0) continue;
      double sum = 0;
      for (int j = 0; j < m; ++j) sum += h[j] * x[block.gluing + 3 * j + d];
      z[3 * block.coupled + d] = sum / (h[m] * std::sqrt(double(block.copies)));
    }
  }
}

void RowGram::applyBlock(const Block& block, const Eigen::VectorXd& g, const double* x, double* y, double* v) const {
  const int mu = block.copies, m = mu - 1;
  if (mu == 0) {
    for (int row : block.dirichlet)
      if (row >= 0) y[row] = 0;  // no element has the node
    return;
  }
  const double* H = H_.data() + block.at;
  const double* h = edge(block);
  for (int d = 0; d < 3; ++d) {
    const int dirichlet = block.dirichlet[std::size_t(d)];
    for (int j = 0; j < m; ++j) v[j] = x[block.gluing + 3 * j + d];
    if (dirichlet >= 0) {
      v[m] = x[dirichlet];
    } else {  // (H_gg - H_ge H_eg / h_ee) x_g + q g  is  H_gg x_g + H_ge (last entry)
      v[m] = block.coupled < 0 ? 0.0 : g[3 * block.coupled + d] / (h[m] * std::sqrt(double(mu)));
      for (int j = 0; j < m; ++j) v[m] -= h[j] * v[j] / h[m];
    }
    for (int i = 0; i < mu; ++i) {
      if (i == m && dirichlet < 0) break;
      double sum = 0;
      for (int j = 0; j < mu; ++j) sum += H[i * mu + j] * v[j];
      y[i < m ? block.gluing + 3 * i + d : dirichlet] = sum;
    }
  }
}

// Contact rows first, from their own matrix with the gluing rows eliminated; then node by node the gluing and Dirichlet rows,
// with what contact rows leave them.
void RowGram::applyTo(const double* x, double* y) const {
  const auto& rows = pairs_.rows();
  Eigen::VectorXd contact(Eigen::Index(rows.size())), g = Eigen::VectorXd::Zero(3 * Eigen::Index(pairs_.nodes().size()));
  for (std::size_t i = 0; i < rows.size(); ++i) contact[Eigen::Index(i)] = x[rows[i]];
  collectMeans(x, g);
  pairs_.solve(contact, g);
  std::vector<double> scratch(mostCopies_);
  for (const Block& block : blocks_) applyBlock(block, g, x, y, scratch.data());
  for (std::size_t i = 0; i < rows.size(); ++i) y[rows[i]] = contact[Eigen::Index(i)];
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
      const double* H = H_.data() + block.at;
      const double* h = edge(block);
      const int dirichlet = block.dirichlet[std::size_t(d)];
      if (dirichlet >= 0) result[dirichlet] = h[m];
      for (int i = 0; i < m; ++i) {
        double value = H[i * mu + i];
        const double q = h[i] / h[m];
        if (dirichlet < 0) value -= h[i] * q;
        if (dirichlet < 0 && block.coupled >= 0) value += q * q / mu * pairs_.nodeDiagonal()[3 * block.coupled + d];
        result[block.gluing + 3 * i + d] = value;
      }
    }
  }
  return result;
}

}  // namespace Haptos
