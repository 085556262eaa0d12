// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_PcpgSolver.hpp"

#include <BelosPseudoBlockCGSolMgr.hpp>
#include <BelosTpetraAdapter.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>

#include "Haptos_FetiSystem.hpp"

namespace Haptos {
namespace {

constexpr double kNothing = 1e-13;  // of what is projected: rigid motions alone, and their round-off

// P M P: keeps the iterates in Ker G.
class ProjectedPreconditioner final : public Operator {
 public:
  ProjectedPreconditioner(RCP<const Operator> M, RCP<const Operator> P) : M_(std::move(M)), P_(std::move(P)) {}
  RCP<const Map> getDomainMap() const override { return P_->getDomainMap(); }
  RCP<const Map> getRangeMap() const override { return P_->getRangeMap(); }
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const override {
    MultiVector px(x.getMap(), x.getNumVectors()), z(x.getMap(), x.getNumVectors());
    P_->apply(x, px);
    // Belos knows no projections: P M P keeps its directions in Ker G.
    M_->apply(px, z);
    P_->apply(z, y, Teuchos::NO_TRANS, alpha, beta);
  }

 private:
  RCP<const Operator> M_, P_;
};

}  // namespace

PcpgSolver::PcpgSolver(SolverContext context) : context_(std::move(context)) {
  x_ = Teuchos::rcp(new MultiVector(context_.system.dual().map(), 1));
  begin(context_.start);
  if (context_.system.hasSlenderSubdomains()) deflated_ = context_.system.makeDeflated();
}

void PcpgSolver::renew() {
  history_.clear();
  begin(solution_.lambda);
}

// b = P (h - F lambdaIm), x = start - lambdaIm or 0
void PcpgSolver::begin(const RCP<const Vector>& start) {
  const DualProblem& dual = context_.system.dual();
  Vector r(*dual.h, Teuchos::Copy);
  dual.F->apply(*dual.lambdaIm, r, Teuchos::NO_TRANS, -1.0, 1.0);
  b_ = Teuchos::rcp(new MultiVector(dual.map(), 1));
  dual.P->apply(r, *b_);
  // Loads that G^T alone carries leave round-off in b: to solve for that would take forever.
  const bool isNothing = b_->getVector(0)->norm2() <= kNothing * r.norm2();
  if (isNothing) b_->putScalar(0.0);
  x_->putScalar(0.0);
  if (!start.is_null() && !isNothing) x_->update(1.0, *start, -1.0, *dual.lambdaIm, 0.0);
}

// x in Ker G keeps G lambda = e; Belos iterates on P F P x = b, and lambda = lambdaIm + P x after it, whatever round-off left in x.
bool PcpgSolver::solve(const SolveRequest& request) {
  using Problem = Belos::LinearProblem<double, MultiVector, Operator>;
  const FetiSystem& system = context_.system;
  const DualProblem& dual = system.dual();
  const RCP<const Operator> A = dual.PFP;
  auto problem = Teuchos::rcp(new Problem(A, x_, b_));
  if (!system.preconditioner().is_null()) {
    RCP<const Operator> M = system.preconditioner();
    if (!deflated_.is_null()) M = deflated_;
    problem->setLeftPrec(Teuchos::rcp(new ProjectedPreconditioner(M, dual.P)));
  }
  problem->setProblem();
  auto list = Teuchos::parameterList();
  // Two are F lambdaIm and the last one, for s.
  const long left = request.maximumMultiplications - dual.F->applications() - 2;
  list->set("Maximum Iterations", int(std::max(1L, left)));
  list->set("Convergence Tolerance", request.tolerance);
  list->set("Implicit Residual Scaling", "Norm of RHS");
  Belos::PseudoBlockCGSolMgr<double, MultiVector, Operator> manager(problem, list);
  const bool passed = b_->getVector(0)->norm2() == 0.0 || manager.solve() == Belos::Converged;
  iterations_ += b_->getVector(0)->norm2() == 0.0 ? 0 : manager.getNumIters();
  outcome_ = passed ? Outcome::Converged : left < 1 ? Outcome::MultiplicationLimit : Outcome::NotConverged;

  solution_.lambda = Teuchos::rcp(new Vector(*dual.lambdaIm, Teuchos::Copy));
  Vector px(dual.map());
  dual.P->apply(*x_, px);
  solution_.lambda->update(1.0, px, 1.0);
  // s = P (h - F lambda): the rigid part is chosen so that nothing is left in Im G^T
  solution_.s = Teuchos::rcp(new Vector(*b_->getVector(0), Teuchos::Copy));
  dual.PFP->apply(px, *solution_.s, Teuchos::NO_TRANS, -1.0, 1.0);
  const double reference = b_->getVector(0)->norm2();
  history_.push_back({dual.F->applications(), reference > 0 ? solution_.s->norm2() / reference : 0.0, 0, 0, 0});
  if (context_.progress) context_.progress(history_.back());
  return passed;
}

}  // namespace Haptos
