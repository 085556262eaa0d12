// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SurfaceSchur.hpp"

#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_FixingNodes.hpp"
#include "Haptos_SparseBlocks.hpp"

namespace Haptos {

namespace {

constexpr Eigen::Index blockWidth = 64;  // columns at a time: products of matrices, and a workspace with a bound

/// Whether unknowns come in threes, those of a node in a row.
bool areWholeNodes(const std::vector<int>& unknowns) {
  if (unknowns.size() % 3 != 0) return false;
  for (std::size_t i = 0; i < unknowns.size(); i += 3)
    if (unknowns[i] % 3 != 0 || unknowns[i + 1] != unknowns[i] + 1 || unknowns[i + 2] != unknowns[i] + 2) return false;
  return true;
}

/// Entries of a vector of `size` unknowns when its nodes are padded.
Eigen::Index paddedSize(Eigen::Index size) { return size / 3 * NodeBlockMatrix::kPadded; }

void pad(const Eigen::Ref<const Eigen::VectorXd>& x, double factor, Eigen::Ref<Eigen::VectorXf> padded) {
  for (Eigen::Index i = 0, to = 0; i < x.size(); i += 3, to += NodeBlockMatrix::kPadded)
    padded.segment<4>(to) << (factor * x.segment<3>(i)).cast<float>(), 0.0f;
}

/// The fourth entry of a node is whatever a product left there.
void unpad(const Eigen::Ref<const Eigen::VectorXf>& padded, double factor, Eigen::Ref<Eigen::VectorXd> x) {
  for (Eigen::Index i = 0, from = 0; i < x.size(); i += 3, from += NodeBlockMatrix::kPadded)
    x.segment<3>(i) = factor * padded.segment<3>(from).cast<double>();
}

/// Orthonormal basis of the kernel of K_ii: the kernel vectors of K that vanish on b, seen on i.
Eigen::MatrixXd interiorKernel(const Eigen::MatrixXd& kernel, const std::vector<int>& boundary,
                               const std::vector<int>& interior) {
  if (kernel.cols() == 0) return Eigen::MatrixXd(interior.size(), 0);
  Eigen::MatrixXd onBoundary = Eigen::MatrixXd::Zero(boundary.size() + 1, kernel.cols());  // one row even if b is empty
  for (std::size_t k = 0; k < boundary.size(); ++k) onBoundary.row(k) = kernel.row(boundary[k]);
  const RightSvd svd(onBoundary);

  // what the singular values would be if R were spread evenly over all unknowns
  const double even = std::sqrt(double(boundary.size()) / double(kernel.rows()));
  Eigen::Index rank = 0;
  while (rank < svd.values.size() && svd.values[rank] > 1e-9 * even) ++rank;

  const Eigen::MatrixXd unseen = kernel * svd.V.rightCols(kernel.cols() - rank);
  return rowsOf(unseen, interior);
}

}  // namespace

SurfaceSchur::SurfaceSchur(const Eigen::SparseMatrix<double>& K, const Eigen::MatrixXd& kernel,
                       const std::vector<int>& boundary, LocalSolverMethod method, FactorPrecision precision) {
  TEUCHOS_ASSERT(K.rows() == K.cols() && K.rows() == kernel.rows());
  const auto interior = complement(K.rows(), boundary);
  keep(K, boundary, interior, precision);
  if (interior.empty()) return;
  const auto Z = interiorKernel(kernel, boundary, interior);
  interiorKernelSize_ = Z.cols();
  auto Kii = regularizeByFixing(blockOf(K, interior, interior), Z, chooseFixingUnknowns(Z));
  interior_ = std::make_unique<LocalSolverFactor>(std::move(Kii), method, precision);
  interior_->releaseMatrix();
}

SurfaceSchur SurfaceSchur::lumped(const Eigen::SparseMatrix<double>& K, const std::vector<int>& boundary, FactorPrecision precision) {
  SurfaceSchur result;
  result.keep(K, boundary, {}, precision);
  return result;
}

SurfaceSchur::~SurfaceSchur() = default;
SurfaceSchur::SurfaceSchur(SurfaceSchur&&) noexcept = default;

/// Parts of K as they are multiplied by: in double as sparse matrices, in single precision as blocks between nodes.
void SurfaceSchur::keep(const Eigen::SparseMatrix<double>& K, const std::vector<int>& boundary, const std::vector<int>& interior,
                      FactorPrecision precision) {
  size_ = Eigen::Index(boundary.size());
  isSingle_ = precision == FactorPrecision::Single && areWholeNodes(boundary) && areWholeNodes(interior);
  if (isSingle_) keepByNodes(K, boundary, interior);
  else double_ = {blockOf(K, boundary, boundary), blockOf(K, interior, boundary)};
}

/// K_bb / scale and K_ib / scale in single precision, scale = max diag K_bb: their entries are at most about 1 in any units.
void SurfaceSchur::keepByNodes(const Eigen::SparseMatrix<double>& K, const std::vector<int>& boundary, const std::vector<int>& interior) {
  double largest = 0;  // of K_bb, positive semidefinite
  for (int i : boundary) largest = std::max(largest, K.coeff(i, i));
  if (largest > 0) scale_ = largest;
  const std::size_t nodes = std::size_t(K.rows() / 3);
  std::vector<int> onBoundary(nodes, -1), inside(nodes, -1), columns;
  for (std::size_t i = 0; i < boundary.size(); i += 3) {
    onBoundary[std::size_t(boundary[i] / 3)] = int(i / 3);
    columns.push_back(boundary[i] / 3);
  }
  for (std::size_t i = 0; i < interior.size(); i += 3) inside[std::size_t(interior[i] / 3)] = int(i / 3);
  single_.Kbb = NodeBlockMatrix(K, onBoundary, columns, int(columns.size()), scale_, true);
  single_.Kib = NodeBlockMatrix(K, inside, columns, int(interior.size() / 3), scale_, false);
}

Eigen::Index SurfaceSchur::size() const { return size_; }
Eigen::Index SurfaceSchur::interiorKernelSize() const { return interiorKernelSize_; }

/// In blocks of columns: K_ii is solved with at once for each, and memory is bounded.
void SurfaceSchur::apply(const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::Ref<Eigen::MatrixXd> Y) const {
  TEUCHOS_ASSERT(X.rows() == size() && Y.rows() == size() && X.cols() == Y.cols());
  for (Eigen::Index first = 0; first < X.cols(); first += blockWidth) {
    const Eigen::Index width = std::min(blockWidth, X.cols() - first);
    if (isSingle_) applySingle(X.middleCols(first, width), Y.middleCols(first, width));
    else applyDouble(X.middleCols(first, width), Y.middleCols(first, width));
  }
}

/// Y := K_bb X - K_bi K_ii^+ K_ib X; K_ib X lies in the range of K_ii, so any generalised inverse will do.
void SurfaceSchur::applyDouble(const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::Ref<Eigen::MatrixXd> Y) const {
  Y = timesColumns(double_.Kbb.transpose(), X);  // symmetric; sums by columns write nothing but their result
  if (!interior_) return;
  const Eigen::MatrixXd force = timesColumns(double_.Kib, X);
  Eigen::MatrixXd motion(force.rows(), force.cols());
  interior_->solve(force, motion);
  Y -= timesColumns(double_.Kib.transpose(), motion);
}

/// The same, x / unit and f / scale in single precision, each at most about 1; K_ii^+ gets f in its own units.
void SurfaceSchur::applySingle(const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::Ref<Eigen::MatrixXd> Y) const {
  if (X.size() == 0) return;
  const double largest = X.cwiseAbs().maxCoeff(), unit = largest > 0 ? largest : 1.0;
  const Eigen::Index m = X.cols(), inside = interior_ ? interior_->rows() : 0;
  Eigen::MatrixXf x(paddedSize(size()), m), y = Eigen::MatrixXf::Zero(x.rows(), m), f(paddedSize(inside), 1);
  Eigen::MatrixXd force(inside, m), motion(inside, m);
  for (Eigen::Index j = 0; j < m; ++j) {
    pad(X.col(j), 1 / unit, x.col(j));
    single_.Kbb.add(x.col(j).data(), y.col(j).data());
    if (!interior_) continue;
    f.setZero();
    single_.Kib.add(x.col(j).data(), f.data());
    unpad(f.col(0), scale_, force.col(j));
  }
  if (interior_) interior_->solve(force, motion);
  for (Eigen::Index j = 0; j < m; ++j) {
    if (interior_) {
      pad(motion.col(j), 1, f.col(0));
      single_.Kib.subtractTransposed(f.data(), y.col(j).data());
    }
    unpad(y.col(j), scale_ * unit, Y.col(j));
  }
}

/// K_bb(:, c) and K_ib(:, c), in double whatever they are kept in
SurfaceSchur::Parts SurfaceSchur::columns(const std::vector<int>& c) const {
  if (isSingle_) return {single_.Kbb.columns(c), single_.Kib.columns(c)};
  const auto of = [&](const Eigen::SparseMatrix<double>& K) { return blockOf(K, complement(K.rows(), {}), c); };
  return {of(double_.Kbb), of(double_.Kib)};
}

/// K_cc - K_ci K_ii^+ K_ic
Eigen::MatrixXd SurfaceSchur::block(const std::vector<int>& c) const {
  const Parts K = columns(c);
  const Eigen::Index n = Eigen::Index(c.size());
  std::vector<int> position(std::size_t(size()), -1);
  for (Eigen::Index i = 0; i < n; ++i) position[std::size_t(c[std::size_t(i)])] = int(i);
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(K.Kbb, j); it; ++it)
      if (position[std::size_t(it.row())] >= 0) S(position[std::size_t(it.row())], j) = it.value();
  if (interior_) interior_->subtractGram(K.Kib, S);
  return S;
}

Eigen::MatrixXd SurfaceSchur::dense() const {
  std::vector<int> all(std::size_t(size()), 0);
  std::iota(all.begin(), all.end(), 0);
  return block(all);
}

}  // namespace Haptos
