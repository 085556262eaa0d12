// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactPairs.hpp"

#include <algorithm>
#include <iterator>
#include <sstream>

#include "Haptos_ContactSurface.hpp"
#include "Haptos_InputCheck.hpp"
#include "Haptos_SurfaceMatching.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

bool isDirection(const std::array<double, 3>& a) {
  return Vec3::isFinite(a) && (a[0] != 0.0 || a[1] != 0.0 || a[2] != 0.0);
}

std::string show(const std::array<double, 3>& a) {
  std::ostringstream text;
  text << "(" << a[0] << ", " << a[1] << ", " << a[2] << ")";
  return text.str();
}

// Once more what the input checks: applications come here without it.
void checkSpec(const ContactSpec& spec) {
  const std::string where = "Contact '" + spec.name + "': ";
  HAPTOS_REFUSE_IF(spec.primarySideSet.empty() == !spec.rigidPlane,
                   where << "give either a Primary Side Set or a Rigid Plane, and only one of them.");
  HAPTOS_REFUSE_IF(!isDirection(spec.principalDirection),
                   where << "Principal Direction " << show(spec.principalDirection)
                         << " must be finite and must not be zero.");
  HAPTOS_REFUSE_IF(!(spec.matchingTolerance > 0.0 && spec.matchingTolerance <= 0.25),
                   where << "matching tolerance " << spec.matchingTolerance
                         << " (part of the element size) must be above 0 and at most 0.25.");
  if (!spec.rigidPlane) return;
  HAPTOS_REFUSE_IF(!isDirection(spec.rigidPlane->normal),
                   where << "Rigid Plane Normal " << show(spec.rigidPlane->normal)
                         << " must be finite and must not be zero.");
  HAPTOS_REFUSE_IF(!Vec3::isFinite(spec.rigidPlane->point),
                   where << "Rigid Plane Point " << show(spec.rigidPlane->point) << " must be finite.");
}

// The surface's own messages with the interface's name before them.
ContactSurface surfaceOf(const Mesh& mesh, const ContactSpec& spec, const std::string& sideSet,
                         const char* role) {
  try {
    return makeContactSurface(mesh, sideSet);
  } catch (const InputError& error) {
    throw InputError("Contact '" + spec.name + "', " + role + ": " + error.what());
  }
}

// A node on both surfaces would be in contact with itself: bodies must be apart there, by nodes of their own.
void checkNoSharedNode(const Mesh& mesh, const ContactSpec& spec, const ContactSurface& secondary,
                       const ContactSurface& primary) {
  std::vector<std::int64_t> shared;
  std::set_intersection(secondary.nodes.begin(), secondary.nodes.end(), primary.nodes.begin(),
                        primary.nodes.end(), std::back_inserter(shared));
  if (shared.empty()) return;
  HAPTOS_REFUSE_IF(secondary.nodes == primary.nodes,
                   "Contact '" << spec.name << "': side sets '" << secondary.name << "' and '"
                               << primary.name << "' hold the same nodes, "
                               << describeNode(mesh, shared[0])
                               << " for one; a surface cannot be in contact with itself.");
  HAPTOS_REFUSE_IF(true,
                   "Contact '" << spec.name << "': " << describeNode(mesh, shared[0]) << " is in side set '"
                               << secondary.name << "' and in '" << primary.name << "' (so are " << shared.size() - 1
                               << " more); a node cannot be in contact with itself. The bodies need "
                                  "nodes of their own there, or the faces must leave the side sets.");
}

// Said in the summary: nothing in reach is more often a mistake than a model.
std::string unpairedNote(const ContactSurface& secondary, const ContactSurface& primary, std::size_t count) {
  std::ostringstream text;
  if (count == secondary.numNodes())
    text << "no contact (no pair within reach): no face of '" << primary.name << "' lies opposite a node of '"
         << secondary.name << "'";
  else
    text << count << " of " << secondary.numNodes() << " nodes of '" << secondary.name
         << "' have no pair: no face of '" << primary.name << "' lies opposite them";
  return text.str();
}

// Deeper than an element: more likely surfaces that face away from each other than an interference fit.
void notePenetration(const Mesh& mesh, const ContactSurface& secondary, ContactInterface& interface) {
  const auto deepest = std::min_element(interface.pairs.begin(), interface.pairs.end(),
                                        [](const auto& a, const auto& b) { return a.gap < b.gap; });
  if (deepest == interface.pairs.end()) return;
  const auto position =
      std::lower_bound(secondary.nodes.begin(), secondary.nodes.end(), deepest->secondaryNode);
  const double size = secondary.sizes[std::size_t(position - secondary.nodes.begin())];
  if (!(deepest->gap < -size)) return;
  std::ostringstream text;
  text << "initial penetration of " << -deepest->gap << ", more than the element size " << size << ", at "
       << describeNode(mesh, deepest->secondaryNode) << " of '" << secondary.name
       << "': do the surfaces face each other?";
  interface.notes.push_back(text.str());
}

// One pair a secondary node that has a partner; nodes without one take no part, which is noted.
void pairWithSurface(const Mesh& mesh, const ContactSpec& spec, const ContactSurface& secondary,
                     ContactInterface& interface) {
  const ContactSurface primary = surfaceOf(mesh, spec, spec.primarySideSet, "Primary Side Set");
  checkNoSharedNode(mesh, spec, secondary, primary);
  const SurfaceMatch match = matchSurfaces({mesh, spec.name, secondary, primary}, spec.matchingTolerance);
  for (std::size_t i = 0; i < secondary.numNodes(); ++i) {
    if (match.partner[i] < 0) {
      ++interface.unpairedNodes;
      continue;
    }
    interface.pairs.push_back({secondary.nodes[i], {{secondary.nodes[i], 1.0}}, {{primary.nodes[std::size_t(match.partner[i])], 1.0}},
                               makeFrame(secondary.normals[i], spec.principalDirection), match.gap[i],
                               secondary.areas[i]});
  }
  if (interface.unpairedNodes > 0)
    interface.notes.push_back(unpairedNote(secondary, primary, interface.unpairedNodes));
  if (match.mismatched > 0)
    interface.notes.push_back("the nodes of '" + secondary.name + "' and '" + primary.name + "' match, but " +
                              std::to_string(match.mismatched) +
                              " faces do not (other diagonals, triangles on quadrilaterals): nodal pressures "
                              "are less accurate there");
}

// Every secondary node is paired with the plane, whatever its distance: the gap is - (x - point) . n.
void pairWithPlane(const ContactSpec& spec, const ContactSurface& secondary, ContactInterface& interface) {
  // n = -Normal: outward from the body, towards the obstacle
  const LocalFrame frame = makeFrame(Vec3::scale(-1.0, spec.rigidPlane->normal), spec.principalDirection);
  double best = -1.0;
  for (std::size_t i = 0; i < secondary.numNodes(); ++i) {
    best = std::max(best, Vec3::dot(secondary.normals[i], frame.normal));
    const auto fromPlane = Vec3::subtract(secondary.coordinates[i], spec.rigidPlane->point);
    interface.pairs.push_back(
        {secondary.nodes[i], {{secondary.nodes[i], 1.0}}, {}, frame, -Vec3::dot(fromPlane, frame.normal), secondary.areas[i]});
  }
  HAPTOS_REFUSE_IF(best <= 1e-6,
                   "Contact '" << spec.name << "': no face of side set '" << secondary.name
                               << "' looks towards the Rigid Plane; its Normal " << show(spec.rigidPlane->normal)
                               << " must point to the body. Is it the wrong side set, or the wrong sign?");
}

}  // namespace

// Surfaces, pairs, and what the user should know of them.
ContactInterface buildContactInterface(const Mesh& mesh, const ContactSpec& spec) {
  checkSpec(spec);
  const ContactSurface secondary = surfaceOf(mesh, spec, spec.secondarySideSet, "Secondary Side Set");
  ContactInterface interface;
  interface.name = spec.name;
  interface.tied = spec.tied;
  interface.pairs.reserve(secondary.numNodes());
  if (spec.rigidPlane)
    pairWithPlane(spec, secondary, interface);
  else
    pairWithSurface(mesh, spec, secondary, interface);
  notePenetration(mesh, secondary, interface);
  return interface;
}

std::vector<ContactInterface> buildContact(const Mesh& mesh, const std::vector<ContactSpec>& specs) {
  std::vector<ContactInterface> interfaces;
  interfaces.reserve(specs.size());
  for (const ContactSpec& spec : specs) interfaces.push_back(buildContactInterface(mesh, spec));
  return interfaces;
}

}  // namespace Haptos
