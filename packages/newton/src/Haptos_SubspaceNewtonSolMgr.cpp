// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SubspaceNewtonSolMgr.hpp"

#include <BelosSolverFactory_Tpetra.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <cmath>
#include <limits>
#include <sstream>

#include "Haptos_Error.hpp"
#include "Haptos_SubspaceNewtonRun.hpp"

namespace Haptos {
namespace {

using Teuchos::ParameterList;

// Every parameter with its place in the options, whose defaults are the list's.
template <class List>
void forEachParameter(SubspaceNewtonOptions& o, List&& list) {
  list("Convergence Tolerance", o.tolerance, "What the dimensionless residual is compared with.");
  list("Maximum Hessian Multiplications", o.maximumMultiplications, "Limit over all calls of solve().");
  list("Maximum Pairs", o.maximumPairs, "Limit of the recycled pairs; when it is reached older ones are dropped, >= 20.");
  list("First Axis Ratio", o.continuation.firstAxisRatio, "Axis ratio at which the continuation starts, >= 1; smaller ratios need none.");
  list("First Factor", o.continuation.firstFactor, "Of the friction coefficients, before the true ones, >= 1.");
  list("Level Tolerance", o.continuation.levelTolerance, "Of a level before the last one, relative to the jumps of the start, > 0.");
  list("Level Patience", o.continuation.levelPatience, "Multiplications without halving the residual that end such a level.");
  list("Patience", o.continuation.patience, "The same at the true coefficients.");
  list("Maximum Restarts", o.continuation.maximumRestarts, "After so many stalls the method gives up.");
  list("Floating Penalty", o.floatingPenalty, "Penalty relative to the nodal stiffness where friction alone holds a body, > 0.");
}

RCP<const ParameterList> makeValidParameters() {
  auto p = Teuchos::rcp(new ParameterList("Haptos Subspace Newton"));
  SubspaceNewtonOptions defaults;
  forEachParameter(defaults, [&](const char* name, auto& value, const char* text) { p->set(name, value, text); });
  return p;
}

SubspaceNewtonOptions optionsFrom(const ParameterList& p) {
  SubspaceNewtonOptions options;
  forEachParameter(options, [&](const char* name, auto& value, const char*) { value = p.get<std::decay_t<decltype(value)>>(name); });
  return options;
}

// Bounds of parameters that are numbers.
struct Rule {
  const char* name;
  double low;
  const char* text;
};

// The first value out of range is refused with its name and what would be right.
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

SubspaceNewtonSolMgr::SubspaceNewtonSolMgr() : options_(std::make_unique<SubspaceNewtonOptions>()) {
  setParameters(Teuchos::rcp(new ParameterList));
}
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
  *options_ = optionsFrom(*p);
}

RCP<const ParameterList> SubspaceNewtonSolMgr::getValidParameters() const {
  static const RCP<const ParameterList> parameters = makeValidParameters();
  return parameters;
}

void SubspaceNewtonSolMgr::reset(const Belos::ResetType type) {
  if ((type & Belos::Problem) == 0) return;
  run_.reset();
  reason_.clear();
}

// Made at the first use: what it needs, a problem, comes after the construction that Belos asks for.
SubspaceNewtonRun& SubspaceNewtonSolMgr::run() {
  TEUCHOS_TEST_FOR_EXCEPTION(problem_.is_null(), std::invalid_argument, "Haptos Subspace Newton: call setProblem first");
  if (!run_) run_ = std::make_unique<SubspaceNewtonRun>(problem_->operators(), *problem_->getLHS()->getVector(0), *options_, hooks_);
  return *run_;
}

void SubspaceNewtonSolMgr::startFrom(const Vector& lambda, const Vector& s) { run().startFrom(lambda, s); }

// The state is given back whatever the outcome: the caller may go on from it by another method.
void SubspaceNewtonSolMgr::goOn() {
  if (run_) run_->goOn();
}

Belos::ReturnType SubspaceNewtonSolMgr::solve() {
  const NewtonStop stop = run().solve();
  reason_ = stop == NewtonStop::Converged ? "converged"
            : stop == NewtonStop::Limit   ? "limit of Hessian multiplications"
                                          : stagnation();
  problem_->getLHS()->getVectorNonConst(0)->assign(*run_->lambda());
  return stop == NewtonStop::Converged ? Belos::Converged : Belos::Unconverged;
}

double SubspaceNewtonSolMgr::achievedTol() const { return run_ ? run_->residual() : -1; }
RCP<const Vector> SubspaceNewtonSolMgr::jumps() const { return run_ ? run_->jumps() : RCP<Vector>(); }
long SubspaceNewtonSolMgr::hessianApplications() const { return problem_.is_null() ? 0 : problem_->operators().F->applications(); }
SubspaceNewtonSolMgr::Subspace SubspaceNewtonSolMgr::subspace() const {
  if (!run_) return {};
  const RecycledSubspace& s = run_->subspace();
  return {long(s.largestSize()), s.compressions(), s.memoryMb()};
}
int SubspaceNewtonSolMgr::getNumIters() const { return run_ ? run_->steps() : 0; }

void registerSubspaceNewtonSolMgr() {
  // Belos looks names up in capitals
  Belos::Impl::registerSolverSubclassForTypes<SubspaceNewtonSolMgr, double, MultiVector, Operator>("HAPTOS SUBSPACE NEWTON");
}

}  // namespace Haptos
