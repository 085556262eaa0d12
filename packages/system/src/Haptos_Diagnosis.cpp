// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Diagnosis.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>

#include "Haptos_FetiSystem.hpp"
#include "Haptos_Format.hpp"
#include "Haptos_PairLaws.hpp"

namespace Haptos {
namespace {

bool isRoundOff(const Accuracy& accuracy) { return accuracy.floor > 0.1 * accuracy.errors.kkt(); }

// Where the largest error is: a node of an interface, a node, or a body.
std::string place(const UnconvergedRun& run, const std::string& measure) {
  const FetiSystem& system = run.system;
  const SystemModel& data = system.model();
  if (measure == "equilibrium")
    return run.accuracy.residualBody < 0 ? "" : " in body '" + data.bodyNames[std::size_t(run.accuracy.residualBody)] + "'";
  if (measure == "continuity") return " at node " + data.nameOfNode(run.accuracy.differenceNode);
  if (measure == "field_equilibrium") return " at node " + data.nameOfNode(run.accuracy.imbalanceNode);
  Vector s(system.c(), Teuchos::Copy);
  system.jump().apply(run.u, s, Teuchos::NO_TRANS, 1.0, -1.0);
  const auto worst = findWorstPair(system.law(), system.jump().multipliers(), *run.solver.solution().lambda, s, run.accuracy.scales);
  if (worst.interface < 0) return "";
  return " at node " + data.nameOfNode(worst.node) + " of interface '" + data.interfaceNames[std::size_t(worst.interface)] + "'";
}

// What about the friction of an interface makes it hard; empty for the usual.
std::string hardFriction(const SystemModel& data) {
  constexpr double kHardRatio = 100;
  std::string text;
  for (std::size_t i = 0; i < data.friction.size(); ++i) {
    const auto [low, high] = std::minmax(data.friction[i].coefficients[0], data.friction[i].coefficients[1]);
    if (low > 0 && high > kHardRatio * low)
      text += "; the coefficients of friction of '" + data.interfaceNames[i] + "' differ by a factor of " +
              formatted("%.0f", high / low) + ": a smaller ratio, or 0 for the small one, is easier";
    else if (high > 1 && data.friction[i].law == FrictionLaw::Coulomb)
      text += "; a coefficient of friction of '" + data.interfaceNames[i] + "' is " + formatted("%g", high) +
              ": above 1 there may be no or several solutions";
  }
  return text;
}

// Nearer it is the last digits that are missing.
bool isFar(const UnconvergedRun& run) {
  constexpr double kFar = 1e3;  // times the tolerance
  return run.accuracy.errors.kkt() > kFar * run.options.solver.tolerance;
}

// What pairs that stick hold no more, as where loads are beyond what friction carries, or gaps too wide to be closed.
std::string freeMotion(const UnconvergedRun& run) {
  const FetiSystem& system = run.system;
  const double kkt = run.accuracy.errors.kkt();
  const Vector& lambda = *run.solver.solution().lambda;
  const double force = contactForceScale(system.law(), lambda, run.accuracy.scales.load);
  const UnheldMotions free = system.motionsUnheldAt(lambda, {force, 0.1 * kkt});  // forces are known to kkt
  if (free.basis.cols() <= system.unheldMotions().basis.cols()) return "";
  return "; where it ended, only pairs that slide or are open are left against a motion of " +
         system.bodies().describeDriven(drivenMotion(free, system.bodies(), system.dual().e)) +
         ": the loads may be more than contact and friction carry, or the gaps too wide to close";
}

// What helps, in the order in which it should be tried; nothing helps against round-off but a larger tolerance.
std::string advice(const UnconvergedRun& run) {
  const SolverOptions& solver = run.options.solver;
  if (isRoundOff(run.accuracy))
    return "; round-off forbids less than about " + formatted("%.1e", run.accuracy.floor) +
           ": raise Solver->Relative Tolerance above it; large rigid motions prescribed to all bodies alike make it worse";
  std::string text;
  if (run.system.dual().F->applications() >= solver.maximumMultiplications)
    text += "; raise Solver->Maximum Hessian Multiplications (" + std::to_string(solver.maximumMultiplications) + ")";
  if (run.solver.subspace().compressions > 0)
    text += "; raise Solver->Maximum Recycled Pairs (" + std::to_string(solver.maximumRecycledPairs) + ")";
  if (run.options.preconditioner.kind != PreconditionerKind::Dirichlet && solver.method != SolverMethod::Smalse)
    text += "; set Preconditioner->Type to Dirichlet";
  if (text.empty() && isFar(run)) text += freeMotion(run);
  text += hardFriction(run.system.model());
  if (text.empty() && solver.method != SolverMethod::Automatic) text += "; set Solver->Method to Automatic";
  if (text.empty() && isFar(run)) text += "; there may be no solution: see whether smaller loads, or more friction, have one";
  if (text.empty()) text += "; a finer mesh at the edge of contact or a looser Solver->Relative Tolerance may help";
  return text;
}

}  // namespace

std::string explainUnconverged(const UnconvergedRun& run) {
  const std::string measure = run.accuracy.errors.worst();
  return std::string(run.passed ? "the method's own test passed, but kkt did not reach the tolerance" : describe(run.solver.outcome())) +
         "; largest error: " + measure + " = " + formatted("%.2e", run.accuracy.errors.kkt()) + place(run, measure) + advice(run);
}

}  // namespace Haptos
