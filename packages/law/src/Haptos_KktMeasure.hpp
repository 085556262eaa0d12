// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "Haptos_ContactLaw.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief Dimensionless errors of the contact conditions and of equilibrium; 0 where there are no data.
struct KktErrors {
  double equilibrium = 0;      ///< || f - K u - B^T lambda ||_2 / ext
  double fieldEquilibrium = 0; ///< || f - sum over copies of K v - contact forces ||_2 / ext, v the displacements that are written
  double continuity = 0;       ///< largest difference of copies, or to a prescribed value, / u_ref
  double penetration = 0;      ///< max (N u - d)+ / u_ref
  double compression = 0;      ///< max (-lambda_N)+ / l_ref
  double complementarity = 0;  ///< max min(lambda_N+ / l_ref, (d - N u)+ / u_ref)
  double cone = 0;             ///< max || lambda_T - P(lambda_T) || / l_ref
  double slipLaw = 0;          ///< max || lambda_T - P(lambda_T + (l_ref/u_ref) T u) || / l_ref

  double kkt() const;
  /// \brief Name of the largest, as in the summary ("slip_law").
  std::string worst() const;
};

/// \brief What the errors are measured by.
struct KktScales {
  double uRef = 0;   ///< largest nodal displacement [length]
  double load = 0;   ///< largest nodal load or reaction [force]; l_ref = max(largest contact force, 1e-3 load)
};

/// \brief l_ref [force] from the largest contact force of all ranks.
double contactForceScale(double largestContactForce, double load);
/// \brief l_ref = max(largest nodal contact force, 1e-3 load).  Collective.
double contactForceScale(const ContactLaw& law, const Vector& lambda, double load);

/// \brief Largest contact force of this rank's pairs [force].
double largestContactForce(const ContactLaw& law, const Vector& lambda);

/// \brief The five contact errors from lambda [force] and s = B u - c [length]; the others stay 0.  Collective.
KktErrors measureContact(const ContactLaw& law, const Vector& lambda, const Vector& s, const KktScales& scales);
/// \brief The same where l_ref is known.  Collective: one reduction.
KktErrors measureContact(const ContactLaw& law, const Vector& lambda, const Vector& s, double uRef, double lRef);

/// \brief The largest contact error of every pair of this rank, in the order of `law.pairs()`.
std::vector<double> errorsOfPairs(const ContactLaw& law, const Vector& lambda, const Vector& s, double uRef, double lRef);

}  // namespace Haptos
