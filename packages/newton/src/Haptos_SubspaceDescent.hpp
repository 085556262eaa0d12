// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "Haptos_SmallSystem.hpp"
#include "Haptos_SubspaceNewtonOptions.hpp"

namespace Haptos {

/// \brief Multipliers and jumps during the iteration; [rows] each.
struct NewtonState {
  Eigen::VectorXd lambda, s;
};

/// \brief Gauss-Newton for the law in the span of all pairs, at (lambda, s) + sum of y_j (v_j, s_j): no F is needed.
class SubspaceDescent {
 public:
  /// References are kept.
  struct Setting {
    const RecycledSubspace& subspace;
    const DualVectors& vectors;
    const std::vector<PairLaw>& pairs;
    const Eigen::VectorXd& r;  ///< [pairs]
    const SubspaceNewtonOptions::Steps& options;
  };

  /// \brief At y = 0, where `law` and `norm` are the state's.  Collective.
  SubspaceDescent(const Setting& setting, const NewtonState& state, LawLinearization law, double norm);

  /// \brief Takes these coefficients if they are better.  Collective.
  void tryStep(const Eigen::VectorXd& y);

  /// \brief Steps as long as they pay.  Collective.
  ///
  /// \param isFrozen directions were made for one linearisation: longer patience, no damping
  /// \param bestNorm so far: bounds a step that does not descend
  void run(bool isFrozen, double bestNorm);

  const Eigen::VectorXd& y() const { return y_; }    ///< [m]
  LawLinearization takeLaw() { return std::move(law_); }  ///< at y; nothing but `y` must be called after it

 private:
  struct Candidate {
    Eigen::VectorXd y;
    LawLinearization law;
    double norm;
  };
  struct Search {
    std::optional<Candidate> better;
    double fullNorm;  // of the full step
  };
  Eigen::VectorXd gluingAt(const Eigen::VectorXd& y) const;
  Candidate at(const Eigen::VectorXd& y) const;
  void moveTo(Candidate&& candidate);
  double promise(const SmallSystem& system, const Eigen::VectorXd& dy) const;
  Search search(const SmallSystem& system, const Eigen::VectorXd& dy, bool isFrozen) const;

  Setting setting_;
  const Eigen::VectorXd lambda0_, s0_;  // contact values at y = 0
  const RecycledSubspace::Projected gluing0_;
  Eigen::VectorXd y_;
  LawLinearization law_;
  double norm_;
};

}  // namespace Haptos
