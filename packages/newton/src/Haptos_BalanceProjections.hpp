// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "Haptos_ContactOperators.hpp"
#include "Haptos_DualVectors.hpp"
#include "Haptos_LawLinearization.hpp"

namespace Haptos {

/// \brief Contact values without those of rows that never carry a force: a motion along them is answered by nothing.
/// \param values [3 pairs x m]
Eigen::MatrixXd carriedRows(Eigen::MatrixXd values, const std::vector<PairLaw>& pairs);

/// \brief Keeps multipliers in balance and jumps free of rigid parts, by the gluing rows alone.
///
/// G_E are the columns of G for gluing and Dirichlet rows.  Motions of whole bodies that these rows do not feel
/// ("floating" ones, Zk) stay unknowns: H = G_c^T Zk V are the contact values that they cause, V those combinations that rows
/// of contact which may carry a force feel.  What none of them feels (a slide without friction) stays 0.
class GluingBalance {
 public:
  /// Collective.
  GluingBalance(const ContactOperators& dual, const DualVectors& vectors);

  /// \brief v_E := v_E - G_E^T (G_E G_E^T)^-1 (G v - target): afterwards G v = target, if contact carries Zk^T target.
  void balance(Eigen::VectorXd& v, const Eigen::VectorXd& target) const;
  void balance(Eigen::VectorXd& v) const { balance(v, Eigen::VectorXd::Zero(coarseSize_)); }

  /// \brief s := s + G^T a with G_E s_E = 0 and a orthogonal to Zk.
  void removeRigidPart(Eigen::VectorXd& s) const;

  Eigen::VectorXd applyG(const Eigen::VectorXd& v) const;  ///< Collective

  /// \brief Jumps of the floating motion that is nearest to these jumps.  Collective.
  Eigen::VectorXd nearestMotion(const Eigen::VectorXd& s) const;

  /// \brief This rank's part of G_E v_E [l].
  Eigen::VectorXd sumGluing(const Eigen::VectorXd& v) const;

  const DualVectors& vectors() const { return vectors_; }
  const CoarseRows& GT() const { return *dual_.GT; }
  const Eigen::VectorXd& isGluing() const { return isGluing_; }  ///< [rows] 1 or 0
  Eigen::Index numFloating() const { return jumps_.cols(); }  ///< k, those that are felt
  const Eigen::MatrixXd& H() const { return H_; }            ///< [3 pairs x k] contact values of the floating motions
  const Eigen::MatrixXd& jumps() const { return jumps_; }    ///< [rows x k] G^T Zk V
  /// \brief [3 pairs x those of Zk] contact jumps of all floating motions, also of those that are not felt.
  Eigen::MatrixXd contactMotions() const;
  Eigen::VectorXd load() const { return feltMotions_.transpose() * dual_.e; }  ///< [k] (Zk V)^T e, of the present e
  /// \brief Whether these pairs carry forces along the rows of those it was made with: H is of no other.  Collective.
  bool isOf(const std::vector<PairLaw>& pairs) const;
  const CoarseProblem::Holds& holds() const { return dual_.holds; }

 private:
  Eigen::MatrixXd contactRowsOf(const Eigen::MatrixXd& values) const;  // [rows x m] to [3 pairs x m]

  const ContactOperators& dual_;
  const DualVectors& vectors_;
  Eigen::VectorXd isGluing_;  // a mask instead of a second G^T
  Eigen::VectorXd carried_;   // [3 pairs] rows that H has
  std::unique_ptr<CoarseProblem> EE_;
  Eigen::MatrixXd Zk_, feltMotions_, H_, jumps_;  // feltMotions_: Zk V
  Eigen::Index coarseSize_;
};

/// \brief The coarse projection with gluing rows and ACTIVE contact rows: it makes the counts flat in the subdomains.
///
///   dual:   res := res + G_A^T a  with  G_A D res = 0;   primal:  z := z - D G_A^T (G_A D G_A^T)^-1 G_A z
///
/// D = diag(M) / its largest entry.  G_A has the gluing rows, normal rows of closed pairs, tangential rows weighted by sqrt(theta).
class ActiveCoarseProjection {
 public:
  /// \brief Of which rows may become active; `renew` follows before any use.
  /// \param gluing, weights [rows] D, vectors are kept by reference.  Collective.
  ActiveCoarseProjection(const ContactOperators& dual, const GluingBalance& gluing, const DualVectors& vectors,
                         const Eigen::VectorXd& weights);

  /// \brief Takes the active rows of this law.  \param modes [pairs].  Collective.
  void renew(const LawLinearization& law, const std::vector<TangentialModes>& modes);

  void projectDual(Eigen::VectorXd& residual) const;  ///< Collective

 private:
  friend class PrimalBalance;

  const GluingBalance& gluing_;
  const DualVectors& vectors_;
  const Eigen::VectorXd& weights_;
  std::vector<double> q_, contactWeights_;  // D of the rows, of the contact values
  CoarseRows contactRows_, active_;         // [3 pairs x l] G_c^T; weighted by the law
  CoarseProblem coarse_;
  std::unique_ptr<CoarseProblem> gluingAlone_;  // of its fixed rows
};

/// \brief Balances a direction z while its contact values follow the law, G_A D G_A^T a = imbalance again and again.
///
/// The gluing rows, which are most of all, are summed up once at the start and changed once at the end; between,
/// G_E z_E is carried on by the coarse matrix of the gluing rows.
class PrimalBalance {
 public:
  PrimalBalance(const ActiveCoarseProjection& active, const Eigen::VectorXd& z);

  /// \brief The primal projection: contact values of z after it.  \param contact those before.  Collective.
  Eigen::VectorXd project(const Eigen::VectorXd& contact);

  /// \brief Spreads the imbalance that z has with these contact values over all active rows; returns what they are to
  /// change by.  Collective.
  Eigen::VectorXd spreadImbalance(const Eigen::VectorXd& contact);

  /// \brief z with these contact values, balanced by the gluing rows alone: G z = 0, D-weighted.  Collective.
  void finish(const Eigen::VectorXd& contact, Eigen::VectorXd& z);

 private:
  Eigen::VectorXd takeOff(const Eigen::VectorXd& contactSum);

  const ActiveCoarseProjection& active_;
  CoarseProblem::Series series_;  // a: D G_A^T a is taken off so far
};

}  // namespace Haptos
