// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CoarseProblem.hpp"

#include <Teuchos_Comm.hpp>
#include <algorithm>
#include <chrono>
#include <climits>

#include "Haptos_CoarseSchurFactor.hpp"
#include "Haptos_CoarseTree.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

// Adds what a scope lasts and sends to the costs.
class Measured {
 public:
  Measured(double& seconds, CommunicationCounts& sent) : seconds_(seconds), sent_(sent) {}
  ~Measured() {
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    sent_ += communicationSoFar() - before_;
  }

 private:
  double& seconds_;
  CommunicationCounts& sent_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  CommunicationCounts before_ = communicationSoFar();
};

// Those with a diagonal block: every row that touches a subdomain adds to that.
std::vector<int> subdomainsOf(const CoarseBlocks& blocks) {
  std::vector<int> subdomains;
  for (const auto& [key, block] : blocks.blocks())
    if (CoarseBlocks::row(key) == CoarseBlocks::column(key)) subdomains.push_back(CoarseBlocks::row(key));
  std::sort(subdomains.begin(), subdomains.end());
  return subdomains;
}

// Of positive semidefinite matrices.
double largestDiagonalOfSum(const CoarseBlocks& a, const CoarseBlocks& b) {
  double largest = a.largestDiagonal();
  for (const auto& [key, block] : b.blocks()) {
    if (CoarseBlocks::row(key) != CoarseBlocks::column(key)) continue;
    const auto other = a.blocks().find(key);
    for (std::size_t i = 0; i < block.size(); i += kCoarseModes + 1)
      largest = std::max(largest, block[i] + (other == a.blocks().end() ? 0.0 : other->second[i]));
  }
  return largest;
}

std::size_t blocksOfSum(const CoarseBlocks& a, const CoarseBlocks& b) {
  std::size_t size = a.size();
  for (const auto& [key, block] : b.blocks()) size += a.blocks().count(key) == 0;
  return size;
}

}  // namespace

CoarseProblem::CoarseProblem(Placement placement, const CoarseRows& C, const std::vector<double>& q, const Holds& holds)
    : placement_(std::move(placement)), size_(C.cols()) {
  const Measured measured(placement_->costs().setUpSeconds, placement_->costs().setUpSent);
  fixed_ = std::make_shared<const CoarseBlocks>(sumUp({C, q}));
  countBlocks({});
  addHolds(holds, largestDiagonalWith({}));
  factor({});
}

CoarseProblem::CoarseProblem(Placement placement, const Weighted& fixed, const Weighted& changing, const Holds& holds, Factor when)
    : placement_(std::move(placement)), size_(fixed.rows.cols()) {
  const Measured measured(placement_->costs().setUpSeconds, placement_->costs().setUpSent);
  fixed_ = std::make_shared<const CoarseBlocks>(sumUp(fixed));
  CoarseBlocks first = sumUp(changing);
  addHolds(holds, largestDiagonalWith(first));
  countBlocks(first);
  changing_ = subdomainsOf(first);
  if (placement_->isShared()) changing_ = gatheredOnAll(placement_->comm(), changing_);  // owners' ranges ascend
  Eigen::MatrixXd condenses(1, 1);
  condenses(0, 0) = CoarseSchur::pays(paddedSize(), kCoarseModes * Eigen::Index(changing_.size()));
  placement_->broadcast(condenses);
  condenses_ = condenses(0, 0) != 0;
  if (!condenses_ && !placement_->isShared()) matrix_ = CoarseMatrix({fixed_.get(), &first, &held_}, paddedSize());
  if (when == Factor::WithRoughRenewal) precision_ = FactorPrecision::Single;
  if (when == Factor::Now) factor(std::move(first));
}

// A = A_fixed + E + holds: without E and with the same holds (none) S of A_fixed on the changing subdomains is what the whole
// problem started from, so the elimination is shared and only S itself is factored.  Else it is a matrix of its own.
CoarseProblem::CoarseProblem(const CoarseProblem& whole, const Holds& holds)
    : placement_(whole.placement_), size_(whole.size_), fixed_(whole.fixed_) {
  const Measured measured(placement_->costs().setUpSeconds, placement_->costs().setUpSent);
  addHolds(holds, largestDiagonalWith({}));
  condenses_ = whole.condenses_ && holds.empty() && !whole.isHeld_;
  if (condenses_ && whole.condensed_) condensed_ = std::make_unique<CoarseSchurFactor>(whole.condensed_->schur(), precision_);
  if (condenses_ && whole.shared_) shared_ = std::make_unique<CoarseTreeFactor>(whole.shared_->tree());
  factor({});
}

CoarseProblem::~CoarseProblem() = default;

// Of the fixed rows and `first`; on the holders, or on all ranks where these have parts.
double CoarseProblem::largestDiagonalWith(const CoarseBlocks& first) const {
  const double mine = largestDiagonalOfSum(*fixed_, first);
  return placement_->isShared() ? largestOfAll(placement_->comm(), mine) : mine;
}

// Of the first matrix of a run.
void CoarseProblem::countBlocks(const CoarseBlocks& first) const {
  CoarseCosts& costs = placement_->costs();
  if (costs.setUps > 0 || !placement_->holds()) return;
  const auto mine = (long long)(blocksOfSum(*fixed_, first));
  costs.blocks = std::size_t(placement_->isShared() ? sumOfAll(placement_->comm(), mine) : mine);
}

CoarseBlocks CoarseProblem::sumUp(const Weighted& part) const {
  return CoarseBlocks(part.rows, part.q).onHolders(*placement_, paddedSize() / kCoarseModes);
}

// At least six: without equalities there is a matrix all the same.
Eigen::Index CoarseProblem::paddedSize() const { return (std::max<Eigen::Index>(size_, 1) + kCoarseModes - 1) / kCoarseModes * kCoarseModes; }

// With zeros for the unknowns that fill the last six, which the matrix keeps apart.
Eigen::MatrixXd CoarseProblem::padded(Eigen::MatrixXd b) const {
  if (paddedSize() == size_) return b;
  b.conservativeResize(paddedSize(), Eigen::NoChange);
  b.bottomRows(paddedSize() - size_).setZero();
  return b;
}

// + scale w w^T: large enough to hold, not so large that it hides the rest; the largest diagonal entry is the natural unit.
void CoarseProblem::addHolds(const Holds& holds, double scale) {
  Holds all = holds;
  for (Eigen::Index i = size_; i < paddedSize(); ++i) {  // a unit vector each: 1 on the diagonal, nothing beside it
    all.emplace_back(paddedSize());
    all.back().insert(i) = 1;
  }
  const bool adds = !placement_->isShared() || placement_->comm().getRank() == 0;  // once
  if (adds) held_.add(CoarseBlocks(all), scale > 0 ? scale : 1.0);                 // 0: no row at all
  isHeld_ = !holds.empty();
}

CoarseProblem::CoarseProblem(const Communicator& comm, const CoarseRows& C, const std::vector<double>& q, const Holds& holds)
    : CoarseProblem(std::make_shared<CoarsePlacement>(Teuchos::rcpFromRef(comm), C.cols(), CoarseOptions{INT_MAX, 1}), C, q, holds) {}

void CoarseProblem::renew(const Weighted& changing) {
  const Measured measured(placement_->costs().setUpSeconds, placement_->costs().setUpSent);
  factor(sumUp(changing));
}

// On the holders only.  Where all ranks hold, all do the same with the same numbers; else the others wait for the holders' word.
void CoarseProblem::factor(CoarseBlocks changing) try {
  changingBlocks_ = std::move(changing);
  CoarseCosts& costs = placement_->costs();
  ++costs.setUps;
  const auto work = [&] {
    if (placement_->isShared()) factorShared();
    else if (condenses_) factorCondensed();
    else factorWhole();
    costs.factorEntries = std::max(costs.factorEntries, factorEntries());
  };
  if (placement_->isReplicated() || placement_->isShared()) {
    work();  // fails on all ranks or on none
    return;
  }
  CaughtError error;
  try {
    if (placement_->holds()) work();
  } catch (...) {
    error = describeCurrentException();
  }
  broadcastAndThrow(placement_->comm(), error, placement_->firstHolder());  // all holders have the same matrix
} catch (const std::runtime_error& e) {
  throw UselessFactor(e.what());
}

// P^T A P = L L^T, sparse, of all unknowns
void CoarseProblem::factorWhole() {
  if (matrix_.matrix().rows() == 0) matrix_ = CoarseMatrix({fixed_.get(), &held_}, paddedSize());
  matrix_.set({fixed_.get(), &held_, &changingBlocks_});
  if (factor_) factor_->renew(matrix_.matrix());
  else factor_ = std::make_unique<LocalSolverFactor>(matrix_.matrix(), LocalSolverMethod::Automatic);
}

// [ A_oo A_oc ; A_co A_cc + E ], o: others, c: where rows change.  A_oo = L_oo L_oo^T once, S = A_cc - A_co A_oo^-1 A_oc; then S + E
void CoarseProblem::factorCondensed() {
  if (!condensed_) {
    const CoarseSchur::Parts stays{fixed_.get(), &held_};
    condensed_ = std::make_unique<CoarseSchurFactor>(std::make_shared<const CoarseSchur>(paddedSize(), stays, changing_), precision_);
    placement_->costs().flops += condensed_->schur()->flops();
  }
  condensed_->renew(changingBlocks_);
  const double c = double(condensed_->schurSize());
  placement_->costs().flops += c * c * c / 6;
}

// The same over all ranks; where nothing is condensed, all of it anew.
void CoarseProblem::factorShared() {
  CoarseSchur::Parts parts{fixed_.get(), &held_};
  if (!condenses_) parts.push_back(&changingBlocks_);
  if (!shared_ || !condenses_) {
    shared_ = std::make_unique<CoarseTreeFactor>(
        std::make_shared<const CoarseTree>(*placement_, paddedSize(), parts, condenses_ ? changing_ : std::vector<int>{}));
    CoarseCosts& costs = placement_->costs();
    costs.flops += shared_->tree()->flops();
    costs.between = std::max(costs.between, shared_->tree()->between());
    costs.last = std::max(costs.last, kCoarseModes * long(shared_->tree()->last().pivots().size()));
  }
  shared_->renew(condenses_ ? changingBlocks_ : CoarseBlocks());
  placement_->costs().flops += shared_->flops();
}

std::size_t CoarseProblem::factorEntries() const {
  if (shared_) return shared_->entries();
  if (condensed_) return condensed_->factorEntries();
  return factor_ ? factor_->factorEntries() : 0;
}

// b on the holders, empty elsewhere; x on all.
Eigen::MatrixXd CoarseProblem::solveOnHolders(const Eigen::MatrixXd& b, Eigen::Index rows, Eigen::Index columns) const {
  Eigen::MatrixXd x(paddedSize(), columns), copy;
  const Eigen::MatrixXd& rhs = paddedSize() == b.rows() ? b : copy = padded(b);
  if (factor_) factor_->solve(rhs, x);
  if (condensed_) x = condensed_->solve(rhs);
  if (shared_) x = shared_->solve(rhs);
  x.conservativeResize(rows, Eigen::NoChange);
  placement_->broadcast(x);
  count(columns, double(factorEntries()));
  return x;
}

// Each entry is read forward and backward.
void CoarseProblem::count(Eigen::Index columns, double entries) const {
  solves_ += long(columns);
  placement_->costs().solves += long(columns);
  placement_->costs().entriesRead += 2 * entries * double(columns);
}

Eigen::MatrixXd CoarseProblem::solve(const Eigen::MatrixXd& b) const {
  const Measured measured(placement_->costs().solveSeconds, placement_->costs().solveSent);
  return solveOnHolders(b, b.rows(), b.cols());
}

// One reduction to the holders, a solve there, a broadcast from them; with a factor on every rank the reduction alone.
Eigen::MatrixXd CoarseProblem::solveSum(const Eigen::MatrixXd& mine, const Eigen::MatrixXd& shift) const {
  const Measured measured(placement_->costs().solveSeconds, placement_->costs().solveSent);
  Eigen::MatrixXd b = placement_->sum(mine);
  if (placement_->holds() && shift.size() > 0) b -= shift;
  return solveOnHolders(b, mine.rows(), mine.cols());
}

struct CoarseProblem::Series::SharedElimination {
  CoarseTree::Eliminated rhs;
};

CoarseProblem::Series::Series(const CoarseProblem& problem, Eigen::VectorXd mine) : problem_(problem), mine_(std::move(mine)) {}

// a_k = A^-1 r_k with r_1 = b_1 and, since A_fixed a = A a - E a and A a_i = r_i,
//
//   r_k = b_k - A_fixed (a_1 + ... + a_k-1) = b_k - (r_1 + ... + r_k-1) + E (a_1 + ... + a_k-1).
//
// b_k - b_1 and E a lie in c.  So do all r_k but r_1, whose others are eliminated once: every a_k comes from S + E alone, and only
// its entries in c are right.  They are all that E, and the active contact rows, ask for.
Eigen::VectorXd CoarseProblem::Series::next(const Eigen::VectorXd& changing) {
  const CoarsePlacement& placement = *problem_.placement_;
  const Measured measured(placement.costs().solveSeconds, placement.costs().solveSent);
  const bool isFirst = first_.size() == 0;
  if (isFirst) first_ = changing;
  Eigen::MatrixXd b = placement.sum(isFirst ? Eigen::VectorXd(mine_ + changing) : addChanging(changing - first_));
  Eigen::MatrixXd a(changing.size(), 1);
  if (placement.holds()) {
    b = problem_.padded(std::move(b));
    if (isFirst) eliminate(b);
    else if (!problem_.shared_) b += problem_.changingBlocks_.multiply(total_);
    a = solveForRest(isFirst ? Eigen::VectorXd() : Eigen::VectorXd(b));
    total_ += a;
    a.conservativeResize(changing.size(), Eigen::NoChange);
  }
  placement.broadcast(a);
  problem_.count(1, entriesOfNext(isFirst));
  return a;
}

// Where each rank has a part of E, E (all a so far) is summed up with the rest.
Eigen::VectorXd CoarseProblem::Series::addChanging(Eigen::VectorXd changing) const {
  if (problem_.shared_) changing += problem_.changingBlocks_.multiply(total_).head(changing.size());
  return changing;
}

void CoarseProblem::Series::eliminate(const Eigen::MatrixXd& b) {
  total_ = Eigen::VectorXd::Zero(b.rows());
  if (problem_.shared_ && problem_.condenses_) {
    shared_ = std::make_shared<const SharedElimination>(SharedElimination{problem_.shared_->tree()->eliminate(b)});
    eliminated_ = shared_->rhs.last;
  } else {
    eliminated_ = problem_.condensed_ ? problem_.condensed_->schur()->eliminate(b) : b;
  }
}

// The whole of a factor for the first, if that is not condensed for all; else what changes alone.
double CoarseProblem::Series::entriesOfNext(bool isFirst) const {
  if (!problem_.condenses_ || isFirst) return double(problem_.factorEntries());
  if (problem_.shared_) return double(problem_.shared_->entries() - problem_.shared_->tree()->entries());
  const double c = problem_.condensed_ ? double(problem_.condensed_->schurSize()) : 0;
  return c * (c + 1) / 2;
}

// Unknown of every row of `rhs` in solveForRest.
int CoarseProblem::Series::unknown(Eigen::Index row) const {
  if (shared_) return kCoarseModes * problem_.changing_[std::size_t(row / kCoarseModes)] + int(row % kCoarseModes);
  if (!problem_.condensed_) return int(row);
  const auto& order = problem_.condensed_->schur()->order();
  return order[order.size() - std::size_t(problem_.condensed_->schurSize()) + std::size_t(row)];
}

// a of r = (b_1 with the others eliminated) + `more` - (all r so far), more = b_k - b_1 + E (all a so far) [l]; empty at k = 1.
Eigen::VectorXd CoarseProblem::Series::solveForRest(const Eigen::VectorXd& more) {
  const CoarseSchurFactor* condensed = problem_.condensed_.get();
  const Eigen::Index n = condensed ? condensed->schurSize() : eliminated_.rows();
  Eigen::VectorXd rhs = eliminated_.bottomRows(n);
  if (more.size() > 0) {
    rhs -= solvedFor_;
    for (Eigen::Index i = 0; i < n; ++i) rhs[i] += more[unknown(i)];
    solvedFor_ += rhs;
  } else {
    solvedFor_ = rhs;
  }
  Eigen::MatrixXd x = rhs;
  if (condensed) condensed->solveSchur(x);
  else if (shared_) x = problem_.shared_->solveLast(rhs);
  else if (problem_.shared_) x = problem_.shared_->solve(rhs);
  else problem_.factor_->solve(rhs, x);
  Eigen::VectorXd a = Eigen::VectorXd::Zero(total_.size());
  for (Eigen::Index i = 0; i < n; ++i) a[unknown(i)] = x(i, 0);
  return a;
}

// A_fixed a = b, b = b_1 + what changed since, which lies in c: b_1 is eliminated, what changed is added to its last rows, S (without
// E) solves for those, and one substitution gives the others.
Eigen::VectorXd CoarseProblem::Series::last(const CoarseProblem& fixedAlone, const Eigen::VectorXd& changing) {
  const bool shares = fixedAlone.condenses_ && first_.size() > 0;  // then what was eliminated first serves again
  if (!shares) return fixedAlone.solveSum(mine_ + changing);
  const CoarsePlacement& placement = *problem_.placement_;
  const Measured measured(placement.costs().solveSeconds, placement.costs().solveSent);
  Eigen::MatrixXd b = placement.sum(Eigen::VectorXd(changing - first_));
  Eigen::MatrixXd a(mine_.size(), 1);
  if (placement.holds()) {
    a = substituteBack(fixedAlone, problem_.padded(std::move(b)));
    a.conservativeResize(mine_.size(), Eigen::NoChange);
  }
  placement.broadcast(a);
  fixedAlone.count(1, double(fixedAlone.factorEntries()));
  return a;
}

Eigen::MatrixXd CoarseProblem::Series::substituteBack(const CoarseProblem& fixedAlone, const Eigen::MatrixXd& more) {
  const CoarseSchurFactor* condensed = fixedAlone.condensed_.get();
  const Eigen::Index n = condensed ? condensed->schurSize() : eliminated_.rows();
  auto rhs = eliminated_.bottomRows(n);
  for (Eigen::Index i = 0; i < n; ++i) rhs(i, 0) += more(unknown(i), 0);
  if (shared_) return fixedAlone.shared_->tree()->substituteBack(shared_->rhs, fixedAlone.shared_->solveLast(rhs));
  condensed->solveSchur(rhs);
  return condensed->schur()->substituteBack(eliminated_);
}

}  // namespace Haptos
