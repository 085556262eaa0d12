// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>

#include "Haptos_DualVectors.hpp"
#include "Haptos_LawLinearization.hpp"
#include "Haptos_SubspaceNewtonOptions.hpp"

namespace Haptos {

/// \brief The contact problem with M^-1 in the place of F, solved on the contact rows: for an M with G M = 0.
///
/// A direction z = M (s_E, sigma) closes the jumps s_E of the gluing rows and changes those of contact by -sigma.
/// With the dense block M_cc, sigma obeys the law itself,
///
///   phi(lambda_c + m + M_cc sigma, s_c - sigma) = 0,   m = (M s_E)_c,
///
/// or its linearisation (A M_cc - B) sigma = -phi - A m with A = (I - P') / r, B = -P'.  Open pairs, slip directions
/// and all couplings are in it; nothing is left to be balanced.  M_cc and its factors are on all ranks, which
/// compute alike: for small contact surfaces (`SubspaceNewtonOptions::Condensed::largest`).
class CondensedContact {
 public:
  /// \brief 3 x pairs applications of `contactM`, M between contact rows and on those alone.  Collective.
  CondensedContact(RCP<const Operator> M, const Operator& contactM, const DualVectors& vectors,
                   SubspaceNewtonOptions::Condensed options = {});

  /// \brief Solves the linearised law.  \param s its gluing rows are read, \param phi [3 pairs].
  /// Collective: two applications of M, two reductions.
  Eigen::VectorXd solveLinearized(const LawLinearization& law, const Eigen::VectorXd& s, const Eigen::VectorXd& phi) const;

  struct Step {
    Eigen::VectorXd z;      ///< [rows] multipliers
    Eigen::VectorXd sigma;  ///< [3 pairs] change of the contact jumps, sign reversed
  };
  /// \brief Solves the law, as far as a damped Newton method gets.  \param r [pairs].  Collective, as above.
  Step solveLaw(const std::vector<PairLaw>& pairs, const Eigen::VectorXd& r, const Eigen::VectorXd& lambda,
                 const Eigen::VectorXd& s) const;

  /// \brief 1 / (normal compliance of the pair, the other pairs open): as far as a pair feels a stiffness, it is this one.
  Eigen::VectorXd normalStiffness() const;

 private:
  struct Model;
  Eigen::MatrixXd onAllRanks(const Eigen::MatrixXd& mine) const;
  Eigen::VectorXd forcesOfGluing(const Eigen::VectorXd& s) const;
  Eigen::VectorXd response(Eigen::VectorXd s, const Eigen::VectorXd& sigma) const;

  RCP<const Operator> M_;
  const DualVectors& vectors_;
  SubspaceNewtonOptions::Condensed options_;
  Eigen::Index first_ = 0, size_ = 0;  // of this rank's contact values among all, and of all
  Eigen::MatrixXd Mcc_;                // [all contact values]^2
};

}  // namespace Haptos
