// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_PcpgSolver.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <array>
#include <cmath>

#include "Haptos_ConjugateDirections.hpp"
#include "Haptos_FetiSystem.hpp"
#include "Haptos_Reductions.hpp"

namespace Haptos {

// P_D M P_D^T with P_D = I - D G^T (G D G^T)^-1 G, D = diag M: in Ker G, and the same for r and r + G^T a.  D = I would spread what moves a
// subdomain over all its rows alike, those between stiff and soft bodies, which M gives the soft one's stiffness, as well: counts grew with
// contrasts, 61, 52, 460 for 23, 17, 83 now.  Source: Bhardwaj et al. 2000 (superlumped Q).  Without M: P.
class BalancedPreconditioner {
 public:
  BalancedPreconditioner(RCP<const Operator> M, const DualProblem& dual, RCP<const Vector> D, const CoarseProblem::Holds& holds)
      : M_(std::move(M)), G_(dual.G), D_(std::move(D)) {
    const auto weights = D_->getData();
    GDGT_ = Teuchos::rcp(new CoarseProblem(dual.GGT->placement(), G_->rows(), std::vector<double>(weights.begin(), weights.end()), holds));
  }
  explicit BalancedPreconditioner(const DualProblem& dual) : G_(dual.G), GDGT_(dual.GGT) {}

  // r := P_D^T r, z := P_D M r
  void apply(Vector& r, Vector& z) const {
    z.update(1.0, r, 0.0);
    multiplyByD(z);
    G_->applyGT(GDGT_->solveSum(G_->partOfG(z)), r, -1.0, 1.0);
    if (M_.is_null()) return z.update(1.0, r, 0.0);
    M_->apply(r, z);
    Vector rest(z.getMap());
    G_->applyGT(GDGT_->solveSum(G_->partOfG(z)), rest);
    multiplyByD(rest);
    z.update(-1.0, rest, 1.0);
  }

 private:
  void multiplyByD(Vector& x) const {
    if (!D_.is_null()) x.elementWiseMultiply(1.0, *D_, x, 0.0);
  }

  RCP<const Operator> M_;
  RCP<const NaturalCoarseSpace> G_;
  RCP<const Vector> D_;
  RCP<const CoarseProblem> GDGT_;
};

namespace {

constexpr double kNothing = 1e-13;  // of what is projected: rigid motions alone, and their round-off

// (r . z, r . r) by one reduction.
std::array<double, 2> products(const Vector& r, const Vector& z) {
  std::array<double, 2> mine{0, 0};
  const auto a = r.getData(0), b = z.getData(0);
  for (Teuchos::Ordinal i = 0; i < a.size(); ++i) {
    mine[0] += a[i] * b[i];
    mine[1] += a[i] * a[i];
  }
  return sumOfAll(*r.getMap()->getComm(), mine);
}

// Whether it takes more than `many` iterations at the rate of so far.  Looked at now and then: the residual of conjugate gradients goes up and down.
bool takesMore(long many, long k, double residual, double tolerance) { return double(k) * std::log(tolerance) < double(many) * std::log(residual); }

}  // namespace

// Polynomials are cheap; spectral motions of large subdomains cost far more than those of others: these alone come first.
PcpgSolver::PcpgSolver(SolverContext context, int maximumDirections)
    : context_(std::move(context)), directions_(std::make_unique<ConjugateDirections>(*context_.system.dual().map(), maximumDirections)) {
  const FetiSystem& system = context_.system;
  if (!system.preconditioner().is_null()) {
    if (system.largestBoundary() > DeflatedMotions::kUsualSpectrum) cures_.push_back({DeflatedMotions::kLargestSpectrum});
    cures_.push_back({DeflatedMotions::kUsualSpectrum});
    if (system.mayDeflateByPolynomials()) cures_.push_back({Cure::kPolynomials});
  }
  begin(context_.start);
  if (!system.needsDeflation() || !(useAssembled() || deflate())) use(system.preconditioner());
}

PcpgSolver::~PcpgSolver() = default;

void PcpgSolver::use(RCP<const Operator> M) {
  const FetiSystem& system = context_.system;
  if (M.is_null()) {
    preconditioner_ = std::make_unique<BalancedPreconditioner>(system.dual());
    return;
  }
  preconditioner_ = std::make_unique<BalancedPreconditioner>(std::move(M), system.dual(), system.preconditioner()->diagonal(),
                                                             holdsFor(system.unheldMotions(), system.bodies()));
}

// Polynomials after few iterations; spectral motions, which cost far more, where it takes very many, and sooner where polynomials were no cure.
bool PcpgSolver::isTooSlow(long k, double residual, double tolerance) const {
  constexpr long kFirstLook = 8, kMany = 30;
  const long kLook = deflated_.is_null() ? 20 : 10, kVeryMany = deflated_.is_null() ? 60 : 40;
  if (cures_.empty()) return false;
  if (cures_.back().isPolynomials() && k == kFirstLook) return takesMore(kMany, k, residual, tolerance);
  return k > 0 && k % kLook == 0 && takesMore(kVeryMany, k, residual, tolerance);
}

// Whether there is another preconditioner.
bool PcpgSolver::deflate() {
  const FetiSystem& system = context_.system;
  const Cure cure = cures_.back();
  cures_.pop_back();
  const auto deflated = cure.isPolynomials() ? system.makeDeflatedByPolynomials() : system.makeDeflated(DeflatedMotions::Spectra{cure.largestBoundary});
  if (deflated.is_null()) return false;
  deflated_ = deflated;
  use(deflated_);
  return true;
}

bool PcpgSolver::useAssembled() {
  assembled_ = context_.system.makeAssembled();
  if (assembled_.is_null()) return false;
  use(assembled_);
  return true;
}

DeflationReport PcpgSolver::deflation() const {
  if (!deflated_.is_null()) return {deflated_->numCoarse(), deflated_->applications()};
  return assembled_.is_null() ? DeflationReport{} : DeflationReport{assembled_->numContinuous(), assembled_->applications()};
}

bool PcpgSolver::deflateByAny() {
  while (!cures_.empty())
    if (deflate()) return true;
  return false;
}

void PcpgSolver::renew() {
  history_.clear();
  begin(solution_.lambda);
}

// G lambda = e, whatever round-off the sum of many steps left: lambda := lambdaIm + P (lambda - lambdaIm)
void PcpgSolver::balance() {
  const DualProblem& dual = context_.system.dual();
  lambda_->update(-1.0, *dual.lambdaIm, 1.0);
  Vector inside(dual.map());
  dual.P->apply(*lambda_, inside);
  lambda_->update(1.0, *dual.lambdaIm, 1.0, inside, 0.0);
}

// lambda := lambdaIm + P start
void PcpgSolver::begin(const RCP<const Vector>& start) {
  const DualProblem& dual = context_.system.dual();
  const auto r = dual.jumpsOf(*dual.lambdaIm);
  Vector b(dual.map());
  dual.P->apply(*r, b);
  reference_ = b.norm2();
  // Loads that G^T alone carries leave round-off in b: to solve for that would take forever.
  if (reference_ <= kNothing * r->norm2()) reference_ = 0;
  const bool isStarted = reference_ > 0 && !start.is_null();
  lambda_ = Teuchos::rcp(new Vector(isStarted ? *start : *dual.lambdaIm, Teuchos::Copy));
  if (isStarted) balance();
}

// r = h - F lambda + G^T a with any a, as p . G^T a = 0; P_D^T takes a such that it is small.
//
//   r := P_D^T r,  z := P_D M r;   p := z - P (F P)^T z + (r.z / r_old.z_old) p;   t := r.z / p.F p;   lambda += t p,  r -= t F p
//
// P: directions that are kept, the last p not among them.  It ends early where M was deflated.
PcpgSolver::End PcpgSolver::iterate(double tolerance, long most) {
  constexpr int kUsual = 20;  // iterations of a problem of which none is kept
  const DualProblem& dual = context_.system.dual();
  Vector r(*dual.jumpsOf(*lambda_), Teuchos::Copy), z(dual.map()), p(dual.map()), Fp(dual.map());
  directions_->step(*lambda_, r);
  double before = 0;
  bool isKept = false;
  for (long k = 0;; ++k) {
    preconditioner_->apply(r, z);
    const auto [rz, rr] = products(r, z);
    const double residual = std::sqrt(rr) / reference_;
    if (residual <= tolerance) return End::Converged;
    if (k == most) return End::NoMore;
    if (isTooSlow(k, residual, tolerance) && deflate()) return End::Deflated;
    directions_->makeConjugate(z);
    p.update(1.0, z, k == 0 || isKept ? 0.0 : rz / before);
    dual.F->apply(p, Fp);
    const double pFp = p.dot(Fp);
    if (!(rz > 0 && pFp > 0)) return End::NoMore;  // round-off is all that is left; NaN is no success
    lambda_->update(rz / pFp, p, 1.0);
    r.update(-rz / pFp, Fp, 1.0);
    before = rz;
    isKept = ++iterations_ >= kUsual && !directions_->isFull();
    if (isKept) directions_->append(p, Fp, pFp);
  }
}

// Where this takes many iterations at the rate of so far, soft motions of elements or subdomains are at fault: M is deflated, which costs an
// application a coarse unknown.  Blocks of elements 1 : 1 : .03 take 36 instead of 259; ordinary scenes end before.
bool PcpgSolver::converge(const SolveRequest& request) {
  // Two more: where it begins again, and for s.
  const auto left = [&] { return std::max(1L, request.maximumMultiplications - context_.system.dual().F->applications() - 2); };
  for (;;) {
    const End end = iterate(request.tolerance, left());
    if (end == End::Converged) return true;
    if (left() < 2 || (end == End::NoMore && !deflateByAny())) return false;
  }
}

bool PcpgSolver::solve(const SolveRequest& request) {
  const DualProblem& dual = context_.system.dual();
  const bool passed = reference_ == 0.0 || converge(request);
  balance();
  outcome_ = passed ? Outcome::Converged : request.maximumMultiplications - dual.F->applications() < 3 ? Outcome::MultiplicationLimit : Outcome::NotConverged;

  solution_.lambda = Teuchos::rcp(new Vector(*lambda_, Teuchos::Copy));
  // s = P (h - F lambda): the rigid part is chosen so that nothing is left in Im G^T
  solution_.s = Teuchos::rcp(new Vector(dual.map()));
  dual.P->apply(*dual.jumpsOf(*lambda_), *solution_.s);
  history_.push_back({dual.F->applications(), reference_ > 0 ? solution_.s->norm2() / reference_ : 0.0, 0, 0, 0});
  if (context_.progress) context_.progress(history_.back());
  return passed;
}

}  // namespace Haptos
