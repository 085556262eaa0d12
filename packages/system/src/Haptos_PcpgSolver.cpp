// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_PcpgSolver.hpp"

#include <BelosPseudoBlockCGSolMgr.hpp>
#include <BelosTpetraAdapter.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <cmath>
#include <memory>

#include "Haptos_FetiSystem.hpp"

namespace Haptos {
namespace {

constexpr double kNothing = 1e-13;  // of what is projected: rigid motions alone, and their round-off

// P_D M P_D^T with P_D = I - D G^T (G D G^T)^-1 G, D = diag M: in Ker G, and the same for r and r + G^T a.  D = I would spread what moves a
// subdomain over all its rows alike, those between stiff and soft bodies, which M gives the soft one's stiffness, as well: counts grew with
// contrasts, 61, 52, 460 for 23, 17, 83 now.  Source: Bhardwaj et al. 2000 (superlumped Q).
class BalancedPreconditioner final : public Operator {
 public:
  BalancedPreconditioner(RCP<const Operator> M, const DualProblem& dual, RCP<const Vector> D, const CoarseProblem::Holds& holds)
      : M_(std::move(M)), G_(dual.G), D_(std::move(D)) {
    const auto weights = D_->getData();
    GDGT_ = std::make_unique<CoarseProblem>(dual.GGT->placement(), G_->rows(), std::vector<double>(weights.begin(), weights.end()), holds);
  }
  RCP<const Map> getDomainMap() const override { return M_->getDomainMap(); }
  RCP<const Map> getRangeMap() const override { return M_->getRangeMap(); }
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const override {
    MultiVector Dx(x.getMap(), x.getNumVectors()), z(x.getMap(), x.getNumVectors()), r(x, Teuchos::Copy);
    Dx.elementWiseMultiply(1.0, *D_, x, 0.0);
    G_->applyGT(GDGT_->solveSum(G_->partOfG(Dx)), r, -1.0, 1.0);  // r := P_D^T x
    M_->apply(r, z);
    G_->applyGT(GDGT_->solveSum(G_->partOfG(z)), r);
    z.elementWiseMultiply(-1.0, *D_, r, 1.0);  // z := P_D z
    y.update(alpha, z, beta);
  }

 private:
  RCP<const Operator> M_;
  RCP<const NaturalCoarseSpace> G_;
  RCP<const Vector> D_;
  std::unique_ptr<CoarseProblem> GDGT_;
};

}  // namespace

PcpgSolver::PcpgSolver(SolverContext context) : context_(std::move(context)) {
  x_ = Teuchos::rcp(new MultiVector(context_.system.dual().map(), 1));
  begin(context_.start);
  if (context_.system.hasSlenderSubdomains()) deflate();
  else if (!context_.system.preconditioner().is_null()) use(context_.system.preconditioner());
}

void PcpgSolver::use(RCP<const Operator> M) {
  const FetiSystem& system = context_.system;
  preconditioner_ = Teuchos::rcp(new BalancedPreconditioner(std::move(M), system.dual(), system.preconditioner()->diagonal(),
                                                            holdsFor(system.unheldMotions(), system.bodies())));
}

void PcpgSolver::deflate() {
  deflated_ = context_.system.makeDeflated();
  use(deflated_.is_null() ? RCP<const Operator>(context_.system.preconditioner()) : RCP<const Operator>(deflated_));
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

// Belos iterates on P F P x = b from where x is; the residual that is left, of the right-hand side's.
double PcpgSolver::iterate(double tolerance, long most) {
  using Problem = Belos::LinearProblem<double, MultiVector, Operator>;
  const RCP<const Operator> A = context_.system.dual().PFP;
  auto problem = Teuchos::rcp(new Problem(A, x_, b_));
  if (!preconditioner_.is_null()) problem->setLeftPrec(preconditioner_);
  problem->setProblem();
  auto list = Teuchos::parameterList();
  list->set("Maximum Iterations", int(std::max(1L, most)));
  list->set("Convergence Tolerance", tolerance);
  list->set("Implicit Residual Scaling", "Norm of RHS");
  Belos::PseudoBlockCGSolMgr<double, MultiVector, Operator> manager(problem, list);
  const bool passed = manager.solve() == Belos::Converged;
  iterations_ += manager.getNumIters();
  return passed ? 0.0 : manager.achievedTol();
}

// Where a first stretch shows that half as much again will not do, soft motions of elements or subdomains are at fault: M is deflated, which
// costs an application a coarse unknown.  Plates of elements 1 : 1 : .03 take 75 instead of 229; ordinary scenes end before.
bool PcpgSolver::converge(const SolveRequest& request) {
  constexpr long kFirst = 40;
  constexpr double kEnough = 2.0 / 3;  // of the digits
  const auto left = [&] { return request.maximumMultiplications - context_.system.dual().F->applications() - 1; };  // the last one is for s
  const bool mayDeflate = deflated_.is_null() && !preconditioner_.is_null();
  double residual = iterate(request.tolerance, mayDeflate ? std::min(kFirst, left() - 1) : left() - 1);
  if (residual == 0 || !mayDeflate || left() < 2) return residual == 0;
  if (residual > std::pow(request.tolerance, kEnough)) deflate();
  return iterate(request.tolerance, left() - 1) == 0;
}

// x in Ker G keeps G lambda = e: lambda = lambdaIm + P x, whatever round-off left in x.
bool PcpgSolver::solve(const SolveRequest& request) {
  const DualProblem& dual = context_.system.dual();
  const bool passed = b_->getVector(0)->norm2() == 0.0 || converge(request);
  outcome_ = passed ? Outcome::Converged : request.maximumMultiplications - dual.F->applications() < 3 ? Outcome::MultiplicationLimit : Outcome::NotConverged;

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
