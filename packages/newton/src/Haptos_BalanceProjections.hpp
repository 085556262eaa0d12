// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "Haptos_BodyMotions.hpp"
#include "Haptos_ChangingCoarseProblem.hpp"
#include "Haptos_DualProblem.hpp"
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
  GluingBalance(const DualProblem& dual, const BodyMotions& bodies, const DualVectors& vectors);

  /// \brief v_E := v_E - G_E^T (G_E G_E^T)^-1 (G v - target): afterwards G v = target, if contact carries Zk^T target.
  void balance(Eigen::VectorXd& v, const Eigen::VectorXd& target) const;
  void balance(Eigen::VectorXd& v) const { balance(v, Eigen::VectorXd::Zero(coarseSize_)); }

  /// \brief s := s + G^T a with G_E s_E = 0 and a orthogonal to Zk.
  void removeRigidPart(Eigen::VectorXd& s) const;

  Eigen::VectorXd applyG(const Eigen::VectorXd& v) const;  ///< Collective

  Eigen::Index numFloating() const { return Zk_.cols(); }
  const Eigen::MatrixXd& H() const { return H_; }            ///< [3 pairs x k] contact values of the floating motions
  const Eigen::MatrixXd& jumps() const { return jumps_; }    ///< [rows x k] G^T Zk
  const Eigen::VectorXd& load() const { return load_; }      ///< [k] Zk^T e
  const CoarseProblem::Holds& holds() const { return holds_; }

 private:
  const DualProblem& dual_;
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
/// The part of the gluing rows is eliminated once, for all active sets.
class ActiveCoarseProjection {
 public:
  /// \param weights [rows] D.  Collective.
  ActiveCoarseProjection(const DualProblem& dual, const DualVectors& vectors, const std::vector<PairLaw>& pairs,
                         const Eigen::VectorXd& weights, const CoarseProblem::Holds& holds);

  /// \brief Takes the active set of `law` with its modes [pairs].  Collective.
  void update(const std::vector<PairLaw>& pairs, const LawLinearization& law, const std::vector<TangentialModes>& modes);

  void projectDual(Eigen::VectorXd& residual) const;  ///< Collective
  void projectPrimal(Eigen::VectorXd& z) const;       ///< Collective

 private:
  // G^T on the rows of one pair: one block of rows (n, t1, t2) and six columns for every subdomain.
  struct PairColumns {
    std::vector<int> subdomains;
    std::vector<Eigen::Matrix<double, 3, 6>> blocks;
  };

  PairColumns columnsOf(const PairLaw& pair) const;
  Eigen::VectorXd activeRows(const Eigen::VectorXd& x) const;

  const DualVectors& vectors_;
  const Eigen::VectorXd& weights_;
  const CoarseRows& rows_;  // G^T
  std::vector<PairColumns> columns_;     // [pairs]
  std::vector<Eigen::Matrix3d> active_;  // [pairs] weights of the rows (n, t1, t2) in G_A
  std::unique_ptr<ChangingCoarseProblem> coarse_;
};

}  // namespace Haptos
