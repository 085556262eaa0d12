// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_KktEstimator.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <cmath>

namespace Haptos {

void KktEstimator::renewScale(const Vector& lambda, const Vector& s) {
  const auto u = recoverPrimal(system_.dual(), system_.f(), system_.c(), lambda, s);
  const auto data = u->getData(0);
  double mine = 0;
  for (int i = 0; i + 2 < int(data.size()); i += 3) mine = std::max(mine, std::hypot(data[i], data[i + 1], data[i + 2]));
  Teuchos::reduceAll(*system_.model().comm, Teuchos::REDUCE_MAX, mine, Teuchos::outArg(uRef_));
  const double ext = std::max(loads_.norm, measureReactions(system_.jump().multipliers(), lambda).norm);
  floor_ = roundOffFloor(system_.systems(), system_.jump().primalOffsets(), *u, ext);
}

KktErrors KktEstimator::measure(const Vector& lambda, const Vector& s, double uRef) const {
  const MultiplierMap& multipliers = system_.jump().multipliers();
  const LoadScales reactions = measureReactions(multipliers, lambda);
  KktErrors errors = measureContact(system_.law(), lambda, s, {uRef, std::max(loads_.largest, reactions.largest)});
  const double ext = std::max(loads_.norm, reactions.norm);
  const Eigen::MatrixXd imbalance = system_.dual().G->applyG(lambda) - system_.dual().e;
  errors.equilibrium = ext > 0 ? imbalance.norm() / ext : 0.0;
  // An orthonormal row of two copies is their difference over sqrt(2).
  double mine = 0, largest = 0;
  const auto data = s.getData(0);
  for (std::size_t row = 0; row < multipliers.kinds().size(); ++row)
    if (isEquality(multipliers.kinds()[row]))
      mine = std::max(mine, std::abs(data[row]));
  Teuchos::reduceAll(*system_.model().comm, Teuchos::REDUCE_MAX, mine, Teuchos::outArg(largest));
  errors.continuity = uRef > 0 ? std::sqrt(2.0) * largest / uRef : (largest > 0 ? 1.0 : 0.0);
  return errors;
}

// No error falls when uRef does: what passes at a quarter of it passes at the scale of today, unless floating bodies came a long way.
bool KktEstimator::passesAnyScale(const Vector& lambda, const Vector& s, double tolerance) const {
  constexpr double kShrunk = 0.25;
  return system_.floatingMotions().basis.cols() == 0 && measure(lambda, s, kShrunk * uRef_).kkt() <= tolerance;
}

double KktEstimator::estimate(const Vector& lambda, const Vector& s, double tolerance) {
  constexpr double kHidden = 0.1;        // of the floor, which is a bound: measured errors end at about this
  constexpr double kLargestFloor = 1e-2;  // above it the state is a start without forces, not an answer hidden by round-off
  const auto hidden = [&] { return floor_ < kLargestFloor ? kHidden * floor_ : 0.0; };
  if (uRef_ < 0) renewScale(lambda, s);
  kkt_ = measure(lambda, s, uRef_).kkt();
  if (kkt_ > std::max(tolerance, hidden())) return kkt_;
  if (kkt_ <= tolerance && passesAnyScale(lambda, s, tolerance)) return kkt_;
  renewScale(lambda, s);
  kkt_ = measure(lambda, s, uRef_).kkt();
  return kkt_ <= hidden() ? std::min(kkt_, tolerance) : kkt_;
}

}  // namespace Haptos
