// SPDX-License-Identifier: BSD-3-Clause
// Contact: pairs of surfaces, rigid planes, friction.
#include <Teuchos_Array.hpp>
#include <Teuchos_ParameterList.hpp>
#include <algorithm>
#include <array>
#include <cctype>

#include "Haptos_Error.hpp"
#include "Haptos_Expression.hpp"
#include "Haptos_ParameterSections.hpp"

namespace Haptos {

namespace {

using Teuchos::ParameterList;
using Type = ParameterType;
using Texts = std::vector<std::string>;

std::string zeroVector(const ParameterList& list, const std::string& name) {
  if (!list.isParameter(name)) return "";
  const auto& vector = list.get<Teuchos::Array<double>>(name);
  const bool zero = std::all_of(vector.begin(), vector.end(), [](double v) { return v == 0.0; });
  return zero ? name + ": is the zero vector; give a direction (its length does not matter)" : "";
}

ParameterTree rigidPlane() {
  ParameterTree plane("Rigid Plane", "A rigid obstacle in the place of a primary surface.");
  plane
      .add(ParameterSpec("Point", {Type::DoubleArray}, "A point of the plane")
               .mustBeGiven()
               .entries(3, 3)
               .measuredIn("length"))
      .add(ParameterSpec("Normal", {Type::DoubleArray}, "Points from the plane to the body; any length")
               .mustBeGiven()
               .entries(3, 3))
      .rule("`Normal` is not zero.", [](const ParameterList& list) { return zeroVector(list, "Normal"); });
  return plane;
}

// Coefficients without a law would be those of frictionless contact.
std::string lawIsMissing(const ParameterList& list) {
  if (list.isParameter("Law") || !list.isParameter("Coefficients")) return "";
  return "Law: is missing though Coefficients are given; give Coulomb, Tresca, Frictionless or Tied";
}

std::string lawName(std::optional<FrictionLaw> law) { return nameOf(law); }

bool isLetter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// A text that is one name, and none that expressions know, is a nodal field.
bool isFieldName(const std::string& text) {
  static const Texts known = {"x", "y", "z", "t", "pi", "_pi", "_e"};
  return !text.empty() && isLetter(text[0]) && std::find(known.begin(), known.end(), text) == known.end() &&
         std::all_of(text.begin(), text.end(), [](char c) { return isLetter(c) || std::isdigit(static_cast<unsigned char>(c)) != 0; });
}

std::vector<PlaceFunction> placeFunctions(const ParameterList& list, const std::string& name, const std::string& path) {
  const auto value = *valueOf(list.getEntry(name));
  std::vector<PlaceFunction> functions;
  if (const auto* numbers = std::get_if<std::vector<double>>(&value))
    for (const double number : *numbers) functions.push_back({Expression(number), ""});
  else
    for (const auto& text : std::get<Texts>(value))
      functions.push_back(isFieldName(trimmed(text)) ? PlaceFunction{{}, trimmed(text)} : PlaceFunction{Expression(text, path), ""});
  return functions;
}

// Those that hold everywhere are refused at once.
std::string wrongCoefficient(const ParameterList& list) {
  if (!list.isParameter("Coefficients")) return "";
  try {
    for (const auto& function : placeFunctions(list, "Coefficients", "Coefficients"))
      if (function.isConstant() && !(function.expression(0, 0, 0) >= 0))
        return "Coefficients: has the entry " + function.expression.text() + "; must be at least 0";
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

ParameterTree cylindrical() {
  ParameterTree section("Cylindrical", "The axis t1 follows cylindrical coordinates about an axis.");
  section.add(ParameterSpec("Point", {Type::DoubleArray}, "A point of the axis").mustBeGiven().entries(3, 3).measuredIn("length"))
      .add(ParameterSpec("Axis", {Type::DoubleArray}, "Direction of the axis; any length").mustBeGiven().entries(3, 3))
      .add(ParameterSpec("Direction", {Type::String},
                         "What t1 is the projection of on the tangent plane: Circumferential is Axis x (from the axis to the node), Radial points from the axis to "
                         "the node")
               .mustBeGiven()
               .oneOf(choiceNames<CylindricalDirection>()))
      .rule("`Axis` is not zero.", [](const ParameterList& list) { return zeroVector(list, "Axis"); });
  return section;
}

ParameterTree friction() {
  ParameterTree section("Friction", "Orthotropic friction: ||F^-1 lambda_T|| <= g, F = diag(F1, F2).");
  section
      .add(ParameterSpec("Law", {Type::String},
                         "Coulomb: g is the contact pressure; Tresca: g is the Slip Bound; Tied: no law, both surfaces are bonded (their "
                         "displacements are the same, whatever the gap)")
               .defaultTo(lawName(FrictionOptions{}.law))
               .oneOf(choiceNames<std::optional<FrictionLaw>>()))
      .add(ParameterSpec("Coefficients", {Type::DoubleArray, Type::StringArray},
                         "F1, F2 along the principal axes t1, t2; 0 takes the friction along an axis away. A string is an expression of x, y, z, or the "
                         "name of a nodal field of the mesh file (values of its last time step), both taken at the node that carries the multiplier")
               .neededWhen("Law", {lawName(FrictionLaw::Tresca), lawName(FrictionLaw::Coulomb)})
               .entries(2, 2)
               .within(NumberRange::atLeast(0))
               .measuredIn("-"))
      .add(ParameterSpec("Principal Direction", {Type::DoubleArray},
                         "Its projection on the tangent plane is the axis t1; t2 = n x t1")
               .defaultTo(std::vector<double>{1, 0, 0})
               .entries(3, 3))
      .add(ParameterSpec("Principal Field", {Type::StringArray}, "Names of three nodal fields of the mesh file, in place of Principal Direction")
               .entries(3, 3)
               .notEmpty())
      .add(cylindrical())
      .atMostOneOf({"Principal Direction", "Principal Field", "Cylindrical"})
      .add(ParameterSpec("Slip Bound", {Type::Double}, "Bound of the tangential traction")
               .onlyWhen("Law", {lawName(FrictionLaw::Tresca)})
               .neededWhen("Law", {lawName(FrictionLaw::Tresca)})
               .within(NumberRange::atLeast(0))
               .measuredIn("force per area"))
      .rule("`Principal Direction` is not zero.",
            [](const ParameterList& list) { return zeroVector(list, "Principal Direction"); })
      .rule("Where `Coefficients` are given, `Law` is given too.", lawIsMissing)
      .rule("An expression is one of x, y, z as in Boundary Conditions; a single other name is a nodal field.", wrongCoefficient);
  return section;
}

template <std::size_t n>
std::array<double, n> numbers(const ParameterList& list, const std::string& name) {
  const auto& given = list.get<Teuchos::Array<double>>(name);
  std::array<double, n> values;
  std::copy_n(given.begin(), n, values.begin());
  return values;
}

FrictionOptions frictionOptions(const ParameterList& list, const std::string& path) {
  FrictionOptions friction;
  friction.law = choiceNamed<std::optional<FrictionLaw>>(list.get<std::string>("Law"));
  if (list.isParameter("Coefficients")) {
    const auto functions = placeFunctions(list, "Coefficients", joinPath(path, "Coefficients"));
    std::copy(functions.begin(), functions.end(), friction.coefficients.begin());
  }
  friction.principalDirection = numbers<3>(list, "Principal Direction");
  if (list.isParameter("Principal Field")) friction.principalField = list.get<Teuchos::Array<std::string>>("Principal Field").toVector();
  if (list.isSublist("Cylindrical")) {
    const auto& axes = list.sublist("Cylindrical");
    friction.cylindrical = CylindricalOptions{numbers<3>(axes, "Point"), numbers<3>(axes, "Axis"),
                                              choiceNamed<CylindricalDirection>(axes.get<std::string>("Direction"))};
  }
  if (list.isParameter("Slip Bound")) friction.slipBound = list.get<double>("Slip Bound");
  return friction;
}

const std::string geometric = "Geometric", closed = "Closed";

std::optional<Expression> gapOf(const ParameterList& list, const std::string& path) {
  if (list.isType<double>("Gap")) return Expression(list.get<double>("Gap"));
  const auto& text = list.get<std::string>("Gap");
  if (text == geometric) return std::nullopt;
  return text == closed ? Expression(0.0) : Expression(text, path);
}

std::string wrongGap(const ParameterList& list) {
  try {
    if (list.isParameter("Gap")) gapOf(list, "Gap");
  } catch (const InputError& e) {
    return std::string(e.what()) + "; or give " + geometric + " or " + closed;
  }
  return "";
}

std::string smoothedPlane(const ParameterList& list) {
  const std::string none = nameOf(PrimarySmoothing::None);
  if (!list.isSublist("Rigid Plane") || !list.isParameter("Primary Smoothing") || list.get<std::string>("Primary Smoothing") == none) return "";
  return "Primary Smoothing: is of no use for a Rigid Plane; leave it out";
}

std::string sameSurface(const ParameterList& list) {
  if (!list.isParameter("Primary Side Set")) return "";
  const auto& name = list.get<std::string>("Primary Side Set");
  if (name != list.get<std::string>("Secondary Side Set")) return "";
  return "Primary Side Set: is the Secondary Side Set '" + name + "' too; give two different surfaces";
}

bool joinTheSame(const ParameterList& a, const ParameterList& b) {
  const auto side = [](const ParameterList& list, const char* which) { return list.isParameter(which) ? list.get<std::string>(which) : ""; };
  const auto surfaces = [&](const ParameterList& list) {
    std::array<std::string, 2> names{side(list, "Secondary Side Set"), side(list, "Primary Side Set")};
    std::sort(names.begin(), names.end());
    return names;
  };
  const auto plane = [](const ParameterList& list) {
    const ParameterList& own = list.sublist("Rigid Plane");
    return std::array{numbers<3>(own, "Point"), numbers<3>(own, "Normal")};
  };
  if (surfaces(a) != surfaces(b)) return false;
  return !a.isSublist("Rigid Plane") || (b.isSublist("Rigid Plane") && plane(a) == plane(b));
}

// The forces of both could be told by their sum only.
std::string joinedTwice(const ParameterList& contacts) {
  for (auto b = contacts.begin(); b != contacts.end(); ++b)
    for (auto a = contacts.begin(); a != b; ++a)
      if (joinTheSame(contacts.sublist(contacts.name(a)), contacts.sublist(contacts.name(b))))
        return contacts.name(b) + ": joins the same surfaces as contact '" + contacts.name(a) + "'; leave one of them out";
  return "";
}

}  // namespace

// Absent ones keep the defaults of the options: these are written nowhere else.
ContactOptions contactOptions(const std::string& name, const ParameterList& list) {
  ContactOptions contact;
  contact.name = name;
  contact.path = "Contact->" + name;
  contact.secondarySideSet = list.get<std::string>("Secondary Side Set");
  if (list.isParameter("Primary Side Set")) contact.primarySideSet = list.get<std::string>("Primary Side Set");
  if (list.isSublist("Rigid Plane")) {
    const auto& plane = list.sublist("Rigid Plane");
    contact.rigidPlane = RigidPlaneOptions{numbers<3>(plane, "Point"), numbers<3>(plane, "Normal")};
  }
  contact.discretization = choiceNamed<Discretization>(list.get<std::string>("Discretization"));
  contact.sides = choiceNamed<ContactSides>(list.get<std::string>("Sides"));
  contact.multiplierSpace = choiceNamed<MultiplierSpace>(list.get<std::string>("Multiplier Space"));
  contact.gap = gapOf(list, joinPath(contact.path, "Gap"));
  contact.initialPenetration = choiceNamed<InitialPenetration>(list.get<std::string>("Initial Penetration"));
  contact.smoothing = choiceNamed<PrimarySmoothing>(list.get<std::string>("Primary Smoothing"));
  contact.matchingTolerance = list.get<double>("Matching Tolerance");
  contact.friction = frictionOptions(list.sublist("Friction"), joinPath(contact.path, "Friction"));
  return contact;
}

ParameterTree contactSection() {
  ParameterTree pair("<contact>", "One pair of surfaces, or a surface and a rigid plane; the name is yours.");
  pair.add(ParameterSpec("Secondary Side Set", {Type::String},
                         "Name or number of the surface that carries the multipliers and the normal")
               .mustBeGiven()
               .notEmpty())
      .add(ParameterSpec("Primary Side Set", {Type::String}, "Name or number of the opposite surface")
               .notEmpty())
      .add(rigidPlane())
      .add(ParameterSpec("Discretization", {Type::String},
                         "Node To Node needs matching meshes; Mortar is weak contact between any; Automatic takes Node To Node where meshes match and surfaces have no "
                         "creases")
               .defaultTo(std::string(nameOf(ContactOptions{}.discretization)))
               .oneOf(choiceNames<Discretization>()))
      .add(ParameterSpec("Sides", {Type::String},
                         "Mortar: Automatic lets the softer side, of two alike the finer one, be the secondary surface, but none of which supports or "
                         "the other body leave a row of nodes or fewer, and the one named so where a nodal field gives friction; As Given the one named so")
               .defaultTo(std::string(nameOf(ContactOptions{}.sides)))
               .oneOf(choiceNames<ContactSides>()))
      .add(ParameterSpec("Multiplier Space", {Type::String},
                         "Mortar on quadratic faces: Linear has multipliers at corners alone, Automatic and Full at all nodes of faces that are covered "
                         "as a whole")
               .defaultTo(std::string(nameOf(ContactOptions{}.multiplierSpace)))
               .oneOf(choiceNames<MultiplierSpace>()))
      .add(ParameterSpec("Gap", {Type::Double, Type::String},
                         "Distance of the surfaces along the secondary surface's normal, negative where they overlap: Geometric takes it from the mesh, Closed "
                         "is 0; or a number, or an expression of x, y, z at the nodes that carry multipliers. Of no effect where Law is Tied")
               .defaultTo(geometric)
               .measuredIn("length"))
      .add(ParameterSpec("Initial Penetration", {Type::String},
                         "Where the surfaces overlap at the start: Resolve presses them apart (an interference fit), Ignore takes them as touching")
               .defaultTo(std::string(nameOf(ContactOptions{}.initialPenetration)))
               .oneOf(choiceNames<InitialPenetration>()))
      .add(ParameterSpec("Primary Smoothing", {Type::String},
                         "Mortar: gaps are measured to a curved surface through the nodes of the primary one, against the noise of facets (curvature x h^2 / 8): "
                         "Cylinder and Sphere are fitted to all its nodes, Nagata patches follow the normals at the nodes of each linear face")
               .defaultTo(std::string(nameOf(ContactOptions{}.smoothing)))
               .oneOf(choiceNames<PrimarySmoothing>()))
      .add(ParameterSpec(
               "Matching Tolerance", {Type::Double},
               "Node To Node: largest tangential distance of paired nodes, relative to the element size")
               .defaultTo(ContactOptions{}.matchingTolerance)
               .within(NumberRange{0, 0.25, true, false})
               .measuredIn("-"))
      .add(friction())
      .exactlyOneOf({"Primary Side Set", "Rigid Plane"})
      .rule("The two side sets differ.", sameSurface)
      .rule("`Gap` is a word, a number or an expression as in Boundary Conditions.", wrongGap)
      .rule("`Primary Smoothing` goes with a `Primary Side Set`.", smoothedPlane);
  ParameterTree contact("Contact", "One list for each contact; without this section there is no contact.");
  contact.addUserNamed(std::move(pair), 0).rule("No two contacts join the same surfaces.", joinedTwice);
  return contact;
}

}  // namespace Haptos
