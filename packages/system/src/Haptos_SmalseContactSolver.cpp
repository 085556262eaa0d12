// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SmalseContactSolver.hpp"

#include <BelosTpetraAdapter.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>

#include "Haptos_CoulombFixedPoint.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_FetiSystem.hpp"
#include "Haptos_KktEstimator.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_SmalseSolMgr.hpp"

namespace Haptos {
namespace {

using Manager = SmalseSolMgr<double, MultiVector, Operator>;
using Program = QuadraticProgram<double, MultiVector, Operator>;

// Shares the coarse solve between P F P x and Q x.
class FetiProgram final : public Program {
 public:
  FetiProgram(const DualProblem& dual, const RCP<MultiVector>& x, const RCP<const MultiVector>& b,
              const RCP<FeasibleSet<MultiVector>>& omega)
      : Program(dual.PFP, x, b, omega, dual.Q, dual.lambdaIm), PFP_(dual.PFP) {}
  void applyHessian(const MultiVector& x, MultiVector& Ax, MultiVector& Qx) const override {
    PFP_->applyWithProjection(x, Ax, Qx);
  }

 private:
  RCP<const ProjectedDualOperator> PFP_;
};

// b = P (h - F lambdaIm)
RCP<MultiVector> rightHandSide(const DualProblem& dual) {
  auto b = Teuchos::rcp(new MultiVector(dual.map(), 1));
  dual.P->apply(*dual.jumpsOf(*dual.lambdaIm), *b);
  return b;
}

// Q of the gaps: the first multiplier of G lambda = e.  P spreads the gaps over all rows of b; this takes them
// back, so that the first gradient has them in the contact rows alone.  From 0 the multiplier would have to grow to
// the size of the largest gap first: with one of 1e3, displacements of 1e-3 were never resolved.
RCP<MultiVector> gapMultiplier(const FetiSystem& system) {
  Vector gaps(system.dual().map());
  {
    const auto c = system.c().getData(0);
    const auto data = gaps.getDataNonConst(0);
    for (const auto& pair : system.law().pairs()) data[pair.normal] = c[pair.normal];
  }
  auto multiplier = Teuchos::rcp(new MultiVector(system.dual().map(), 1));
  system.dual().Q->apply(gaps, *multiplier);
  return multiplier;
}

}  // namespace

std::array<long, 3> countStates(const ContactLaw& law, const Vector& lambda, const StateScales& scales) {
  std::array<long, 3> mine{0, 0, 0};
  const auto data = lambda.getData(0);
  for (const auto& pair : law.pairs()) {
    const auto status = contactStatus(pair, ContactLaw::gather(pair, data.getRawPtr()), scales);
    ++mine[status == ContactStatus::Stick ? 0 : status == ContactStatus::Slip ? 1 : 2];
  }
  return sumOfAll(*lambda.getMap()->getComm(), mine);
}

struct SmalseContactSolver::Impl {
  explicit Impl(const SolverContext& context) : estimator(context.system, context.loads, KktEstimator::Balance::Sought) {}
  KktEstimator estimator;
  RCP<MultiVector> x;
  std::unique_ptr<CoulombFixedPoint> fixedPoint;
  RCP<Program> program;
  Manager manager;
  SolveRequest request{};
};

SmalseContactSolver::SmalseContactSolver(SolverContext context, const SmalseOptions& options)
    : context_(std::move(context)), options_(options) {
  begin(context_.start);
}

void SmalseContactSolver::renew() {
  history_.clear();
  begin(solution_.lambda);
}

// The program refers to the operators of the step: another step is another program on the same multipliers.
void SmalseContactSolver::begin(const RCP<const Vector>& start) {
  impl_ = std::make_unique<Impl>(context_);
  const FetiSystem& system = context_.system;
  const DualProblem& dual = system.dual();
  const Vector& first = start.is_null() ? *dual.lambdaIm : *start;
  impl_->x = Teuchos::rcp(new MultiVector(first, Teuchos::Copy));
  impl_->fixedPoint = std::make_unique<CoulombFixedPoint>(dual.map(), system.law(), system.jump().multipliers(), first);
  impl_->program = Teuchos::rcp(new FetiProgram(dual, impl_->x, rightHandSide(dual), impl_->fixedPoint->set()));
  impl_->manager.setProblem(impl_->program);
  impl_->manager.setMultiplier(gapMultiplier(system));
  impl_->manager.setOptions({options_});
  impl_->manager.setFeasibleSetUpdate(Teuchos::rcp(impl_->fixedPoint.get(), false));
  impl_->manager.setOuterTest([this](const MultiVector& x, const MultiVector& g) { return estimateKkt(x, g); });
  impl_->manager.setObserver([this](const SmalseRecord&) { record(impl_->estimator.kkt()); });
}

SmalseContactSolver::~SmalseContactSolver() = default;

// What round-off hides is known to the estimate alone.
Outcome SmalseContactSolver::outcome() const {
  const Outcome outcome = impl_->manager.outcome();
  return outcome == Outcome::Stagnated && impl_->estimator.isRoundOff() ? Outcome::RoundOff : outcome;
}

int SmalseContactSolver::outerIterations() const { return int(impl_->manager.history().size()); }

// The dual cost falls without end where no displacements obey all that is asked of them.
bool SmalseContactSolver::solve(const SolveRequest& request) try {
  const DualProblem& dual = context_.system.dual();
  impl_->request = request;
  const long others = dual.F->applications() - impl_->manager.counts().hessianApplications;  // a request counts those of the whole run
  auto options = impl_->manager.options();
  options.tolerance = request.tolerance;
  options.maximumMultiplications = int(std::max(1L, request.maximumMultiplications - others));
  impl_->manager.setOptions(options);
  const bool passed = impl_->manager.solve() == Belos::Converged;
  solution_.lambda = Teuchos::rcp(new Vector(*impl_->x->getVector(0), Teuchos::Copy));
  solution_.s = Teuchos::rcp(new Vector(*impl_->manager.gradient()->getVector(0), Teuchos::Copy));
  solution_.s->scale(-1.0);  // s = B u - c = h - F lambda + G^T a is minus the gradient of the Lagrangian
  return passed;
} catch (const UnboundedCost&) {  // on all ranks
  throw InsufficientModel("The model has no solution: gaps of contact and what is prescribed contradict each other, no displacements obey all of them. "
                          "Look for bodies or nodes between two obstacles that are nearer to each other than they are thick.");
}

double SmalseContactSolver::estimateKkt(const MultiVector& x, const MultiVector& gradient) {
  Vector s(*gradient.getVector(0), Teuchos::Copy);
  s.scale(-1.0);
  const auto scale = impl_->request.isDoubted ? KktEstimator::Scale::Doubted : KktEstimator::Scale::Trusted;
  return impl_->estimator.estimate(*x.getVector(0), s, impl_->request.tolerance, scale);
}

void SmalseContactSolver::record(double residual) {
  const FetiSystem& system = context_.system;
  const Vector lambda(*impl_->x->getVector(0), Teuchos::Copy);
  const double force = contactForceScale(system.law(), lambda, context_.loads.largest);
  const auto states = countStates(system.law(), lambda, {force, impl_->request.tolerance});
  history_.push_back({system.dual().F->applications(), residual, states[0], states[1], states[2]});
  if (context_.progress) context_.progress(history_.back());
}

}  // namespace Haptos
