// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <BelosSolverManager.hpp>
#include <Teuchos_ParameterList.hpp>
#include <functional>
#include <memory>
#include <optional>

#include "Haptos_ContactProblem.hpp"
#include "Haptos_Outcome.hpp"

namespace Haptos {

class SubspaceNewtonRun;
struct SubspaceNewtonOptions;

/// \brief One step of the subspace Newton method.
struct SubspaceNewtonRecord {
  long hessianApplications = 0;  ///< so far, over all calls of solve()
  double residual = 0;           ///< [-] of the level; at the true coefficients what is compared with the tolerance
  bool isFinalLevel = false;     ///< the true coefficients of friction
};

/// \brief Subspace Newton with continuation in the friction coefficients, all pairs kept between the levels.
///
/// Levels: where the axes differ by much the small coefficient is raised and lowered again step by step; then
/// larger coefficients; then the true ones.  A stall drops all pairs and comes back through more levels.
/// Works on a `ContactProblem`; registered in Belos' factory as "Haptos Subspace Newton".  solve() may be called
/// again with a tighter tolerance and then goes on where it was.  All parameters are dimensionless.
class SubspaceNewtonSolMgr final : public Belos::SolverManager<double, MultiVector, Operator> {
 public:
  using LinearProblem = Belos::LinearProblem<double, MultiVector, Operator>;
  /// (lambda, s) -> dimensionless residual, the same on every rank.
  using StatusTest = std::function<double(const Vector&, const Vector&)>;
  using Observer = std::function<void(const SubspaceNewtonRecord&, const Vector&)>;
  /// Both may be empty.
  struct Hooks {
    StatusTest statusTest;
    Observer observer;
  };

  SubspaceNewtonSolMgr();
  ~SubspaceNewtonSolMgr() override;
  Teuchos::RCP<Belos::SolverManager<double, MultiVector, Operator>> clone() const override;

  /// \brief A `ContactProblem`; forgets all pairs and the state.
  /// \throws std::invalid_argument for any other linear problem.
  void setProblem(const RCP<LinearProblem>& problem) override;

  /// \throws InputError for a value out of range, a wrong type, or an unknown name, with the nearest valid one.
  void setParameters(const RCP<Teuchos::ParameterList>& parameters) override;

  /// \brief The same, typed, with the numbers that are no parameters.
  void setOptions(const SubspaceNewtonOptions& options);
  const SubspaceNewtonOptions& options() const { return *options_; }

  /// \brief Replaces the built-in test || (s_E, phi) || / || s of the start ||.
  void setStatusTest(StatusTest test) { hooks_.statusTest = std::move(test); }

  /// \brief Called with every step and its multipliers, e.g. to print progress.
  void setObserver(Observer observer) { hooks_.observer = std::move(observer); }

  /// \brief Goes on from other multipliers and jumps at the next solve(), without continuation and without pairs.
  /// Collective; after setProblem.
  void startFrom(const Vector& lambda, const Vector& s);

  /// \brief For a further solve() of the same problem: jumps of the result, computed anew by a caller that needs no F for them.  Collective.
  void setJumps(const Vector& s);

  /// \brief The problem has other loads or laws (ContactProblem::setStep): the next solve() goes on from the present multipliers,
  /// with all pairs, which depend on F and G alone; without them where coefficients have become 0, or are no longer.  Collective.
  void goOn();

  /// \brief Converged or Unconverged; `outcome()` says why.  Collective.
  /// \throws std::runtime_error on break-down.
  Belos::ReturnType solve() override;

  Outcome outcome() const { return *outcome_; }  ///< after solve()
  RCP<const Vector> jumps() const;  ///< s = h - F lambda + G^T a [length] of the result
  long hessianApplications() const;  ///< since setProblem

  /// \brief The recycled pairs: how many at most, how often old ones were dropped, memory on this rank.
  struct Subspace {
    long largestSize = 0;
    int compressions = 0;
    double memoryMb = 0;
  };
  Subspace subspace() const;

  const LinearProblem& getProblem() const override { return *problem_; }
  RCP<const Teuchos::ParameterList> getValidParameters() const override;
  RCP<const Teuchos::ParameterList> getCurrentParameters() const override { return parameters_; }
  double achievedTol() const override;
  int getNumIters() const override;
  bool isLOADetected() const override { return outcome_ == Outcome::Stalled; }
  void reset(const Belos::ResetType type) override;

 private:
  SubspaceNewtonRun& run();

  RCP<ContactProblem> problem_;
  RCP<Teuchos::ParameterList> parameters_;
  std::unique_ptr<SubspaceNewtonOptions> options_;  // typed parameters_
  Hooks hooks_;
  std::unique_ptr<SubspaceNewtonRun> run_;  // since setProblem, from the first use on
  std::optional<Outcome> outcome_;
};

/// \brief Registers "Haptos Subspace Newton" with Belos::SolverFactory; may be called more than once.
void registerSubspaceNewtonSolMgr();

}  // namespace Haptos
