// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>

#include "Haptos_CountedOperator.hpp"
#include "Haptos_DirectionChoice.hpp"
#include "Haptos_RecycledSubspace.hpp"
#include "Haptos_SubspaceDescent.hpp"

namespace Haptos {

/// \brief Why the iteration came back.
///
/// Plateau: condensed directions, not yet made, may help.  LongWay: `NewtonLimits::isLongWay` says so.
enum class NewtonStop { Converged, Stalled, Plateau, LongWay, Limit };

/// \brief When the iteration comes back.
struct NewtonLimits {
  double tolerance = 0;      ///< of || (s_E, phi) || relative to `reference`
  double reference = 1;      ///< [length]
  double wayAfter = 1;       ///< times what is accepted here is what levels to come leave of it
  int stall = 0;             ///< F applications without halving the residual; 0: never
  long maxApplications = 0;  ///< of F in this call
  /// Asked at every step with lambda, s and the relative residual: what is accepted in parts of what it may be, so 1 or less ends the way.
  /// Replaces `tolerance` where it is set.
  std::function<double(const Eigen::VectorXd&, const Eigen::VectorXd&, double)> measure;
  std::function<bool()> isLongWay;  ///< asked after it, the same on all ranks; not set: never
  std::function<void()> renew;      ///< brings the state into balance and makes its jumps anew, by an F; not set: nothing does
};

/// \brief Nonlinear subspace Newton: one F and one M a step, everything recycled.
///
/// Unknowns (lambda, s) obey s_E = 0 on gluing rows and phi(lambda, s) = 0 on contact pairs.  Every step adds one
/// pair (v, -F v + rigid part) in the direction of the preconditioned Newton residual; a few Gauss-Newton steps then
/// solve the law inside the whole subspace, which needs no F.  Where that stalls, the linearisation is frozen and
/// directions are added for the linear residual (an inexact Newton step), until there were two good steps.
class SubspaceNewtonIter {
 public:
  /// References are kept.
  struct Parts {
    const ContactOperators& dual;
    const DualVectors& vectors;
    const GluingBalance& balance;
    DirectionChoice& directions;
    RecycledSubspace& subspace;
  };
  /// \param r [pairs] penalty of the law, of which `SubspaceNewtonOptions::Steps::penalties` are parts.
  SubspaceNewtonIter(const Parts& parts, Eigen::VectorXd r, const SubspaceNewtonOptions::Steps& options);

  /// \brief Improves `state`; `needsDirection` tells whether the first step must add a pair.  Collective.
  NewtonStop iterate(const std::vector<PairLaw>& pairs, NewtonState& state, const NewtonLimits& limits, bool needsDirection);

  void setPenalty(Eigen::VectorXd r) { baseR_ = std::move(r); }  ///< [pairs], from the next `iterate` on
  /// \brief Where the multipliers and jumps started from: what came since is kept as one pair when pairs are dropped.
  void setOrigin(NewtonState origin) { origin_ = std::move(origin); }

  int steps() const { return steps_; }
  double residual() const { return norm_; }  ///< || (s_E, phi) || [length]

 private:
  void begin(const std::vector<PairLaw>& pairs, const NewtonState& state);
  void advance(NewtonState& state, const NewtonLimits& limits, bool needsDirection);
  void linearize(const NewtonState& state);
  void dropRigidPart(NewtonState& state);
  void measure(const NewtonState& state);
  void addDirection(const Eigen::VectorXd& dLambda, const Eigen::VectorXd& dS, const NewtonState& state);
  void planStep(double length, const Eigen::VectorXd& jumpChange);
  void makeRoom(const Eigen::VectorXd& dLambda, const Eigen::VectorXd& dS, const NewtonState& state);
  void linearPass(const NewtonState& state, const NewtonLimits& limits, double target);
  void solveInSubspace(NewtonState& state);
  void noteHalving();
  double measureOf(const NewtonState& state, const NewtonLimits& limits) const;
  bool isStuck(const NewtonLimits& limits) const;
  bool hasStalled(const NewtonLimits& limits, int patience) const;
  void chooseMode(double before);
  bool isNearlyThere(const NewtonLimits& limits) const;
  bool isSlow() const;
  bool isMeasureDeaf() const;
  bool hasMorePenalties() const;
  bool isPoor(double factor) const;  ///< steps without much progress
  void leavePlateau(const NewtonState& state);
  void takePenalty(int tried, const NewtonState& state);
  long applications() const { return dual_.F->applications() - firstApplication_; }

  const ContactOperators& dual_;
  const DualVectors& vectors_;
  const GluingBalance& balance_;
  DirectionChoice& directions_;
  RecycledSubspace& subspace_;
  SubspaceNewtonOptions::Steps options_;
  Eigen::VectorXd baseR_, r_;  // [pairs]

  const std::vector<PairLaw>* pairs_ = nullptr;
  LawLinearization law_;
  NewtonState origin_;
  Eigen::VectorXd step_;  // coefficients of a whole step that the last direction was made for; empty if there is none
  std::vector<double> measures_;  // of this level, at every F
  std::size_t renewedAt_ = 0;     // how many there were
  double norm_ = 0, bestNorm_ = 0, halved_ = 0, roundNorm_ = 0;
  long firstApplication_ = 0, halvedAt_ = 0;
  bool linear_ = false, idle_ = false, isRoundForNothing_ = false;
  int goodSteps_ = 0, hopeless_ = 0, penaltyTried_ = 0, steps_ = 0;
  std::vector<double> window_;
};

}  // namespace Haptos
