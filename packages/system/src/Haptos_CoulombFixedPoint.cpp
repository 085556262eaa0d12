// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CoulombFixedPoint.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <cmath>

#include "Haptos_Reductions.hpp"

namespace Haptos {

// Bounds on normal rows, an ellipse on every frictional pair, pins on rows without a force; the rest (gluing) is free.
CoulombFixedPoint::CoulombFixedPoint(const RCP<const Map>& map, const ContactLaw& law, const MultiplierMap& multipliers,
                                     const Vector& lambda)
    : map_(map), law_(law) {
  std::vector<BoundEllipseSet::Bound> bounds;
  std::vector<int> pinned;
  for (std::size_t i = 0; i < law.pairs().size(); ++i) {
    const PairLaw& pair = law.pairs()[i];
    if (pair.normalPinned) pinned.push_back(pair.normal);
    else bounds.push_back({pair.normal, 0.0});
    if (pair.frictional()) frictional_.push_back(int(i));
  }
  g_ = slipBounds(lambda);
  std::vector<BoundEllipseSet::Ellipse> ellipses;
  const auto axes = semiAxes();
  for (std::size_t k = 0; k < frictional_.size(); ++k) ellipses.push_back({law.pairs()[frictional_[k]].tangential, axes[k]});
  for (std::size_t row = 0; row < multipliers.kinds().size(); ++row)
    if (multipliers.pinned()[row] && multipliers.kinds()[row] == RowKind::Dirichlet) pinned.push_back(int(row));
  set_ = Teuchos::rcp(new BoundEllipseSet(map, bounds, ellipses, pinned));
}

// g = max(0, lambda_N), 0 where the normal row is pinned; the bound itself for Tresca.
std::vector<double> CoulombFixedPoint::slipBounds(const MultiVector& lambda) const {
  const auto data = lambda.getData(0);
  std::vector<double> g;
  for (int i : frictional_) {
    const PairLaw& pair = law_.pairs()[i];
    g.push_back(pair.slipBound(pair.normalPinned ? 0.0 : data[pair.normal]));
  }
  return g;
}

// F1 g, F2 g
std::vector<std::array<double, 2>> CoulombFixedPoint::semiAxes() const {
  std::vector<std::array<double, 2>> axes;
  for (std::size_t k = 0; k < frictional_.size(); ++k) {
    const auto& F = law_.pairs()[frictional_[k]].coefficients;
    axes.push_back({F[0] * g_[k], F[1] * g_[k]});
  }
  return axes;
}

// Multipliers on the boundary of an ellipse go with it, so that the next step starts from a feasible point with the same active set.
double CoulombFixedPoint::update(MultiVector& lambda) {
  const auto before = std::move(g_);
  g_ = slipBounds(lambda);
  std::array<double, 2> mine{0, 0};
  for (std::size_t k = 0; k < g_.size(); ++k) {
    mine[0] += (g_[k] - before[k]) * (g_[k] - before[k]);
    mine[1] += g_[k] * g_[k];
  }
  const auto sum = sumOfAll(*map_->getComm(), mine);
  set_->setSemiAxes(semiAxes(), &lambda);
  return sum[1] > 0 ? std::sqrt(sum[0] / sum[1]) : (sum[0] > 0 ? 1.0 : 0.0);
}

}  // namespace Haptos
