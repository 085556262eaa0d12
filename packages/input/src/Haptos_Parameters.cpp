// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Parameters.hpp"

#include <Teuchos_ParameterList.hpp>
#include <filesystem>
#include <iostream>

#include "Haptos_CommandLine.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_ParameterDocumentation.hpp"
#include "Haptos_ParameterSections.hpp"
#include "Haptos_ParameterValidation.hpp"
#include "Haptos_ParameterXml.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {

namespace {

using Teuchos::ParameterList;
using Sets = std::vector<std::pair<std::string, std::string>>;

bool isGenerated(const ParameterList& list) {
  return list.isSublist("Mesh") && list.sublist("Mesh").isSublist("Two Beams");
}

// Bricks are the subdomains that the generated mesh was made of: 2k x k x k in each of two bodies.
std::string bricksDoNotFit(const ParameterList& list) {
  if (!list.isSublist("Decomposition")) return "";
  const auto& decomposition = list.sublist("Decomposition");
  const bool named = decomposition.isParameter("Method");
  const bool bricks = named ? decomposition.get<std::string>("Method") == nameOf(PartitionMethod::Bricks) : isGenerated(list);
  if (!bricks) return "";
  if (!isGenerated(list))
    return "Decomposition->Method: Bricks is valid only for a generated mesh (Mesh->Two Beams); use METIS";
  const double k = list.sublist("Mesh").sublist("Two Beams").get<int>("Subdomains Per Edge");
  const int given = decomposition.isParameter("Subdomains") ? decomposition.get<int>("Subdomains") : 0;
  if (given == 0 || given == 4 * k * k * k) return "";
  return "Decomposition->Subdomains: is " + std::to_string(given) +
         ", but Bricks make 4 k^3 = " + numberText(4 * k * k * k) +
         " subdomains for Subdomains Per Edge k = " + numberText(k) + "; give 0, or Method METIS";
}

/// The bricks of a generated mesh are its subdomains unless the user wants others.
void chooseBricks(ParameterList& list) {
  auto& decomposition = list.sublist("Decomposition");
  if (isGenerated(list) && !decomposition.isParameter("Method"))
    decomposition.set("Method", std::string(nameOf(PartitionMethod::Bricks)));
}

ParameterTree makeTree() {
  ParameterTree smalse("SMALSE",
                       "Constants of the augmented Lagrangian method (SMALSE-M with MPGP); the defaults suit almost every problem. The "
                       "method as published has Expansion Fixed Step, Inner Reduction 0 and M Floor 0.");
  ParameterTree tree("Haptos",
                     "Every valid parameter of the input, a Teuchos parameter list named \"Haptos\".");
  tree.add(ParameterSpec("Title", {ParameterType::String}, "Any text; it is the title of the result file (as far as 80 characters go) and of the summary")
               .defaultTo(std::string()))
      .add(meshSection())
      .add(ParameterTree("Decomposition", "How the bodies are cut into subdomains; no subdomain spans two bodies.")
               .addOptions<DecompositionOptions>())
      .add(materialsSection())
      .add(boundaryConditionsSection())
      .add(contactSection())
      .add(ParameterTree("Local Solver", "Factorisation of the stiffness matrix of every subdomain.").addOptions<LocalSolverOptions>())
      .add(ParameterTree("Preconditioner", "Preconditioner of the dual problem.").addOptions<PreconditionerOptions>())
      .add(ParameterTree("Coarse Problem",
                         "Where the factors of the coarse matrices live (6 unknowns a subdomain); the answer does not depend on it.")
               .addOptions<CoarseOptions>())
      .add(ParameterTree("Solver", "The iteration for the contact and gluing forces.").addOptions<SolverOptions>().add(smalse.addOptions<SmalseOptions>()))
      .add(ParameterTree("Output", "Files that are written; an empty name writes none.").addOptions<OutputOptions>())
      .rule("`Decomposition->Method` Bricks needs a generated mesh, and fixes the number of subdomains.",
            bricksDoNotFit)
      .prepare(chooseBricks);
  return tree;
}

/// The text of the file, read by rank 0 and checked there with all overrides.  Collective.
std::string readAndCheck(const Communicator& comm, const std::string& fileName, const Sets& sets) {
  std::string text;
  runOnRoot(comm, [&] {
    text = readTextFile(fileName);
    std::vector<std::string> warnings;
    const ParameterList output = parametersFromXml(text, fileName, sets, warnings).sublist("Output");
    for (const char* name : {"File", "Summary"})
      requireOtherFile(std::string("Output->") + name, output.get<std::string>(name), "the input", fileName);
    for (const auto& warning : warnings) std::cerr << "haptos: warning: " << warning << std::endl;
  });
  return broadcasted(comm, text);
}

}  // namespace

const ParameterTree& parameterTree() {
  static const ParameterTree tree = makeTree();
  return tree;
}

ParameterList parametersFromXml(const std::string& text, const std::string& origin, const Sets& sets,
                                std::vector<std::string>& warnings) {
  const auto& tree = parameterTree();
  ParameterList list = parameterListFromXml(text, origin);
  resolveAliases(tree, list, warnings);
  resolveFileNames(tree, list, std::filesystem::path(origin).parent_path().string());
  for (const auto& [path, value] : sets) setFromText(tree, list, path, value, warnings);
  return validatedList(tree, std::move(list), warnings);
}

ParameterList validatedParameters(const ParameterList& given) {
  std::vector<std::string> warnings;
  return validatedList(parameterTree(), given, warnings);
}

ParameterList readParameters(const Communicator& comm, const CommandLine& line) {
  Sets sets = line.sets;
  if (!line.output.empty()) sets.emplace_back("Output->File", line.output);
  if (!line.summary.empty()) sets.emplace_back("Output->Summary", line.summary);
  // Every rank builds the list from the same text: a list sent as text would lose bits of its numbers.
  const std::string text = readAndCheck(comm, line.input, sets);
  std::vector<std::string> printedBefore;
  return parametersFromXml(text, line.input, sets, printedBefore);
}

std::string printedParameters() { return parametersAsText(parameterTree()); }

std::string inputDocumentation() {
  return "# Input\n\nThis file is generated from the program's parameter tree (`haptos --print-parameters` "
         "prints the "
         "same); do not edit it.\n\nTypes are those of Teuchos parameter lists. An int is accepted where a "
         "double is "
         "valid. Units are yours: any consistent set. `<name>` stands for a name of your choice. Every "
         "parameter can "
         "be overridden on the command line: `--set \"Solver->Relative Tolerance=1e-8\"`.\n\n" +
         parametersAsMarkdown(parameterTree());
}

}  // namespace Haptos
