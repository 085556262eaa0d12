// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "Haptos_ContactSolver.hpp"
#include "Haptos_DeflatedPreconditioner.hpp"

namespace Haptos {

class AssembledPreconditioner;
class BalancedPreconditioner;
class ConjugateDirections;

/// \brief Preconditioned conjugate projected gradients for bodies without contact (Farhat and Roux 1991).
///
/// F lambda = h + G^T a, G lambda = e, with the preconditioner P_D M P_D^T, P_D = I - D G^T (G D G^T)^-1 G and D = diag M; only equality
/// rows exist, so lambda is free.
class PcpgSolver final : public ContactSolver {
 public:
  /// \param maximumDirections that are kept where iterations are many
  PcpgSolver(SolverContext context, int maximumDirections);
  ~PcpgSolver() override;

  std::string name() const override { return "PCPG"; }
  bool solve(const SolveRequest& request) override;
  void renew() override;
  const DualSolution& solution() const override { return solution_; }
  Outcome outcome() const override { return outcome_; }
  int outerIterations() const override { return iterations_; }
  const std::vector<HistoryEntry>& history() const override { return history_; }
  DeflationReport deflation() const override;

 private:
  /// What M is deflated by where it takes many iterations: polynomials, or spectral motions of subdomains with boundaries up to so many unknowns.
  struct Cure {
    static constexpr int kPolynomials = 0;
    int largestBoundary;
    bool isPolynomials() const { return largestBoundary == kPolynomials; }
  };
  void begin(const RCP<const Vector>& start);
  void balance();
  void use(RCP<const Operator> M);
  bool useAssembled();
  bool deflate();
  bool deflateByAny();
  bool isTooSlow(long k, double residual, double tolerance) const;
  enum class End { Converged, Deflated, NoMore };
  End iterate(double tolerance, long most);
  bool converge(const SolveRequest& request);

  SolverContext context_;
  RCP<Vector> lambda_;      ///< G lambda = e
  double reference_ = 0;    ///< || P (h - F lambdaIm) || [length], what residuals are compared with; 0: loads need no lambda but lambdaIm
  std::unique_ptr<const BalancedPreconditioner> preconditioner_;
  std::unique_ptr<ConjugateDirections> directions_;  ///< once iterations are many
  std::vector<Cure> cures_;  ///< that were not tried yet, the next one last
  RCP<const AssembledPreconditioner> assembled_;  ///< where subdomains are slender, and that is cheaper
  RCP<const DeflatedPreconditioner> deflated_;  ///< where subdomains are slender, or iterations too many
  DualSolution solution_;
  Outcome outcome_ = Outcome::NotConverged;
  int iterations_ = 0;
  std::vector<HistoryEntry> history_;
};

}  // namespace Haptos
