// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

#include "Haptos_ContactLaw.hpp"

namespace Haptos {

/// \brief The law as one equation per pair, phi = (lambda - P(lambda + r s)) / r = 0 [length], and its derivative.
///
///   d phi = A d lambda + B d s,   A = (I - P') / r,  B = -P'
///
/// r > 0 is free, and may differ from pair to pair.
struct LawLinearization {
  Eigen::VectorXd r;                  ///< [pairs] [force/length]
  Eigen::VectorXd phi;                ///< [3 pairs]
  std::vector<Eigen::Matrix3d> dP;    ///< [pairs] P'
  std::vector<char> closed;           ///< [pairs] normal contact is closed
  std::vector<char> tangential;       ///< [pairs] the tangential law acts (closed, or Tresca)

  /// \brief J = A V + B S for blocks of contact values [3 pairs x m].
  Eigen::MatrixXd multiply(const Eigen::Ref<const Eigen::MatrixXd>& V, const Eigen::Ref<const Eigen::MatrixXd>& S) const;
};

/// \param lambda, s contact values [3 pairs]
/// \param r [pairs]
LawLinearization linearizeLaw(const std::vector<PairLaw>& pairs, const Eigen::VectorXd& lambda, const Eigen::VectorXd& s,
                              const Eigen::VectorXd& r);

/// \brief The tangential part of one pair's P' in its eigenvectors, as the preconditioner needs it.
struct TangentialModes {
  Eigen::Matrix2d E;          ///< eigenvectors in columns
  Eigen::Vector2d sigma;      ///< eigenvalues in [0, 1]: 1 stick, 0 slip direction held by the law
  Eigen::Vector2d theta;      ///< share of the preconditioner: (1/k) / ((1 - sigma)/(r sigma) + 1/k)

  /// \param stiffness k: the preconditioner's nodal stiffness [force/length]
  static TangentialModes of(const Eigen::Matrix3d& dP, double r, double stiffness);
  double stiffness = 0;       ///< k, as given
  /// 1 / C = r sigma / (1 - sigma) of a mode with 0 < theta < 1 [force/length]
  double inverseCompliance(int mode) const { return stiffness * theta[mode] / (1 - theta[mode]); }
  bool isHeld(int mode) const { return sigma[mode] < kHeld; }
  bool isPartial(int mode) const { return sigma[mode] < 1 - kHeld; }  ///< the law gives way
  static constexpr double kHeld = 1e-13;
};

}  // namespace Haptos
