// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SubspaceNewtonSolver.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <cmath>
#include <optional>

#include "Haptos_ContactBlock.hpp"
#include "Haptos_FetiSystem.hpp"
#include "Haptos_ForcesOfDependentRows.hpp"
#include "Haptos_KktEstimator.hpp"
#include "Haptos_PairGroups.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_SmoothJumps.hpp"
#include "Haptos_SubspaceNewtonOptions.hpp"
#include "Haptos_SubspaceNewtonSolMgr.hpp"

namespace Haptos {
namespace {

// What Newton knows of a FETI system: F and M as operators, rows of G^T and the laws of pairs; no mesh, no subdomain.
ContactOperators contactOperators(const FetiSystem& system, decltype(ContactOperators::makeDeflatedM) makeDeflatedM) {
  const DualProblem& dual = system.dual();
  ContactOperators o;
  o.F = Teuchos::rcp(new CountedOperator(dual.F));
  o.jumpsOf = [&dual, F = o.F](const Vector& lambda) {
    const long before = dual.F->applications();
    const auto s = dual.jumpsOf(lambda);
    F->count(dual.F->applications() - before);
    return s;
  };
  o.M = system.preconditioner();
  const auto block = Teuchos::rcp(new ContactBlock(system.preconditioner()));
  o.contactM = block;
  o.contactRowsOfM = Teuchos::rcp(new ContactRows(system.preconditioner(), block));
  o.makeDeflatedM = makeDeflatedM;
  o.needsDeflatedM = system.needsDeflation();
  o.isDeflatedMDear = system.isDeflationDear();
  o.mayNeedDeflatedM = system.model().isHard;
  o.diagonalOfM = system.preconditioner()->diagonal();
  o.GT = Teuchos::rcpFromRef(dual.G->rows());
  o.GGT = dual.GGT;
  o.contactChangesGGT = true;
  o.e = dual.e;
  const UnheldMotions& floating = system.floatingMotions();
  o.motions = system.bodies().Z() * floating.basis;
  o.holds = holdsFor(floating, system.bodies());
  o.pairs = system.law().pairs();
  const auto& kinds = system.jump().multipliers().kinds();
  for (std::size_t row = 0; row < kinds.size(); ++row)
    if (isEquality(kinds[row])) o.gluingRows.push_back(int(row));
  addForcesOfDependentRows(*system.preconditioner(), o);
  return o;
}

// Gluing rows balance all but the bodies that they do not hold.
bool keepsBalance(const FetiSystem& system) { return system.floatingMotions().basis.cols() == 0; }

}  // namespace

struct SubspaceNewtonSolver::Impl {
  SolverContext context;
  std::optional<KktEstimator> estimator;
  RCP<MultiVector> lambda;
  RCP<const AssembledPreconditioner> assembled;
  bool isAssemblyTried = false;
  RCP<const DeflatedPreconditioner> deflated;
  RCP<ContactProblem> problem;
  SubspaceNewtonSolMgr manager;
  SolveRequest request{};
  DualSolution solution;
  std::vector<HistoryEntry> history;

  Impl(SolverContext c, int maximumPairs)
      : context(std::move(c)),
        lambda(Teuchos::rcp(new MultiVector(context.start.is_null() ? *context.system.dual().lambdaIm : *context.start, Teuchos::Copy))),
        problem(Teuchos::rcp(new ContactProblem(contactOperators(context.system, [this](ContactOperators::Price price) { return makeDeflated(price); }), lambda))) {
    makeEstimator();
    SubspaceNewtonOptions options;
    options.maximumPairs = maximumPairs;
    manager.setOptions(options);
    manager.setProblem(problem);
    manager.setStatusTest([this](const Vector& l, const Vector& s) { return estimateKkt(l, s); });
    manager.setObserver([this](const SubspaceNewtonRecord& record, const Vector& l) { keep(record, l); });
  }

  void makeEstimator() {
    estimator.emplace(context.system, context.loads, keepsBalance(context.system) ? KktEstimator::Balance::Kept : KktEstimator::Balance::Sought);
  }

  // Near incompressibility pairs are stiffer than a capped Poisson's ratio has them, and softer than the diagonal of the true S: the geometric
  // mean took 15 multiplications at nu = .4999 where the capped one took 28, its hundredfold 18 (decisions/042).
  double trueStiffness() const {
    if (!context.system.model().softened) return 1;
    Eigen::Vector2d sums(0, 0);
    const auto exact = deflated->base().diagonal(), capped = context.system.preconditioner()->diagonal();
    for (int row : context.system.jump().multipliers().contactRows()) sums += Eigen::Vector2d(exact->getData(0)[row], capped->getData(0)[row]);
    const auto all = sumOfAll(*context.system.model().comm, sums);
    return all[1] > 0 ? std::sqrt(all[0] / all[1]) : 1.0;
  }

  // Of large parts only where elements are hard: ordinary ones pay three to five times the seconds for half of the multiplications (decisions/042).
  DeflatedMotions::Spectra spectraFor(ContactOperators::Price price) const {
    using Spectra = DeflatedMotions::Spectra;
    if (price == ContactOperators::Price::Any) return Spectra::atAnyPrice();
    if (price == ContactOperators::Price::Little) return Spectra::none();
    return {context.system.model().isHard ? DeflatedMotions::kLargestSpectrum : DeflatedMotions::kUsualSpectrum};
  }

  // Once: where it led to no answer soft motions may.
  ContactOperators::Deflated makeAssembled() {
    assembled = context.system.makeAssembled();
    if (assembled.is_null()) return {};
    ContactOperators::Deflated made{assembled, {}};
    if (assembled->isDenseCheaper()) {
      made.between = [M = assembled](const std::vector<int>&) { return M->contactMatrix(); };
      return made;
    }
    made.exact.multiply = [M = assembled](const Eigen::VectorXd& x) { return M->onContact(x); };
    made.exact.solverWith = [M = assembled](const std::vector<Eigen::Matrix3d>& D) { return M->solverWith(D); };
    return made;
  }

  ContactOperators::Deflated makeDeflated(ContactOperators::Price price) {
    if (!std::exchange(isAssemblyTried, true))
      if (const auto made = makeAssembled(); !made.M.is_null()) return made;
    const auto better = context.system.makeDeflated(spectraFor(price));
    if (better.is_null()) return {};  // the one before, if any, stays in use
    deflated = better;
    const DeflatedPreconditioner::Block block = deflated->contactBlock();
    ContactOperators::Deflated made{deflated, block.M, trueStiffness(), block.between};
    if (block.M.is_null()) made.between = [M = deflated](const std::vector<int>& rows) { return M->between(rows); };
    made.smoothJumps = [system = &context.system] { return smoothJumps(*system->model().multipliers, placesOfPairs(*system)); };
    made.groups = [system = &context.system] { return groupsOfPairs(*system->model().multipliers, placesOfPairs(*system)); };
    made.ofGroups = block.ofGroups;
    made.entriesRead = block.entriesRead;
    return made;
  }

  double estimateKkt(const Vector& l, const Vector& s) {
    return estimator->estimate(l, s, request.tolerance, request.isDoubted ? KktEstimator::Scale::Doubted : KktEstimator::Scale::Trusted);
  }

  // Levels before the last have laws of their own, whose residual is not kkt: they tell the residual instead.
  void keep(const SubspaceNewtonRecord& record, const Vector& l) {
    const ContactLaw& law = context.system.law();
    const double force = record.isFinalLevel ? estimator->contactForce() : contactForceScale(law, l, context.loads.largest);
    const auto states = countStates(law, l, {force, request.tolerance});
    const double residual = record.isFinalLevel ? estimator->kkt() : record.residual;
    history.push_back({context.system.dual().F->applications(), residual, states[0], states[1], states[2]});
    if (context.progress) context.progress(history.back());
  }

  // The manager counts its own multiplications, a request those of the whole run.
  void setRequest(const SolveRequest& r) {
    request = r;
    estimator->limitRoundOff(r.roundOff);
    const long others = context.system.dual().F->applications() - manager.hessianApplications();
    auto options = manager.options();
    options.tolerance = request.tolerance;
    options.maximumMultiplications = int(std::max(1L, request.maximumMultiplications - others));
    manager.setOptions(options);
  }
};

SubspaceNewtonSolver::SubspaceNewtonSolver(SolverContext context, const SolverOptions& options)
    : impl_(std::make_unique<Impl>(std::move(context), options.maximumRecycledPairs)) {}
SubspaceNewtonSolver::~SubspaceNewtonSolver() = default;

void SubspaceNewtonSolver::startFrom(const DualSolution& solution) { impl_->manager.startFrom(*solution.lambda, *solution.s); }

void SubspaceNewtonSolver::renew() {
  Impl& impl = *impl_;
  const FetiSystem& system = impl.context.system;
  impl.makeEstimator();
  impl.history.clear();
  impl.problem->setStep(Teuchos::null, system.dual().e, system.law().pairs());
  impl.manager.goOn();
}

bool SubspaceNewtonSolver::solve(const SolveRequest& request) {
  Impl& impl = *impl_;
  impl.setRequest(request);
  if (!request.jumps.is_null()) impl.manager.setJumps(*request.jumps);
  const bool passed = impl.manager.solve() == Belos::Converged;
  impl.solution.lambda = Teuchos::rcp(new Vector(*impl.lambda->getVector(0), Teuchos::Copy));
  impl.solution.s = Teuchos::rcp(new Vector(*impl.manager.jumps(), Teuchos::Copy));
  return passed;
}

const DualSolution& SubspaceNewtonSolver::solution() const { return impl_->solution; }
Outcome SubspaceNewtonSolver::outcome() const { return impl_->manager.outcome(); }
int SubspaceNewtonSolver::outerIterations() const { return impl_->manager.getNumIters(); }
const std::vector<HistoryEntry>& SubspaceNewtonSolver::history() const { return impl_->history; }
bool SubspaceNewtonSolver::gaveUp() const { return impl_->manager.isLOADetected(); }

DeflationReport SubspaceNewtonSolver::deflation() const {
  if (const auto& M = impl_->deflated; !M.is_null()) return {M->numCoarse(), M->applications()};
  const auto& M = impl_->assembled;
  return M.is_null() ? DeflationReport{} : DeflationReport{M->numContinuous(), M->applications()};
}

SubspaceReport SubspaceNewtonSolver::subspace() const {
  const auto s = impl_->manager.subspace();
  return {s.largestSize, s.compressions, largestOfAll(*impl_->context.system.model().comm, s.memoryMb)};
}

}  // namespace Haptos
