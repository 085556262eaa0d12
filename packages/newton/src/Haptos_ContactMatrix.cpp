// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactMatrix.hpp"

#include <Eigen/LU>
#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Operator.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_ContactKrylov.hpp"
#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_StackedQr.hpp"

namespace Haptos {
namespace {

// Y_i := A_i X_i
template <class Values>
Values multiplyBlocks(const ContactMatrix::Blocks& A, const Values& X) {
  Values Y(X.rows(), X.cols());
  for (std::size_t i = 0; i < A.size(); ++i) Y.template middleRows<3>(3 * Eigen::Index(i)) = A[i] * X.template middleRows<3>(3 * Eigen::Index(i));
  return Y;
}

// L^T with K = L L^T by Cholesky, which keeps the digits of small coefficients: it does not mind how rows are scaled.  What is left of
// a pivot by round-off alone is none.
Eigen::Matrix3d rootOf(const Eigen::Matrix3d& K) {
  constexpr double kRoundOff = 1e-15;
  Eigen::Matrix3d rest = K, root = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) {
    if (!(rest(k, k) > kRoundOff * K(k, k))) continue;
    root.row(k).tail(3 - k) = rest.row(k).tail(3 - k) / std::sqrt(rest(k, k));
    rest -= root.row(k).transpose() * root.row(k);
  }
  return root;
}

// T such that Y T is orthonormal over all ranks; combinations of columns that leave nothing are left out.  Twice, as the first
// time loses the digits of what is small.
Eigen::MatrixXd orthonormalizer(const Communicator& comm, const Eigen::MatrixXd& Y) {
  constexpr double kNothing = 1e-13;
  Eigen::MatrixXd T = Eigen::MatrixXd::Identity(Y.cols(), Y.cols());
  for (int pass = 0; pass < 2 && T.cols() > 0; ++pass) {
    const RightSvd svd(stackedQr(comm, Y * T));
    Eigen::Index rank = 0;
    while (rank < T.cols() && svd.values[rank] > kNothing * svd.values[0]) ++rank;
    T = (T * svd.V.leftCols(rank) * svd.values.head(rank).cwiseInverse().asDiagonal()).eval();
  }
  return T;
}

// (A_i D_i + B_i)^-1; a row without a law and without stiffness stays 0
ContactMatrix::Blocks invertedBlocks(const ContactMatrix::Blocks& A, const ContactMatrix::Blocks& B, const Eigen::VectorXd& diagonal) {
  ContactMatrix::Blocks inverse;
  for (std::size_t i = 0; i < A.size(); ++i) {
    const Eigen::Vector3d D = diagonal.segment<3>(3 * Eigen::Index(i));
    inverse.push_back((A[i] * D.asDiagonal() + B[i]).inverse());
  }
  return inverse;
}

}  // namespace

ContactMatrix::ContactMatrix(Parts parts, const DualVectors& vectors, Kind kind, const SubspaceNewtonOptions::Condensed& options)
    : M_(std::move(parts.M)),
      makeWhole_(std::move(parts.dense)),
      vectors_(vectors),
      diagonal_(std::move(parts.diagonal)),
      kernel_(std::move(parts.kernel)),
      kind_(kind),
      options_(options) {
  for (double& value : diagonal_)
    if (!(value > 0)) value = 1;
  const Eigen::Index mine = 3 * vectors.numPairs();
  Eigen::Index end = 0;
  Teuchos::scan(vectors.comm(), Teuchos::REDUCE_SUM, mine, Teuchos::outArg(end));
  Teuchos::reduceAll(vectors.comm(), Teuchos::REDUCE_SUM, mine, Teuchos::outArg(size_));
  first_ = end - mine;
  if (kind == Kind::Dense) makeDense();
}

// Column j of M is M applied to unit force j, some columns at a time; every rank has its own rows of it, then all have all.
Eigen::MatrixXd ContactMatrix::byColumns() const {
  constexpr Eigen::Index kAtATime = 32;
  const Eigen::Index mine = 3 * vectors_.numPairs();
  Eigen::MatrixXd rows(mine, size_);
  for (Eigen::Index j = 0; j < size_; j += kAtATime) {
    Eigen::MatrixXd units = Eigen::MatrixXd::Zero(mine, std::min(kAtATime, size_ - j));
    for (Eigen::Index k = 0; k < units.cols(); ++k)
      if (j + k >= first_ && j + k < first_ + mine) units(j + k - first_, k) = 1;
    rows.middleCols(j, units.cols()) = vectors_.applyOnContactByColumns(*M_, units);
  }
  return onAllRanks(rows);
}

// Symmetric and without the kernel, as M is but for round-off and the single precision of its parts.
void ContactMatrix::makeDense() const {
  dense_ = makeWhole_ ? makeWhole_() : byColumns();
  dense_ = (0.5 * (dense_ + dense_.transpose())).eval();
  wholeKernel_ = Eigen::MatrixXd(size_, 0);
  if (kernel_.cols() == 0) return;
  wholeKernel_ = onAllRanks(kernel_ * orthonormalizer(vectors_.comm(), kernel_));
  const Eigen::MatrixXd &N = wholeKernel_, MN = dense_ * N;
  dense_ += N * (N.transpose() * MN) * N.transpose() - N * MN.transpose() - MN * N.transpose();
}

// Every rank's rows, in the order of the ranks, by one sum of numbers that are 0 elsewhere.
Eigen::MatrixXd ContactMatrix::onAllRanks(const Eigen::MatrixXd& mine) const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(size_, mine.cols());
  all.middleRows(first_, mine.rows()) = mine;
  vectors_.sum(all);
  return all;
}

Eigen::VectorXd ContactMatrix::multiply(const Eigen::VectorXd& x) const {
  if (dense_.size() == 0) return vectors_.applyOnContact(*M_, x);
  Eigen::VectorXd all = onAllRanks(x);
  all -= wholeKernel_ * (wholeKernel_.transpose() * all);  // bodies that went far would leave round-off of their way
  return dense_.middleRows(first_, x.size()) * all;
}

// The kernel's images are B kernel; T makes them orthonormal.
Eigen::VectorXd ContactMatrix::solve(const Blocks& A, const Blocks& B, const Eigen::VectorXd& b, double tolerance) const {
  const Blocks inverse = invertedBlocks(A, B, diagonal_);
  ContactEquations equations{
      [&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return multiplyBlocks(A, multiply(x)) + multiplyBlocks(B, x); },
      [&](const Eigen::VectorXd& x) { return multiplyBlocks(inverse, x); }, tolerance, options_.linearSteps};
  if (kernel_.cols() > 0) {
    const Eigen::MatrixXd images = multiplyBlocks(B, kernel_), T = orthonormalizer(vectors_.comm(), images);
    equations.known = {kernel_ * T, images * T};
  }
  std::optional<Eigen::VectorXd> direct;
  if (dense_.size() > 0) {
    const Eigen::MatrixXd blocks = blocksOfAll(A, B);
    if (!(direct = solveByLast(equations, blocks, b))) direct = solveDirectly(blocks, b);
    if (direct) return *direct;
  }
  const auto solution = equations.solveByGmres(vectors_, b);
  if (!mayStay(solution)) direct = solveDirectly(blocksOfAll(A, B), b);
  return direct.value_or(solution.x);
}

// The kernel's images are K kernel, K = L L^T; T makes L^T kernel orthonormal.
ContactEquations::Solution ContactMatrix::solveByCg(const Blocks& K, const Eigen::VectorXd& b) const {
  const Blocks inverse = invertedBlocks(Blocks(K.size(), Eigen::Matrix3d::Identity()), K, diagonal_);
  ContactEquations equations{[&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return multiply(x) + multiplyBlocks(K, x); },
                             [&](const Eigen::VectorXd& x) { return multiplyBlocks(inverse, x); }, options_.pathLinearTolerance,
                             options_.linearSteps};
  if (kernel_.cols() > 0) {
    Blocks roots;
    for (const auto& Ki : K) roots.push_back(rootOf(Ki));
    const Eigen::MatrixXd motions = kernel_ * orthonormalizer(vectors_.comm(), multiplyBlocks(roots, kernel_));
    equations.known = {motions, multiplyBlocks(K, motions)};
  }
  return equations.solveByCg(vectors_, b);
}

// Where Cholesky's method is no good for the matrix LU may be.
Eigen::VectorXd ContactMatrix::Symmetric::solve(const Eigen::VectorXd& b) {
  std::optional<ContactEquations::Solution> byCg;
  if (M_.dense_.size() == 0) {
    byCg = M_.solveByCg(K_, b);
    if (M_.mayStay(*byCg)) return byCg->x;
  }
  const auto blocks = [&] { return M_.blocksOfAll(Blocks(K_.size(), Eigen::Matrix3d::Identity()), K_); };  // collective: a factor has them
  const Eigen::VectorXd all = M_.onAllRanks(b);
  if (!factor_) factor_ = std::make_unique<const ContactFactor>(M_.dense_, M_.wholeKernel_, blocks(), ContactFactor::Shape::Symmetric);
  const Eigen::VectorXd x = factor_->solve(all);
  if (factor_->isSolution(x, all)) return x.segment(M_.first_, b.size());
  const auto direct = M_.solveDirectly(blocks(), b);
  return direct ? *direct : byCg ? byCg->x : M_.solveByCg(K_, b).x;
}

// A Krylov method that does not get there leaves Newton's steps without direction, and costs its products each time: the dense matrix
// is made then, which costs a product a row once.  So it is where products of solves have cost as much and a factorisation is cheaper.
bool ContactMatrix::mayStay(const ContactEquations::Solution& solution) const {
  if (dense_.size() > 0 || size_ > options_.rowsOfStep * options_.linearSteps) return true;
  products_ += solution.products;
  ++solves_;
  const bool isDear = products_ > size_ && options_.rowsOfStep * products_ > size_ * solves_;
  if (solution.isConverged && !isDear) return true;
  makeDense();
  return solution.isConverged;
}

Eigen::VectorXd ContactMatrix::kernelPart(const Eigen::VectorXd& x) const {
  const Eigen::Index k = kernel_.cols();
  if (k == 0) return Eigen::VectorXd::Zero(x.size());
  Eigen::MatrixXd sums(k, k + 1);
  sums << kernel_.transpose() * kernel_, kernel_.transpose() * x;
  vectors_.sum(sums);
  return kernel_ * solveLeastSquares(sums.leftCols(k), sums.rightCols(1));
}

// [all contact values x 6] row by row A_i and B_i, the same on every rank
Eigen::MatrixXd ContactMatrix::blocksOfAll(const Blocks& A, const Blocks& B) const {
  Eigen::MatrixXd mine(3 * Eigen::Index(A.size()), 6);
  for (std::size_t i = 0; i < A.size(); ++i) mine.middleRows<3>(3 * Eigen::Index(i)) << A[i], B[i];
  return onAllRanks(mine);
}

// The same system on every rank, from the pairs of all.  A singular one (motions that nothing holds) has no solution but what a Krylov method
// comes to, or that of least norm where there is none.
std::optional<Eigen::VectorXd> ContactMatrix::solveDirectly(const Eigen::MatrixXd& blocks, const Eigen::VectorXd& b) const {
  const Eigen::VectorXd all = onAllRanks(b);
  Eigen::VectorXd x;
  const auto isSolvedBy = [&](const ContactFactor& factor) { return factor.isSolution(x = factor.solve(all), all); };
  auto factor = factorByForces(blocks);
  const bool isTried = factor != nullptr;
  bool isSolved = isTried && isSolvedBy(*factor);
  if (!isSolved) {
    factor = std::make_unique<const ContactFactor>(dense_, wholeKernel_, blocks, ContactFactor::Shape::General);
    isSolved = isSolvedBy(*factor);
    if (isTried && isSolved) isCompliant_ = false;  // it was not the matrix that is singular
  }
  if (isSolved) last_ = std::move(factor);
  else if (kind_ == Kind::Products) return {};
  else x = factor->solveLeastSquares(all);
  return x.segment(first_, b.size());
}

// Once the set of what slips has settled a factor serves many steps.  Collective.
std::optional<Eigen::VectorXd> ContactMatrix::solveByLast(ContactEquations equations, const Eigen::MatrixXd& blocks, const Eigen::VectorXd& b) const {
  if (!last_ || last_->numChanged(blocks) > options_.changedPairs) return {};
  equations.preconditioner = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return last_->solve(onAllRanks(x)).segment(first_, x.size()); };
  equations.steps = options_.stepsByLast;
  const auto solution = equations.solveByGmres(vectors_, b);
  if (!solution.isConverged) return {};
  return solution.x;
}

// Null where there is no use for one.  The inverse costs as much as one and a half LU of all rows.
std::unique_ptr<const ContactFactor> ContactMatrix::factorByForces(const Eigen::MatrixXd& blocks) const {
  if (!isCompliant_ || !ContactFactor::isSmallerByForces(blocks)) return {};
  makeCompliance();
  return std::make_unique<const ContactFactor>(dense_, wholeKernel_, compliance_, blocks);
}

// With S = diag(M)^-1/2, M^+ is taken as S (S M S)^+ S, whose rank does not depend on the stiffness of a pair; rows of which M has nothing
// are pinned, or not there.
void ContactMatrix::makeCompliance() const {
  constexpr double kFree = 1e-10;  // of the largest eigenvalue: rigid motions
  if (compliance_.size() > 0) return;
  std::vector<Eigen::Index> felt;
  for (Eigen::Index row = 0; row < size_; ++row)
    if (dense_(row, row) > 0) felt.push_back(row);
  const Eigen::VectorXd diagonal = dense_.diagonal()(felt), S = diagonal.cwiseSqrt().cwiseInverse();
  const PivotedQr motions(diagonal.cwiseSqrt().asDiagonal() * wholeKernel_(felt, Eigen::all));
  const Eigen::MatrixXd inverse = pseudoInverse(S.asDiagonal() * dense_(felt, felt) * S.asDiagonal(), motions.Q.leftCols(Eigen::Index(motions.columns.size())), kFree);
  compliance_ = Eigen::MatrixXd::Zero(size_, size_);
  compliance_(felt, felt) = S.asDiagonal() * inverse * S.asDiagonal();
}

// 1 / (M^+)_ii: with M^-1 in the place of F, (M^-1)_ii is what pair i opens under a unit force, no force at the others.
Eigen::VectorXd ContactMatrix::normalStiffness() const {
  makeCompliance();
  Eigen::VectorXd stiffness = Eigen::VectorXd::Zero(vectors_.numPairs());
  for (Eigen::Index i = 0; i < stiffness.size(); ++i) {
    const Eigen::Index row = first_ + 3 * i;
    if (const double compliance = compliance_(row, row); compliance > 0) stiffness[i] = 1 / compliance;
  }
  return stiffness;
}

}  // namespace Haptos
