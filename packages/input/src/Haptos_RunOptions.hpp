// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "Haptos_ContactChoices.hpp"
#include "Haptos_Expression.hpp"
#include "Haptos_Options.hpp"

namespace Haptos {

/// \brief The generated benchmark mesh.
struct TwoBeamsOptions {
  int subdomainsPerEdge = 1;          ///< k
  int elementsPerSubdomainEdge = 1;  ///< p = H/h
};

/// \brief A file, or the generated mesh; neither where a caller brings a mesh of its own.
struct MeshOptions {
  std::string file;
  std::optional<TwoBeamsOptions> twoBeams;
};

struct MaterialOptions {
  std::string name;
  std::vector<std::string> blocks;  ///< names or numbers
  double youngsModulus, poissonsRatio;
};

enum class ConditionType { Displacement, Pressure, Traction, BodyForce };
template <>
struct Choices<ConditionType> {
  using E = ConditionType;
  static constexpr Choice<E> all[] = {
      {E::Displacement, "Displacement"}, {E::Pressure, "Pressure"}, {E::Traction, "Traction"}, {E::BodyForce, "Body Force"}};
};

/// \brief One boundary condition or load.
struct ConditionOptions {
  std::string path;  ///< "Boundary Conditions->press", for messages
  ConditionType type;
  std::vector<std::string> sets;    ///< names or numbers; empty for a body force
  std::vector<std::string> blocks;  ///< of a body force
  std::string components;           ///< of a displacement: letters of "xyz"
  Expression pressure;              ///< [force/area], positive into the body
  VectorExpression value;           ///< of all but a pressure: [length], [force/area], [force/volume]
};

/// \brief A function of place: a number, an expression, or a nodal field of the mesh.
struct PlaceFunction {
  Expression expression;  ///< where there is no field
  std::string field;      ///< its name

  bool isConstant() const { return field.empty() && expression.isConstant(); }
};

enum class CylindricalDirection { Circumferential, Axial, Radial };
template <>
struct Choices<CylindricalDirection> {
  using E = CylindricalDirection;
  static constexpr Choice<E> all[] = {{E::Circumferential, "Circumferential"}, {E::Axial, "Axial"}, {E::Radial, "Radial"}};
};

/// \brief One of the directions of cylindrical coordinates about an axis.
struct CylindricalOptions {
  std::array<double, 3> point, axis;
  CylindricalDirection direction;
};

/// \brief At most one of the last two is given, and goes before `principalDirection`.
struct FrictionOptions {
  std::optional<FrictionLaw> law = FrictionLaw::Frictionless;  ///< none: tied
  std::array<PlaceFunction, 2> coefficients;                   ///< F1, F2 [-]
  std::array<double, 3> principalDirection{1, 0, 0};
  std::vector<std::string> principalField;  ///< names of three nodal fields, or none
  std::optional<CylindricalOptions> cylindrical;
  double slipBound = 0;  ///< Tresca [force/area]

  bool hasFields() const { return !coefficients[0].isConstant() || !coefficients[1].isConstant(); }
};

struct RigidPlaneOptions {
  std::array<double, 3> point, normal;
};

/// \brief One pair of surfaces, or a surface and a rigid plane.
struct ContactOptions {
  std::string name;
  std::string path;  ///< "Contact->interface", for messages
  std::string secondarySideSet, primarySideSet;  ///< names or numbers; no primary one: rigid plane
  std::optional<RigidPlaneOptions> rigidPlane;
  Discretization discretization = Discretization::Automatic;
  ContactSides sides = ContactSides::Automatic;
  MultiplierSpace multiplierSpace = MultiplierSpace::Automatic;
  std::optional<Expression> gap;  ///< [length]; none: that of the geometry
  InitialPenetration initialPenetration = InitialPenetration::Resolve;
  PrimarySmoothing smoothing = PrimarySmoothing::None;
  double matchingTolerance = 1e-3;  ///< of the element size
  FrictionOptions friction;
};

/// \brief All that a run is told, typed: the valid parameters, read once.  No other code looks a parameter up by its name.
struct RunOptions {
  std::string title;
  MeshOptions mesh;
  DecompositionOptions decomposition;
  std::vector<MaterialOptions> materials;
  std::vector<ConditionOptions> conditions;
  std::vector<ContactOptions> contacts;
  LocalSolverOptions localSolver;
  PreconditionerOptions preconditioner;
  CoarseOptions coarse;
  SolverOptions solver;
  OutputOptions output;
};

/// \brief Reads a list that is validated, with all defaults (`readParameters`, `validatedParameters`).
/// \throws InputError for an expression that cannot be understood
RunOptions runOptions(const Teuchos::ParameterList& parameters);

}  // namespace Haptos
