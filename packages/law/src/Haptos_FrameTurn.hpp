// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

namespace Haptos {

/// \brief How tangential rows t1, t2 of a pair are turned from the axes a1, a2 of friction: t1 = c a1 + s a2, t2 = c a2 - s a1.
///
/// Where coefficients differ, multipliers with one coefficient stand for forces T_i = k_i x (what the turn gives), k_i = F_i / that coefficient; with
/// slips k_i s_i they do the same work, so that their ellipse is a circle, of which any axes are axes.
struct FrameTurn {
  double c, s;
  bool isOnly;  ///< supports leave t1 as the only direction to slip
  std::array<double, 2> stretch{1, 1};  ///< k_1, k_2 [-]

  bool isStretched() const { return stretch[0] != 1 || stretch[1] != 1; }
  /// \brief Forces along the axes of friction from multipliers.
  std::array<double, 2> toAxes(double l1, double l2) const { return {stretch[0] * (c * l1 - s * l2), stretch[1] * (s * l1 + c * l2)}; }
  /// \brief Slips along the axes of friction from those of rows.
  std::array<double, 2> slipToAxes(double s1, double s2) const { return {(c * s1 - s * s2) / stretch[0], (s * s1 + c * s2) / stretch[1]}; }
  /// \brief Slips of rows from those along the axes of friction.
  std::array<double, 2> slipOfRows(double a1, double a2) const {
    return {c * stretch[0] * a1 + s * stretch[1] * a2, c * stretch[1] * a2 - s * stretch[0] * a1};
  }
  bool operator==(const FrameTurn& other) const { return c == other.c && s == other.s && isOnly == other.isOnly && stretch == other.stretch; }
};

}  // namespace Haptos
