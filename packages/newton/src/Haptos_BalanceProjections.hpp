// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "Haptos_BodyMotions.hpp"
#include "Haptos_ContactProblem.hpp"
#include "Haptos_DualVectors.hpp"
#include "Haptos_LawLinearization.hpp"

namespace Haptos {

/// \brief Keeps multipliers in balance and jumps free of rigid parts, by the gluing rows alone.
///
/// G_E are the columns of G for gluing and Dirichlet rows.  Motions of whole bodies that these rows do not feel
/// ("floating" ones, Zk) stay unknowns: H = G_c^T Zk are the contact values that they cause.
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

  const CoarseRows& gluingRows() const { return gluingRows_; }  ///< G^T with contact rows emptied
  Eigen::Index numFloating() const { return Zk_.cols(); }
  const Eigen::MatrixXd& H() const { return H_; }            ///< [3 pairs x k] contact values of the floating motions
  const Eigen::MatrixXd& jumps() const { return jumps_; }    ///< [rows x k] G^T Zk
  const Eigen::VectorXd& load() const { return load_; }      ///< [k] Zk^T e
  const CoarseProblem::Holds& holds() const { return holds_; }

 private:
  const ContactOperators& dual_;
  const DualVectors& vectors_;
  CoarseRows gluingRows_;  // G^T with contact rows emptied
  std::unique_ptr<CoarseProblem> EE_;
  CoarseProblem::Holds holds_;
  Eigen::MatrixXd Zk_, H_, jumps_;
  Eigen::VectorXd load_;
  Eigen::Index coarseSize_;
};

/// \brief The coarse projection with gluing rows and ACTIVE contact rows: it makes the counts flat in the subdomains.
///
///   dual:   res := res + G_A^T a  with  G_A D res = 0;   primal:  z := z - D G_A^T (G_A D G_A^T)^-1 G_A z
///
/// D = diag(M) / median.  G_A has the gluing rows, normal rows of closed pairs, tangential rows weighted by sqrt(theta).
class ActiveCoarseProjection {
 public:
  /// \brief With every contact row active; `renew` follows.
  /// \param gluingRows G^T with contact rows emptied, \param weights [rows] D; both are kept by reference.  Collective.
  ActiveCoarseProjection(const ContactOperators& dual, const CoarseRows& gluingRows, const std::vector<PairLaw>& pairs,
                         const Eigen::VectorXd& weights, const CoarseProblem::Holds& holds);

  /// \brief Takes the active rows of this law.  \param modes [pairs].  Collective.
  void renew(const std::vector<PairLaw>& pairs, const LawLinearization& law, const std::vector<TangentialModes>& modes);

  void projectDual(Eigen::VectorXd& residual) const;  ///< Collective
  void projectPrimal(Eigen::VectorXd& z) const;       ///< Collective

  /// \brief D G_A^T (G_A D G_A^T)^-1 (sum over ranks of `mine`): takes the force imbalance `mine` away.  Collective.
  Eigen::VectorXd carry(const Eigen::VectorXd& mine) const;

 private:
  Eigen::VectorXd sumUp(const Eigen::VectorXd& x) const;
  Eigen::VectorXd spread(const Eigen::VectorXd& a) const;

  const CoarseRows& gluingRows_;
  CoarseRows contactRows_;  // G^T with gluing rows emptied
  const Eigen::VectorXd& weights_;
  std::vector<double> q_;   // the weights
  CoarseRows active_;       // contactRows_ weighted by the law
  CoarseProblem coarse_;
};

}  // namespace Haptos
