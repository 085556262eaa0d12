// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "Haptos_ContactPair.hpp"
#include "Haptos_MeshShare.hpp"
#include "Haptos_PartialMesh.hpp"
#include "Haptos_RunOptions.hpp"

namespace Haptos {

/// \brief Coefficients and axes of friction at the nodes of contact surfaces, from expressions, nodal fields and cylindrical axes.
///
/// Nodes are positions in the mesh of the surfaces, which must outlive this.
class FrictionFields {
 public:
  /// \brief Fetches the nodal fields at the nodes of `surfaces`, here.  Collective.
  FrictionFields(const Communicator& comm, const MeshShare& mesh, const PartialMesh& surfaces);

  /// \brief The principal direction at a node, of any length > 0; empty where it is the same at all nodes.
  /// \throws InputError, when called, for a direction that is zero or not finite, naming the node
  std::function<std::array<double, 3>(std::int64_t)> directionAt(const ContactOptions& contact) const;

  /// \brief Coefficients of every pair at its secondary node, where they are not the same everywhere.
  /// \throws InputError for one that is negative or not finite, naming the node and its place
  void setCoefficients(const ContactOptions& contact, ContactInterface& interface) const;

 private:
  double valueAt(const PlaceFunction& function, std::int64_t node) const;
  double fieldAt(const std::string& name, std::int64_t node) const;

  const Mesh& mesh_;
  std::vector<NodalField> fields_;  // [nodes of mesh_]
};

std::vector<std::string> namedFields(const std::vector<ContactOptions>& contacts);  ///< nodal fields that they need

/// \brief Checks that the mesh has the nodal fields of a contact, and their values.
///
/// \param mesh whole, or a rank's share  \throws InputError naming the parameter and the field that has none, or the fields there are
void requireNodalFields(const ContactOptions& contact, const Mesh& mesh);

/// \brief F1 and F2, each the largest of pairs that have their own.
std::array<double, 2> largestCoefficients(const ContactInterface& interface);

}  // namespace Haptos
