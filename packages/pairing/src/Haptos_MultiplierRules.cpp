// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_MultiplierRules.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <tuple>
#include <unordered_map>

#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

constexpr double kHeldNormal = 0.05;  // what prescribed components leave of a unit normal
constexpr double kSameNormal = 0.9;   // cosine: normals that are nearer say the same twice

using Drafts = std::vector<MortarDraft>;

// Bars the nodes that `isHit` names and says so of those that would have carried a multiplier.
void bar(MortarDraft& draft, Bar how, const std::function<bool(std::size_t)>& isHit, const std::string& why,
         std::vector<std::string>& told, const std::string& name) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < draft.secondary.numNodes(); ++i) {
    if (draft.bars[i] >= how || !isHit(i)) continue;
    count += draft.overlap.isCovered[i] && draft.bars[i] == Bar::None;
    draft.bars[i] = how;
  }
  if (count > 0)
    told.push_back("'" + name + "': " + std::to_string(count) + " nodes of '" + draft.secondary.name + "' " + why +
                   " and have no multiplier there; their neighbours stand for them");
}

bool contains(const ContactSurface& surface, std::int64_t node) {
  return std::binary_search(surface.nodes.begin(), surface.nodes.end(), node);
}

// A row that only moves other nodes would repeat what supports say.
void barHeldNodes(const ContactSurroundings& around, MortarDraft& draft, ContactInterface& interface) {
  if (around.isPrescribed.empty()) return;
  const auto isHeld = [&](std::size_t i) {
    return isHeldFor(*draft.spec, around.isPrescribed[std::size_t(draft.secondary.nodes[i])], draft.secondary.normals[i]);
  };
  bar(draft, Bar::Held, isHeld, "are held by prescribed displacements", interface.remarks, interface.name);
}

// A claim of an interface on a node.
struct Claim {
  std::size_t interface;
  int draft;  // -1: node to node or a rigid plane
  bool isMortar, isTied, isFrictionless;
  double area;
  Vec3::Array normal;

  // Ties first, as they leave nothing open; then pairs of single nodes, which cannot stand back; then who has more area there.
  bool goesBefore(const Claim& other) const {
    if (isTied != other.isTied) return isTied;
    if (isMortar != other.isMortar) return other.isMortar;
    return std::abs(area - other.area) > 1e-9 * area ? area > other.area : std::tie(interface, draft) < std::tie(other.interface, other.draft);
  }
};

std::map<std::int64_t, std::vector<Claim>> collectClaims(const Drafts& drafts, const std::vector<ContactInterface>& interfaces) {
  std::map<std::int64_t, std::vector<Claim>> claims;
  for (std::size_t k = 0; k < interfaces.size(); ++k)
    for (const auto& pair : interfaces[k].pairs)
      claims[pair.secondaryNode].push_back({k, -1, false, interfaces[k].tied, false, pair.area, pair.frame.normal});
  for (std::size_t k = 0; k < drafts.size(); ++k) {
    const MortarDraft& draft = drafts[k];
    std::vector<double> areas(draft.secondary.numNodes(), 0.0);
    for (std::size_t f = 0; f < draft.secondary.faces.size(); ++f)
      for (int i = 0; i < draft.secondary.faces[f].size; ++i)
        areas[std::size_t(draft.secondary.faces[f].nodes[std::size_t(i)])] += draft.overlap.faces[f].area;
    for (std::size_t i = 0; i < areas.size(); ++i)
      if (draft.overlap.isCovered[i] && draft.bars[i] == Bar::None)
        claims[draft.secondary.nodes[i]].push_back(
            {draft.interface, int(k), true, draft.spec->tied, draft.spec->isFrictionless, areas[i], draft.secondary.normals[i]});
  }
  return claims;
}

void barNodesOfOthers(Drafts& drafts, std::vector<ContactInterface>& interfaces) {
  struct Lost {
    std::vector<std::int64_t> toPatch, toOther;  // of the same interface or not
  };
  std::vector<Lost> lost(drafts.size());
  for (auto& [node, claims] : collectClaims(drafts, interfaces)) {
    if (claims.size() < 2) continue;
    const Claim first = *std::min_element(claims.begin(), claims.end(), [](const Claim& a, const Claim& b) { return a.goesBefore(b); });
    for (const Claim& claim : claims) {
      // At an edge between two frictionless contacts both normals may hold a node: they are independent.
      const bool isApart = first.isFrictionless && claim.isFrictionless && std::abs(Vec3::dot(first.normal, claim.normal)) < kSameNormal;
      if (!claim.isMortar || claim.draft == first.draft || isApart) continue;
      Lost& own = lost[std::size_t(claim.draft)];
      (claim.interface == first.interface ? own.toPatch : own.toOther).push_back(node);
    }
  }
  for (std::size_t k = 0; k < drafts.size(); ++k) {
    ContactInterface& interface = interfaces[drafts[k].interface];
    const auto barLost = [&](const std::vector<std::int64_t>& nodes, const std::string& why) {
      const auto isLost = [&](std::size_t i) { return std::binary_search(nodes.begin(), nodes.end(), drafts[k].secondary.nodes[i]); };
      if (!nodes.empty()) bar(drafts[k], Bar::Taken, isLost, why, interface.remarks, interface.name);
    };
    barLost(lost[k].toOther, "are secondary in another contact too");
    barLost(lost[k].toPatch, "lie on a crease, of which the other side takes them,");
  }
}

// [drafts x drafts] whether secondary nodes of the first are primary in the second, over any number of steps
// Warshall: a step from a to b by way of c, for every c.
std::vector<std::vector<char>> reachable(const Drafts& drafts) {
  const std::size_t n = drafts.size();
  std::vector<std::vector<char>> reach(n, std::vector<char>(n, 0));
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b)
      if (a == b || drafts[a].interface != drafts[b].interface)
        reach[a][b] = std::any_of(drafts[a].secondary.nodes.begin(), drafts[a].secondary.nodes.end(),
                                  [&](std::int64_t node) { return contains(*drafts[b].primary, node); });
  for (std::size_t c = 0; c < n; ++c)
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < n && reach[a][c]; ++b) reach[a][b] |= reach[c][b];
  return reach;
}

void barNodesInCircles(Drafts& drafts, std::vector<ContactInterface>& interfaces) {
  const auto reach = reachable(drafts);
  for (std::size_t b = 0; b < drafts.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) {
      // Each of the two would write the other's nodes as means of its own: rows in a circle may depend on each other.
      if (!reach[a][b] || !reach[b][a] || drafts[a].interface == drafts[b].interface) continue;
      ContactInterface& own = interfaces[drafts[b].interface];
      const auto isPrimary = [&](std::size_t i) { return contains(*drafts[a].primary, drafts[b].secondary.nodes[i]); };
      bar(drafts[b], Bar::Taken, isPrimary, "are primary in '" + interfaces[drafts[a].interface].name + "', whose secondary nodes are primary here,", own.notes,
          own.name);
    }
}

// Nodes joined by pairs, in all directions or along a normal.
class Links {
 public:
  // \return false: the nodes are joined already by what holds where this one does
  bool join(const ContactPair& pair, bool isFrictionless) {
    const auto a = pair.secondaryNode, b = pair.primary[0].node;
    const Link link{b, isFrictionless ? std::optional(pair.frame.normal) : std::nullopt};
    const bool isNew = !isReached(a, link);
    linksOf_[a].push_back(link);
    linksOf_[b].push_back({a, link.normal});
    return isNew;
  }

 private:
  struct Link {
    std::int64_t other;
    std::optional<Vec3::Array> normal;  // none: all directions
  };

  bool isReached(std::int64_t from, const Link& target) const {
    std::vector<std::int64_t> reached{from};
    for (std::size_t i = 0; i < reached.size(); ++i) {
      const auto found = linksOf_.find(reached[i]);
      if (found == linksOf_.end()) continue;
      for (const Link& link : found->second) {
        if (link.normal && target.normal && std::abs(Vec3::dot(*link.normal, *target.normal)) < kSameNormal) continue;
        if (link.other == target.other) return true;
        if (std::find(reached.begin(), reached.end(), link.other) == reached.end()) reached.push_back(link.other);
      }
    }
    return false;
  }

  std::unordered_map<std::int64_t, std::vector<Link>> linksOf_;
};

}  // namespace

bool isNormalHeld(const std::array<char, 3>& held, const Vec3::Array& normal) {
  Vec3::Array left = normal;
  for (std::size_t d = 0; d < 3; ++d)
    if (held[d]) left[d] = 0;
  return Vec3::norm(left) < kHeldNormal;
}

bool isHeldFor(const ContactSpec& spec, const std::array<char, 3>& held, const Vec3::Array& normal) {
  return spec.tied ? held[0] && held[1] && held[2] : isNormalHeld(held, normal);
}

std::vector<std::vector<std::int64_t>> nodesThatCloseCircles(const std::vector<ContactSpec>& specs, const std::vector<ContactInterface>& interfaces) {
  std::vector<std::vector<std::int64_t>> closing(specs.size());
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < specs.size(); ++k)
    if (!interfaces[k].isMortar && !specs[k].rigidPlane) order.push_back(k);
  if (order.size() < 2) return closing;
  const auto rank = [&](std::size_t k) { return specs[k].tied ? 0 : specs[k].isFrictionless ? 2 : 1; };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  Links links;
  for (const std::size_t k : order) {
    for (const auto& pair : interfaces[k].pairs)
      if (!links.join(pair, specs[k].isFrictionless)) closing[k].insert(closing[k].end(), {pair.secondaryNode, pair.primary[0].node});
    std::sort(closing[k].begin(), closing[k].end());
  }
  return closing;
}

void barDependentNodes(const ContactSurroundings& around, const std::vector<std::vector<std::int64_t>>& closing, Drafts& drafts,
                       std::vector<ContactInterface>& interfaces) {
  for (MortarDraft& draft : drafts) {
    ContactInterface& interface = interfaces[draft.interface];
    const auto& circles = closing[draft.interface];
    const auto closes = [&](std::size_t i) { return std::binary_search(circles.begin(), circles.end(), draft.secondary.nodes[i]); };
    bar(draft, Bar::Taken, closes, "close circles with pairs of other contacts", interface.remarks, interface.name);
    const auto isShared = [&](std::size_t i) { return contains(*draft.primary, draft.secondary.nodes[i]); };
    bar(draft, Bar::Taken, isShared, "are on both sides", interface.remarks, interface.name);
    barHeldNodes(around, draft, interface);
  }
  barNodesOfOthers(drafts, interfaces);
  barNodesInCircles(drafts, interfaces);
}

}  // namespace Haptos
