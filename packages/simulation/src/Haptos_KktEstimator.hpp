// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_Accuracy.hpp"
#include "Haptos_FetiSystem.hpp"

namespace Haptos {

/// \brief kkt as a dual method can see it, from lambda and s = B u - c, without the element matrices.
///
/// The largest displacement is recovered (one local solve a subdomain, no F) at the first call, and again where
/// the estimate passes the tolerance, unless it would with a quarter of that displacement.  The final accuracy is measured
/// elsewhere, from u.
class KktEstimator {
 public:
  KktEstimator(const FetiSystem& system, const LoadScales& loads) : system_(system), loads_(loads) {}

  /// \brief kkt, or `tolerance` where kkt is within what round-off hides (a tenth of the floor).  Collective.
  ///
  /// Below the larger of both the displacement scale and the floor are renewed first, where that can matter.
  double estimate(const Vector& lambda, const Vector& s, double tolerance);

  double kkt() const { return kkt_; }  ///< at the last estimate, floor or not

 private:
  KktErrors measure(const Vector& lambda, const Vector& s, double uRef) const;
  bool passesAnyScale(const Vector& lambda, const Vector& s, double tolerance) const;
  void renewScale(const Vector& lambda, const Vector& s);

  const FetiSystem& system_;
  const LoadScales& loads_;
  double uRef_ = -1, floor_ = 0, kkt_ = 0;
};

}  // namespace Haptos
