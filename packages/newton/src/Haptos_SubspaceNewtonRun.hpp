// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_Continuation.hpp"
#include "Haptos_SubspaceNewtonIter.hpp"
#include "Haptos_SubspaceNewtonSolMgr.hpp"

namespace Haptos {

/// \brief All that `SubspaceNewtonSolMgr` does for one problem: a start, levels of friction, restarts, condensed directions.
///
/// Pairs and state are kept from one `solve` to the next.
class SubspaceNewtonRun {
 public:
  /// All but `start` [rows] is kept by reference and may change between calls.  Collective.
  SubspaceNewtonRun(const ContactOperators& dual, const Vector& start, const SubspaceNewtonOptions& options,
                    const SubspaceNewtonSolMgr::Hooks& hooks);

  /// \brief From the start, or on from the state.  Collective.
  NewtonStop solve();
  /// \brief Makes this the state, without pairs.  Collective.
  void startFrom(const Vector& lambda, const Vector& s);

  /// \brief Jumps of the state, without F: the next `solve` needs none to renew them.  Collective.
  void setJumps(const Vector& s);
  /// \brief Loads or laws have changed: the next `solve` keeps pairs and multipliers.  False where other rows carry forces than when it was made:
  /// then another run is wanted.  Collective.
  bool goOn();

  RCP<Vector> lambda() const { return vectors_.toVector(state_.lambda); }
  RCP<Vector> jumps() const { return vectors_.toVector(state_.s); }
  double residual() const { return residual_; }  ///< that the tolerance was compared with last; -1: never
  const RecycledSubspace& subspace() const { return subspace_; }
  int steps() const { return iteration_.steps(); }

 private:
  // What ends a level.
  struct Level {
    double tolerance;  // relative to the jumps of the start; at the true coefficients of the status test
    int patience;      // F without halving the residual
    bool isFinal;      // the true coefficients
  };
  // How a row of levels ended.
  struct LevelsEnd {
    bool isFresh = true;      // there was none since the start
    bool isPlateau = false;   // that condensed directions could leave
  };

  long left() const { return options_.maximumMultiplications - dual_.F->applications(); }
  bool isFloating() const { return balance_.numFloating() > 0; }
  Level finalLevel(int patience) const { return {options_.continuation.aim * options_.tolerance, patience, true}; }
  Eigen::VectorXd jumpsOf(const Eigen::VectorXd& lambda) const;
  void keepOrigin();
  void start();
  void startOnFoundation();
  void liftRest();
  void refreshJumps();
  void takeJumps(Eigen::VectorXd s);
  double measure(const Eigen::VectorXd& lambda, const Eigen::VectorXd& s, double residual, const Level& level);
  void noteLeast(double residual, const Level& level);
  bool isLongWay() const;
  // pairsFirst: what these can do before a direction; a start of floating bodies leaves their motions as pairs
  NewtonStop runLevel(const std::vector<PairLaw>& law, const Level& level, bool pairsFirst = false);
  LevelsEnd runLevels(const FrictionLevels& levels);
  enum class Reason { M, Law };  // M is poor; ellipses are long
  void condense(Reason reason);
  void noteBegin();
  NewtonStop leavePlateau(const Level& level);
  NewtonStop solveFromStart();
  NewtonStop solveRenewed();
  NewtonStop descend();

  const ContactOperators& dual_;
  const SubspaceNewtonOptions& options_;
  const SubspaceNewtonSolMgr::Hooks& hooks_;
  DualVectors vectors_;
  GluingBalance balance_;
  DirectionChoice directions_;
  RecycledSubspace subspace_;
  Eigen::VectorXd r_;  // [pairs] penalty of the law
  SubspaceNewtonIter iteration_;
  Eigen::VectorXd first_;  // multipliers given by the user
  NewtonState state_;
  double reference_ = 0, residual_ = -1;
  double least_ = 1;   // residual since the start, of its jumps, or the answer's once that is measured
  bool isAnswerMeasured_ = false;
  long begunAt_ = 0;   // applications of F before
  bool isStarted_ = false, isRenewed_ = false, isFresh_ = false;  // isFresh_: s is that of lambda
};

}  // namespace Haptos
