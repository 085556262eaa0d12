// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_FrictionFields.hpp"

#include <algorithm>
#include <cmath>

#include "Haptos_Error.hpp"
#include "Haptos_ParameterValue.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

// With the parameter that names each.
std::vector<std::pair<std::string, std::string>> fieldsOf(const FrictionOptions& friction) {
  std::vector<std::pair<std::string, std::string>> names;
  for (const auto& function : friction.coefficients)
    if (!function.field.empty()) names.emplace_back("Coefficients", function.field);
  for (const auto& name : friction.principalField) names.emplace_back("Principal Field", name);
  return names;
}

// Zero on the axis, but for the axis itself.
Vec3::Array directionOf(const CylindricalOptions& axes, const Vec3::Array& x) {
  const auto axis = Vec3::normalized(axes.axis);
  if (axes.direction == CylindricalDirection::Axial) return axis;
  const auto from = Vec3::subtract(x, axes.point);
  const auto radius = Vec3::subtract(from, Vec3::scale(Vec3::dot(from, axis), axis));
  const bool isOnAxis = Vec3::norm(radius) <= 1e-9 * std::max(Vec3::norm(from), Vec3::norm(x));
  if (isOnAxis) return {};
  return axes.direction == CylindricalDirection::Radial ? radius : Vec3::cross(axis, radius);
}

}  // namespace

FrictionFields::FrictionFields(const Communicator& comm, const MeshShare& mesh, const PartialMesh& surfaces) : mesh_(surfaces.mesh) {
  const RemoteValues nodes(comm, mesh.nodes, surfaces.nodes);
  for (const auto& field : mesh.part.nodalFields) {
    if (!anyOfAll(comm, !field.values.empty())) continue;  // nobody asked for it
    fields_.push_back({field.name, nodes.fetch([&](std::int64_t place) { return field.values[std::size_t(place)]; })});
  }
}

double FrictionFields::fieldAt(const std::string& name, std::int64_t node) const {
  const auto field = std::find_if(fields_.begin(), fields_.end(), [&](const NodalField& f) { return f.name == name; });
  return field->values[std::size_t(node)];
}

double FrictionFields::valueAt(const PlaceFunction& function, std::int64_t node) const {
  if (!function.field.empty()) return fieldAt(function.field, node);
  const auto& x = mesh_.coordinates[std::size_t(node)];
  return function.expression(x[0], x[1], x[2]);
}

std::function<std::array<double, 3>(std::int64_t)> FrictionFields::directionAt(const ContactOptions& contact) const {
  const FrictionOptions& friction = contact.friction;
  if (friction.principalField.empty() && !friction.cylindrical) return nullptr;
  return [this, friction, path = contact.path + "->Friction->"](std::int64_t node) {
    Vec3::Array direction{};
    if (friction.cylindrical) direction = directionOf(*friction.cylindrical, mesh_.coordinates[std::size_t(node)]);
    else
      for (std::size_t d = 0; d < 3; ++d) direction[d] = fieldAt(friction.principalField[d], node);
    if (Vec3::isFinite(direction) && direction != Vec3::Array{}) return direction;
    if (friction.cylindrical)
      throw InputError(path + "Cylindrical: " + describeNode(mesh_, node) + " lies on the axis, where there is no " +
                       nameOf(friction.cylindrical->direction) + " direction; take the Axial one, or a Principal Field");
    throw InputError(path + "Principal Field: is (" + numberText(direction[0]) + ", " + numberText(direction[1]) + ", " + numberText(direction[2]) +
                     ") at " + describeNode(mesh_, node) + "; it must be finite and not zero on the contact surfaces");
  };
}

void FrictionFields::setCoefficients(const ContactOptions& contact, ContactInterface& interface) const {
  const FrictionOptions& friction = contact.friction;
  if (!friction.hasFields() || !friction.law || friction.law == FrictionLaw::Frictionless) return;
  const std::string path = contact.path + "->Friction->Coefficients: ";
  for (auto& pair : interface.pairs) {
    auto& values = pair.coefficients.emplace();
    for (std::size_t i = 0; i < 2; ++i) {
      const PlaceFunction& function = friction.coefficients[i];
      const std::string place = describeNode(mesh_, pair.secondaryNode);
      try {
        values[i] = valueAt(function, pair.secondaryNode);
      } catch (const InputError& e) {
        throw InputError(std::string(e.what()) + ", and there is " + place);
      }
      if (!(values[i] >= 0 && std::isfinite(values[i])))
        throw InputError(path + "F" + std::to_string(i + 1) + ", " + (function.field.empty() ? "the expression '" + function.expression.text() : "the nodal field '" + function.field) +
                         "', is " + numberText(values[i]) + " at " + place + "; it must be finite and at least 0 on the contact surface");
    }
  }
}

std::vector<std::string> namedFields(const std::vector<ContactOptions>& contacts) {
  std::vector<std::string> names;
  for (const auto& contact : contacts)
    for (const auto& [parameter, name] : fieldsOf(contact.friction)) names.push_back(name);
  return names;
}

void requireNodalFields(const ContactOptions& contact, const Mesh& mesh) {
  for (const auto& [parameter, name] : fieldsOf(contact.friction)) {
    const std::string path = contact.path + "->Friction->" + parameter + ": ";
    const int field = findNodalField(mesh, name);
    if (field < 0)
      throw InputError(path + "the mesh has no nodal field '" + name + "'; its nodal fields are: " + listNodalFields(mesh) +
                       (parameter == "Coefficients" ? " (expressions know x, y, z)" : ""));
    // A share without nodes has none of the values either.
    if (mesh.nodalFields[std::size_t(field)].values.empty() && mesh.numNodes() > 0)
      throw InputError(path + "the mesh's nodal field '" + name + "' has no values; give one for each node");
  }
}

std::array<double, 2> largestCoefficients(const ContactInterface& interface) {
  std::array<double, 2> largest{0, 0};
  for (const auto& pair : interface.pairs)
    for (std::size_t i = 0; i < 2 && pair.coefficients; ++i) largest[i] = std::max(largest[i], (*pair.coefficients)[i]);
  return largest;
}

}  // namespace Haptos
