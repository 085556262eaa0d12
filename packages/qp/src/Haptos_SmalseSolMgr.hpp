// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <BelosSolverManager.hpp>
#include <Teuchos_ParameterList.hpp>
#include <functional>
#include <optional>
#include <vector>

#include "Haptos_MpgpIter.hpp"
#include "Haptos_Options.hpp"
#include "Haptos_Outcome.hpp"
#include "Haptos_StatusTestProjectedGradient.hpp"

namespace Haptos {

/// \brief One outer step of SMALSE.
struct SmalseRecord {
  int hessianApplications = 0;     ///< so far, over all calls of solve(), norm estimate included
  double residual = 0;             ///< [-], what is compared with the tolerance
  double projectedGradient = 0;    ///< ||g^P|| / reference
  double equality = 0;             ///< rho ||Q (x - x0)|| / reference
  double setChange = 0;            ///< relative change of the set after this step
};

/// \brief What the manager is told: the constants of the method, and when it ends.
struct SmalseSolMgrOptions : SmalseOptions {
  double tolerance = 1e-6;  ///< what the dimensionless residual is compared with
  int maximumIterations = 1000;
  int maximumMultiplications = SolverOptions{}.maximumMultiplications;
  int normApplications = 10;
  int stagnationSteps = 50;

  static const OptionTable<SmalseSolMgrOptions>& table();
};

/// \brief SMALSE-M: semimonotonic augmented Lagrangians for separable sets and an equality.
///
/// Outer loop on a `QuadraticProgram`:
///
///   x^k:  MPGP on L(., mu^k) over Omega until ||g^P|| <= min(M ||Q (x - x0)||, eta)
///   if L grew by less than rho/2 ||Q (x^k - x0)||^2:  M := M / beta, not below its floor
///   mu^{k+1} := mu^k + rho Q (x^k - x0)
///   Omega := update(x^k)      connected iterates (Coulomb); the monitor of L then starts again
///
/// with rho = rho factor x ||A||.  All parameters and the residual are dimensionless: scaling A, b and Omega changes
/// nothing.  The multiplier, norm estimate and M are kept between calls of solve(), which continues where the last
/// call ended, at the tolerance set by then.  Registered in Belos' factory as "Haptos SMALSE".
/// Z. Dostal, R. Kucera, SIAM J. Optim. 20 (2010) 2913-2938; Z. Dostal, T. Kozubek, Math. Program. 135 (2012) 195-220.
template <class Scalar, class MV, class OP>
class SmalseSolMgr : public Belos::SolverManager<Scalar, MV, OP> {
 public:
  using Problem = QuadraticProgram<Scalar, MV, OP>;
  using Iteration = MpgpIter<Scalar, MV, OP>;
  /// (x, A x - b + mu after its update) -> dimensionless residual, the same on every rank.
  using OuterTest = std::function<double(const MV&, const MV&)>;

  SmalseSolMgr();
  Teuchos::RCP<Belos::SolverManager<Scalar, MV, OP>> clone() const override;

  /// \brief A `QuadraticProgram`; forgets multiplier, norm and counts.
  /// \throws std::invalid_argument for any other linear problem.
  void setProblem(const RCP<Belos::LinearProblem<Scalar, MV, OP>>& problem) override;

  /// \brief Names as in the input, with `Convergence Tolerance`, `Maximum Iterations` and the like beside them; names of
  /// version 0.1 are taken with a warning on Teuchos' default output.
  /// \throws InputError for a value out of range, a wrong type, or an unknown name, with the nearest valid one.
  void setParameters(const RCP<Teuchos::ParameterList>& parameters) override;

  /// \brief The same, typed.
  void setOptions(const SmalseSolMgrOptions& options);
  const SmalseSolMgrOptions& options() const { return options_; }

  /// \brief Called after every outer step; null for a fixed set.
  void setFeasibleSetUpdate(const RCP<FeasibleSetUpdate<MV>>& update) { update_ = update; }

  /// \brief Replaces the built-in test max(||g^P||, rho ||Q (x - x0)||) / ||b|| (and the set's relative change).
  ///
  /// Evaluated at inner iterates too, so that no inner loop goes on where the whole problem is solved already.
  void setOuterTest(const OuterTest& test) { outerTest_ = test; }

  /// \brief Called with every record, e.g. to print progress.
  void setObserver(const std::function<void(const SmalseRecord&)>& observer) { observer_ = observer; }

  /// \brief Starts from this multiplier (in Im Q) instead of 0; after setProblem and before the first solve().
  void setMultiplier(const RCP<MV>& mu) { startMultiplier_ = mu; }

  /// \brief Uses this estimate of ||A|| instead of computing one; after setProblem and before the first solve().
  void setOperatorNorm(const OperatorNorm& norm) { givenNorm_ = norm; }

  /// \brief Converged or Unconverged; `outcome()` says why.  Collective.
  /// \throws std::runtime_error on break-down, saying which assumption failed.
  Belos::ReturnType solve() override;

  Outcome outcome() const { return *outcome_; }  ///< after solve()
  const std::vector<SmalseRecord>& history() const { return history_; }  ///< over all calls of solve()
  MpgpCounts counts() const;                    ///< over all calls of solve(), norm estimate included
  OperatorNorm operatorNorm() const;            ///< as corrected by the iteration
  RCP<const MV> multiplier() const;             ///< mu; null before solve()
  RCP<const MV> gradient() const;               ///< A x - b + mu + rho Q (x - x0) at x; null before solve()
  double projectedGradient() const;             ///< ||g^P|| / reference

  const Belos::LinearProblem<Scalar, MV, OP>& getProblem() const override { return *problem_; }
  RCP<const Teuchos::ParameterList> getValidParameters() const override;
  RCP<const Teuchos::ParameterList> getCurrentParameters() const override { return parameters_; }
  typename Teuchos::ScalarTraits<Scalar>::magnitudeType achievedTol() const override { return residual_; }
  int getNumIters() const override { return int(history_.size()); }  ///< outer steps
  bool isLOADetected() const override { return outcome_ == Outcome::Stagnated; }
  void reset(const Belos::ResetType type) override;

 private:
  using Inner = StatusTestBalancedGradient<Scalar, MV, OP>;
  void prepare();
  bool accepts(const Iteration& iter) const;
  double builtInResidual(const Iteration& iter) const;
  void setInnerTest();
  void outerStep();
  void monitorLagrangian();
  void recordStep(double change);
  bool isFinished();
  bool stagnates();

  RCP<Problem> problem_;
  RCP<Teuchos::ParameterList> parameters_;
  SmalseSolMgrOptions options_;
  RCP<FeasibleSetUpdate<MV>> update_;
  OuterTest outerTest_;
  std::function<void(const SmalseRecord&)> observer_;
  RCP<MV> startMultiplier_, xStart_, gStart_, xLast_;
  OperatorNorm givenNorm_;
  RCP<Iteration> iter_;
  RCP<Inner> inner_;
  int normApplications_ = 0, stepsWithoutGain_ = 0, solveStart_ = 0;
  double rho_ = 0, M_ = 0, reference_ = 0, residual_ = -1, bestResidual_ = 0, setChange_ = 0;
  bool monitorIsValid_ = false;
  std::optional<Outcome> outcome_;
  std::vector<SmalseRecord> history_;
};

/// \brief Registers "Haptos SMALSE" with Belos::SolverFactory; may be called more than once.
void registerSmalseSolMgr();

extern template class SmalseSolMgr<double, MultiVector, Operator>;

}  // namespace Haptos
