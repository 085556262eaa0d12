// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_LocalSchur.hpp"

#include <Eigen/Dense>
#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_FixingNodes.hpp"

namespace Haptos {

namespace {

constexpr Eigen::Index blockWidth = 64;

/// The unknowns not in `listed`, ascending.
std::vector<int> complement(Eigen::Index n, const std::vector<int>& listed) {
  std::vector<bool> isListed(n, false);
  for (const int i : listed) {
    TEUCHOS_ASSERT(i >= 0 && i < n && !isListed[i]);
    isListed[i] = true;
  }
  std::vector<int> rest;
  for (Eigen::Index i = 0; i < n; ++i)
    if (!isListed[i]) rest.push_back(int(i));
  return rest;
}

/// K(rows, columns)
Eigen::SparseMatrix<double> extract(const Eigen::SparseMatrix<double>& K, const std::vector<int>& rows,
                                    const std::vector<int>& columns) {
  std::vector<int> newRow(K.rows(), -1);
  for (std::size_t i = 0; i < rows.size(); ++i) newRow[rows[i]] = int(i);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t j = 0; j < columns.size(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(K, columns[j]); it; ++it)
      if (newRow[it.row()] >= 0) entries.emplace_back(newRow[it.row()], int(j), it.value());
  Eigen::SparseMatrix<double> part(rows.size(), columns.size());
  part.setFromTriplets(entries.begin(), entries.end());
  return part;
}

/// Orthonormal basis of the kernel of K_ii: the kernel vectors of K that vanish on b, seen on i.
Eigen::MatrixXd interiorKernel(const Eigen::MatrixXd& kernel, const std::vector<int>& boundary,
                               const std::vector<int>& interior) {
  if (kernel.cols() == 0) return Eigen::MatrixXd(interior.size(), 0);
  Eigen::MatrixXd onBoundary = Eigen::MatrixXd::Zero(boundary.size() + 1, kernel.cols());  // one row even if b is empty
  for (std::size_t k = 0; k < boundary.size(); ++k) onBoundary.row(k) = kernel.row(boundary[k]);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(onBoundary, Eigen::ComputeFullV);

  // what the singular values would be if R were spread evenly over all unknowns
  const double even = std::sqrt(double(boundary.size()) / double(kernel.rows()));
  Eigen::Index rank = 0;
  while (rank < svd.singularValues().size() && svd.singularValues()[rank] > 1e-9 * even) ++rank;

  const Eigen::MatrixXd unseen = kernel * svd.matrixV().rightCols(kernel.cols() - rank);
  Eigen::MatrixXd Z(interior.size(), unseen.cols());
  for (std::size_t k = 0; k < interior.size(); ++k) Z.row(k) = unseen.row(interior[k]);
  return Z;
}

}  // namespace

LocalSchur::LocalSchur(const Eigen::SparseMatrix<double>& K, const Eigen::MatrixXd& kernel,
                       const std::vector<int>& boundary, LocalSolverMethod method) {
  TEUCHOS_ASSERT(K.rows() == K.cols() && K.rows() == kernel.rows());
  const auto interior = complement(K.rows(), boundary);
  Kbb_ = extract(K, boundary, boundary);
  Kib_ = extract(K, interior, boundary);
  if (interior.empty()) return;
  const auto Z = interiorKernel(kernel, boundary, interior);
  interiorKernelSize_ = Z.cols();
  auto Kii = regularizeByFixing(extract(K, interior, interior), Z, chooseFixingUnknowns(Z));
  interior_ = std::make_unique<LocalSolverFactor>(std::move(Kii), method);
  interior_->releaseMatrix();
}

LocalSchur::~LocalSchur() = default;
LocalSchur::LocalSchur(LocalSchur&&) noexcept = default;

Eigen::Index LocalSchur::size() const { return Kbb_.rows(); }
Eigen::Index LocalSchur::interiorKernelSize() const { return interiorKernelSize_; }

void LocalSchur::apply(const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::Ref<Eigen::MatrixXd> Y) const {
  TEUCHOS_ASSERT(X.rows() == size() && Y.rows() == size() && X.cols() == Y.cols());
  for (Eigen::Index first = 0; first < X.cols(); first += blockWidth) {
    const Eigen::Index width = std::min(blockWidth, X.cols() - first);
    const auto x = X.middleCols(first, width);
    auto y = Y.middleCols(first, width);
    y.noalias() = Kbb_ * x;
    subtractInterior(x, y);
  }
}

/// Y -= K_bi K_ii^+ K_ib X; K_ib X lies in the range of K_ii, so any generalised inverse will do.
void LocalSchur::subtractInterior(const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::Ref<Eigen::MatrixXd> Y) const {
  if (!interior_ || X.rows() == 0) return;
  const Eigen::MatrixXd force = Kib_ * X;
  Eigen::MatrixXd motion(force.rows(), force.cols());
  interior_->solve(force, motion);
  Y.noalias() -= Kib_.transpose() * motion;
}

Eigen::MatrixXd LocalSchur::dense() const {
  Eigen::MatrixXd S = Kbb_;
  for (Eigen::Index first = 0; first < size(); first += blockWidth) {
    const Eigen::Index width = std::min(blockWidth, size() - first);
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(size(), width);
    for (Eigen::Index j = 0; j < width; ++j) unit(first + j, j) = 1.0;
    subtractInterior(unit, S.middleCols(first, width));
  }
  return 0.5 * (S + S.transpose());
}

}  // namespace Haptos
