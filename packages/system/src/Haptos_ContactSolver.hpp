// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "Haptos_Accuracy.hpp"
#include "Haptos_Outcome.hpp"
#include "Haptos_SolverReport.hpp"

namespace Haptos {

class FetiSystem;

/// \brief Multipliers and jumps, from which the displacements follow (recoverPrimal).
struct DualSolution {
  RCP<Vector> lambda;  ///< [force], dual map
  RCP<Vector> s;       ///< B u - c as the method holds it [length], dual map
};

/// \brief What a method is asked for.
struct SolveRequest {
  double tolerance;           ///< of the residual that the method estimates kkt by
  long maximumMultiplications;  ///< of F, counted from the start of the run
  bool isDoubted = false;     ///< the method took something for an answer that the measure from u refused
  double roundOff = 1;  ///< part of what round-off usually hides that it may hide: less where the written field shows what was hidden
  RCP<const Vector> jumps = Teuchos::null;  ///< B u - c of its last solution, free of what its own recursion has lost; or null
};

/// \brief A method for the dual problem with contact; keeps its state, so a tighter request goes on where it was.
class ContactSolver {
 public:
  virtual ~ContactSolver() = default;
  virtual std::string name() const = 0;

  /// \brief Whether the method's own test passed.  Collective.
  virtual bool solve(const SolveRequest& request) = 0;

  /// \brief The system has another step, or other laws: the next solve goes on from the last solution.  Collective.
  virtual void renew() = 0;

  /// \brief Whether jumps are kept by a recursion, which `SolveRequest::jumps` free of what it has lost, at no multiplication.
  virtual bool tracksJumps() const { return false; }

  virtual const DualSolution& solution() const = 0;
  virtual Outcome outcome() const = 0;  ///< of the last solve()
  virtual int outerIterations() const = 0;
  virtual const std::vector<HistoryEntry>& history() const = 0;

  /// \brief What the method keeps from step to step; zeros where it keeps nothing.  Collective.
  virtual SubspaceReport subspace() const { return {}; }

  /// \brief The deflated preconditioner, if the method made one.
  virtual DeflationReport deflation() const { return {}; }
};

/// \brief Scales and loads that a method may use for its estimate of kkt.
struct SolverContext {
  const FetiSystem& system;
  const LoadScales& loads;
  std::function<void(const HistoryEntry&)> progress;  ///< called now and then
  RCP<const Vector> start = Teuchos::null;            ///< first multipliers, or null for those of Im G^T
};

/// \brief Numbers of pairs that stick, slip, are open, over all ranks.  Collective.
std::array<long, 3> countStates(const ContactLaw& law, const Vector& lambda, const StateScales& scales);

}  // namespace Haptos
