// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Teuchos_ParameterList.hpp>
#include <array>
#include <string>
#include <vector>

#include "DenseReference.hpp"
#include "Haptos_ModelBuilder.hpp"

namespace Haptos::Scenes {

/// \brief Displacements of a side set.
struct SceneHold {
  std::string set, components;
  std::array<double, 3> value{0, 0, 0};
};

/// \brief A pressure (value[0], positive into the body) or a traction; `ramp` multiplies by clip(1.5 - x, 0, 1).
struct SceneLoad {
  std::string set;
  bool pressure;
  std::array<double, 3> value;
  bool ramp = false;
};

/// \brief One scene: two blocks of 2k p x k p x k p elements as in the two-beam benchmark, changed in some way.
///
/// Lengths, moduli and loads are in the benchmark's units; `length` and `force` turn them into others.
struct Scene {
  std::string name, group, what;

  int k = 2, p = 2;
  std::array<double, 3> stretch{1, 1, 1};  ///< factors on x, y, z
  double gap = 0;                          ///< the upper body starts higher by this
  double shift = 0;                        ///< and further along y by this
  bool upperInTwo = false;                 ///< the upper block is two bodies, x < 1 - h and x > 1
  int invertedElement = -1;                ///< 0-based
  bool skew = false;                       ///< inner nodes moved

  std::array<double, 2> young{6.9e4, 2.119e5}, poisson{0.333, 0.277};  ///< lower, upper
  bool contact = true;
  std::string law = "Coulomb";
  double slipBound = 0;
  std::array<double, 2> friction{0.3, 0.3};
  std::array<double, 3> direction{1, 0, 0};

  std::vector<SceneHold> holds{{"lower_clamp", "xyz"}, {"upper_clamp", "xyz"}};
  std::vector<SceneLoad> loads;

  std::string decomposition = "Bricks";
  int subdomains = 0;
  int seed = 1;
  double length = 1, force = 1;
  double tolerance = 1e-6;

  int status = 0;                          ///< wanted exit status
  std::vector<std::string> says;           ///< parts of the message where status is 1 or 3
  std::array<int, 3> atLeast{0, 0, 0};     ///< pairs that stick, slip, are open in the dense solution
  std::string onlyState;                   ///< "stick", "slip" or "open" where all pairs with a row are that
  std::string twin;                        ///< scene that must give the same answer in other units
  bool displacementsAreUnique = true;      ///< contact forces are, in every scene of the table
};

/// \brief All scenes, in the order of the table.
const std::vector<Scene>& allScenes();

/// \throws std::invalid_argument for an unknown name
const Scene& findScene(const std::string& name);

/// \brief The mesh, with bricks where the scene has them.
SourceMesh makeSceneMesh(const Scene& scene);

/// \brief Parameters for Simulation, validated.
Teuchos::ParameterList makeSceneParameters(const Scene& scene, const std::string& method, double tolerance);

/// \brief The same scene for the reference: pairs by place, loads integrated over the whole bodies.
ReferenceProblem makeReferenceProblem(const Scene& scene, Formulation formulation);

}  // namespace Haptos::Scenes
