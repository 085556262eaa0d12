// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace Haptos {

/// \brief A closed convex set Omega that separates into single entries and small groups of entries.
///
/// The set remembers which entries the last `project` moved to their boundary (the active ones) and keeps them
/// active until a projection moves them inside; nothing is decided by a distance.  Active entries have a free
/// gradient 0, the others a boundary gradient 0.
/// Z. Dostal, R. Kucera, SIAM J. Optim. 20 (2010) 2913-2938; Z. Dostal, T. Kozubek, Math. Program. 135 (2012) 195-220.
template <class MV>
class FeasibleSet {
 public:
  virtual ~FeasibleSet() = default;

  /// \brief x := P_Omega(x), Euclidean, and remembers the active entries.
  virtual void project(MV& x) = 0;

  /// \brief The largest t >= 0 with x - t p in Omega, where p is 0 in active entries; may be infinite.  Collective.
  virtual double maxFeasibleStep(const MV& x, const MV& p) const = 0;

  /// \brief Splits the gradient g at a feasible x, for the steplength alphaBar:
  ///
  ///   phi  = g on free entries                                    free gradient
  ///   phiR = (x - P(x - alphaBar g)) / alphaBar on free entries   reduced free gradient
  ///   beta = (x - P(x - alphaBar g)) / alphaBar on active entries reduced boundary gradient
  ///
  /// Each is 0 elsewhere; x is optimal exactly where phi + beta = 0.
  virtual void splitGradient(const MV& x, const MV& g, double alphaBar, MV& phi, MV& phiR, MV& beta) const = 0;
};

/// \brief Changes a feasible set after an outer step (Coulomb: the slip bounds from the normal multipliers).
template <class MV>
class FeasibleSetUpdate {
 public:
  virtual ~FeasibleSetUpdate() = default;

  /// \brief Changes the set from the current x; returns the relative change [-] (0: nothing changed).  Collective.
  ///
  /// x may be moved along with the boundary (a sliding pair keeps sliding); the solver projects it afterwards.
  virtual double update(MV& x) = 0;
};

}  // namespace Haptos
