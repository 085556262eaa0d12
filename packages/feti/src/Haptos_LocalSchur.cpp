// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_LocalSchur.hpp"

#include <Eigen/Dense>
#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <cmath>
#include <numeric>

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
  std::vector<int> newRow(std::size_t(K.rows()), -1);
  for (std::size_t i = 0; i < rows.size(); ++i) newRow[rows[i]] = int(i);
  Eigen::Index entries = 0;
  for (const int column : columns)
    for (Eigen::SparseMatrix<double>::InnerIterator it(K, column); it; ++it) entries += newRow[it.row()] >= 0;
  Eigen::SparseMatrix<double> part(Eigen::Index(rows.size()), Eigen::Index(columns.size()));
  part.resizeNonZeros(entries);
  Eigen::Index at = 0;
  for (std::size_t j = 0; j < columns.size(); ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(K, columns[j]); it; ++it) {
      if (newRow[it.row()] < 0) continue;
      part.innerIndexPtr()[at] = newRow[it.row()];
      part.valuePtr()[at++] = it.value();
    }
    part.outerIndexPtr()[j + 1] = int(at);
  }
  if (std::is_sorted(rows.begin(), rows.end())) return part;
  const Eigen::SparseMatrix<double> byRows = part.transpose();  // sorts
  return byRows.transpose();
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
                       const std::vector<int>& boundary, LocalSolverMethod method, FactorPrecision precision) {
  TEUCHOS_ASSERT(K.rows() == K.cols() && K.rows() == kernel.rows());
  const auto interior = complement(K.rows(), boundary);
  keep(extract(K, boundary, boundary), extract(K, interior, boundary), precision);
  if (interior.empty()) return;
  const auto Z = interiorKernel(kernel, boundary, interior);
  interiorKernelSize_ = Z.cols();
  auto Kii = regularizeByFixing(extract(K, interior, interior), Z, chooseFixingUnknowns(Z));
  interior_ = std::make_unique<LocalSolverFactor>(std::move(Kii), method, precision);
  interior_->releaseMatrix();
}

LocalSchur LocalSchur::lumped(const Eigen::SparseMatrix<double>& K, const std::vector<int>& boundary, FactorPrecision precision) {
  LocalSchur result;
  result.keep(extract(K, boundary, boundary), {}, precision);
  return result;
}

LocalSchur::~LocalSchur() = default;
LocalSchur::LocalSchur(LocalSchur&&) noexcept = default;

void LocalSchur::keep(const Eigen::SparseMatrix<double>& Kbb, const Eigen::SparseMatrix<double>& Kib, FactorPrecision precision) {
  size_ = Kbb.rows();
  isSingle_ = precision == FactorPrecision::Single;
  if (!isSingle_) {
    double_ = {Kbb, Kib};
    return;
  }
  const double largest = Kbb.nonZeros() > 0 ? Kbb.coeffs().abs().maxCoeff() : 0.0;
  if (largest > 0) scale_ = largest;
  single_ = {(Kbb / scale_).cast<float>(), (Kib / scale_).cast<float>()};
}

Eigen::Index LocalSchur::size() const { return size_; }
Eigen::Index LocalSchur::interiorKernelSize() const { return interiorKernelSize_; }

void LocalSchur::apply(const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::Ref<Eigen::MatrixXd> Y) const {
  TEUCHOS_ASSERT(X.rows() == size() && Y.rows() == size() && X.cols() == Y.cols());
  for (Eigen::Index first = 0; first < X.cols(); first += blockWidth) {
    const Eigen::Index width = std::min(blockWidth, X.cols() - first);
    if (isSingle_) applyParts(single_, X.middleCols(first, width), Y.middleCols(first, width));
    else applyParts(double_, X.middleCols(first, width), Y.middleCols(first, width));
  }
}

/// Y := K_bb X - K_bi K_ii^+ K_ib X; K_ib X lies in the range of K_ii, so any generalised inverse will do.
template <class Scalar>
void LocalSchur::applyParts(const Parts<Scalar>& parts, const Eigen::Ref<const Eigen::MatrixXd>& X,
                            Eigen::Ref<Eigen::MatrixXd> Y) const {
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  if (X.size() == 0) return;
  const double largest = isSingle_ ? X.cwiseAbs().maxCoeff() : 1.0, unit = largest > 0 ? largest : 1.0;
  const Matrix x = (X / unit).template cast<Scalar>();
  Matrix y = parts.Kbb.transpose() * x;  // symmetric; sums by columns write nothing but their result
  if (interior_) {
    const Eigen::MatrixXd force = Matrix(parts.Kib * x).template cast<double>() * scale_;
    Eigen::MatrixXd motion(force.rows(), force.cols());
    interior_->solve(force, motion);
    y.noalias() -= parts.Kib.transpose() * Matrix(motion.template cast<Scalar>());
  }
  Y = y.template cast<double>() * (scale_ * unit);
}

/// K_cc - K_ci K_ii^+ K_ic
template <class Scalar>
Eigen::MatrixXd LocalSchur::blockOf(const Parts<Scalar>& parts, const std::vector<int>& c) const {
  const Eigen::Index n = Eigen::Index(c.size());
  std::vector<int> position(std::size_t(size()), -1);
  for (Eigen::Index i = 0; i < n; ++i) position[std::size_t(c[std::size_t(i)])] = int(i);
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (typename Eigen::SparseMatrix<Scalar>::InnerIterator it(parts.Kbb, c[std::size_t(j)]); it; ++it)
      if (position[std::size_t(it.row())] >= 0) S(position[std::size_t(it.row())], j) = scale_ * double(it.value());
  if (!interior_) return S;
  for (Eigen::Index first = 0; first < n; first += blockWidth) {
    const Eigen::Index width = std::min(blockWidth, n - first);
    Eigen::MatrixXd force = Eigen::MatrixXd::Zero(parts.Kib.rows(), width), motion(parts.Kib.rows(), width);
    for (Eigen::Index j = 0; j < width; ++j)
      for (typename Eigen::SparseMatrix<Scalar>::InnerIterator it(parts.Kib, c[std::size_t(first + j)]); it; ++it)
        force(it.row(), j) = scale_ * double(it.value());
    interior_->solve(force, motion);
    for (Eigen::Index i = 0; i < n; ++i)
      for (typename Eigen::SparseMatrix<Scalar>::InnerIterator it(parts.Kib, c[std::size_t(i)]); it; ++it)
        S.row(i).segment(first, width) -= scale_ * double(it.value()) * motion.row(it.row());
  }
  return 0.5 * (S + S.transpose());
}

Eigen::MatrixXd LocalSchur::block(const std::vector<int>& c) const { return isSingle_ ? blockOf(single_, c) : blockOf(double_, c); }

Eigen::MatrixXd LocalSchur::dense() const {
  std::vector<int> all(std::size_t(size()), 0);
  std::iota(all.begin(), all.end(), 0);
  return block(all);
}

}  // namespace Haptos
