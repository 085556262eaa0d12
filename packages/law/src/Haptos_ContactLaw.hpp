// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "Haptos_FrameTurn.hpp"
#include "Haptos_Options.hpp"

namespace Haptos {

/// \brief Friction of one interface.
struct FrictionSpec {
  FrictionLaw law = FrictionLaw::Frictionless;
  std::array<double, 2> coefficients{0, 0};  ///< F1, F2 [-] along the principal axes; of pairs that have their own, the largest
  double slipBound = 0;                      ///< Tresca: traction [force/area]
  bool tied = false;                         ///< bonded: no law at all, equality rows
};

enum class ContactStatus { Open = 1, Slip = 2, Stick = 3 };

/// \brief Projection of one pair on its law's set, with derivative; order N, T1, T2.
struct PairProjection {
  std::array<double, 3> point;                ///< [force]
  std::array<std::array<double, 3>, 3> dPdx;  ///< [-]; not symmetric for Coulomb: the slip bound follows N
  ContactStatus status;
};

/// \brief The law of one pair: lambda_N >= 0 and || F^-1 lambda_T || <= g.
///
/// g = max(0, x_N) for Coulomb, the slip force for Tresca.  A pinned row, a missing one or a coefficient 0
/// hold their component at 0.
struct PairLaw {
  int normal;                         ///< local dual row
  std::array<int, 2> tangential;      ///< local dual rows, -1 without friction
  std::array<double, 2> coefficients; ///< F1, F2 [-]
  double slipForce;                   ///< Tresca: slip bound x area [force]
  FrictionLaw law;
  bool normalPinned;
  std::optional<FrameTurn> turn = std::nullopt;  ///< of pairs whose rows are stretched: errors and forces are those along the axes

  bool frictional() const { return tangential[0] >= 0; }
  double slipBound(double normalForce) const { return law == FrictionLaw::Tresca ? slipForce : std::max(0.0, normalForce); }

  /// \brief The same law along the axes of friction.
  PairLaw alongAxes() const;

  /// \brief P(x) at x = lambda + r s.
  PairProjection project(const std::array<double, 3>& x) const;
};

/// \brief The laws of the pairs that this rank owns, in the order of its rows (`makeContactLaw`).
///
/// Source: contract of the associated law, lambda_T = g F^2 [u]_T / || F [u]_T || in slip (Haslinger, Kucera, Kozubek 2009).
class ContactLaw {
 public:
  explicit ContactLaw(std::vector<PairLaw> pairs) : pairs_(std::move(pairs)) {}

  const std::vector<PairLaw>& pairs() const { return pairs_; }

  /// \brief (N, T1, T2) of pair i in a dual vector's local data; 0 where there is no row.
  static std::array<double, 3> gather(const PairLaw& pair, const double* data) {
    const bool t = pair.frictional();
    return {data[pair.normal], t ? data[pair.tangential[0]] : 0.0, t ? data[pair.tangential[1]] : 0.0};
  }

 private:
  std::vector<PairLaw> pairs_;
};

/// \brief What forces are compared with where they tell states.
struct StateScales {
  double force;      ///< l_ref
  double tolerance;  ///< of the run: forces are known to about this
};

/// \brief Whether the normal force is at most max(1e-9, tolerance) l_ref (open), T lies on its ellipse to max(1e-6, 10 tolerance)
/// relative (slip), or neither (stick).
ContactStatus contactStatus(const PairLaw& pair, const std::array<double, 3>& lambda, const StateScales& scales);

}  // namespace Haptos
