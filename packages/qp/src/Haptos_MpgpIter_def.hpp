// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "Haptos_MpgpIter.hpp"
#include "Haptos_VectorDetails.hpp"

namespace Haptos {

template <class Scalar, class MV, class OP>
MpgpIter<Scalar, MV, OP>::MpgpIter(const RCP<Problem>& problem, const RCP<Test>& stop, const OperatorNorm& normA,
                                   const MpgpOptions& options)
    : problem_(problem), stop_(stop), normA_(normA), options_(options), x_(problem->getLHS()) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  for (RCP<MV>* v : {&g_, &c_, &Qx0_, &mu_, &phi_, &phiR_, &beta_, &p_, &Hp_, &Qp_, &dx_, &xSaved_, &gSaved_, &cSaved_})
    *v = MVT::Clone(*x_, 1);
  MVT::MvInit(*mu_, 0);
  MVT::MvInit(*Qx0_, 0);
  if (!problem_->particularPoint().is_null()) problem_->applyEqualityProjector(*problem_->particularPoint(), *Qx0_);
}

template <class Scalar, class MV, class OP>
void MpgpIter<Scalar, MV, OP>::setPenalty(Scalar rho, const RCP<MV>& mu) {
  rho_ = rho;
  if (!mu.is_null()) Details::copy<Scalar>(*mu, *mu_);
  initialized_ = false;
}

template <class Scalar, class MV, class OP>
void MpgpIter<Scalar, MV, OP>::initialize() {
  problem_->feasibleSet()->project(*x_);
  evaluateGradient();
  restartDirection();
  initialized_ = true;
}

template <class Scalar, class MV, class OP>
void MpgpIter<Scalar, MV, OP>::iterate() {
  if (!initialized_) initialize();

  while (stop_->checkStatus(this) != Belos::Passed) {
    if (isProportional()) {
      const Scalar pAp = applyToDirection();
      const Scalar alphaCg = pAp > 0 ? Details::dot<Scalar>(*g_, *p_) / pAp : std::numeric_limits<Scalar>::infinity();
      const Scalar alphaFeasible = problem_->feasibleSet()->maxFeasibleStep(*x_, *p_);
      TEUCHOS_TEST_FOR_EXCEPTION(std::isinf(alphaCg) && std::isinf(alphaFeasible), UnboundedCost,
                                 "MPGP: the cost is unbounded from below: A has a zero eigenvalue along which "
                                 "neither the set nor the equality holds the iterate");
      if (alphaCg <= alphaFeasible)
        conjugateGradientStep(alphaCg, pAp);
      else
        expansionStep(alphaCg, alphaFeasible);
    } else {
      proportioningStep();
    }
    ++iter_;
  }
}

template <class Scalar, class MV, class OP>
bool MpgpIter<Scalar, MV, OP>::isProportional() const {
  return betaSquared_ <= options_.gamma * options_.gamma * phiRphi_;  // ||beta||^2 <= Gamma^2 phiR^T phi
}

template <class Scalar, class MV, class OP>
void MpgpIter<Scalar, MV, OP>::conjugateGradientStep(Scalar alphaCg, Scalar pAp) {
  Details::add<Scalar>(*x_, -alphaCg, *p_);   // x := x - alphaCg p
  Details::add<Scalar>(*g_, -alphaCg, *Hp_);  // g := g - alphaCg H p
  Details::add<Scalar>(*c_, -alphaCg, *Qp_);
  splitGradient();
  const Scalar betaCg = Details::dot<Scalar>(*phi_, *Hp_) / pAp;
  Belos::MultiVecTraits<Scalar, MV>::MvAddMv(1, *phi_, -betaCg, *p_, *p_);  // p := phi - betaCg p
  ++counts_.cg;
}

template <class Scalar, class MV, class OP>
void MpgpIter<Scalar, MV, OP>::expansionStep(Scalar alphaCg, Scalar alphaFeasible) {
  Details::add<Scalar>(*x_, -alphaFeasible, *p_);   // x := x - alphaFeasible p, on the border of the face
  Details::add<Scalar>(*g_, -alphaFeasible, *Hp_);
  Details::add<Scalar>(*c_, -alphaFeasible, *Qp_);
  splitGradient();
  save();
  // what x := P(x - phi/||H||) is bound to gain
  const Scalar bound = Details::dot<Scalar>(*phiR_, *phiR_) / (2 * hessianNorm());
  bool done = false;
  if (options_.expansion != Expansion::FixedStep && std::isfinite(alphaCg)) {
    if (trialsToSkip_ > 0)
      --trialsToSkip_;
    else
      done = tryProjectedCgStep(alphaCg - alphaFeasible, bound);
  }
  if (!done) gradientProjectionStep(*phi_);
  restartDirection();
  ++counts_.expansion;
}

template <class Scalar, class MV, class OP>
bool MpgpIter<Scalar, MV, OP>::tryProjectedCgStep(Scalar length, Scalar requiredDecrease) {
  Details::add<Scalar>(*x_, -length, *p_);
  problem_->feasibleSet()->project(*x_);
  evaluateGradient();
  if (decreaseSinceSaved() >= requiredDecrease) {
    lastSkip_ = 0;
    return true;
  }
  takeBack();
  if (options_.expansion == Expansion::Automatic) trialsToSkip_ = lastSkip_ = std::min(16, 2 * lastSkip_ + 1);
  return false;
}

template <class Scalar, class MV, class OP>
void MpgpIter<Scalar, MV, OP>::proportioningStep() {
  save();
  Belos::MultiVecTraits<Scalar, MV>::MvAddMv(1, *g_, -1, *phi_, *Hp_);  // g on active entries only
  gradientProjectionStep(*Hp_);
  restartDirection();
  ++counts_.proportioning;
}

/// x := P(x - alphaBar direction); if the cost grew, ||H|| was underestimated: raises it and tries again.
template <class Scalar, class MV, class OP>
void MpgpIter<Scalar, MV, OP>::gradientProjectionStep(const MV& direction) {
  for (;;) {
    Details::add<Scalar>(*x_, -alphaBar(), direction);
    problem_->feasibleSet()->project(*x_);
    evaluateGradient();
    const Scalar decrease = decreaseSinceSaved();
    const Scalar dxdx = Details::dot<Scalar>(*dx_, *dx_);
    if (!(dxdx > 0)) return;
    // dx^T H dx = dx^T (g - gSaved) is at most ||H|| dx^T dx
    Belos::MultiVecTraits<Scalar, MV>::MvAddMv(1, *g_, -1, *gSaved_, *Qp_);
    const Scalar curvature = Details::dot<Scalar>(*dx_, *Qp_) / dxdx;
    if (!(curvature > hessianNorm())) return;
    if (!raiseNorm(curvature) || decrease >= 0) return;  // no shorter step would be tried: what is left is round-off
    takeBack();
  }
}

template <class Scalar, class MV, class OP>
void MpgpIter<Scalar, MV, OP>::evaluateGradient() {
  problem_->applyHessian(*x_, *g_, *c_);
  ++counts_.hessianApplications;
  Details::add<Scalar>(*c_, -1, *Qx0_);
  Details::add<Scalar>(*g_, -1, *problem_->getRHS());
  Details::add<Scalar>(*g_, 1, *mu_);
  Details::add<Scalar>(*g_, rho_, *c_);
}

template <class Scalar, class MV, class OP>
void MpgpIter<Scalar, MV, OP>::splitGradient() {
  problem_->feasibleSet()->splitGradient(*x_, *g_, alphaBar(), *phi_, *phiR_, *beta_);
  phiRphi_ = Details::dot<Scalar>(*phiR_, *phi_);
  betaSquared_ = Details::dot<Scalar>(*beta_, *beta_);
  normGP_ = std::sqrt(Details::dot<Scalar>(*phiR_, *phiR_) + betaSquared_);  // disjoint supports
  normC_ = Details::norm<Scalar>(*c_);
  TEUCHOS_TEST_FOR_EXCEPTION(!std::isfinite(normGP_) || !std::isfinite(normC_), std::runtime_error,
                             "MPGP: the gradient is not finite: the operator returned NaN or infinity");
}

template <class Scalar, class MV, class OP>
void MpgpIter<Scalar, MV, OP>::restartDirection() {
  splitGradient();
  Details::copy<Scalar>(*phi_, *p_);
}

/// Hp := H p, Qp := Q p; returns p^T H p, 0 if that is round-off.
template <class Scalar, class MV, class OP>
Scalar MpgpIter<Scalar, MV, OP>::applyToDirection() {
  problem_->applyHessian(*p_, *Hp_, *Qp_);
  ++counts_.hessianApplications;
  Details::add<Scalar>(*Hp_, rho_, *Qp_);
  const Scalar pAp = Details::dot<Scalar>(*p_, *Hp_), pp = Details::dot<Scalar>(*p_, *p_);
  const Scalar length = Details::norm<Scalar>(*Hp_);
  TEUCHOS_TEST_FOR_EXCEPTION(!std::isfinite(pAp), std::runtime_error,
                             "MPGP: p^T H p is not finite: the operator returned NaN or infinity");
  if (length * length > hessianNorm() * hessianNorm() * pp) raiseNorm(length / std::sqrt(pp));
  const Scalar roundOff = 1e-13 * hessianNorm() * pp;
  TEUCHOS_TEST_FOR_EXCEPTION(pAp < -1e3 * roundOff, std::runtime_error,
                             "MPGP: the Hessian is not positive semidefinite: p^T H p / (||H|| p^T p) = "
                                 << pAp / (hessianNorm() * pp));
  return pAp > roundOff ? pAp : Scalar(0);
}

template <class Scalar, class MV, class OP>
Scalar MpgpIter<Scalar, MV, OP>::hessianNorm() const {
  if (!problem_->hasEquality()) return normA_.value;
  return normA_.decoupled ? std::max<Scalar>(normA_.value, rho_) : normA_.value + rho_;
}

template <class Scalar, class MV, class OP>
bool MpgpIter<Scalar, MV, OP>::raiseNorm(Scalar curvature) {
  const Scalar missing = curvature - hessianNorm();
  if (missing <= 1e-12 * curvature) return false;
  normA_.value = std::max<Scalar>(normA_.value, hessianNorm() - (normA_.decoupled ? 0 : rho_)) + missing;
  normA_.value += 0.05 * curvature;
  ++counts_.normCorrections;
  return true;
}

template <class Scalar, class MV, class OP>
void MpgpIter<Scalar, MV, OP>::save() {
  Details::copy<Scalar>(*x_, *xSaved_);
  Details::copy<Scalar>(*g_, *gSaved_);
  Details::copy<Scalar>(*c_, *cSaved_);
}

template <class Scalar, class MV, class OP>
void MpgpIter<Scalar, MV, OP>::takeBack() {
  Details::copy<Scalar>(*xSaved_, *x_);
  Details::copy<Scalar>(*gSaved_, *g_);
  Details::copy<Scalar>(*cSaved_, *c_);
  ++counts_.rejected;
}

/// L(saved) - L(x) = -1/2 dx^T (g + gSaved), without cancellation; leaves dx in dx_.
template <class Scalar, class MV, class OP>
Scalar MpgpIter<Scalar, MV, OP>::decreaseSinceSaved() {
  Belos::MultiVecTraits<Scalar, MV>::MvAddMv(1, *x_, -1, *xSaved_, *dx_);
  return -(Details::dot<Scalar>(*dx_, *g_) + Details::dot<Scalar>(*dx_, *gSaved_)) / 2;
}

template <class Scalar, class MV, class OP>
void MpgpIter<Scalar, MV, OP>::updateMultiplier() {
  Details::add<Scalar>(*mu_, rho_, *c_);
  Details::add<Scalar>(*g_, rho_, *c_);
  restartDirection();
}

template <class Scalar, class MV, class OP>
void MpgpIter<Scalar, MV, OP>::feasibleSetChanged(const MV& xBefore) {
  problem_->feasibleSet()->project(*x_);
  Belos::MultiVecTraits<Scalar, MV>::MvAddMv(1, *x_, -1, xBefore, *dx_);
  if (Details::dot<Scalar>(*dx_, *dx_) > 0) evaluateGradient();
  restartDirection();
}

template <class Scalar, class MV, class OP>
RCP<const MV> MpgpIter<Scalar, MV, OP>::getNativeResiduals(
    std::vector<typename Teuchos::ScalarTraits<Scalar>::magnitudeType>* norms) const {
  if (norms != nullptr) {
    norms->assign(1, normGP_);
    return Teuchos::null;
  }
  const RCP<MV> gP = Belos::MultiVecTraits<Scalar, MV>::CloneCopy(*phiR_);
  Details::add<Scalar>(*gP, 1, *beta_);
  return gP;
}

template <class Scalar, class MV, class OP>
void MpgpIter<Scalar, MV, OP>::setBlockSize(int blockSize) {
  TEUCHOS_TEST_FOR_EXCEPTION(blockSize != 1, std::invalid_argument,
                             "MpgpIter: the block size is 1, got " << blockSize);
}

}  // namespace Haptos
