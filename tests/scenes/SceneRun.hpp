// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "Haptos_Simulation.hpp"
#include "Scenes.hpp"

namespace Haptos::Scenes {

struct SceneOptions {
  std::string method = "Automatic";
  double tolerance = 0;      ///< 0: the scene's own
  bool idleContact = false;     ///< some rank must have no contact pair
  bool idleSubdomains = false;  ///< some rank must have no subdomain
};

/// \brief What became of a scene.
struct SceneOutcome {
  int status = 70;      ///< exit status that the program would give
  std::string message;  ///< of the error, or the solver's reason
  SimulationResult result;
  double tolerance = 0;
  long fewestPairs = 0, fewestSubdomains = 0;  ///< of all ranks

  // Rank 0 only.
  bool compared = false;
  ReferenceSolution reference;
  double forceError = 0;         ///< largest difference of a contact force / l_ref
  double displacementError = 0;  ///< largest difference of a nodal displacement / u_ref
  std::vector<std::string> failures;
};

/// \brief Runs a scene as the program would, compares it with the dense reference on rank 0, and lists what is
/// not as it should be.  Collective.
SceneOutcome runScene(const RCP<const Communicator>& comm, const Scene& scene, const SceneOptions& options);

/// \brief Compares a scene with its twin in other units: counts within 2, the same forces.  Rank 0.
void compareWithTwin(const Scene& scene, SceneOutcome& outcome, const Scene& twin, const SceneOutcome& other);

/// \brief The table of doc/scenes.md.
std::string markdownTable(const std::vector<Scene>& scenes, const std::vector<SceneOutcome>& outcomes);

/// \brief One line for people.
std::string summaryLine(const Scene& scene, const SceneOutcome& outcome);

/// \brief Largest number of multiplications by F on these scenes, where this `Solver->Method` is asked for (of SMALSE, which
/// promises nothing, the default of `Maximum Hessian Multiplications`).
long promisedMultiplications(const std::string& method);

}  // namespace Haptos::Scenes
