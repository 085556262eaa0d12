// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>

#include "Haptos_ConePath.hpp"
#include "Haptos_ContactMatrix.hpp"
#include "Haptos_LawLinearization.hpp"

namespace Haptos {

/// \brief The contact problem with M^-1 in the place of F, solved on the contact rows: for an M with G M = 0.
///
/// A direction z = M (s_E, sigma) closes the jumps s_E of the gluing rows and changes those of contact by -sigma.
/// With M_cc, M between contact rows, sigma obeys the law itself,
///
///   phi(lambda_c + m + M_cc sigma, s_c - sigma) = 0,   m = (M s_E)_c.
///
/// Open pairs, slip directions and all couplings are in it; nothing is left to be balanced.
class CondensedContact {
 public:
  /// \param contact between contact rows and on those alone; kept by reference.  Its `scaling` is that of M, too.
  CondensedContact(RCP<const Operator> M, const ContactMatrix& contact, SubspaceNewtonOptions::Condensed options = {});

  struct Step {
    Eigen::VectorXd z;      ///< [rows] multipliers
    Eigen::VectorXd sigma;  ///< [3 pairs] change of the contact jumps, sign reversed
    double left;            ///< of phi
  };
  /// \brief Solves the law to `Condensed::reduction`: by Newton's method from here, by interior points where that fails.
  /// \param r [pairs].  Collective.
  Step solveLaw(const std::vector<PairLaw>& pairs, const Eigen::VectorXd& r, const Eigen::VectorXd& lambda,
                const Eigen::VectorXd& s);

 private:
  struct Model;
  Eigen::VectorXd forcesOfGluing(const Eigen::VectorXd& s) const;
  Eigen::VectorXd response(Eigen::VectorXd s, const Eigen::VectorXd& sigma) const;

  RCP<const Operator> M_;
  const ContactMatrix& contact_;
  const DualVectors& vectors_;
  SubspaceNewtonOptions::Condensed options_;
  ConePath path_;
  bool isPathFirst_ = false;  // a path solved the last model, other penalties did not
  Eigen::VectorXd settled_;  // [3 pairs] contact jumps where the last model was solved; empty before
};

}  // namespace Haptos
