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
    bool isFloating = false;  ///< contact alone holds some bodies: jumps are kept within reach
  };

  /// \brief At y = 0, where `law` and `norm` are the state's.  Collective.
  SubspaceDescent(const Setting& setting, const NewtonState& state, LawLinearization law, double norm);

  /// \brief Steps as long as they pay.  Collective.
  ///
  /// \param isFrozen directions were made for one linearisation: longer patience, no damping
  /// \param bestNorm so far: bounds a step that does not descend
  void run(bool isFrozen, double bestNorm);

  /// \brief The same from the step that the last direction was made for; where that goes up, from here, too, and the better end counts.  That step
  /// itself where neither leads on.
  void runFrom(const Eigen::VectorXd& planned, bool isFrozen, double bestNorm);

  const Eigen::VectorXd& y() const { return y_; }    ///< [m]
  LawLinearization takeLaw() { return std::move(law_); }  ///< at y; nothing but `y` must be called after it

 private:
  struct Candidate {
    Eigen::VectorXd y;
    LawLinearization law;
    double norm;
    double jumps;  // || s_c ||
  };
  void runFromBoth(const Candidate& plan, bool isFrozen, double bestNorm);
  struct Search {
    std::optional<Candidate> better;
    double fullNorm;  // of the full step; infinite if it is beyond reach
  };
  Eigen::VectorXd gluingAt(const Eigen::VectorXd& y) const;
  Candidate at(const Eigen::VectorXd& y) const;
  void moveTo(Candidate&& candidate);
  bool isWithinReach(const Candidate& candidate) const { return candidate.jumps <= reach_; }
  double promise(const SmallSystem& system, const Eigen::VectorXd& dy) const;
  Search search(const SmallSystem& system, const Eigen::VectorXd& dy, bool isFrozen) const;

  Setting setting_;
  const Eigen::VectorXd lambda0_, s0_;  // contact values at y = 0
  const RecycledSubspace::Projected gluing0_;
  double reach_;  // of || s_c ||
  Eigen::VectorXd y_;
  LawLinearization law_;
  double norm_;
};

}  // namespace Haptos
