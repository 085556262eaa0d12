// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <string>
#include <vector>

#include "Haptos_FeasibleSet.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief Lower bounds on single entries and ellipses on pairs of entries.
///
///   x[i] >= lower[i]                                              normal contact
///   ((x[i] - c1)/a1)^2 + ((x[j] - c2)/a2)^2 <= 1                  friction
///   x[i] = 0                                                      pinned
///
/// For a Tresca step a1 = F1 g, a2 = F2 g, with F1, F2 [-] the friction coefficients along the principal
/// directions and g the slip bound in the unit of x.  A semi-axis 0 pins its entry to the centre; one semi-axis 0
/// leaves an interval on the other.  All rows are local to this rank; both entries of a pair live on one rank.
class BoundEllipseSet final : public FeasibleSet<MultiVector> {
 public:
  struct Bound {
    int row;       ///< local row
    double lower;  ///< in the unit of x, may be -infinity
  };
  struct Ellipse {
    std::array<int, 2> rows;                ///< local rows
    std::array<double, 2> semiAxes;         ///< in the unit of x, finite and >= 0
    std::array<double, 2> centre = {0, 0};  ///< in the unit of x
  };

  /// \brief Collective over `map`'s communicator.
  /// \throws InputError on all ranks if a row is not on the rank or named twice, a bound is NaN or +infinity, or a
  ///   semi-axis is negative or not finite.
  BoundEllipseSet(const RCP<const Map>& map, std::vector<Bound> bounds, std::vector<Ellipse> ellipses,
                  std::vector<int> pinnedRows = {});

  /// \brief New semi-axes, one pair for each ellipse in the order of construction.  Collective.
  ///
  /// If x is given, active pairs are moved with their ellipse (scaled by new/old in each axis), so that a sliding
  /// pair keeps sliding; project x afterwards.  \throws InputError on all ranks, as the constructor.
  void setSemiAxes(const std::vector<std::array<double, 2>>& semiAxes, MultiVector* x = nullptr);

  const std::vector<Bound>& bounds() const { return bounds_; }
  const std::vector<Ellipse>& ellipses() const { return ellipses_; }

  /// \brief Whether the last `project` left bound or ellipse number i at its boundary.
  bool isBoundActive(std::size_t i) const { return boundActive_[i]; }
  bool isEllipseActive(std::size_t i) const { return ellipseActive_[i]; }

  void project(MultiVector& x) override;
  double maxFeasibleStep(const MultiVector& x, const MultiVector& p) const override;
  void splitGradient(const MultiVector& x, const MultiVector& g, double alphaBar, MultiVector& phi, MultiVector& phiR,
                     MultiVector& beta) const override;

 private:
  std::string checkRows() const;
  static std::string checkSemiAxes(const std::array<int, 2>& rows, const std::array<double, 2>& semiAxes);

  RCP<const Map> map_;
  std::vector<Bound> bounds_;
  std::vector<Ellipse> ellipses_;
  std::vector<int> pinned_;
  std::vector<char> boundActive_, ellipseActive_;
};

}  // namespace Haptos
