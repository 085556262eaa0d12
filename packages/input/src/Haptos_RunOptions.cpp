// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_RunOptions.hpp"

#include <Teuchos_ParameterList.hpp>

#include "Haptos_OptionTable.hpp"
#include "Haptos_ParameterSections.hpp"

namespace Haptos {

namespace {

using Teuchos::ParameterList;

template <class Options>
Options sectionOptions(const ParameterList& parameters, const std::string& name) {
  return readOptions<Options>(parameters.sublist(name), name);
}

// The sublists that the user named, in the order of the input.
template <class Item>
std::vector<Item> namedOptions(const ParameterList& parameters, const std::string& section,
                               Item (*read)(const std::string& name, const ParameterList& list)) {
  std::vector<Item> items;
  const ParameterList& list = parameters.sublist(section);
  for (auto it = list.begin(); it != list.end(); ++it) items.push_back(read(it->first, list.sublist(it->first)));
  return items;
}

}  // namespace

RunOptions runOptions(const ParameterList& parameters) {
  RunOptions o;
  o.title = parameters.get<std::string>("Title");
  o.mesh = meshOptions(parameters.sublist("Mesh"));
  o.decomposition = sectionOptions<DecompositionOptions>(parameters, "Decomposition");
  o.materials = namedOptions(parameters, "Materials", materialOptions);
  o.conditions = namedOptions(parameters, "Boundary Conditions", conditionOptions);
  o.contacts = namedOptions(parameters, "Contact", contactOptions);
  o.localSolver = sectionOptions<LocalSolverOptions>(parameters, "Local Solver");
  o.preconditioner = sectionOptions<PreconditionerOptions>(parameters, "Preconditioner");
  o.coarse = sectionOptions<CoarseOptions>(parameters, "Coarse Problem");
  o.solver = sectionOptions<SolverOptions>(parameters, "Solver");
  o.solver.smalse = readOptions<SmalseOptions>(parameters.sublist("Solver").sublist("SMALSE"), "Solver->SMALSE");
  o.output = sectionOptions<OutputOptions>(parameters, "Output");
  return o;
}

}  // namespace Haptos
