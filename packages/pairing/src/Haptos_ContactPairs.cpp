// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactPairs.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include "Haptos_ContactSurface.hpp"
#include "Haptos_FacetTree.hpp"
#include "Haptos_InputCheck.hpp"
#include "Haptos_MortarSides.hpp"
#include "Haptos_MultiplierRules.hpp"
#include "Haptos_PointwiseGap.hpp"
#include "Haptos_SurfaceMatching.hpp"
#include "Haptos_UnpairedNodes.hpp"
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

// A node on both surfaces would be in contact with itself.  Where the surfaces look at each other (crack tips) it takes no part;
// elsewhere bodies must be apart, by nodes of their own.
void checkSharedNodes(const Mesh& mesh, const ContactSpec& spec, const ContactSurface& secondary, const ContactSurface& primary) {
  constexpr double kOpposing = -0.2;
  std::vector<std::int64_t> shared;
  std::set_intersection(secondary.nodes.begin(), secondary.nodes.end(), primary.nodes.begin(),
                        primary.nodes.end(), std::back_inserter(shared));
  HAPTOS_REFUSE_IF(shared.size() == std::min(secondary.numNodes(), primary.numNodes()),
                   "Contact '" << spec.name << "': side sets '" << secondary.name << "' and '"
                               << primary.name << "' hold the same nodes, "
                               << describeNode(mesh, shared[0])
                               << " for one; a surface cannot be in contact with itself.");
  const auto normalAt = [](const ContactSurface& surface, std::int64_t node) {
    return surface.normals[std::size_t(std::lower_bound(surface.nodes.begin(), surface.nodes.end(), node) - surface.nodes.begin())];
  };
  shared.erase(std::remove_if(shared.begin(), shared.end(),
                              [&](std::int64_t node) { return Vec3::dot(normalAt(secondary, node), normalAt(primary, node)) < kOpposing; }),
               shared.end());
  HAPTOS_REFUSE_IF(!shared.empty(),
                   "Contact '" << spec.name << "': " << describeNode(mesh, shared[0]) << " is in side set '"
                               << secondary.name << "' and in '" << primary.name << "' (so are " << shared.size() - 1
                               << " more), which do not look at each other there; a node cannot be in contact with itself. The bodies need "
                                  "nodes of their own there, or the faces must leave the side sets.");
}

// Said in the summary.
std::string unpairedNote(const SurfaceCouple& couple, std::size_t count, std::size_t numNodes) {
  return std::to_string(count) + " of " + std::to_string(numNodes) + " nodes of '" + couple.secondary.name + "' have no pair from the start: no face of '" +
         couple.primary.name + "' lies opposite them";
}

// Deeper than an element: more likely surfaces that face away from each other than an interference fit.
void notePenetration(const Mesh& mesh, const ContactPair& deepest, ContactInterface& interface) {
  const double size = deepest.size;
  constexpr double kRoundOff = 1e-10;
  if (!(deepest.gap < -kRoundOff * size)) return;
  const auto node = std::size_t(deepest.secondaryNode);
  interface.overlap = {-deepest.gap, mesh.nodeNumbers.empty() ? deepest.secondaryNode + 1 : mesh.nodeNumbers[node], mesh.coordinates[node]};
  if (!(deepest.gap < -size)) return;
  std::ostringstream text;
  text << "initial penetration of " << -deepest.gap << ", more than the element size " << size << ", at "
       << describeNode(mesh, deepest.secondaryNode) << " of '" << interface.name
       << "': do the surfaces face each other?";
  interface.notes.push_back(text.str());
}

// What is known of all gaps together.
void finishGaps(const Mesh& mesh, const ContactSpec& spec, ContactInterface& interface) {
  const auto deepest = std::min_element(interface.pairs.begin(), interface.pairs.end(),
                                        [](const auto& a, const auto& b) { return a.gap < b.gap; });
  if (deepest == interface.pairs.end()) return;
  notePenetration(mesh, *deepest, interface);
  if (spec.initialPenetration == InitialPenetration::Ignore && !spec.tied)
    for (auto& pair : interface.pairs) pair.gap = std::max(pair.gap, 0.0);
}

// Every node deeper inside the other body than two elements: no fit is so tight.  A gap that is given tells nothing of the places.
void requireFacing(const ContactSpec& spec, const SurfaceCouple& couple, const ContactInterface& interface) {
  if (interface.pairs.empty() || spec.gapAt) return;
  const bool isInside =
      std::all_of(interface.pairs.begin(), interface.pairs.end(), [](const ContactPair& pair) { return pair.gap < -2 * pair.size; });
  HAPTOS_REFUSE_IF(isInside, "Contact '" << interface.name << "': all of side set '" << couple.secondary.name << "' lies behind '" << couple.primary.name
                                         << "', deeper than two elements; the surfaces look away from each other. Is one of them the wrong side set?");
}

void requireOpposite(const SurfaceCouple& couple, bool isAnyOpposite) {
  HAPTOS_REFUSE_IF(!isAnyOpposite, "Contact '" << couple.interface << "': no face of side set '" << couple.primary.name << "' lies opposite one of '"
                                               << couple.secondary.name << "' and looks at it; name surfaces that face each other.");
}

// A node that nothing lies opposite; its tangential axes are looked up when it gets a row.
UnpairedNodes::Node unpairedNode(const ContactSpec& spec, const ContactSurface& s, std::size_t i) {
  ContactPair pair{s.nodes[i], {{s.nodes[i], 1.0}}, {}, makeFrame(s.normals[i], spec.principalDirection), 0.0, s.areas[i]};
  pair.size = s.sizes[i];
  return {std::move(pair), s.coordinates[i], spec.gapAt ? std::optional(spec.gapAt(s.nodes[i])) : std::nullopt};
}

// They are told, and kept for the check that nothing carries them into the other body; a tie has no such check.
void keepUnpaired(const ContactSpec& spec, const SurfaceCouple& couple, std::vector<UnpairedNodes::Node> nodes, std::size_t numNodes, ContactInterface& interface) {
  if (interface.unpairedNodes > 0) interface.notes.push_back(unpairedNote(couple, interface.unpairedNodes, numNodes));
  if (!spec.tied && !nodes.empty()) interface.unpaired = std::make_shared<UnpairedNodes>(std::move(nodes), couple.primary, spec.initialPenetration);
}

// [secondary nodes] of the faces that are covered as wholes: a surface that reaches beyond the other one has its pressure there only.  A node with no
// such face keeps its whole area.
std::vector<double> areasInContact(const ContactSurface& surface, const SurfaceMatch& match) {
  std::vector<char> isCovered(surface.numFacets(), 1);
  for (std::size_t f = 0; f < surface.numFacets(); ++f)
    for (const int node : surface.facets[f])
      if (node >= 0 && match.partner[std::size_t(node)] < 0) isCovered[f] = 0;
  std::vector<double> areas = areasOnFacets(surface, isCovered);
  for (std::size_t i = 0; i < areas.size(); ++i)
    if (!(areas[i] > 0)) areas[i] = surface.areas[i];
  return areas;
}

// One pair a secondary node that has a partner; nodes without one take no part, which is noted.
void pairNodeToNode(const ContactSpec& spec, const SurfaceCouple& couple, ContactInterface& interface) {
  const ContactSurface &secondary = couple.secondary, &primary = couple.primary;
  const SurfaceMatch match = matchSurfaces(couple, spec.matchingTolerance);
  const std::vector<double> areas = areasInContact(secondary, match);
  std::size_t onBothSides = 0;
  std::vector<UnpairedNodes::Node> unpaired;
  for (std::size_t i = 0; i < secondary.numNodes(); ++i) {
    if (match.partner[i] < 0) {
      unpaired.push_back(unpairedNode(spec, secondary, i));
      continue;
    }
    const auto partner = primary.nodes[std::size_t(match.partner[i])];
    if (partner == secondary.nodes[i]) {
      ++onBothSides;
      continue;
    }
    interface.pairs.push_back({secondary.nodes[i], {{secondary.nodes[i], 1.0}}, {{partner, 1.0}},
                               spec.frameAt(secondary.nodes[i], secondary.normals[i]),
                               spec.gapAt ? spec.gapAt(secondary.nodes[i]) : match.gap[i],
                               areas[i]});
    interface.pairs.back().size = secondary.sizes[i];
  }
  interface.unpairedNodes = unpaired.size();
  requireOpposite(couple, interface.unpairedNodes < secondary.numNodes());
  if (!spec.tied) requireFacing(spec, couple, interface);
  keepUnpaired(spec, couple, std::move(unpaired), secondary.numNodes(), interface);
  if (onBothSides > 0)
    interface.notes.push_back(std::to_string(onBothSides) + " nodes are in '" + secondary.name + "' and in '" + primary.name +
                              "' and take no part in the contact");
  if (match.mismatched > 0)
    interface.notes.push_back("the nodes of '" + secondary.name + "' and '" + primary.name + "' match, but " +
                              std::to_string(match.mismatched) +
                              " faces do not (other diagonals, triangles on quadrilaterals): nodal pressures "
                              "are less accurate there");
}

// Patch by patch, but for ties, which have no normals.  What is covered is integrated now; which nodes carry multipliers is decided
// when all interfaces are known.
std::vector<MortarDraft> draftMortar(const Mesh& mesh, const ContactSpec& spec, const std::string& secondarySet, ContactSurface primarySurface) {
  const auto primary = std::make_shared<const ContactSurface>(std::move(primarySurface));
  const FacetTree tree(*primary);
  auto patches = spec.tied ? std::vector<ContactSurface>{makeContactSurface(mesh, secondarySet)} : smoothPatches(mesh, secondarySet);
  std::vector<MortarDraft> drafts;
  for (auto& patch : patches) {
    MortarDraft& draft = drafts.emplace_back(MortarDraft{&spec, std::move(patch), primary, {}, {}});
    draft.bars.assign(draft.secondary.numNodes(), Bar::None);
    draft.overlap = integrateOverlap(draft.secondary, *draft.primary, tree);
  }
  return drafts;
}

std::optional<RoundSurface> roundSurfaceOf(const ContactSpec& spec, const ContactSurface& primary) {
  try {
    return roundSurface(primary, spec.smoothing);
  } catch (const InputError& error) {
    throw InputError("Contact '" + spec.name + "': " + error.what());
  }
}

// A node on a crease has one pair node to node, along a mean of normals that is none of its faces'; patches of mortar have one each.
std::string creaseIn(const ContactSpec& spec, const ContactSurface& secondary, const ContactSurface& primary) {
  if (spec.tied || spec.discretization != Discretization::Automatic) return "";
  if (isCreased(secondary)) return "'" + spec.secondarySideSet + "' has creases";
  return isCreased(primary) ? "'" + spec.primarySideSet + "' has creases" : "";
}

// Node to node where the meshes match or where it is asked for.
// \param toldToBeMortar why; empty: by itself it need not
std::vector<MortarDraft> pairWithSurface(const Mesh& mesh, const ContactSpec& spec, const ContactSurroundings& around,
                                         const std::string& toldToBeMortar, ContactInterface& interface) {
  ContactSurface secondary = surfaceOf(mesh, spec, spec.secondarySideSet, "Secondary Side Set");
  ContactSurface primary = surfaceOf(mesh, spec, spec.primarySideSet, "Primary Side Set");
  checkSharedNodes(mesh, spec, secondary, primary);
  const std::string mustBeMortar = toldToBeMortar.empty() ? creaseIn(spec, secondary, primary) : toldToBeMortar;
  std::string reason = mustBeMortar.empty() ? "Discretization is Mortar" : mustBeMortar;
  if (hasMiddles(secondary) || hasMiddles(primary)) {  // all nodes take the rows of mortar there, the same ones where the meshes match
    if (spec.discretization == Discretization::NodeToNode) matchSurfaces({mesh, spec.name, secondary, primary}, spec.matchingTolerance);
    reason = "faces are quadratic";
  } else if (spec.discretization != Discretization::Mortar && mustBeMortar.empty()) try {
      pairNodeToNode(spec, {mesh, spec.name, secondary, primary}, interface);
      finishGaps(mesh, spec, interface);
      return {};
    } catch (const NonMatchingError&) {
      if (spec.discretization == Discretization::NodeToNode) throw;
      reason = "the meshes do not match";
    }
  interface.isMortar = true;
  const std::string exchange = reasonToExchange(mesh, spec, around, secondary, primary);
  interface.isExchanged = !exchange.empty();
  if (interface.isExchanged) std::swap(secondary, primary);
  auto drafts = draftMortar(mesh, spec, exchange.empty() ? spec.secondarySideSet : spec.primarySideSet, primary);
  interface.remarks.push_back("'" + spec.name + "' is joined by mortar (" + reason + ")" +
                              (exchange.empty() ? "" : "; its sides are exchanged: '" + secondary.name + "', " + exchange +
                                                           ", carries the multipliers"));
  if (drafts.size() > 1)
    interface.remarks.push_back("'" + spec.name + "': '" + secondary.name + "' is cut along its creases into " + std::to_string(drafts.size()) + " surfaces");
  if (const auto round = roundSurfaceOf(spec, primary)) interface.remarks.push_back(describe(*round, primary.name, spec.name));
  return drafts;
}

// Of faces that look towards the plane, the others are noted: those of a body's sides and back may be in its side set, and never touch.
ContactSurface surfaceOnPlane(const Mesh& mesh, const ContactSpec& spec, ContactInterface& interface) {
  const ContactSurface whole = surfaceOf(mesh, spec, spec.secondarySideSet, "Secondary Side Set");
  ContactSurface facing = facesTowards(mesh, spec.secondarySideSet, whole, Vec3::scale(-1.0, spec.rigidPlane->normal));
  HAPTOS_REFUSE_IF(facing.nodes.empty(), "Contact '" << spec.name << "': no face of side set '" << facing.name
                                                     << "' looks towards the Rigid Plane; its Normal " << show(spec.rigidPlane->normal)
                                                     << " must point to the body. Is it the wrong side set, or the wrong sign?");
  const std::size_t all = whole.faces.size();
  if (all > facing.faces.size())
    interface.notes.push_back("'" + spec.name + "': " + std::to_string(all - facing.faces.size()) + " of " + std::to_string(all) + " faces of '" + facing.name +
                              "' do not look towards the Rigid Plane, and take no part in the contact");
  return facing;
}

// Every secondary node is paired with the plane, whatever its distance: the gap is - (x - point) . n.
void pairWithPlane(const ContactSpec& spec, const ContactSurface& secondary, ContactInterface& interface) {
  // n = -Normal: outward from the body, towards the obstacle
  const LocalFrame common = makeFrame(Vec3::scale(-1.0, spec.rigidPlane->normal), spec.principalDirection);
  const auto gapAt = [&](int node) {
    if (spec.gapAt) return std::optional(spec.gapAt(secondary.nodes[std::size_t(node)]));
    return std::optional(-Vec3::dot(Vec3::subtract(secondary.coordinates[std::size_t(node)], spec.rigidPlane->point), common.normal));
  };
  const auto add = [&](std::size_t i, std::vector<NodeWeight> weights, double gap, double area) {
    const LocalFrame frame = spec.directionAt ? spec.frameAt(secondary.nodes[i], common.normal) : common;
    interface.pairs.push_back({secondary.nodes[i], std::move(weights), {}, frame, gap, area});
    interface.pairs.back().size = secondary.sizes[i];
  };
  if (hasMiddles(secondary)) {
    interface.isMortar = true;
    for (const MortarRow& row : rowsOfWholeSurface(secondary, spec.multiplierSpace == MultiplierSpace::Linear))
      add(std::size_t(row.node), onMesh(secondary, row.secondary), *gapOfRow(row, gapAt), row.w);
  } else {
    for (std::size_t i = 0; i < secondary.numNodes(); ++i) add(i, {{secondary.nodes[i], 1.0}}, *gapAt(int(i)), secondary.areas[i]);
  }
}

// Of one interface, but for the pairs of mortar.
std::vector<MortarDraft> startInterface(const Mesh& mesh, const ContactSpec& spec, const ContactSurroundings& around, const std::string& mustBeMortar,
                                        ContactInterface& interface) {
  checkSpec(spec);
  interface = {};
  interface.name = spec.name;
  interface.tied = spec.tied;
  if (!spec.rigidPlane) return pairWithSurface(mesh, spec, around, mustBeMortar, interface);
  pairWithPlane(spec, surfaceOnPlane(mesh, spec, interface), interface);
  finishGaps(mesh, spec, interface);
  return {};
}

// Nodes that no primary face lies opposite and that have no pair, in any patch.
std::vector<UnpairedNodes::Node> findUnpaired(const std::vector<const MortarDraft*>& drafts, const ContactInterface& interface, std::size_t& numNodes) {
  std::map<std::int64_t, bool> isOpposite;
  for (const MortarDraft* draft : drafts)
    for (std::size_t i = 0; i < draft->secondary.numNodes(); ++i) {
      bool& flag = isOpposite[draft->secondary.nodes[i]];
      flag = flag || draft->overlap.isCovered[i];
    }
  for (const auto& pair : interface.pairs) isOpposite[pair.secondaryNode] = true;
  numNodes = isOpposite.size();
  std::vector<UnpairedNodes::Node> unpaired;
  for (const MortarDraft* draft : drafts)
    for (std::size_t i = 0; i < draft->secondary.numNodes(); ++i)
      if (!isOpposite[draft->secondary.nodes[i]]) unpaired.push_back(unpairedNode(*draft->spec, draft->secondary, i));
  return unpaired;
}

// \param drafts of the interface
void finishMortar(const Mesh& mesh, const ContactSurroundings& around, const std::vector<const MortarDraft*>& drafts, ContactInterface& interface) {
  const MortarDraft& first = *drafts.front();
  PointwiseGap gaps(*first.primary, first.spec->smoothing);
  bool isAnyCovered = false;
  for (const MortarDraft* draft : drafts) {
    addMortarPairs(around, *draft, gaps, interface);
    for (const auto& sums : draft->overlap.faces) isAnyCovered = isAnyCovered || sums.area > 0;
  }
  std::stable_sort(interface.pairs.begin(), interface.pairs.end(), [](const auto& a, const auto& b) { return a.secondaryNode < b.secondaryNode; });
  const SurfaceCouple couple{mesh, interface.name, first.secondary, *first.primary};
  requireFacing(*first.spec, couple, interface);
  requireOpposite(couple, isAnyCovered);
  std::size_t numNodes = 0;
  auto unpaired = findUnpaired(drafts, interface, numNodes);
  std::set<std::int64_t> different;  // one on a crease has several normals
  for (const auto& node : unpaired) different.insert(node.pair.secondaryNode);
  interface.unpairedNodes = different.size();
  keepUnpaired(*first.spec, couple, std::move(unpaired), numNodes, interface);
  finishGaps(mesh, *first.spec, interface);
}

// Those that never get a row: nodes of both sides, nodes that supports hold along n, nodes that another contact holds.
void dropHeldNodes(const ContactSurroundings& around, std::vector<ContactInterface>& interfaces) {
  std::set<std::int64_t> taken;
  for (const auto& interface : interfaces)
    for (const auto& pair : interface.pairs) taken.insert(pair.secondaryNode);
  const auto isHeld = [&](const ContactPair& pair) {
    return taken.count(pair.secondaryNode) > 0 ||
           (!around.isPrescribed.empty() && isNormalHeld(around.isPrescribed[std::size_t(pair.secondaryNode)], pair.frame.normal));
  };
  for (auto& interface : interfaces)
    if (interface.unpaired) interface.unpaired->drop(isHeld);
}

}  // namespace

std::vector<ContactInterface> buildContact(const Mesh& mesh, const std::vector<ContactSpec>& specs, const ContactSurroundings& around) {
  std::vector<ContactInterface> interfaces(specs.size());
  std::vector<std::vector<MortarDraft>> draftsOf(specs.size());
  for (std::size_t k = 0; k < specs.size(); ++k) draftsOf[k] = startInterface(mesh, specs[k], around, "", interfaces[k]);
  const auto closing = nodesThatCloseCircles(specs, interfaces);
  for (std::size_t k = 0; k < specs.size(); ++k) {
    const std::string told = "pairs of single nodes close circles with those of other contacts";
    if (closing[k].empty()) continue;
    if (specs[k].discretization == Discretization::Automatic) draftsOf[k] = startInterface(mesh, specs[k], around, told, interfaces[k]);
    else interfaces[k].notes.push_back("'" + specs[k].name + "': " + told + ", so that forces there are not unique; Automatic or Mortar avoids it");
  }
  std::vector<MortarDraft> drafts;
  for (std::size_t k = 0; k < specs.size(); ++k)
    for (auto& draft : draftsOf[k]) {
      draft.interface = k;
      drafts.push_back(std::move(draft));
    }
  barDependentNodes(around, closing, drafts, interfaces);
  std::vector<std::vector<const MortarDraft*>> ofInterface(specs.size());
  for (const auto& draft : drafts) ofInterface[draft.interface].push_back(&draft);
  for (std::size_t k = 0; k < specs.size(); ++k)
    if (!ofInterface[k].empty()) finishMortar(mesh, around, ofInterface[k], interfaces[k]);
  dropHeldNodes(around, interfaces);
  return interfaces;
}

}  // namespace Haptos
