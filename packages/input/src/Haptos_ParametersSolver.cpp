// SPDX-License-Identifier: BSD-3-Clause
// Local Solver, Preconditioner, Solver and Output.
#include "Haptos_ParameterSections.hpp"

namespace Haptos {

namespace {

using Type = ParameterType;

ParameterSpec number(const std::string& name, double value, NumberRange range, const std::string& meaning) {
  return ParameterSpec(name, {Type::Double}, meaning).defaultTo(value).within(range).measuredIn("-");
}

ParameterTree smalse() {
  ParameterTree section(
      "SMALSE",
      "Constants of the augmented Lagrangian method (SMALSE-M with MPGP); the defaults suit almost "
      "every problem.");
  section.add(number("Rho Factor", 1.0, NumberRange::above(0), "Penalty rho, relative to the norm of P F P"))
      .add(number("M Factor", 1.0, NumberRange::above(0), "First M, relative to rho"))
      .add(number("M Floor", 0.1, NumberRange::atLeast(0), "Smallest M, relative to rho"))
      .add(number("Beta", 10.0, NumberRange::above(1),
                  "M is divided by it when the Lagrangian grew too little"))
      .add(number("Eta Factor", 0.1, NumberRange::above(0),
                  "First bound of the projected gradient, relative to the right-hand side"))
      .add(number("Gamma", 1.0, NumberRange::above(0), "Proportioning constant of MPGP"))
      .add(number("Step Length", 1.9, NumberRange::open(0, 2),
                  "Fixed length of the expansion step, relative to 1/||A||"));
  return section;
}

}  // namespace

ParameterTree localSolverSection() {
  ParameterTree section("Local Solver", "Factorisation of the stiffness matrix of every subdomain.");
  section.add(
      ParameterSpec("Method", {Type::String}, "Automatic takes CHOLMOD where it is built in, else KLU2")
          .defaultTo(std::string("Automatic"))
          .oneOf({"Automatic", "CHOLMOD", "KLU2"}));
  section.add(
      ParameterSpec("Dual Operator", {Type::String},
                    "How a subdomain acts in an application of F and of the Dirichlet preconditioner: Implicit by solves with its "
                    "sparse factor, Explicit by dense matrices on its surface (more work before, less in every application); "
                    "Automatic predicts for every class of congruent subdomains which is faster, within half the machine's memory")
          .defaultTo(std::string("Automatic"))
          .oneOf({"Automatic", "Implicit", "Explicit"}));
  return section;
}

ParameterTree preconditionerSection() {
  ParameterTree section("Preconditioner", "Preconditioner of the dual problem.");
  section.add(
      ParameterSpec("Type", {Type::String}, "Dirichlet needs the fewest iterations, Lumped less work in each")
          .defaultTo(std::string("Dirichlet"))
          .oneOf({"Dirichlet", "Lumped", "None"}));
  return section;
}

ParameterTree coarseProblemSection() {
  ParameterTree section("Coarse Problem",
                        "Where the factors of the coarse matrices live (6 unknowns a subdomain); the answer does not depend on it.");
  section
      .add(ParameterSpec("Replicated Up To", {Type::Int},
                         "Coarse unknowns up to which every rank holds a factor; a larger one is shared by groups of ranks")
               .defaultTo(6000)
               .within(NumberRange::atLeast(0)))
      .add(ParameterSpec("Ranks Per Factor", {Type::Int}, "Ranks that share a factor then; 0 takes those of a node")
               .defaultTo(0)
               .within(NumberRange::atLeast(0)));
  return section;
}

ParameterTree solverSection() {
  ParameterTree section("Solver", "The iteration for the contact and gluing forces.");
  section
      .add(ParameterSpec(
               "Method", {Type::String},
               "SMALSE is the method with a proof of convergence, Subspace Newton the fast one, PCPG is for "
               "problems without contact; Automatic chooses")
               .defaultTo(std::string("Automatic"))
               .oneOf({"Automatic", "SMALSE", "Subspace Newton", "PCPG"}))
      .add(number("Relative Tolerance", 1e-6, NumberRange::closed(1e-14, 1e-1),
                  "Bound of the largest relative error of equilibrium, continuity and contact law (kkt)"))
      .add(ParameterSpec("Maximum Hessian Multiplications", {Type::Int},
                         "Largest number of applications of F = B K^+ B^T to a vector")
               .defaultTo(5000)
               .within(NumberRange::atLeast(1)))
      .add(ParameterSpec("Maximum Recycled Pairs", {Type::Int},
                         "Subspace Newton keeps so many pairs of dual vectors; when they are reached older ones are dropped. "
                         "Less memory, and below 30 more multiplications")
               .defaultTo(300)
               .within(NumberRange::atLeast(20)))
      .add(smalse());
  return section;
}

ParameterTree outputSection() {
  ParameterTree section("Output", "Files that are written; an empty name writes none.");
  section
      .add(ParameterSpec("File", {Type::String},
                         "Result file (Exodus II), relative to the folder of this XML file")
               .defaultTo(std::string())
               .isFileName())
      .add(ParameterSpec("Summary", {Type::String}, "Summary (JSON), relative to the folder of this XML file")
               .defaultTo(std::string())
               .isFileName());
  return section;
}

}  // namespace Haptos
