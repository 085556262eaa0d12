// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SubspaceNewtonSolMgr.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>

#include "Haptos_BelosRegistration.hpp"
#include "Haptos_OptionTable.hpp"
#include "Haptos_SubspaceNewtonRun.hpp"

namespace Haptos {

using Teuchos::ParameterList;

namespace {

constexpr const char* kName = "Haptos Subspace Newton";

}  // namespace

const OptionTable<SubspaceNewtonOptions>& SubspaceNewtonOptions::table() {
  using O = SubspaceNewtonOptions;
  const auto count = NumberRange::atLeast(1);
  static const auto table =
      OptionTable<O>()
          .add("Convergence Tolerance", &O::tolerance, NumberRange::atLeast(0), "What the dimensionless residual is compared with")
          .addFrom(SolverOptions::table(), "Maximum Hessian Multiplications", &O::maximumMultiplications)
          .addFrom(SolverOptions::table(), "Maximum Recycled Pairs", &O::maximumPairs)
          .add("First Axis Ratio", [](auto& o) -> auto& { return o.continuation.firstAxisRatio; }, NumberRange::atLeast(1),
               "Axis ratio at which the continuation starts; smaller ratios need none")
          .add("First Factor", [](auto& o) -> auto& { return o.continuation.firstFactor; }, NumberRange::atLeast(1),
               "Of the friction coefficients, before the true ones")
          .add("Level Tolerance", [](auto& o) -> auto& { return o.continuation.levelTolerance; }, NumberRange::above(0),
               "Of a level before the last one, relative to the jumps of the start")
          .add("Level Patience", [](auto& o) -> auto& { return o.continuation.levelPatience; }, count,
               "Multiplications without halving the residual that end such a level")
          .add("Patience", [](auto& o) -> auto& { return o.continuation.patience; }, count, "The same at the true coefficients")
          .add("Maximum Restarts", [](auto& o) -> auto& { return o.continuation.maximumRestarts; }, NumberRange::atLeast(0),
               "After so many stalls the method gives up")
          .add("Floating Penalty", &O::floatingPenalty, NumberRange::above(0),
               "Penalty relative to the nodal stiffness where friction alone holds a body");
  return table;
}

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
  *options_ = readManagerParameters<SubspaceNewtonOptions>(*p, kName, {{"Maximum Pairs", "Maximum Recycled Pairs"}});
  parameters_ = p;
}

void SubspaceNewtonSolMgr::setOptions(const SubspaceNewtonOptions& options) {
  const auto list = Teuchos::parameterList(listOf(options, kName));
  readManagerParameters<SubspaceNewtonOptions>(*list, kName, {});  // checks them
  *options_ = options;
  parameters_ = list;
}

RCP<const ParameterList> SubspaceNewtonSolMgr::getValidParameters() const {
  return Teuchos::parameterList(listOf(SubspaceNewtonOptions{}, kName));
}

void SubspaceNewtonSolMgr::reset(const Belos::ResetType type) {
  if ((type & Belos::Problem) == 0) return;
  run_.reset();
  outcome_.reset();
}

// Made at the first use: what it needs, a problem, comes after the construction that Belos asks for.
SubspaceNewtonRun& SubspaceNewtonSolMgr::run() {
  TEUCHOS_TEST_FOR_EXCEPTION(problem_.is_null(), std::invalid_argument, "Haptos Subspace Newton: call setProblem first");
  if (!run_) run_ = std::make_unique<SubspaceNewtonRun>(problem_->operators(), *problem_->getLHS()->getVector(0), *options_, hooks_);
  return *run_;
}

void SubspaceNewtonSolMgr::startFrom(const Vector& lambda, const Vector& s) { run().startFrom(lambda, s); }

void SubspaceNewtonSolMgr::setJumps(const Vector& s) { run().setJumps(s); }

// Motions of floating bodies that friction now feels, or feels no more, are other unknowns: then from the present multipliers alone.
void SubspaceNewtonSolMgr::goOn() {
  if (run_ && !run_->goOn()) run_.reset();
}

// The state is given back whatever the outcome: the caller may go on from it by another method.
Belos::ReturnType SubspaceNewtonSolMgr::solve() {
  const NewtonStop stop = run().solve();
  outcome_ = stop == NewtonStop::Converged ? Outcome::Converged : stop == NewtonStop::Limit ? Outcome::MultiplicationLimit : Outcome::Stalled;
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

void registerSubspaceNewtonSolMgr() { registerWithBelos<SubspaceNewtonSolMgr>(kName); }

}  // namespace Haptos
