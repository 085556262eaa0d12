// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "Haptos_BoundEllipseSet.hpp"
#include "Haptos_ContactLaw.hpp"
#include "Haptos_MultiplierMap.hpp"

namespace Haptos {

/// \brief Coulomb friction by connected successive approximations: Tresca sets Omega(g), g = max(0, lambda_N).
///
/// After every outer step of the augmented Lagrangian the slip bounds are taken from the present normal forces,
/// without a restart.  Tresca pairs keep theirs.
class CoulombFixedPoint final : public FeasibleSetUpdate<MultiVector> {
 public:
  /// \brief Starts from the slip bounds of `lambda`.  Collective.
  CoulombFixedPoint(const RCP<const Map>& map, const ContactLaw& law, const MultiplierMap& multipliers, const Vector& lambda);

  const RCP<BoundEllipseSet>& set() const { return set_; }

  /// \brief New slip bounds from lambda; returns || g_new - g_old || / || g_new ||.  Collective.
  double update(MultiVector& lambda) override;

 private:
  std::vector<double> slipBounds(const MultiVector& lambda) const;
  std::vector<std::array<double, 2>> semiAxes() const;

  RCP<const Map> map_;
  const ContactLaw& law_;
  std::vector<int> frictional_;  // positions in law_.pairs()
  std::vector<double> g_;        // [frictional pairs]
  RCP<BoundEllipseSet> set_;
};

}  // namespace Haptos
