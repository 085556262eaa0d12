// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <BelosIteration.hpp>
#include <BelosStatusTest.hpp>
#include <vector>

#include "Haptos_OperatorNorm.hpp"
#include "Haptos_Options.hpp"
#include "Haptos_QuadraticProgram.hpp"

namespace Haptos {

/// \brief Steps by kind and what they cost.
struct MpgpCounts {
  int cg = 0;                   ///< conjugate gradient steps
  int expansion = 0;            ///< expansion steps
  int proportioning = 0;        ///< proportioning steps
  int rejected = 0;             ///< trial steps taken back (each costs one application)
  int normCorrections = 0;      ///< times the estimate of ||H|| proved too small
  int hessianApplications = 0;  ///< products with A (and Q)
};

/// \brief MPGP: modified proportioning with gradient projection, for the augmented Lagrangian
///
///   L(x) = 1/2 x^T A x - b^T x + mu^T Q (x - x0) + rho/2 ||Q (x - x0)||^2   over Omega,   H = A + rho Q
///
/// Proportional iterates, ||beta||^2 <= Gamma^2 phiR^T phi, take conjugate gradient steps on the face of the free
/// entries or, at its border, an expansion step; the others a proportioning step P(x - alphaBar beta).  Every step
/// costs one multiplication by A, an expansion one more.  Tracks g = grad L and c = Q (x - x0).
/// Z. Dostal, R. Kucera, SIAM J. Optim. 20 (2010) 2913-2938; Z. Dostal, T. Kozubek, Math. Program. 135 (2012) 195-220;
/// expansion by projected conjugate gradients: J. Kruzik et al., Adv. Eng. Softw. 150 (2020) 102895.
/// All methods that change the iterate are collective.
template <class Scalar, class MV, class OP>
class MpgpIter : public Belos::Iteration<Scalar, MV, OP> {
 public:
  using Problem = QuadraticProgram<Scalar, MV, OP>;
  using Test = Belos::StatusTest<Scalar, MV, OP>;

  /// \brief normA: an estimate of ||A||, corrected where the iteration meets a larger curvature.
  MpgpIter(const RCP<Problem>& problem, const RCP<Test>& stop, const OperatorNorm& normA, const MpgpOptions& options);

  /// \brief Sets the penalty rho >= 0 and, unless null, the multiplier mu (in Im Q); invalidates the gradient.
  void setPenalty(Scalar rho, const RCP<MV>& mu = Teuchos::null);

  /// \brief Projects the problem's x on Omega and evaluates the gradient there; one application.
  void initialize() override;

  /// \brief Iterates until the status test passes.
  /// \throws std::runtime_error on break-down, naming the assumption that failed (A not >= 0, unbounded, NaN).
  void iterate() override;

  /// \brief mu := mu + rho Q (x - x0), and the gradient with it; no application.
  void updateMultiplier();

  /// \brief To be called after Omega (or x) changed: projects x; one application if x is not what it was.
  /// \param xBefore the x of the current gradient
  void feasibleSetChanged(const MV& xBefore);

  const MpgpCounts& counts() const { return counts_; }
  const OperatorNorm& operatorNorm() const { return normA_; }
  const MV& solution() const { return *x_; }
  const MV& gradient() const { return *g_; }             ///< grad L = A x - b + mu + rho Q (x - x0)
  const MV& multiplier() const { return *mu_; }          ///< mu
  Scalar projectedGradientNorm() const { return normGP_; }  ///< ||g^P||, g^P = phiR + beta
  Scalar equalityNorm() const { return normC_; }         ///< ||Q (x - x0)||

  int getNumIters() const override { return iter_; }
  void resetNumIters(int iter = 0) override { iter_ = iter; }
  /// \brief The projected gradient phiR + beta, or, if `norms` is given, its norm and null.
  RCP<const MV> getNativeResiduals(std::vector<typename Teuchos::ScalarTraits<Scalar>::magnitudeType>* norms)
      const override;
  RCP<MV> getCurrentUpdate() const override { return x_; }
  const Belos::LinearProblem<Scalar, MV, OP>& getProblem() const override { return *problem_; }
  int getBlockSize() const override { return 1; }
  void setBlockSize(int blockSize) override;
  bool isInitialized() override { return initialized_; }

 private:
  bool isProportional() const;
  Scalar hessianNorm() const;
  Scalar alphaBar() const { return options_.stepLength / hessianNorm(); }
  void evaluateGradient();
  void splitGradient();
  void restartDirection();
  Scalar applyToDirection();
  bool raiseNorm(Scalar curvature);
  void conjugateGradientStep(Scalar alphaCg, Scalar pAp);
  void expansionStep(Scalar alphaCg, Scalar alphaFeasible);
  bool tryProjectedCgStep(Scalar length, Scalar requiredDecrease);
  void gradientProjectionStep(const MV& direction);
  void proportioningStep();
  void save();
  void takeBack();
  Scalar decreaseSinceSaved();

  RCP<Problem> problem_;
  RCP<Test> stop_;
  OperatorNorm normA_;
  MpgpOptions options_;
  MpgpCounts counts_;
  RCP<MV> x_, g_, c_, Qx0_, mu_;
  RCP<MV> phi_, phiR_, beta_, p_, Hp_, Qp_, dx_;
  RCP<MV> xSaved_, gSaved_, cSaved_;
  Scalar rho_ = 0, normGP_ = 0, normC_ = 0, phiRphi_ = 0, betaSquared_ = 0;
  int iter_ = 0, trialsToSkip_ = 0, lastSkip_ = 0;
  bool initialized_ = false;
};

extern template class MpgpIter<double, MultiVector, Operator>;

}  // namespace Haptos
