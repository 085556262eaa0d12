// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_KktEstimator.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <cmath>
#include <limits>

#include "Haptos_Reductions.hpp"

namespace Haptos {

// The largest displacement of today, and what round-off does to forces at such displacements.
void KktEstimator::renewScale(const Vector& lambda, const Vector& s) {
  const auto u = recoverPrimal(system_.dual(), lambda, s);
  const auto data = u->getData(0);
  double mine = 0;
  for (int i = 0; i + 2 < int(data.size()); i += 3) mine = std::max(mine, std::hypot(data[i], data[i + 1], data[i + 2]));
  Teuchos::reduceAll(*system_.model().comm, Teuchos::REDUCE_MAX, mine, Teuchos::outArg(uRef_));
  const double contact = std::sqrt(sumOfAll(*system_.model().comm, squaresOfContactForces(system_.law(), lambda)));
  const double ext = externalForce(loads_, measureReactions(system_.jump().multipliers(), lambda).norm, contact);
  roundOff_ = roundOffForce(system_.systems(), system_.jump().primalOffsets(), *u);
  floor_ = ext > 0 ? roundOff_ / ext : 0.0;
}

// One reduction for all three.
KktEstimator::Sizes KktEstimator::measureSizes(const Vector& lambda, const Vector& s) const {
  const auto& kinds = system_.jump().multipliers().kinds();
  double mine[3] = {localReactions(system_.jump().multipliers(), lambda).largest, largestContactForce(system_.law(), lambda), 0}, all[3];
  const auto data = s.getData(0);
  for (std::size_t row = 0; row < kinds.size(); ++row)
    if (isEquality(kinds[row])) mine[2] = std::max(mine[2], std::abs(data[row]));
  Teuchos::reduceAll(*system_.model().comm, Teuchos::REDUCE_MAX, 3, mine, all);
  return {all[0], all[1], all[2]};
}

// || G lambda - e || / ext: the part of equilibrium that a dual method can miss; the rest holds by construction of u.
double KktEstimator::measureEquilibrium(const Vector& lambda) const {
  const Eigen::VectorXd part = system_.dual().G->partOfG(lambda);
  Eigen::VectorXd mine(part.size() + 2), all(part.size() + 2);
  mine << part, localReactions(system_.jump().multipliers(), lambda).squares, squaresOfContactForces(system_.law(), lambda);
  Teuchos::reduceAll(*system_.model().comm, Teuchos::REDUCE_SUM, int(mine.size()), mine.data(), all.data());
  const double ext = externalForce(loads_, std::sqrt(all[part.size()]), std::sqrt(all[part.size() + 1]));
  const double rest = (all.head(part.size()) - system_.dual().e).norm();
  if (!std::isfinite(rest)) return std::numeric_limits<double>::infinity();  // NaN would be lost in comparisons
  return ext > 0 && !isWithoutForce_ ? rest / ext : 0.0;
}

// All but equilibrium.  Collective: one reduction.
double KktEstimator::errorsAt(double uRef, const Vector& lambda, const Vector& s, double jump) const {
  KktErrors errors = measureContact(system_.law(), lambda, s, uRef, contactForce_);
  if (isWithoutForce_) errors.compression = errors.complementarity = errors.cone = errors.slipLaw = 0;
  // An orthonormal row of two copies is their difference over sqrt(2).
  errors.continuity = uRef > 0 ? std::sqrt(2.0) * jump / uRef : (jump > 0 ? 1.0 : 0.0);
  return errors.kkt();
}

// What round-off hides; 0 where there is no answer yet that it could hide.
double KktEstimator::hidden() const {
  constexpr double kLargestFloor = 1e-2;  // above it the state is a start without forces, not an answer hidden by round-off
  return floor_ < kLargestFloor ? partHidden_ * Accuracy::kReached * floor_ : 0.0;
}

// In the order of cost: contact and gluing, equilibrium, and a local solve for the scale only where all else passes.
double KktEstimator::estimate(const Vector& lambda, const Vector& s, double tolerance, Scale scale) {
  constexpr double kShrunk = 0.25;
  if (uRef_ < 0) renewScale(lambda, s);
  const Sizes sizes = measureSizes(lambda, s);
  isWithoutForce_ = isWithoutForce(loads_, std::max(sizes.contactForce, sizes.reaction), roundOff_);
  contactForce_ = contactForceScale(sizes.contactForce, std::max(loads_.largest, sizes.reaction));
  kkt_ = errorsAt(uRef_, lambda, s, sizes.jump);
  if (isBalanced_ && kkt_ > std::max(tolerance, hidden())) return kkt_;
  const double equilibrium = measureEquilibrium(lambda);
  kkt_ = std::max(kkt_, equilibrium);
  if (kkt_ > std::max(tolerance, hidden())) return kkt_;
  // No error falls when uRef does: what passes at a quarter of it passes at the scale of today, unless bodies came a long way.
  const auto atAnyScale = [&] { return std::max(equilibrium, errorsAt(kShrunk * uRef_, lambda, s, sizes.jump)); };
  const bool isScaleTrusted = scale == Scale::Trusted && system_.floatingMotions().basis.cols() == 0;
  if (kkt_ <= tolerance && isScaleTrusted && atAnyScale() <= tolerance) return kkt_;
  renewScale(lambda, s);
  kkt_ = std::max(equilibrium, errorsAt(uRef_, lambda, s, sizes.jump));
  return kkt_ <= hidden() ? std::min(kkt_, tolerance) : kkt_;
}

}  // namespace Haptos
