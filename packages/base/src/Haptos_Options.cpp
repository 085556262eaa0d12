// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Options.hpp"

#include "Haptos_OptionTable.hpp"

namespace Haptos {

const OptionTable<LocalSolverOptions>& LocalSolverOptions::table() {
  using O = LocalSolverOptions;
  static const auto table =
      OptionTable<O>()
          .add("Method", &O::method, "Automatic takes CHOLMOD where it is built in, else KLU2")
          .add("Dual Operator", &O::dual,
               "How a subdomain acts in an application of F and of the Dirichlet preconditioner: Implicit by solves with its "
               "sparse factor, Explicit by dense matrices on its surface (more work before, less in every application); "
               "Automatic predicts for every class of congruent subdomains which is faster, within half the machine's memory");
  return table;
}

const OptionTable<PreconditionerOptions>& PreconditionerOptions::table() {
  using O = PreconditionerOptions;
  static const auto table = OptionTable<O>().add(
      "Type", &O::kind, "Dirichlet needs the fewest iterations, Lumped less work in each; SMALSE uses none whatever is given here");
  return table;
}

const OptionTable<CoarseOptions>& CoarseOptions::table() {
  using O = CoarseOptions;
  static const auto table =
      OptionTable<O>()
          .add("Replicated Up To", &O::replicatedUpTo, NumberRange::atLeast(0),
               "Coarse unknowns up to which every rank holds a factor; of a larger one each holds a share")
          .add("Ranks Per Factor", &O::ranksPerFactor, NumberRange::atLeast(0),
               "Beyond that, one of so many ranks holds the factor for them; 0 shares one among all ranks (without CHOLMOD: one of the ranks "
               "of a node holds it)");
  return table;
}

const OptionTable<DecompositionOptions>& DecompositionOptions::table() {
  using O = DecompositionOptions;
  static const auto table =
      OptionTable<O>()
          .add("Method", &O::method,
               "METIS cuts any mesh; Bricks are those of the generated mesh, and its default; Block makes one subdomain of each body")
          .add("Subdomains", &O::subdomains, NumberRange::atLeast(0), "Number of subdomains over all bodies; 0 chooses")
          .add("Seed", &O::seed, NumberRange::atLeast(0), "Seed of METIS; the same seed gives the same subdomains");
  return table;
}

const OptionTable<SmalseOptions>& SmalseOptions::table() {
  using O = SmalseOptions;
  static const auto table =
      OptionTable<O>()
          .add("Rho Factor", &O::rhoFactor, NumberRange::above(0), "Penalty rho, relative to the norm of P F P")
          .add("M Factor", &O::mFactor, NumberRange::above(0), "First M, relative to rho")
          .add("M Floor", &O::mFloor, NumberRange::atLeast(0), "Smallest M, relative to rho")
          .add("Beta", &O::beta, NumberRange::above(1), "M is divided by it when the Lagrangian grew too little")
          .add("Eta Factor", &O::etaFactor, NumberRange::above(0),
               "First bound of the projected gradient, relative to the right-hand side")
          .add("Gamma", &O::gamma, NumberRange::above(0), "Proportioning constant of MPGP")
          .add("Step Length", &O::stepLength, NumberRange::open(0, 2), "Fixed length of the expansion step, relative to 1/||A||")
          .add("Expansion", &O::expansion,
               "Where a conjugate gradient step leaves the feasible set: Fixed Step goes to its border and from there by the Step Length "
               "along the free gradient, as published; Projected CG projects the whole step, and takes the fixed one where that gains "
               "too little; Automatic leaves the trial out for a while after it failed")
          .add("Inner Reduction", &O::innerReduction, NumberRange{0, 1, false, true},
               "The inner loop may also end where the norm of its projected gradient fell to this fraction of its start; 0 is the "
               "published test, min(M ||Q (x - x0)||, eta), alone");
  return table;
}

const OptionTable<SolverOptions>& SolverOptions::table() {
  using O = SolverOptions;
  static const auto table =
      OptionTable<O>()
          .add("Method", &O::method,
               "SMALSE is the method with a proof of convergence, Subspace Newton the fast one, PCPG is for "
               "problems without contact; Automatic chooses")
          .add("Relative Tolerance", &O::tolerance, NumberRange::closed(1e-14, 1e-1),
               "Bound of the largest relative error of equilibrium, continuity and contact law (kkt)")
          .add("Maximum Hessian Multiplications", &O::maximumMultiplications, NumberRange::atLeast(1),
               "Largest number of applications of F = B K^+ B^T to a vector")
          .add("Maximum Recycled Pairs", &O::maximumRecycledPairs, NumberRange::atLeast(20),
               "Subspace Newton keeps so many pairs of dual vectors; when they are reached older ones are dropped. "
               "Less memory, and below 30 more multiplications");
  return table;
}

const OptionTable<OutputOptions>& OutputOptions::table() {
  using O = OutputOptions;
  static const auto table = [] {
    auto t = OptionTable<O>()
                 .add("File", &O::file, "Result file (Exodus II), relative to the folder of this XML file")
                 .add("Summary", &O::summary, "Summary (JSON), relative to the folder of this XML file");
    for (auto& option : t) option.spec.isFileName();
    return t;
  }();
  return table;
}

}  // namespace Haptos
