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
      makeSmooth_(std::move(parts.smooth)),
      findGroups_(std::move(parts.groups)),
      ofGroups_(std::move(parts.ofGroups)),
      vectors_(vectors),
      numbering_(vectors),
      diagonal_(std::move(parts.diagonal)),
      kernel_(std::move(parts.kernel)),
      kind_(kind),
      options_(options) {
  for (double& value : diagonal_)
    if (!(value > 0)) value = 1;
  if (parts.exact.isThere()) exact_.emplace(std::move(parts.exact), vectors_, diagonal_);
  const double n = double(numbering_.size());
  entriesRead_ = parts.entriesRead > 0 ? parts.entriesRead : n * n;
  productsOfFactor_ = n > 0 ? n * n * n / (options.rowsOfStep * entriesRead_) : 0.0;
  const double perEntry = n > options.rowsInCache ? options.readFromMemory : 1.0;
  isCheaperDense_ = 2 * parts.entriesRead > perEntry * n * n;
  if (kind == Kind::Dense) makeDirect();
}

// M times `count` columns, `columns(first, width)` of them at a time
Eigen::MatrixXd ContactMatrix::multiplyColumns(Eigen::Index count, const std::function<Eigen::MatrixXd(Eigen::Index, Eigen::Index)>& columns) const {
  constexpr Eigen::Index kAtATime = 32;
  Eigen::MatrixXd result(3 * vectors_.numPairs(), count);
  for (Eigen::Index j = 0; j < count; j += kAtATime) {
    const Eigen::Index width = std::min(kAtATime, count - j);
    if (dense_.size() > 0) result.middleCols(j, width) = dense_.middleRows(numbering_.first(), result.rows()) * onAllRanks(columns(j, width));
    else result.middleCols(j, width) = scaling_ * vectors_.applyOnContactByColumns(*M_, columns(j, width));
  }
  return result;
}

// Column j of M is M applied to unit force j; every rank has its own rows of it, then all have all.
Eigen::MatrixXd ContactMatrix::byColumns() const {
  const Eigen::Index mine = numbering_.mine();
  return onAllRanks(multiplyColumns(numbering_.size(), [&](Eigen::Index j, Eigen::Index width) {
    Eigen::MatrixXd units = Eigen::MatrixXd::Zero(mine, width);
    for (Eigen::Index k = 0; k < width; ++k)
      if (j + k >= numbering_.first() && j + k < numbering_.first() + mine) units(j + k - numbering_.first(), k) = 1;
    return units;
  }));
}

void ContactMatrix::scale(double factor) {
  scaling_ *= factor;
  diagonal_ *= factor;
  dense_ *= factor;
  compliance_ /= factor;
  last_.reset();
  if (coarse_) keepCoarse(coarse_->scaled(factor));
}

Eigen::MatrixXd ContactMatrix::multiplyMany(const Eigen::MatrixXd& X) const {
  return multiplyColumns(X.cols(), [&X](Eigen::Index j, Eigen::Index width) -> Eigen::MatrixXd { return X.middleCols(j, width); });
}

// Motions of the kernel are solved for by themselves.
void ContactMatrix::makeCoarse() const {
  keepCoarse({vectors_, makeSmooth_(), diagonal_, kernel_, [this](const Eigen::MatrixXd& X) { return multiplyMany(X); }});
}

void ContactMatrix::keepCoarse(ContactCoarse coarse) const {
  coarse_ = std::make_unique<const ContactCoarse>(std::move(coarse));
  twoLevel_ = std::make_unique<TwoLevelPreconditioner>(
      *coarse_, [this](const Eigen::MatrixXd& X) { return multiplyMany(X); }, [this](const Eigen::MatrixXd& X) { return groups_->apply(X); });
  isCoarseReady_ = false;
}

void ContactMatrix::makeDense() const {
  if (dense_.size() > 0) return;
  keepDense(makeWhole_ ? Eigen::MatrixXd(scaling_ * makeWhole_()) : byColumns());
}

// For factors.
void ContactMatrix::makeDirect() const {
  makeDense();
  isDirect_ = true;
}

// Half of a dense symmetric matrix is read by a product; it is made where more than that has been read long enough to pay for it.
void ContactMatrix::makeDenseForProducts() const {
  if (isCheaperDense_ && options_.productsOfRow * products_ > numbering_.size()) makeDense();
}

// Symmetric and without the kernel, as M is but for round-off and the single precision of its parts.
void ContactMatrix::keepDense(const Eigen::MatrixXd& matrix) const {
  dense_ = 0.5 * (matrix + matrix.transpose());
  wholeKernel_ = Eigen::MatrixXd(numbering_.size(), 0);
  if (kernel_.cols() == 0) return;
  wholeKernel_ = onAllRanks(kernel_ * orthonormalizer(vectors_.comm(), kernel_));
  const Eigen::MatrixXd &N = wholeKernel_, MN = dense_ * N;
  dense_ += N * (N.transpose() * MN) * N.transpose() - N * MN.transpose() - MN * N.transpose();
}

Eigen::VectorXd ContactMatrix::multiply(const Eigen::VectorXd& x) const {
  if (exact_) {
    const Eigen::VectorXd* known = exact_->productOfLast(x);
    return scaling_ * (known ? *known : exact_->multiply(x - kernelPart(x)));
  }
  if (dense_.size() == 0) return scaling_ * vectors_.applyOnContact(*M_, x);
  Eigen::VectorXd all = onAllRanks(x);
  all -= wholeKernel_ * (wholeKernel_.transpose() * all);  // bodies that went far would leave round-off of their way
  if (x.size() == numbering_.size()) return symmetricTimes(dense_, all);
  return dense_.middleRows(numbering_.first(), x.size()) * all;
}

Eigen::VectorXd ContactMatrix::solve(const Blocks& A, const Blocks& B, const Eigen::VectorXd& b, double tolerance) const {
  const Eigen::MatrixXd free = freeMotions(B);
  return withoutFree(free, solveAny(A, B, free, b, tolerance));
}

// Of the kernel, that B does not feel either (a coefficient 0, open pairs).
Eigen::MatrixXd ContactMatrix::freeMotions(const Blocks& B) const {
  if (kernel_.cols() == 0) return Eigen::MatrixXd(kernel_.rows(), 0);
  return kernel_ * MotionsOfB(stackedQr(vectors_.comm(), multiplyBlocks(B, kernel_))).free;
}

// They stay where they are: a solution may have any of them.
Eigen::VectorXd ContactMatrix::withoutFree(const Eigen::MatrixXd& free, Eigen::VectorXd d) const {
  if (free.cols() > 0) d -= partIn(free, d);
  return d;
}

// b without what no solution can give, where motions N are free: Y with A^T Y = N and B^T Y = 0 has Y^T (A M + B) = N^T M = 0.  Krylov methods end
// by their bound with it, and least squares take as much.
Eigen::VectorXd ContactMatrix::consistentPart(const Blocks& A, const Blocks& B, const Eigen::MatrixXd& N, const Eigen::VectorXd& b) const {
  constexpr double kNothing = 1e-8;
  if (N.cols() == 0) return b;
  Eigen::MatrixXd Y(N.rows(), N.cols());
  Eigen::Vector4d sums = Eigen::Vector4d::Zero();  // squares of A^T Y - N, N, B^T Y, Y
  for (Eigen::Index at = 0; at < N.rows(); at += 3) {
    const Eigen::Matrix3d &Ai = A[std::size_t(at / 3)], &Bi = B[std::size_t(at / 3)];
    const Eigen::MatrixXd Ni = N.middleRows<3>(at);
    for (Eigen::Index j = 0; j < N.cols(); ++j) Y.col(j).segment<3>(at) = solveLeastSquares(Ai.transpose(), Ni.col(j));
    const auto Yi = Y.middleRows<3>(at);
    sums += Eigen::Vector4d((Ai.transpose() * Yi - Ni).squaredNorm(), Ni.squaredNorm(), (Bi.transpose() * Yi).squaredNorm(), Yi.squaredNorm());
  }
  vectors_.sum(sums);
  constexpr double kSquare = kNothing * kNothing;
  if (sums[0] > kSquare * sums[1] || sums[2] > kSquare * sums[3]) return b;
  const Eigen::VectorXd left = b - partIn(Y, b);
  return vectors_.norm(left) > kNothing * vectors_.norm(b) ? left : Eigen::VectorXd(Eigen::VectorXd::Zero(b.size()));
}

// The kernel's images are B kernel; T makes them orthonormal.
ContactEquations ContactMatrix::generalEquations(const Blocks& A, const Blocks& B, double tolerance) const {
  ContactEquations equations{
      [this, &A, &B](const Eigen::VectorXd& x) -> Eigen::VectorXd { return multiplyBlocks(A, multiply(x)) + multiplyBlocks(B, x); },
      [inverse = invertedBlocks(A, B, diagonal_)](const Eigen::VectorXd& x) { return multiplyBlocks(inverse, x); }, tolerance, options_.linearSteps};
  if (kernel_.cols() > 0) {
    const Eigen::MatrixXd images = multiplyBlocks(B, kernel_), T = orthonormalizer(vectors_.comm(), images);
    equations.known = {kernel_ * T, images * T};
  }
  return equations;
}

Eigen::VectorXd ContactMatrix::solveAny(const Blocks& A, const Blocks& B, const Eigen::MatrixXd& free, const Eigen::VectorXd& b, double tolerance) const {
  if (exact_) return solveExactly(A, B, consistentPart(A, B, free, b), tolerance);
  const Eigen::VectorXd possible = isDirect_ ? b : consistentPart(A, B, free, b);
  while (!isDirect_) {
    auto solution = groups_ ? solveByGroups(A, B, possible, tolerance) : generalEquations(A, B, tolerance).solveByGmres(vectors_, possible);
    if (mayStay(solution, Method::Gmres)) return std::move(solution.x);
  }
  const ContactEquations equations = generalEquations(A, B, tolerance);
  const Eigen::MatrixXd blocks = numbering_.blocksOfAll(A, B);
  auto direct = solveByLast(equations, blocks, b);
  if (!direct) direct = solveDirectly(blocks, b);
  return direct ? *direct : equations.solveByGmres(vectors_, b).x;
}

// A scaling M + B is A M + B of another A.
Eigen::VectorXd ContactMatrix::solveExactly(const Blocks& A, const Blocks& B, const Eigen::VectorXd& b, double tolerance) const {
  Blocks scaled = A;
  for (Eigen::Matrix3d& block : scaled) block *= scaling_;
  ContactEquations equations = generalEquations(A, B, tolerance);
  exact_->prepare(equations, scaled, B);
  return equations.solveByGmres(vectors_, b).x;
}

// Coarse jumps that were made for another law serve this one as well, by more steps: they are made anew once these have cost as much as that.
ContactEquations::Solution ContactMatrix::solveByGroups(const Blocks& A, const Blocks& B, const Eigen::VectorXd& b, double tolerance) const {
  ContactEquations equations = generalEquations(A, B, tolerance);
  groups_->renew(scaling_, numbering_.blocksOfAll(A, B));
  equations.preconditioner = [this](const Eigen::VectorXd& r) { return coarse_ ? twoLevel_->apply(r) : Eigen::VectorXd(groups_->apply(r)); };
  if (!coarse_) return equations.solveByGmres(vectors_, b);
  int inVain = 0;
  if (const double most = stepsOfRenewal() - moreSteps_; isCoarseReady_ && most > 0) {
    equations.steps = int(std::min(freshSteps_ + most, double(options_.linearSteps)));
    auto solution = equations.solveByGmres(vectors_, b);
    if (solution.isConverged) {
      moreSteps_ += std::max(0, solution.products - freshSteps_);
      return solution;
    }
    inVain = solution.products;
    equations.steps = options_.linearSteps;
  }
  twoLevel_->renew(A, B, invertedBlocks(A, B, diagonal_));
  isCoarseReady_ = true;
  auto solution = equations.solveByGmres(vectors_, b);
  freshSteps_ = solution.products;
  moreSteps_ = 0;
  solution.products += inVain;
  return solution;
}

// By what both read, and 40 operations of a matrix product in the time of an entry read (decisions/040).
double ContactMatrix::stepsOfRenewal() const {
  constexpr double kOperations = 40;
  const double n = double(numbering_.size()), k = double(coarse_->Q().cols()), groups = groups_->entriesRead();
  return 2 * k * (n * k + groups) / kOperations / (entriesOfProduct() + groups);
}

// (M + K) d = b by conjugate gradients.  The kernel's images are K kernel, K = L L^T; T makes L^T kernel orthonormal.
ContactEquations ContactMatrix::symmetricEquations(const Blocks& K) const {
  ContactEquations equations{[this, &K](const Eigen::VectorXd& x) -> Eigen::VectorXd { return multiply(x) + multiplyBlocks(K, x); },
                             [inverse = invertedBlocks(Blocks(K.size(), Eigen::Matrix3d::Identity()), K, diagonal_)](const Eigen::VectorXd& x) {
                               return multiplyBlocks(inverse, x);
                             },
                             options_.pathLinearTolerance, options_.linearSteps};
  if (kernel_.cols() > 0) {
    Blocks roots;
    for (const auto& Ki : K) roots.push_back(rootOf(Ki));
    const Eigen::MatrixXd motions = kernel_ * orthonormalizer(vectors_.comm(), multiplyBlocks(roots, kernel_));
    equations.known = {motions, multiplyBlocks(K, motions)};
  }
  if (coarse_) coarse_->appendTo(equations.known, K);
  if (!symmetricGroups_) return equations;
  symmetricGroups_->renew(scaling_, numbering_.blocksOfAll(Blocks(K.size(), Eigen::Matrix3d::Identity()), K));
  equations.preconditioner = [this](const Eigen::VectorXd& r) -> Eigen::VectorXd { return symmetricGroups_->apply(r); };
  return equations;
}

Eigen::VectorXd ContactMatrix::Symmetric::solve(const Eigen::VectorXd& b) { return M_.withoutFree(M_.freeMotions(K_), solveAny(b)); }

// (M + K / scaling) d = b / scaling.  Motions that nothing resists have no factor: conjugate gradients with one that lets them resist a little.
Eigen::VectorXd ContactMatrix::Symmetric::solveExactly(const Eigen::VectorXd& b) {
  Blocks K = K_;
  for (Eigen::Matrix3d& block : K) block /= M_.scaling_;
  if (!exact_) exact_ = M_.exact_->solverWith(K);
  const Eigen::VectorXd d = exact_(b / M_.scaling_);
  if (M_.vectors_.sum(double(!d.allFinite())) == 0) return d;
  ContactEquations equations = M_.symmetricEquations(K_);
  equations.preconditioner = M_.exact_->solverNear(K);
  exact_ = {};
  return equations.solveByCg(M_.vectors_, b).x;
}

// Where Cholesky's method is no good for the matrix LU may be.
Eigen::VectorXd ContactMatrix::Symmetric::solveAny(const Eigen::VectorXd& b) {
  if (M_.exact_) return solveExactly(b);
  std::optional<ContactEquations::Solution> byCg;
  while (!M_.isDirect_) {
    if (!equations_ || helped_ != M_.helpers()) equations_ = M_.symmetricEquations(K_), helped_ = M_.helpers();
    byCg = equations_->solveByCg(M_.vectors_, b);
    if (M_.makeSymmetricGroups(byCg->products) && !byCg->isConverged) continue;
    if (M_.mayStay(*byCg, Method::Cg)) return byCg->x;
  }
  const auto blocks = [&] { return M_.numbering_.blocksOfAll(Blocks(K_.size(), Eigen::Matrix3d::Identity()), K_); };  // collective: a factor has them
  const Eigen::VectorXd all = M_.onAllRanks(b);
  if (!factor_) factor_ = std::make_unique<const ContactFactor>(M_.dense_, M_.wholeKernel_, blocks(), ContactFactor::Shape::Symmetric);
  const Eigen::VectorXd x = factor_->solve(all);
  if (factor_->isSolution(x, all)) return x.segment(M_.numbering_.first(), b.size());
  const auto direct = M_.solveDirectly(blocks(), b);
  return direct ? *direct : byCg ? byCg->x : M_.symmetricEquations(K_).solveByCg(M_.vectors_, b).x;
}

// A Krylov method that does not get there leaves Newton's steps without direction, and costs its products each time.
bool ContactMatrix::mayStay(const ContactEquations::Solution& solution, Method method) const {
  if (isDirect_) return true;
  products_ += solution.products;
  ++solves_;
  makeDenseForProducts();
  if (!makeMore(solution.isConverged, method)) return true;
  products_ = solves_ = numLost_ = 0;
  return solution.isConverged;
}

// For GMRES groups first, then coarse jumps beside them; these first for conjugate gradients.  Where neither helps, or rows are few, the dense matrix,
// which costs a product a row once.  Returns whether anything was made.
bool ContactMatrix::makeMore(bool isConverged, Method method) const {
  const double mean = double(products_) / double(solves_);
  const bool isMany = numbering_.size() >= options_.groupRows;
  numLost_ = isConverged ? 0 : numLost_ + 1;
  if (method == Method::Gmres && !groups_ && findGroups_ && isMany) {
    if (!isConverged || areGroupsCheaper(mean)) makeGroups();
    return groups_ != nullptr;
  }
  if (!coarse_ && makeSmooth_ && isMany) {
    if (!isConverged || (products_ > options_.coarseProducts && mean > options_.coarseSteps)) makeCoarse();
    return coarse_ != nullptr;
  }
  const bool isLost = coarse_ ? numLost_ >= options_.coarseTrials : !isConverged;
  const bool isDear = !groups_ && !coarse_ && products_ > numbering_.size() && mean > productsOfFactor_;
  if ((isLost || isDear) && numbering_.size() <= options_.rowsOfStep * options_.linearSteps) makeDirect();
  return isDirect_;
}

// Parts of the matrix cost nothing beside it.
void ContactMatrix::makeGroups() const {
  if (isCheaperDense_ || !ofGroups_) makeDense();
  auto members = findGroups_();
  if (dense_.size() > 0) {
    groups_ = std::make_unique<SchwarzPreconditioner>(numbering_, members, dense_ / scaling_);
    return;
  }
  auto M = ofGroups_(members);
  groups_ = std::make_unique<SchwarzPreconditioner>(numbering_, SchwarzPreconditioner::Groups{std::move(members), std::move(M)});
}

double ContactMatrix::entriesOfProduct() const { return dense_.size() > 0 ? 0.5 * double(dense_.size()) : entriesRead_; }

// By what products read: a solve as much as factors of groups take, and all of them as much as groups do.
bool ContactMatrix::areGroupsCheaper(double steps) const {
  const double n = double(numbering_.size()), product = entriesOfProduct();
  return steps * product > options_.groupFactor * n && double(products_) * product > options_.groupSetUp * n;
}

// Where groups are at hand, and conjugate gradients with coarse jumps alone read as much as their factors take.  Returns whether they were made.
bool ContactMatrix::makeSymmetricGroups(double steps) const {
  if (symmetricGroups_ || !groups_ || !(steps * entriesOfProduct() > options_.groupFactor * double(numbering_.size()))) return false;
  symmetricGroups_ = std::make_unique<SchwarzPreconditioner>(groups_->withForm(SchwarzPreconditioner::Form::Symmetric));
  return true;
}

Eigen::VectorXd ContactMatrix::kernelPart(const Eigen::VectorXd& x) const {
  if (kernel_.cols() == 0) return Eigen::VectorXd::Zero(x.size());
  return partIn(kernel_, x);
}

Eigen::VectorXd ContactMatrix::partIn(const Eigen::MatrixXd& motions, const Eigen::VectorXd& x) const {
  const Eigen::Index k = motions.cols();
  Eigen::MatrixXd sums(k, k + 1);
  sums << motions.transpose() * motions, motions.transpose() * x;
  vectors_.sum(sums);
  return motions * solveLeastSquares(sums.leftCols(k), sums.rightCols(1));
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
    if (isTried && isSolved && !factor->hasFree()) isCompliant_ = false;  // it was not the matrix that is singular
  }
  if (isSolved) last_ = std::move(factor);
  else if (kind_ == Kind::Products) return {};
  else x = factor->solveLeastSquares(all);
  return x.segment(numbering_.first(), b.size());
}

// Once the set of what slips has settled a factor serves many steps.  What is free now goes so far by one that was made when it was held that
// what GMRES knows of the residual is round-off of its way.  Collective.
std::optional<Eigen::VectorXd> ContactMatrix::solveByLast(ContactEquations equations, const Eigen::MatrixXd& blocks, const Eigen::VectorXd& b) const {
  if (!last_ || last_->numChanged(blocks) > options_.changedPairs) return {};
  equations.preconditioner = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return last_->solve(onAllRanks(x)).segment(numbering_.first(), x.size()); };
  equations.steps = options_.stepsByLast;
  const auto solution = equations.solveByGmres(vectors_, b);
  if (!solution.isConverged || vectors_.norm(b - equations.matrix(solution.x)) > 2 * equations.tolerance * vectors_.norm(b)) return {};
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
  for (Eigen::Index row = 0; row < numbering_.size(); ++row)
    if (dense_(row, row) > 0) felt.push_back(row);
  const Eigen::VectorXd diagonal = dense_.diagonal()(felt), S = diagonal.cwiseSqrt().cwiseInverse();
  const PivotedQr motions(diagonal.cwiseSqrt().asDiagonal() * wholeKernel_(felt, Eigen::all));
  const Eigen::MatrixXd inverse = pseudoInverse(S.asDiagonal() * dense_(felt, felt) * S.asDiagonal(), motions.Q.leftCols(Eigen::Index(motions.columns.size())), kFree);
  compliance_ = Eigen::MatrixXd::Zero(numbering_.size(), numbering_.size());
  compliance_(felt, felt) = S.asDiagonal() * inverse * S.asDiagonal();
}

// 1 / (M^+)_ii: with M^-1 in the place of F, (M^-1)_ii is what pair i opens under a unit force, no force at the others.
Eigen::VectorXd ContactMatrix::normalStiffness() const {
  makeCompliance();
  Eigen::VectorXd stiffness = Eigen::VectorXd::Zero(vectors_.numPairs());
  for (Eigen::Index i = 0; i < stiffness.size(); ++i) {
    const Eigen::Index row = numbering_.first() + 3 * i;
    if (const double compliance = compliance_(row, row); compliance > 0) stiffness[i] = 1 / compliance;
  }
  return stiffness;
}

}  // namespace Haptos
