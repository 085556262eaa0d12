// SPDX-License-Identifier: BSD-3-Clause
// Local Solver, Preconditioner, Coarse Problem, Solver and Output: their parameters stand beside the options that they fill.
#include "Haptos_ParameterSections.hpp"

namespace Haptos {

ParameterTree localSolverSection() {
  return ParameterTree("Local Solver", "Factorisation of the stiffness matrix of every subdomain.").addOptions<LocalSolverOptions>();
}

ParameterTree preconditionerSection() {
  return ParameterTree("Preconditioner", "Preconditioner of the dual problem.").addOptions<PreconditionerOptions>();
}

ParameterTree coarseProblemSection() {
  return ParameterTree("Coarse Problem",
                       "Where the factors of the coarse matrices live (6 unknowns a subdomain); the answer does not depend on it.")
      .addOptions<CoarseOptions>();
}

ParameterTree solverSection() {
  ParameterTree smalse("SMALSE",
                       "Constants of the augmented Lagrangian method (SMALSE-M with MPGP); the defaults suit almost every problem. The "
                       "method as published has Expansion Fixed Step, Inner Reduction 0 and M Floor 0.");
  return ParameterTree("Solver", "The iteration for the contact and gluing forces.")
      .addOptions<SolverOptions>()
      .add(smalse.addOptions<SmalseOptions>());
}

ParameterTree outputSection() {
  return ParameterTree("Output", "Files that are written; an empty name writes none.").addOptions<OutputOptions>();
}

}  // namespace Haptos
