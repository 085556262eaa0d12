// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_LocalSolver.hpp"

#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_FixingNodes.hpp"

namespace Haptos {

namespace {

// Columns solved at once: wide enough for matrix-matrix products, narrow enough to bound the workspace.
constexpr Eigen::Index columnsAtATime = 64;

/// K_reg with all three unknowns of every fixing node.
Eigen::SparseMatrix<double> regularizeOnNodes(const Eigen::SparseMatrix<double>& K, const Eigen::MatrixXd& kernel,
                                              const std::vector<int>& nodes) {
  std::vector<int> unknowns;
  for (const int node : nodes) unknowns.insert(unknowns.end(), {3 * node, 3 * node + 1, 3 * node + 2});
  return regularizeByFixing(K, kernel, unknowns);
}

}  // namespace

LocalSolver::LocalSolver(const Eigen::SparseMatrix<double>& K, const Eigen::MatrixXd& kernel,
                         const std::vector<std::array<double, 3>>& coordinates, LocalSolverMethod method)
    : LocalSolver(K, std::make_shared<const Eigen::MatrixXd>(kernel), coordinates, method) {}

LocalSolver::LocalSolver(const Eigen::SparseMatrix<double>& K, std::shared_ptr<const Eigen::MatrixXd> kernel,
                         const std::vector<std::array<double, 3>>& coordinates, LocalSolverMethod method)
    : kernel_(std::move(kernel)),
      fixingNodes_(chooseFixingNodes(K, *kernel_, coordinates)),
      factor_(regularizeOnNodes(K, *kernel_, fixingNodes_), method) {
  checkKernel(K);
  checkAccuracy();
}

LocalSolver::~LocalSolver() = default;
LocalSolver::LocalSolver(LocalSolver&&) noexcept = default;

/// || K R w || <= 1e-8 || K || for one motion R w: round-off leaves 1e-14, what is no motion of K far more.
void LocalSolver::checkKernel(const Eigen::SparseMatrix<double>& K) const {
  // One motion that has a share of every column: a column of its own each costs six products.
  const Eigen::VectorXd motion = *kernel_ * Eigen::VectorXd::LinSpaced(kernel_->cols(), 1.0, 1.5);
  const double error = (K * motion).norm() / K.norm();
  TEUCHOS_TEST_FOR_EXCEPTION(!(error <= 1e-8), std::runtime_error,
                             "LocalSolver: the kernel given with a subdomain of " << K.rows()
                                 << " unknowns is not in the kernel of its stiffness, |K R| / |K| = " << error);
}

/// A motion without energy that R lacks leaves K_reg singular to round-off; Cholesky may still run through, but
/// then residuals are of the size of the right-hand side.
void LocalSolver::checkAccuracy() const {
  const auto Kreg = factor_.matrix();
  Eigen::VectorXd probe(Kreg.rows()), answer(Kreg.rows());
  for (Eigen::Index i = 0; i < probe.size(); ++i) probe[i] = std::sin(1.0 + 7.0 * double(i) + 0.3 * double(i % 11));
  factor_.solve(probe, answer);
  const double residual = (probe - Kreg * answer).norm() / probe.norm();
  TEUCHOS_TEST_FOR_EXCEPTION(!(residual <= 1e-4), UselessFactor,
                             "LocalSolver: the factor of a subdomain of " << Kreg.rows() << " unknowns and "
                                 << kernel_->cols() << " kernel columns is useless (relative residual " << residual
                                 << "): a motion without energy is missing from its kernel, or its stiffness is too ill-conditioned");
}

void LocalSolver::solve(const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::Ref<Eigen::MatrixXd> X,
                        int refinements) const {
  TEUCHOS_ASSERT(B.rows() == kernel_->rows() && X.rows() == B.rows() && X.cols() == B.cols() && refinements >= 0);
  for (Eigen::Index first = 0; first < B.cols(); first += columnsAtATime) {
    const Eigen::Index width = std::min(columnsAtATime, B.cols() - first);
    solveBlock(B.middleCols(first, width), X.middleCols(first, width), refinements);
  }
}

/// X := (1 - R R^T) K_reg^-1 (1 - R R^T) B.  For balanced B, X = K_reg^-1 B has no rigid part on the fixing nodes: R^T K_reg X = 0
/// is R_f^T N (R_f^T N)^-1 N^T X = N^T X = 0, hence K_reg X = K X.
void LocalSolver::solveBlock(const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::Ref<Eigen::MatrixXd> X,
                             int refinements) const {
  Eigen::MatrixXd balanced = B;
  removeKernel(balanced);
  factor_.solve(balanced, X);
  for (int step = 0; step < refinements; ++step) {
    // Before the projection: K_reg X = K X only while X has no rigid part on the fixing nodes.
    const Eigen::MatrixXd residual = balanced - factor_.matrix() * X;
    Eigen::MatrixXd correction(B.rows(), B.cols());
    factor_.solve(residual, correction);
    X += correction;
  }
  removeKernel(X);
}

/// X := (I - R R^T) X
void LocalSolver::removeKernel(Eigen::Ref<Eigen::MatrixXd> X) const {
  if (kernel_->cols() == 0) return;
  const Eigen::MatrixXd rigid = kernel_->transpose() * X;
  X.noalias() -= *kernel_ * rigid;
}

const Eigen::MatrixXd& LocalSolver::kernel() const { return *kernel_; }
const std::vector<int>& LocalSolver::fixingNodes() const { return fixingNodes_; }
LocalSolverFactor::MatrixView LocalSolver::regularized() const { return factor_.matrix(); }
const char* LocalSolver::methodName() const { return factor_.methodName(); }
std::size_t LocalSolver::factorEntries() const { return factor_.factorEntries(); }
LocalSolverFactor::Counts LocalSolver::counts() const { return factor_.counts(); }

}  // namespace Haptos
