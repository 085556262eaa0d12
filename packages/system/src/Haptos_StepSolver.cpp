// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_StepSolver.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_AutomaticSolver.hpp"
#include "Haptos_Diagnosis.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_FetiSystem.hpp"
#include "Haptos_LocalSolverFactor.hpp"
#include "Haptos_LocalSystems.hpp"
#include "Haptos_PcpgSolver.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_WrittenField.hpp"

namespace Haptos {
namespace {

// SMALSE uses none.
std::optional<PreconditionerKind> preconditionerKind(const SystemOptions& options) {
  return options.solver.method == SolverMethod::Smalse ? std::nullopt : options.preconditioner.kind;
}

}  // namespace

StepSolver::StepSolver(SystemModel model, SystemOptions options, Observer observer)
    : options_(std::move(options)), observer_(std::move(observer)), system_(std::make_unique<FetiSystem>(std::move(model))) {}

StepSolver::~StepSolver() = default;

std::optional<RunClock::Scope> StepSolver::time(Phase phase) const {
  if (observer_.clock == nullptr) return {};
  return observer_.clock->time(phase);
}

void StepSolver::prepare() {
  system_->assemble();
  hasMatrices_ = true;
}

void StepSolver::check(StepData step) {
  system_->setStep(std::move(step));
  loads_ = measureLoads(*system_->model().gather, system_->f(), *system_->model().comm);
}

// K is let go while it is factored, class by class; what depends on B and G comes after it.  Where that was refused before, K is made anew.
void StepSolver::factor() {
  if (!hasMatrices_) prepare();
  hasMatrices_ = false;
  {
    const auto scope = time(Phase::Factor);
    system_->factor(options_.localSolver, preconditionerKind(options_));
  }
  const auto scope = time(Phase::Coarse);
  system_->formDual(options_.coarse);
}

std::unique_ptr<ContactSolver> StepSolver::makeSolver() const {
  SolverMethod method = options_.solver.method;
  const bool contact = system_->model().multipliers->numPairs() > 0;
  if (method == SolverMethod::Automatic && !contact) method = SolverMethod::Pcpg;
  if (method == SolverMethod::Automatic && system_->preconditioner().is_null()) method = SolverMethod::Smalse;  // the one that needs none
  const SolverContext context{*system_, loads_, observer_.progress, start_};
  switch (method) {
    case SolverMethod::Smalse: return std::make_unique<SmalseContactSolver>(context, options_.solver.smalse);
    case SolverMethod::Pcpg: return std::make_unique<PcpgSolver>(context, options_.solver.maximumRecycledPairs);
    case SolverMethod::SubspaceNewton: return std::make_unique<SubspaceNewtonSolver>(context, options_.solver);
    case SolverMethod::Automatic: break;
  }
  return std::make_unique<AutomaticSolver>(context, options_.solver);
}

// What is written is u, unless its jumps cost more force than asked: then it is the smoothed field, by which contact is judged, too, if
// that is the better one.  Smoothing moves pairs: where jumps are large it spoils the law more than it mends the field.  What round-off alone keeps
// above the tolerance is no reason to leave the field as it is.
Accuracy StepSolver::measure(const DualSolution& solution, RCP<Vector>& u, RCP<Vector>& jumps, SmoothingEffort effort) const {
  constexpr double kMargin = 0.8;
  const auto scope = time(Phase::Recover);
  u = recoverPrimal(system_->dual(), *solution.lambda, *solution.s);
  jumps = Teuchos::rcp(new Vector(*system_->step().c, Teuchos::Copy));
  system_->jump().apply(*u, *jumps, Teuchos::NO_TRANS, 1.0, -1.0);
  const AccuracyInput input{system_->systems(), system_->model().bodies, int(system_->model().bodyNames.size()), system_->jump(),
                            system_->law(), system_->step(), *system_->model().gather, loads_};
  const auto residual = residualOf(input, *u, *solution.lambda);
  Accuracy accuracy = measureAccuracy(input, *u, *solution.lambda, *residual);
  if (accuracy.withoutForce) return accuracy;
  WrittenField field(input, *u, *residual);
  const auto addField = [&field](Accuracy& a) {
    if (a.ext > 0) a.errors.fieldEquilibrium = field.imbalance() / a.ext;
    a.imbalanceNode = field.worstNode();
  };
  const double enough = options_.solver.tolerance * accuracy.ext;
  const bool isAllElseDone = accuracy.errors.kkt() <= std::max(options_.solver.tolerance, accuracy.floor);
  addField(accuracy);
  if (!isAllElseDone || !(field.imbalance() > enough)) return accuracy;
  field.smooth(kMargin * enough, effort);
  Accuracy smoothed = accuracy;
  measureContactOf(input, *field.v(), *solution.lambda, smoothed);
  addField(smoothed);
  if (!(smoothed.errors.kkt() < accuracy.errors.kkt())) return accuracy;
  u = field.v();
  return smoothed;
}

// Whether the method's own test passed at last.  Where it passed and kkt did not, the method is asked again, with jumps free of what its
// recursion has lost, by which its test may see what is missing; else with a tighter test.  Without a multiplication nothing is new; what the
// written field still lacks in the end is left to smoothing alone.
bool StepSolver::iterate(StepResult& result) try {
  constexpr int kAttempts = 24;
  const double tolerance = options_.solver.tolerance;
  SolveRequest request{tolerance, system_->dual().F->applications() + options_.solver.maximumMultiplications};
  bool passed = false, isAskedAgain = false;
  RCP<Vector> jumps;
  const auto measureNow = [&](SmoothingEffort effort) { result.accuracy = measure(solver_->solution(), result.u, jumps, effort); };
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const long before = multiplications();
    passed = solver_->solve(request);
    const bool isNew = attempt == 0 || multiplications() > before;
    if (isNew) measureNow(SmoothingEffort::Usual);
    const KktErrors& errors = result.accuracy.errors;
    const double kkt = errors.kkt();
    if (kkt <= std::max(tolerance, Accuracy::kReached * result.accuracy.floor) || !passed || !std::isfinite(kkt)) break;
    // The method's scale of displacements mostly is all that was wrong, unless it is what no method looks at.
    request.isDoubted = kkt > errors.fieldEquilibrium;
    request.jumps = jumps;
    isAskedAgain = isNew && !isAskedAgain && solver_->tracksJumps();
    if (isAskedAgain) continue;
    // Half of what is too much, but by no more than two digits at a time: the two measures are not proportional.
    const double tighter = request.isDoubted && request.tolerance == tolerance ? 0.5 : std::clamp(0.5 * tolerance / kkt, 0.01, 0.5);
    request.tolerance *= tighter;
    if (!request.isDoubted) request.roundOff *= tighter;
  }
  if (passed && result.accuracy.errors.kkt() > tolerance) measureNow(SmoothingEffort::Last);
  return passed;
} catch (const UselessFactor&) {  // on all ranks
  throw InsufficientModel(kLooseModel);
}

namespace {

// Multipliers of a step that is so far below the one before are no start but what their round-off leaves; at rest nothing moves.
bool isFarBelow(const std::array<double, 3>& now, const std::array<double, 3>& before) {
  constexpr double kFar = 1e-8;
  for (std::size_t k = 0; k < now.size(); ++k)
    if (now[k] > kFar * before[k]) return false;
  return true;
}

}  // namespace

// Loads [force], prescribed displacements and overlaps [length] that move the bodies: the largest ones, the same on all ranks.
StepSolver::Drive StepSolver::measureDrive() const {
  const auto& kinds = system_->model().multipliers->kinds();
  const auto c = system_->step().c->getData(0);
  double prescribed = 0, overlap = 0;
  for (std::size_t row = 0; row < kinds.size(); ++row) {
    const double value = c[Teuchos::Ordinal(row)];
    if (kinds[row] == RowKind::Normal) overlap = std::max(overlap, -value);
    else prescribed = std::max(prescribed, std::abs(value));
  }
  const auto largest = largestOfAll(*system_->model().comm, std::array<double, 2>{prescribed, overlap});
  return {loads_.norm, largest[0], largest[1]};
}

// A step that was checked before comes again with the same vectors: then there is nothing to check.  What the method knows is not kept where
// it was thrown out of its work, or came to no numbers.
StepResult StepSolver::solve(StepData step) {
  if (step.f != system_->step().f || step.c != system_->step().c) check(std::move(step));
  if (!system_->isFormed()) factor();
  const auto forget = [&] { solver_.reset(), start_ = Teuchos::null; };
  const Drive drive = measureDrive();
  if (isFarBelow(drive, drive_)) forget();
  drive_ = drive;
  try {
    StepResult result = run();
    if (!std::isfinite(result.accuracy.errors.kkt())) forget();
    return result;
  } catch (...) {
    forget();
    throw;
  }
}

StepResult StepSolver::run() {
  const auto scope = time(Phase::Solve);
  const long before = multiplications();
  StepResult result;
  if (solver_) solver_->renew();
  else solver_ = makeSolver();
  const bool passed = iterate(result);
  result.solved = result.accuracy.errors.kkt() <= options_.solver.tolerance;
  if (!result.solved) result.reason = explainUnconverged({*system_, result.accuracy, *solver_, *result.u, passed, options_});
  result.method = solver_->name();
  result.dual = solver_->solution();
  result.outerIterations = solver_->outerIterations();
  result.multiplications = multiplications() - before;
  result.history = solver_->history();
  result.subspace = solver_->subspace();
  result.deflation = solver_->deflation();
  start_ = result.dual.lambda;
  return result;
}

void StepSolver::setFriction(std::vector<std::string> names, std::vector<FrictionSpec> friction) {
  system_->setFriction(std::move(names), std::move(friction));
}

// Multipliers of other rows mean nothing: the next solve starts afresh.
void StepSolver::renewRows(RCP<const MultiplierMap> multipliers) {
  multipliedBefore_ = multiplications();
  solver_.reset();
  start_ = Teuchos::null;
  system_->renewRows(std::move(multipliers));
}

// Where rows stay in number and order the last multipliers are a start for other values of K.
void StepSolver::renewStiffness(std::shared_ptr<const SubdomainStiffness> stiffness, RCP<const MultiplierMap> multipliers, Rows rows) {
  multipliedBefore_ = multiplications();
  factoredBefore_ = factorizations();
  solver_.reset();
  if (rows == Rows::Others) start_ = Teuchos::null;
  SystemModel model = system_->model();
  model.stiffness = std::move(stiffness);
  model.multipliers = std::move(multipliers);
  system_ = std::make_unique<FetiSystem>(std::move(model));
  prepare();
}

long StepSolver::factorizations() const { return factoredBefore_ + system_->systems().factorizations(); }
long StepSolver::multiplications() const {
  return multipliedBefore_ + (system_->isFormed() ? system_->dual().F->applications() : 0);
}

}  // namespace Haptos
