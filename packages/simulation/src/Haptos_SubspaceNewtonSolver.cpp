// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SubspaceNewtonSolver.hpp"

#include <Eigen/Dense>
#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>

#include "Haptos_FoundationStart.hpp"
#include "Haptos_KktEstimator.hpp"
#include "Haptos_SubspaceNewtonIter.hpp"

namespace Haptos {
namespace {

using Pairs = std::vector<PairLaw>;

constexpr double kFirstRatio = 10;       // axis ratio at which the continuation starts
constexpr double kLevelTolerance = 0.03;  // of the jumps of the start
constexpr double kFirstFactor = 1.5;      // of the friction coefficients, before the true ones
constexpr double kFloatingPenalty = 0.3;  // of the nodal stiffness, where friction alone holds a body: it runs away less
constexpr int kLevelStall = 25, kFinalStall = 12, kMaxRestarts = 2;

// Coefficients times a factor.
Pairs scaled(Pairs pairs, double factor) {
  for (auto& pair : pairs)
    for (double& F : pair.coefficients) F *= factor;
  return pairs;
}

// The small coefficient raised to at least `least` times the large one; zeros stay.
Pairs rounded(Pairs pairs, double least) {
  for (auto& pair : pairs) {
    const double largest = std::max(pair.coefficients[0], pair.coefficients[1]);
    for (double& F : pair.coefficients)
      if (F > 0) F = std::max(F, least * largest);
  }
  return pairs;
}

double largestAxisRatio(const Pairs& pairs, const Communicator& comm) {
  double mine = 1, all = 1;
  for (const auto& pair : pairs) {
    const auto [low, high] = std::minmax(pair.coefficients[0], pair.coefficients[1]);
    if (low > 0) mine = std::max(mine, high / low);
  }
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, mine, Teuchos::outArg(all));
  return all;
}

}  // namespace

struct SubspaceNewtonSolver::Impl {
  SolverContext context;
  const DualProblem& dual;
  DualVectors vectors;
  GluingBalance balance;
  NewtonDirection direction;
  RecycledSubspace subspace;
  double r;
  SubspaceNewtonIter iteration;
  KktEstimator estimator;
  NewtonState state;
  double reference = 0, tolerance = 0;
  long maximum = 0;
  bool started = false, gaveUp = false;
  DualSolution solution;
  std::string reason;
  std::vector<HistoryEntry> history;

  explicit Impl(SolverContext c)
      : context(std::move(c)),
        dual(context.system.dual()),
        vectors(dual.map(), context.system.law(), context.system.jump().multipliers()),
        balance(dual, context.system.bodies(), vectors),
        direction(dual, *context.system.preconditioner(), DualVectors::fromVector(*context.system.preconditioner()->diagonal()),
                  vectors, balance),
        subspace(vectors),
        r((balance.numFloating() > 0 ? kFloatingPenalty : 1.0) * direction.medianNormalStiffness()),
        iteration(dual, vectors, balance, direction, subspace, r),
        estimator(context.system, context.loads) {}

  const Pairs& pairs() const { return context.system.law().pairs(); }
  long left() const { return maximum - dual.F->applications(); }

  // h - F lambda without its rigid part
  Eigen::VectorXd jumps(const Eigen::VectorXd& lambda) const {
    Eigen::VectorXd s = DualVectors::fromVector(*dual.h) - vectors.apply(*dual.F, lambda);
    balance.removeRigidPart(s);
    return s;
  }

  void start() {
    subspace.clear();
    state.lambda = DualVectors::fromVector(*dual.lambdaIm);
    const bool floating = balance.numFloating() > 0;
    if (floating) {
      const auto foundation = solveFoundation(pairs(), Eigen::VectorXd::Zero(3 * vectors.numPairs()), r, balance, vectors);
      state.lambda.setZero();
      vectors.setContact(state.lambda, foundation.forces);
      balance.balance(state.lambda, dual.e);
      liftRest();
    }
    state.s = jumps(state.lambda);
    if (floating) {
      const Eigen::VectorXd x = vectors.contact(state.lambda) + r * vectors.contact(state.s);
      state.s += balance.jumps() * solveFoundation(pairs(), x, r, balance, vectors).a;
      for (Eigen::Index j = 0; j < balance.numFloating(); ++j)
        subspace.add(Eigen::VectorXd::Zero(vectors.numRows()), balance.jumps().col(j));
    }
    reference = vectors.norm(state.s);
    started = true;
  }

  // What contact could not carry at the start is shared by all rows.
  void liftRest() {
    const Eigen::VectorXd rest = balance.applyG(state.lambda) - dual.e;
    if (rest.norm() > 1e-12 * dual.e.norm()) state.lambda -= dual.G->rows() * Eigen::VectorXd(dual.GGT->solve(rest));
  }

  NewtonStop run(const Pairs& level, double levelTolerance, int stall, bool isFinal, bool fresh) {
    NewtonLimits limits;
    limits.tolerance = levelTolerance;
    limits.reference = reference;
    limits.stall = stall;
    limits.maxApplications = left();
    limits.accept = [&](const Eigen::VectorXd& lambda, const Eigen::VectorXd& s, double relative) {
      return accept(lambda, s, relative, levelTolerance, isFinal);
    };
    return iteration.iterate(level, state, limits, !fresh || balance.numFloating() == 0);
  }

  bool accept(const Eigen::VectorXd& lambda, const Eigen::VectorXd& s, double relative, double levelTolerance, bool isFinal) {
    const auto l = vectors.toVector(lambda);
    double residual = relative;
    if (isFinal) residual = estimator.estimate(*l, *vectors.toVector(s), tolerance).kkt();
    const ContactLaw& law = context.system.law();
    const auto states = countStates(law, *l, contactForceScale(law, *l, context.loads.largest));
    history.push_back({dual.F->applications(), residual, states[0], states[1], states[2]});
    if (context.progress) context.progress(history.back());
    return isFinal ? residual <= tolerance : relative <= levelTolerance;
  }

  bool runLevels(const std::vector<Pairs>& levels, double levelTolerance, int stall) {
    bool fresh = true;
    for (const auto& level : levels) {
      run(level, levelTolerance, stall, false, fresh);
      fresh = false;
    }
    return fresh;
  }

  static std::vector<Pairs> aspectLevels(const Pairs& pairs, double ratio, double start, double factor) {
    std::vector<Pairs> levels;
    for (double b = 1 / start; b * ratio > 1; b /= factor) levels.push_back(rounded(pairs, b));
    return levels;
  }

  NewtonStop continuation() {
    const double ratio = largestAxisRatio(pairs(), vectors.comm());
    std::vector<Pairs> levels;
    if (ratio > kFirstRatio) levels = aspectLevels(pairs(), ratio, kFirstRatio, 4);
    levels.push_back(scaled(pairs(), kFirstFactor));
    start();
    bool fresh = runLevels(levels, kLevelTolerance, kLevelStall);
    static const std::vector<std::vector<double>> detours = {{1.5, 1.2}, {2.0, 1.6, 1.3, 1.15, 1.07}};
    for (int restart = 0;; ++restart) {
      const NewtonStop stop = run(pairs(), 0.1 * tolerance, kFinalStall, true, fresh);
      if (stop != NewtonStop::Stalled || restart == kMaxRestarts || left() <= 0) return stop;
      levels.clear();
      if (ratio > kFirstRatio) levels = aspectLevels(pairs(), ratio, 2, 2.5);
      else
        for (double factor : detours[std::size_t(restart)]) levels.push_back(scaled(pairs(), factor));
      start();  // pairs gathered in a runaway only add spurious minima
      fresh = runLevels(levels, 1e-2, 20);
    }
  }

  // The recursion for s drifts after a blow-up; afterwards the jumps are those of lambda again.
  void refreshJumps() {
    Eigen::VectorXd s = jumps(state.lambda);
    if (balance.numFloating() > 0) {
      Eigen::MatrixXd sums(balance.numFloating(), balance.numFloating() + 1);
      sums << balance.jumps().transpose() * balance.jumps(), balance.jumps().transpose() * (state.s - s);
      vectors.sum(sums);
      s += balance.jumps() * Eigen::MatrixXd(sums.leftCols(balance.numFloating())).ldlt().solve(sums.rightCols(1));
    }
    state.s = s;
  }
};

void SubspaceNewtonSolver::startFrom(const DualSolution& solution) {
  Impl& impl = *impl_;
  if (!impl.started) impl.start();
  impl.subspace.clear();
  impl.state.lambda = DualVectors::fromVector(*solution.lambda);
  impl.balance.balance(impl.state.lambda, impl.dual.e);
  impl.state.s = DualVectors::fromVector(*solution.s);
  for (Eigen::Index j = 0; j < impl.balance.numFloating(); ++j)
    impl.subspace.add(Eigen::VectorXd::Zero(impl.vectors.numRows()), impl.balance.jumps().col(j));
}

SubspaceNewtonSolver::SubspaceNewtonSolver(SolverContext context) : impl_(std::make_unique<Impl>(std::move(context))) {}
SubspaceNewtonSolver::~SubspaceNewtonSolver() = default;

bool SubspaceNewtonSolver::solve(const SolveRequest& request) {
  impl_->tolerance = request.tolerance;
  impl_->maximum = request.maximumMultiplications;
  NewtonStop stop;
  if (!impl_->started) {
    stop = impl_->continuation();
  } else {
    impl_->refreshJumps();
    stop = impl_->run(impl_->pairs(), 0.1 * request.tolerance, 2 * kFinalStall, true, false);
  }
  impl_->gaveUp = stop == NewtonStop::Stalled;
  impl_->reason = stop == NewtonStop::Converged ? "converged"
                  : stop == NewtonStop::Limit   ? "Solver->Maximum Hessian Multiplications is reached"
                                                : "the residual was no longer halved";
  impl_->solution = {impl_->vectors.toVector(impl_->state.lambda), impl_->vectors.toVector(impl_->state.s)};
  return stop == NewtonStop::Converged;
}

const DualSolution& SubspaceNewtonSolver::solution() const { return impl_->solution; }
const std::string& SubspaceNewtonSolver::reason() const { return impl_->reason; }
int SubspaceNewtonSolver::outerIterations() const { return impl_->iteration.steps(); }
const std::vector<HistoryEntry>& SubspaceNewtonSolver::history() const { return impl_->history; }
bool SubspaceNewtonSolver::gaveUp() const { return impl_->gaveUp; }
double SubspaceNewtonSolver::subspaceMemoryMb() const { return impl_->subspace.memoryMb(); }

}  // namespace Haptos
