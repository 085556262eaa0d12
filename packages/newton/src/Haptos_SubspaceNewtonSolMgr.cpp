// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SubspaceNewtonSolMgr.hpp"

#include <BelosSolverFactory_Tpetra.hpp>
#include <Eigen/Dense>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <limits>
#include <sstream>

#include "Haptos_Continuation.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_FoundationStart.hpp"
#include "Haptos_SubspaceNewtonIter.hpp"

namespace Haptos {
namespace {

using Pairs = std::vector<PairLaw>;
using Teuchos::ParameterList;

RCP<const ParameterList> makeValidParameters() {
  auto p = Teuchos::rcp(new ParameterList("Haptos Subspace Newton"));
  p->set("Convergence Tolerance", 1e-6, "What the dimensionless residual is compared with.");
  p->set("Maximum Hessian Multiplications", 5000, "Limit over all calls of solve().");
  p->set("Maximum Pairs", 300, "Limit of the recycled pairs; when it is reached older ones are dropped, >= 20.");
  p->set("First Axis Ratio", 10.0, "Axis ratio at which the continuation starts, >= 1; smaller ratios need none.");
  p->set("First Factor", 1.5, "Of the friction coefficients, before the true ones, >= 1.");
  p->set("Level Tolerance", 0.03, "Of a level before the last one, relative to the jumps of the start, > 0.");
  p->set("Level Patience", 25, "Multiplications without halving the residual that end such a level.");
  p->set("Patience", 12, "The same at the true coefficients.");
  p->set("Maximum Restarts", 2, "After so many stalls the method gives up.");
  p->set("Floating Penalty", 0.3, "Penalty relative to the nodal stiffness where friction alone holds a body, > 0.");
  return p;
}

struct Rule {
  const char* name;
  double low;
  const char* text;
};

void checkParameters(const ParameterList& p) {
  const double tiny = std::numeric_limits<double>::min();
  const Rule rules[] = {{"Convergence Tolerance", 0, ">= 0"}, {"First Axis Ratio", 1, ">= 1"}, {"First Factor", 1, ">= 1"},
                        {"Level Tolerance", tiny, "> 0"}, {"Floating Penalty", tiny, "> 0"}};
  const auto refuse = [](const char* name, double value, const std::string& text) {
    std::ostringstream os;
    os << "Haptos Subspace Newton: parameter \"" << name << "\" is " << value << "; it must be " << text << ".";
    throw InputError(os.str());
  };
  for (const Rule& r : rules)
    if (!(p.get<double>(r.name) >= r.low && std::isfinite(p.get<double>(r.name)))) refuse(r.name, p.get<double>(r.name), r.text);
  const std::pair<const char*, int> limits[] = {
      {"Maximum Hessian Multiplications", 1}, {"Level Patience", 1}, {"Patience", 1}, {"Maximum Restarts", 0},
      {"Maximum Pairs", 20}};
  for (const auto& [name, least] : limits)
    if (p.get<int>(name) < least) refuse(name, p.get<int>(name), "at least " + std::to_string(least));
}

}  // namespace

struct SubspaceNewtonSolMgr::Work {
  SubspaceNewtonSolMgr& manager;
  const ContactOperators& dual;
  const Pairs& pairs;
  DualVectors vectors;
  GluingBalance balance;
  NewtonDirection direction;
  RecycledSubspace subspace;
  Eigen::VectorXd r;  // [pairs] penalty of the law
  SubspaceNewtonIter iteration;
  Eigen::VectorXd first;  // multipliers given by the user
  NewtonState state;
  double reference = 0, tolerance = 0;
  bool started = false;

  explicit Work(SubspaceNewtonSolMgr& m)
      : manager(m),
        dual(m.problem_->operators()),
        pairs(dual.pairs),
        vectors(dual.F->getDomainMap(), pairs, dual.gluingRows),
        balance(dual, vectors),
        direction(dual, DualVectors::fromVector(*dual.diagonalOfM), vectors, balance),
        subspace(vectors, count("Maximum Pairs")),
        r((balance.numFloating() > 0 ? number("Floating Penalty") : 1.0) * direction.pairStiffness()),
        iteration(dual, vectors, balance, direction, subspace, r),
        first(DualVectors::fromVector(*m.problem_->getLHS()->getVector(0))) {}

  double number(const char* name) const { return manager.parameters_->get<double>(name); }
  int count(const char* name) const { return manager.parameters_->get<int>(name); }
  long left() const { return count("Maximum Hessian Multiplications") - dual.F->applications(); }

  // h - F lambda without its rigid part
  Eigen::VectorXd jumps(const Eigen::VectorXd& lambda) const {
    Eigen::VectorXd s = DualVectors::fromVector(*dual.h) - vectors.apply(*dual.F, lambda);
    balance.removeRigidPart(s);
    return s;
  }

  // The state that all pairs start from, and the motions of floating bodies, which need no F.
  void keepOrigin() {
    for (Eigen::Index j = 0; j < balance.numFloating(); ++j)
      subspace.add(Eigen::VectorXd::Zero(vectors.numRows()), balance.jumps().col(j));
    subspace.makePermanent();
    iteration.setOrigin(state);
  }

  void start() {
    subspace.clear();
    const bool floating = balance.numFloating() > 0;
    const Pairs easier = scaledCoefficients(pairs, number("First Factor"));  // near the limit of friction rigid bodies run away
    if (floating) {
      const auto foundation = solveFoundation(easier, Eigen::VectorXd::Zero(3 * vectors.numPairs()), r, balance, vectors);
      state.lambda = Eigen::VectorXd::Zero(vectors.numRows());
      vectors.setContact(state.lambda, foundation.forces);
      balance.balance(state.lambda, dual.e);
    } else {
      state.lambda = first;
    }
    liftRest();
    state.s = jumps(state.lambda);
    if (floating) {
      Eigen::VectorXd x = vectors.contact(state.s);
      for (Eigen::Index i = 0; i < r.size(); ++i) x.segment<3>(3 * i) *= r[i];
      x += vectors.contact(state.lambda);
      state.s += balance.jumps() * solveFoundation(easier, x, r, balance, vectors).a;
    }
    keepOrigin();
    reference = vectors.norm(state.s);
    started = true;
  }

  // What is not in balance at the start is shared by all rows.
  void liftRest() {
    const Eigen::VectorXd rest = balance.applyG(state.lambda) - dual.e;
    if (rest.norm() > 1e-12 * dual.e.norm()) state.lambda -= multiply(*dual.GT, dual.GGT->solve(rest));
  }

  NewtonStop run(const Pairs& level, double levelTolerance, int stall, bool isFinal, bool fresh) {
    NewtonLimits limits;
    limits.tolerance = levelTolerance;
    limits.reference = reference;
    limits.stall = stall;
    limits.maxApplications = left();
    limits.accept = [&](const Eigen::VectorXd& lambda, const Eigen::VectorXd& s, double relative) {
      return accept(lambda, s, relative, isFinal ? tolerance : levelTolerance, isFinal);
    };
    return iteration.iterate(level, state, limits, !fresh || balance.numFloating() == 0);
  }

  bool accept(const Eigen::VectorXd& lambda, const Eigen::VectorXd& s, double residual, double bound, bool isFinal) {
    const auto l = vectors.toVector(lambda);
    if (isFinal && manager.statusTest_) residual = manager.statusTest_(*l, *vectors.toVector(s));
    if (isFinal) manager.residual_ = residual;
    if (manager.observer_) manager.observer_({dual.F->applications(), residual, isFinal}, *l);
    return residual <= bound;
  }

  // Whether the next level must begin with a new direction; or the plateau that a model could leave.
  struct LevelsEnd {
    bool fresh = true, plateau = false;
  };
  LevelsEnd runLevels(const std::vector<Pairs>& levels, double levelTolerance, int stall) {
    LevelsEnd end;
    for (const auto& level : levels) {
      end.plateau = run(level, levelTolerance, stall, false, end.fresh) == NewtonStop::Plateau;
      end.fresh = false;
      if (end.plateau) break;
    }
    return end;
  }

  // A model does not mind the axis ratio.
  std::vector<Pairs> firstLevels(double ratio) const {
    std::vector<Pairs> levels;
    if (ratio > number("First Axis Ratio") && !direction.hasModel()) levels = axisRatioLevels(pairs, ratio, number("First Axis Ratio"), 4);
    levels.push_back(scaledCoefficients(pairs, number("First Factor")));
    return levels;
  }

  std::vector<Pairs> detour(double ratio, int restart) const {
    static const std::vector<std::vector<double>> detours = {{1.5, 1.2}, {2.0, 1.6, 1.3, 1.15, 1.07}};
    if (ratio > number("First Axis Ratio")) return axisRatioLevels(pairs, ratio, 2, 2.5);
    std::vector<Pairs> levels;
    for (double factor : detours[std::min<std::size_t>(std::size_t(restart), detours.size() - 1)])
      levels.push_back(scaledCoefficients(pairs, factor));
    return levels;
  }

  void useModel() {
    if (!direction.useModel()) return;
    r = direction.pairStiffness();
    iteration.setPenalty(r);
  }

  // Jumps so large that nothing can be balanced beside them: a floating body went off.
  bool hasRunAway() const {
    constexpr double kFar = 1e6;
    return vectors.norm(state.s) > kFar * reference;
  }

  NewtonStop continuation() {
    if (dual.needsDeflatedM) useModel();
    const NewtonStop stop = descend();
    if (stop != NewtonStop::Plateau) return stop;
    useModel();
    if (hasRunAway()) return descend();
    const NewtonStop fromHere = run(pairs, 0.1 * tolerance, count("Patience"), true, false);
    return fromHere == NewtonStop::Stalled && left() > 0 ? descend() : fromHere;
  }

  NewtonStop descend() {
    const double ratio = largestAxisRatio(pairs, vectors.comm());
    start();
    LevelsEnd levels = runLevels(firstLevels(ratio), number("Level Tolerance"), count("Level Patience"));
    for (int restart = 0;; ++restart) {
      if (levels.plateau) return NewtonStop::Plateau;
      const NewtonStop stop = run(pairs, 0.1 * tolerance, count("Patience"), true, levels.fresh);
      if (stop != NewtonStop::Stalled || restart == count("Maximum Restarts") || left() <= 0) return stop;
      start();  // pairs gathered in a runaway only add spurious minima
      levels = runLevels(detour(ratio, restart), 1e-2, 20);
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

  NewtonStop solve() {
    tolerance = number("Convergence Tolerance");
    subspace.setMaximum(count("Maximum Pairs"));
    if (!started) return continuation();
    refreshJumps();
    const NewtonStop stop = run(pairs, 0.1 * tolerance, 2 * count("Patience"), true, false);
    if (stop != NewtonStop::Plateau) return stop;
    useModel();
    return run(pairs, 0.1 * tolerance, 2 * count("Patience"), true, false);
  }

  void startFrom(const Vector& lambda, const Vector& s) {
    if (!started) start();
    subspace.clear();
    state.lambda = DualVectors::fromVector(lambda);
    balance.balance(state.lambda, dual.e);
    state.s = DualVectors::fromVector(s);
    keepOrigin();
  }
};

SubspaceNewtonSolMgr::SubspaceNewtonSolMgr() { setParameters(Teuchos::rcp(new ParameterList)); }
SubspaceNewtonSolMgr::~SubspaceNewtonSolMgr() = default;

RCP<Belos::SolverManager<double, MultiVector, Operator>> SubspaceNewtonSolMgr::clone() const {
  return Teuchos::rcp(new SubspaceNewtonSolMgr);
}

void SubspaceNewtonSolMgr::setProblem(const RCP<LinearProblem>& problem) {
  problem_ = Teuchos::rcp_dynamic_cast<ContactProblem>(problem);
  TEUCHOS_TEST_FOR_EXCEPTION(problem_.is_null(), std::invalid_argument,
                             "Haptos Subspace Newton: the problem must be a Haptos::ContactProblem");
  reset(Belos::Problem);
}

void SubspaceNewtonSolMgr::setParameters(const RCP<ParameterList>& parameters) {
  const RCP<ParameterList> p = parameters.is_null() ? Teuchos::rcp(new ParameterList) : parameters;
  p->validateParametersAndSetDefaults(*getValidParameters());
  checkParameters(*p);
  parameters_ = p;
}

RCP<const ParameterList> SubspaceNewtonSolMgr::getValidParameters() const {
  static const RCP<const ParameterList> parameters = makeValidParameters();
  return parameters;
}

void SubspaceNewtonSolMgr::reset(const Belos::ResetType type) {
  if ((type & Belos::Problem) == 0) return;
  work_.reset();
  residual_ = -1;
  reason_.clear();
}

void SubspaceNewtonSolMgr::startFrom(const Vector& lambda, const Vector& s) {
  TEUCHOS_TEST_FOR_EXCEPTION(problem_.is_null(), std::invalid_argument, "Haptos Subspace Newton: call setProblem first");
  if (!work_) work_ = std::make_unique<Work>(*this);
  work_->startFrom(lambda, s);
}

Belos::ReturnType SubspaceNewtonSolMgr::solve() {
  TEUCHOS_TEST_FOR_EXCEPTION(problem_.is_null(), std::invalid_argument, "Haptos Subspace Newton: call setProblem first");
  if (!work_) work_ = std::make_unique<Work>(*this);
  const NewtonStop stop = work_->solve();
  reason_ = stop == NewtonStop::Converged ? "converged"
            : stop == NewtonStop::Limit   ? "limit of Hessian multiplications"
                                          : stagnation();
  problem_->getLHS()->getVectorNonConst(0)->assign(*work_->vectors.toVector(work_->state.lambda));
  return stop == NewtonStop::Converged ? Belos::Converged : Belos::Unconverged;
}

RCP<const Vector> SubspaceNewtonSolMgr::jumps() const {
  return work_ ? work_->vectors.toVector(work_->state.s) : RCP<Vector>();
}

long SubspaceNewtonSolMgr::hessianApplications() const { return problem_.is_null() ? 0 : problem_->operators().F->applications(); }
SubspaceNewtonSolMgr::Subspace SubspaceNewtonSolMgr::subspace() const {
  if (!work_) return {};
  const RecycledSubspace& s = work_->subspace;
  return {long(s.largestSize()), s.compressions(), s.memoryMb()};
}
int SubspaceNewtonSolMgr::getNumIters() const { return work_ ? work_->iteration.steps() : 0; }

void registerSubspaceNewtonSolMgr() {
  // Belos looks names up in capitals
  Belos::Impl::registerSolverSubclassForTypes<SubspaceNewtonSolMgr, double, MultiVector, Operator>("HAPTOS SUBSPACE NEWTON");
}

}  // namespace Haptos
