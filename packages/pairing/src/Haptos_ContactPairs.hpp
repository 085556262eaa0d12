// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "Haptos_ContactChoices.hpp"
#include "Haptos_ContactPair.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Mesh.hpp"
#include "Haptos_Options.hpp"

namespace Haptos {

/// \brief The meshes of an interface do not match, so that it cannot be treated node to node.
class NonMatchingError : public InputError {
 public:
  using InputError::InputError;
};

/// \brief A rigid obstacle: the half space behind a plane.
struct RigidPlane {
  std::array<double, 3> point;
  std::array<double, 3> normal;  ///< points to the body; need not be of length 1
};

/// \brief One contact interface as the user states it; exactly one of `primarySideSet` and `rigidPlane` is
/// set.
struct ContactSpec {
  std::string name;              ///< for messages and results
  std::string secondarySideSet;  ///< name or number
  std::string primarySideSet;    ///< name or number; empty: rigid plane
  std::optional<RigidPlane> rigidPlane;
  bool tied = false;             ///< bonded, no contact law
  bool isFrictionless = false;   ///< so that two contacts may act on one node in different directions
  std::array<double, 3> principalDirection = {1.0, 0.0, 0.0};
  std::function<std::array<double, 3>(std::int64_t)> directionAt;  ///< by mesh node, in place of the one; or none
  double matchingTolerance = 1e-3;  ///< tangential mismatch allowed, of the local element size; in (0, 0.25]
  Discretization discretization = Discretization::Automatic;
  ContactSides sides = ContactSides::Automatic;
  bool isToldAtNodes = false;  ///< the law is told at nodes of the side that is given as secondary: sides stay as given
  MultiplierSpace multiplierSpace = MultiplierSpace::Automatic;
  std::function<double(std::int64_t)> gapAt;  ///< by mesh node, in place of that of the geometry; or none
  InitialPenetration initialPenetration = InitialPenetration::Resolve;
  PrimarySmoothing smoothing = PrimarySmoothing::None;  ///< of gaps of mortar

  /// Axes at a mesh node with the normal n.
  LocalFrame frameAt(std::int64_t node, const std::array<double, 3>& normal) const {
    return makeFrame(normal, directionAt ? directionAt(node) : principalDirection);
  }
};

/// \brief What a pairing must know beside the mesh; empty: nothing of the kind.
struct ContactSurroundings {
  std::vector<double> youngsModulus;               ///< [blocks]
  std::vector<std::array<char, 3>> isPrescribed;  ///< [nodes] displacements, by component
};

/// \brief Pairs of all interfaces: node to node (see `matchSurfaces`) or by mortar (see `dualMortarRows`).  Serial: needs the
/// whole mesh.
///
/// Automatic is node to node where the meshes match, else mortar.  There the secondary side is, unless `sides` is AsGiven, the softer
/// one, and of two alike the finer, but none of which supports leave a row of nodes or fewer.  A node may be secondary in several interfaces (a corner): it then has a pair in each.
/// \throws NonMatchingError if the nodes of two surfaces do not match that are to be paired node to node
/// \throws InputError for a side set that is missing, an interface without or with two obstacles, a node on
///   both sides that do not look at each other, normals that do not oppose, a direction that is zero or not finite
std::vector<ContactInterface> buildContact(const Mesh& mesh, const std::vector<ContactSpec>& specs, const ContactSurroundings& around = {});

}  // namespace Haptos
