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
  /// \brief Whether the method keeps G lambda = e by itself: equilibrium is then looked at only where all else passes.
  enum class Balance { Kept, Sought };

  /// \brief What is known of the largest displacement: that it hardly fell since it was recovered, or nothing.
  enum class Scale { Trusted, Doubted };

  KktEstimator(const FetiSystem& system, const LoadScales& loads, Balance balance)
      : system_(system), loads_(loads), isBalanced_(balance == Balance::Kept) {}

  /// \brief kkt, or `tolerance` where kkt is within what round-off hides (a tenth of the floor).
  ///
  /// Below the larger of both the displacement scale and the floor are renewed first, where that can matter.
  /// Collective: two reductions, a third where equilibrium is looked at.
  double estimate(const Vector& lambda, const Vector& s, double tolerance, Scale scale = Scale::Trusted);

  void limitRoundOff(double part) { partHidden_ = part; }  ///< of what it usually hides
  double kkt() const { return kkt_; }                ///< at the last estimate, floor or not
  bool isRoundOff() const { return kkt_ <= 30 * hidden(); }  ///< within three times the floor: more work can hardly lower it
  double contactForce() const { return contactForce_; }  ///< l_ref at the last estimate [force]

 private:
  // Of all ranks; no displacement scale is needed for them.
  struct Sizes {
    double reaction = 0, contactForce = 0, jump = 0;  // largest reaction, contact force, jump of an equality row
  };
  Sizes measureSizes(const Vector& lambda, const Vector& s) const;
  double measureEquilibrium(const Vector& lambda) const;
  double errorsAt(double uRef, const Vector& lambda, const Vector& s, double jump) const;
  double hidden() const;
  void renewScale(const Vector& lambda, const Vector& s);

  const FetiSystem& system_;
  const LoadScales& loads_;
  bool isBalanced_, isWithoutForce_ = false;
  double uRef_ = -1, roundOff_ = 0, floor_ = 0, kkt_ = 0, contactForce_ = 0, partHidden_ = 1;
};

}  // namespace Haptos
