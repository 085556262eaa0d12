// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Teuchos_ParameterList.hpp>
#include <Tpetra_Core.hpp>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_Simulation.hpp"

namespace Haptos::Verification {

inline int numRanks() { return Tpetra::getDefaultComm()->getSize(); }

using Array3 = std::array<double, 3>;
using Names = std::vector<std::string>;

/// \brief Friction as the input states it.
struct Friction {
  std::string law = "Coulomb";
  std::array<double, 2> coefficients{0, 0};
  Array3 principalDirection{1, 0, 0};
  double slipBound = 0;  ///< Tresca only
};

/// \brief A scene of the verification suite: a mesh in memory and the parameters, set by chained calls.
///
///   const auto result = ScenarioBuilder(mesh).material("block", 1.0, 0.3).clamp({"bottom"}).pressure({"top"}, 1.0).solve();
class ScenarioBuilder {
 public:
  /// \param bricks [elements] or empty, for the method Bricks
  explicit ScenarioBuilder(Mesh mesh, std::vector<int> bricks = {});
  /// \brief The generated benchmark, which alone may be cut into bricks.
  explicit ScenarioBuilder(const TwoBeamsSpec& beams);

  /// \brief Moves every node of the mesh; bricks stay.
  ScenarioBuilder& moveNodes(const std::function<Array3(const Array3&)>& map);
  ScenarioBuilder& material(const std::string& block, double youngsModulus, double poissonsRatio);
  /// \brief Prescribes `components` of the displacement on node sets or side sets.
  ScenarioBuilder& displacement(const Names& sets, const std::string& components, const Array3& value);
  ScenarioBuilder& displacementField(const Names& sets, const std::string& components, const std::array<std::string, 3>& expressions);
  ScenarioBuilder& clamp(const Names& sets) { return displacement(sets, "xyz", {0, 0, 0}); }
  ScenarioBuilder& pressure(const Names& sets, double value);
  ScenarioBuilder& pressure(const Names& sets, const std::string& expression);
  ScenarioBuilder& traction(const Names& sets, const Array3& value);
  ScenarioBuilder& nodalForces(NodalForces forces);
  ScenarioBuilder& contact(const std::string& secondary, const std::string& primary, const Friction* friction = nullptr);
  ScenarioBuilder& rigidPlane(const std::string& secondary, const Array3& point, const Array3& normal,
                              const Friction* friction = nullptr);
  /// \brief A parameter of all contacts so far that are between two surfaces.
  ScenarioBuilder& contactOption(const std::string& name, const std::string& value);
  /// \brief Adds to the Friction of all contacts so far.
  ScenarioBuilder& frictionOptions(const Teuchos::ParameterList& list);
  /// \param method METIS, Bricks or Block, \param subdomains over all bodies; 0 chooses
  ScenarioBuilder& decomposition(const std::string& method, int subdomains = 0);
  ScenarioBuilder& solver(const std::string& method) { return setSolver("Method", method); }
  ScenarioBuilder& tolerance(double value) { return setSolver("Relative Tolerance", value); }
  ScenarioBuilder& maximumMultiplications(int value) { return setSolver("Maximum Hessian Multiplications", value); }

  const Mesh& mesh() const { return source_.mesh; }

  /// \brief The model, without a factorisation.  Collective.
  ModelReport prepare() const;
  /// \brief Collective; fields and pairs are on rank 0.
  SimulationResult solve() const;  ///< displacements of the whole mesh on rank 0

 private:
  template <class T>
  ScenarioBuilder& setSolver(const std::string& name, const T& value) {
    parameters_.sublist("Solver").set(name, value);
    return *this;
  }
  void nameBeams(const TwoBeamsSpec& beams);
  Teuchos::ParameterList& newCondition(const std::string& type, const Names& sets);
  Teuchos::ParameterList& newContact(const std::string& secondary, const Friction* friction);

  SourceMesh source_;
  Teuchos::ParameterList parameters_;
  std::vector<NodalForces> forces_;
};

/// \brief Positions of `n` cells between 0 and `length`: equal ones up to `fine`, then growing to the end.
///
/// \param fineCells cells of equal size in [0, fine]; the others grow geometrically
std::vector<double> gradedAxis(double fine, int fineCells, double length, int n);

using Rotation = std::array<Array3, 3>;
/// \brief A matrix of rotation about `axis` (any length) by `angle` [rad].
Rotation rotation(const Array3& axis, double angle);
inline const Rotation identity = rotation({0, 0, 1}, 0.0), tilted = rotation({0.3, -0.8, 0.5}, 2.1);

Array3 operator*(const std::array<Array3, 3>& Q, const Array3& x);
double dot(const Array3& a, const Array3& b);
Array3 cross(const Array3& a, const Array3& b);

/// \brief Sum of lambda_N and the sum of the tangential forces on the secondary surface, over all pairs.
struct Resultants {
  double normal = 0;
  Array3 tangential{0, 0, 0};
  Array3 force{0, 0, 0};  ///< on the secondary body
};
Resultants resultants(const SimulationResult& result);

}  // namespace Haptos::Verification
