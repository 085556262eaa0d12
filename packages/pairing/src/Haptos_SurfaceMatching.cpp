// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SurfaceMatching.hpp"

#include <Teuchos_TestForException.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "Haptos_ApproachDirections.hpp"
#include "Haptos_ContactPairs.hpp"
#include "Haptos_FacetTree.hpp"
#include "Haptos_LineGeometry.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

constexpr double opposingCosine = -0.2;  // normals that enclose less than 101 degrees do not face each other
constexpr double grazingCosine = -0.05;  // a face so steep against a line is not hit by it
constexpr double edgeMargin = 0.1;  // of the element size: a node so near beyond an edge is opposite the face
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double degrees = 57.29577951308232;

// The largest tangential mismatch so far, of a node that lies opposite a face but not opposite a node.
struct Mismatch {
  std::size_t count = 0;
  int node = -1;
  double distance = -1.0;
  double size = 1.0;

  void add(int candidate, double candidateDistance, double candidateSize) {
    ++count;
    if (candidateDistance <= distance) return;
    node = candidate;
    distance = candidateDistance;
    size = candidateSize;
  }
};

class Matcher {
 public:
  Matcher(const SurfaceCouple& couple, double tolerance)
      : couple_(couple),
        s_(couple.secondary),
        p_(couple.primary),
        tolerance_(tolerance),
        primaryTree_(couple.primary),
        approach_(approachDirections(couple.secondary, couple.primary)),
        owner_(couple.primary.numNodes(), -1) {
    match_.partner.assign(s_.numNodes(), -1);
    match_.gap.assign(s_.numNodes(), 0.0);
  }

  // Secondary nodes first, as every one of them must be told; then what their partners leave of the primary surface.
  SurfaceMatch run() {
    pairSecondaryNodes();
    checkUnpairedPrimaryNodes();
    countMismatchedFaces();
    return std::move(match_);
  }

 private:
  struct Candidate {
    int node;
    double gap;
    double mismatch;
  };

  // What the lines through one secondary node met.
  struct Search {
    std::vector<Candidate> candidates;  // opposite nodes on opposing faces
    bool facesPrimary = false;          // a line passes through an opposing face
    double nearest = infinity;          // smallest tangential distance to a node of an opposing face
    double wrongCosine = 0.0;           // n_s . n_face of the nearest face that does not oppose
    double wrongDistance = infinity;
    bool wrongAtNode = false;  // and a primary node lies at that distance, opposite ours
  };

  void pairSecondaryNodes();
  Search searchFrom(int node);
  void searchAlong(const Line& line, int node, Search& found);
  void visitOpposing(int facet, const Line& line, int node, Search& found) const;
  void visitOther(int facet, const Line& line, int node, Search& found) const;
  double tangentialDistance(int node, int primary) const;
  double allowance(int node, double gap) const;
  double exactMismatch(int node) const { return tolerance_ * s_.sizes[std::size_t(node)]; }
  bool hasExact(int node, const std::vector<Candidate>& candidates) const;
  void assign(int node, std::vector<Candidate> candidates);
  void checkUnpairedPrimaryNodes();
  bool isOppositeSecondary(int primary, const FacetTree& tree, double& nearest, int& nearestNode);
  double reachOfFacet(int facet) const;
  void countMismatchedFaces();
  [[noreturn]] void refuseMismatch(const Mismatch& worst, const ContactSurface& own,
                                   const ContactSurface& other) const;
  [[noreturn]] void refuseCompetition(const ContactSurface& surface, int a, int b) const;
  [[noreturn]] void refuseOrientation(int node, const Search& found) const;

  const SurfaceCouple& couple_;
  const ContactSurface& s_;
  const ContactSurface& p_;
  double tolerance_;
  FacetTree primaryTree_;
  std::vector<Vec3::Array> approach_;
  std::vector<int> owner_;  // [primary nodes] its secondary node, or -1
  std::vector<int> facets_;
  SurfaceMatch match_;
};

// Every secondary node has a partner, or lies opposite no face of the primary surface, which is no contact there.  What else there
// can be is refused at the end, by its worst case: nodes opposite faces but not opposite nodes; surfaces that look the same way.
void Matcher::pairSecondaryNodes() {
  Mismatch worst;
  std::size_t paired = 0;
  int wrongNode = -1;
  Search wrong;
  for (int i = 0; i < int(s_.numNodes()); ++i) {
    Search found = searchFrom(i);
    if (!found.candidates.empty()) {
      assign(i, std::move(found.candidates));
      ++paired;
      continue;
    }
    if (found.facesPrimary) {
      worst.add(i, found.nearest, s_.sizes[std::size_t(i)]);
      continue;
    }
    if (found.wrongAtNode && found.wrongDistance <= s_.sizes[std::size_t(i)]) refuseOrientation(i, found);
    if (found.wrongDistance < wrong.wrongDistance) {
      wrongNode = i;
      wrong = std::move(found);
    }
  }
  if (worst.count > 0) refuseMismatch(worst, s_, p_);
  if (paired == 0 && wrongNode >= 0) refuseOrientation(wrongNode, wrong);
}

// Along the node's own normal first; directions of approach count where that found nothing exact.
Matcher::Search Matcher::searchFrom(int node) {
  Search found;
  const auto& x = s_.coordinates[std::size_t(node)];
  searchAlong({x, s_.normals[std::size_t(node)]}, node, found);
  for (const auto& direction : approach_) {
    if (hasExact(node, found.candidates)) break;
    if (Vec3::dot(s_.normals[std::size_t(node)], direction) < 1.0 - 1e-12)
      searchAlong({x, direction}, node, found);
  }
  return found;
}

// All facets near the line, on either side of the node: bodies may overlap or stand apart at the start.
void Matcher::searchAlong(const Line& line, int node, Search& found) {
  primaryTree_.facetsNearLine(line.origin, line.direction, facets_);
  const auto& n = s_.normals[std::size_t(node)];
  for (const int facet : facets_) {
    if (Vec3::dot(n, p_.facetNormals[std::size_t(facet)]) < opposingCosine)
      visitOpposing(facet, line, node, found);
    else
      visitOther(facet, line, node, found);
  }
}

// The nodes of a facet that faces ours are candidates as far as they lie opposite our node, sideways within the allowance.
void Matcher::visitOpposing(int facet, const Line& line, int node, Search& found) const {
  const auto i = std::size_t(node);
  if (Vec3::dot(line.direction, p_.facetNormals[std::size_t(facet)]) < grazingCosine &&
      passesThrough(p_, facet, line, edgeMargin * s_.sizes[i]))
    found.facesPrimary = true;
  for (const int primary : p_.facets[std::size_t(facet)]) {
    if (primary < 0) continue;
    const double mismatch = tangentialDistance(node, primary);
    found.nearest = std::min(found.nearest, mismatch);
    const auto offset = Vec3::subtract(p_.coordinates[std::size_t(primary)], s_.coordinates[i]);
    const double gap = Vec3::dot(offset, s_.normals[i]);
    const auto isSame = [&](const Candidate& c) { return c.node == primary; };
    if (mismatch <= allowance(node, gap) &&
        std::none_of(found.candidates.begin(), found.candidates.end(), isSame))
      found.candidates.push_back({primary, gap, mismatch});
  }
}

// A facet that looks the same way: the nearest of these tells, should nothing be found, how wrong the side set is.
void Matcher::visitOther(int facet, const Line& line, int node, Search& found) const {
  const auto i = std::size_t(node);
  const double cosine = Vec3::dot(s_.normals[i], p_.facetNormals[std::size_t(facet)]);
  for (const int primary : p_.facets[std::size_t(facet)]) {
    if (primary < 0) continue;
    const auto offset = Vec3::subtract(p_.coordinates[std::size_t(primary)], s_.coordinates[i]);
    const double gap = Vec3::dot(offset, s_.normals[i]);
    if (std::abs(gap) >= found.wrongDistance || tangentialDistance(node, primary) > allowance(node, gap))
      continue;
    found.wrongDistance = std::abs(gap);
    found.wrongCosine = cosine;
    found.wrongAtNode = true;
  }
  if (cosine < 0.1 || !passesThrough(p_, facet, line, edgeMargin * s_.sizes[i])) return;
  const double distance = std::abs(distanceToFacet(p_, facet, line));
  if (distance >= found.wrongDistance) return;
  found.wrongDistance = distance;
  found.wrongCosine = cosine;
  found.wrongAtNode = false;
}

// The least distance of the two nodes across any direction along which they may have been meshed alike: the normal of either, a
// direction of approach.
double Matcher::tangentialDistance(int node, int primary) const {
  const auto i = std::size_t(node), j = std::size_t(primary);
  const auto offset = Vec3::subtract(p_.coordinates[j], s_.coordinates[i]);
  double distance = Vec3::distanceFromLine(offset, s_.normals[i]);
  for (const auto& direction : approach_)
    distance = std::min(distance, Vec3::distanceFromLine(offset, direction));
  const bool smooth = s_.turns[i] < smoothTurn && p_.turns[j] < smoothTurn;
  if (smooth && Vec3::dot(s_.normals[i], p_.normals[j]) < -approachCosine)
    distance = std::min(distance, Vec3::distanceFromLine(offset, p_.normals[j]));
  return distance;
}

// Of round-off and of a gap between curved surfaces, gap times the turn of the normal, since there nodes drift sideways.
double Matcher::allowance(int node, double gap) const {
  const auto i = std::size_t(node);
  return exactMismatch(node) + std::min(std::abs(gap) * s_.turns[i], 0.25 * s_.sizes[i]);
}

// Whether a node lies straight opposite, up to the tolerance that the user gives.
bool Matcher::hasExact(int node, const std::vector<Candidate>& candidates) const {
  return std::any_of(candidates.begin(), candidates.end(),
                     [&](const Candidate& c) { return c.mismatch <= exactMismatch(node); });
}

// Takes the nearest free candidate, of the exact ones if there are any.  Nodes at one place (two bodies side
// by side) may each have their own partner, also at one place; another layer of the surface is not a way out.
void Matcher::assign(int node, std::vector<Candidate> candidates) {
  const auto drop = [&](auto&& condition) {
    candidates.erase(std::remove_if(candidates.begin(), candidates.end(), condition), candidates.end());
  };
  if (hasExact(node, candidates)) drop([&](const Candidate& c) { return c.mismatch > exactMismatch(node); });
  const auto nearer = [](const Candidate& a, const Candidate& b) {
    return std::abs(a.gap) < std::abs(b.gap);
  };
  const double least = std::abs(std::min_element(candidates.begin(), candidates.end(), nearer)->gap);
  drop([&](const Candidate& c) { return std::abs(c.gap) > least + exactMismatch(node); });
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.mismatch != b.mismatch ? a.mismatch < b.mismatch : a.node < b.node;
  });
  for (const Candidate& candidate : candidates) {
    int& owner = owner_[std::size_t(candidate.node)];
    if (owner >= 0) continue;
    owner = node;
    match_.partner[std::size_t(node)] = candidate.node;
    match_.gap[std::size_t(node)] = candidate.gap;
    return;
  }
  refuseCompetition(s_, owner_[std::size_t(candidates.front().node)], node);
}

// A finer primary mesh whose nodes between those of the secondary one stay free would be contact on a part of
// the surface only; free primary nodes are right only where no secondary face lies opposite.
void Matcher::checkUnpairedPrimaryNodes() {
  if (std::none_of(owner_.begin(), owner_.end(), [](int owner) { return owner < 0; })) return;
  const FacetTree tree(s_);
  Mismatch worst;
  for (int j = 0; j < int(p_.numNodes()); ++j) {
    if (owner_[std::size_t(j)] >= 0) continue;
    double nearest = infinity;
    int nearestNode = -1;
    if (!isOppositeSecondary(j, tree, nearest, nearestNode)) continue;
    const double size = p_.sizes[std::size_t(j)];
    if (nearest <= tolerance_ * size && match_.partner[std::size_t(nearestNode)] >= 0)
      refuseCompetition(p_, match_.partner[std::size_t(nearestNode)], j);
    worst.add(j, nearest, size);
  }
  if (worst.count > 0) refuseMismatch(worst, p_, s_);
}

// Whether the line through a primary node meets a secondary face that faces it; the nearest node of such a face, too.
bool Matcher::isOppositeSecondary(int primary, const FacetTree& tree, double& nearest, int& nearestNode) {
  const auto j = std::size_t(primary);
  const Line line{p_.coordinates[j], p_.normals[j]};
  tree.facetsNearLine(line.origin, line.direction, facets_);
  bool opposite = false;
  for (const int facet : facets_) {
    if (Vec3::dot(line.direction, s_.facetNormals[std::size_t(facet)]) >= opposingCosine) continue;
    if (!passesThrough(s_, facet, line, edgeMargin * p_.sizes[j])) continue;
    // another layer of the primary surface, behind the one in contact, is not opposite
    if (std::abs(distanceToFacet(s_, facet, line)) > reachOfFacet(facet)) continue;
    opposite = true;
    for (const int node : s_.facets[std::size_t(facet)]) {
      if (node < 0) continue;
      const auto offset = Vec3::subtract(s_.coordinates[std::size_t(node)], line.origin);
      const double distance = Vec3::distanceFromLine(offset, line.direction);
      if (distance >= nearest) continue;
      nearest = distance;
      nearestNode = node;
    }
  }
  return opposite;
}

// How far away the primary surface can be that a secondary face is in contact with.
double Matcher::reachOfFacet(int facet) const {
  double reach = -1.0, size = 0.0;
  for (const int node : s_.facets[std::size_t(facet)]) {
    if (node < 0) continue;
    size = std::max(size, s_.sizes[std::size_t(node)]);
    if (match_.partner[std::size_t(node)] >= 0)
      reach = std::max(reach, std::abs(match_.gap[std::size_t(node)]));
  }
  return reach < 0.0 ? infinity : reach + size;
}

// Secondary faces whose corners all have partners that are no primary face together: other diagonals.
void Matcher::countMismatchedFaces() {
  const auto key = [](std::array<int, 4> facet) {
    std::sort(facet.begin(), facet.end());
    return facet;
  };
  std::set<std::array<int, 4>> primaryFaces;
  for (const auto& facet : p_.facets) primaryFaces.insert(key(facet));
  for (const auto& facet : s_.facets) {
    std::array<int, 4> image = {-1, -1, -1, -1};
    bool complete = true;
    for (std::size_t i = 0; i < 4; ++i) {
      if (facet[i] < 0) continue;
      image[i] = match_.partner[std::size_t(facet[i])];
      complete = complete && image[i] >= 0;
    }
    if (complete && primaryFaces.count(key(image)) == 0) ++match_.mismatched;
  }
}

// Counts, the worst node, how far it is off in element sizes: whether a coarser tolerance or another mesh is wanted.
void Matcher::refuseMismatch(const Mismatch& worst, const ContactSurface& own,
                             const ContactSurface& other) const {
  std::ostringstream text;
  text << "Contact '"
       << couple_.interface << "': the meshes do not match, so they cannot be paired node to node: "
       << worst.count << " of " << own.numNodes() << " nodes of side set '" << own.name
       << "' lie opposite a face of side set '" << other.name
       << "' but not opposite a node of it that is free. Largest tangential mismatch: " << worst.distance
       << ", that is " << worst.distance / worst.size << " of the element size " << worst.size
       << " (allowed: " << tolerance_ << "), at "
       << describeNode(couple_.mesh, own.nodes[std::size_t(worst.node)]) << " of '" << own.name
       << "'. Mesh both surfaces alike, or take Mortar.";
  throw NonMatchingError(text.str());
}

// Two nodes at one place, or one node too few opposite.
void Matcher::refuseCompetition(const ContactSurface& surface, int a, int b) const {
  const ContactSurface& other = &surface == &s_ ? p_ : s_;
  std::ostringstream text;
  text << "Contact '"
       << couple_.interface << "': the meshes do not match, so they cannot be paired node to node: "
       << describeNode(couple_.mesh, surface.nodes[std::size_t(a)]) << " and "
       << describeNode(couple_.mesh, surface.nodes[std::size_t(b)]) << " of side set '" << surface.name
       << "' lie opposite one and the same node of side set '" << other.name
       << "', which can serve only one of them. Merge coincident nodes, mesh both surfaces alike, or take Mortar.";
  throw NonMatchingError(text.str());
}

void Matcher::refuseOrientation(int node, const Search& found) const {
  const double cosine = std::max(-1.0, std::min(1.0, found.wrongCosine));
  std::ostringstream text;
  text << "Contact '" << couple_.interface << "': side sets '" << s_.name << "' and '" << p_.name
       << "' do not face each other: at " << describeNode(couple_.mesh, s_.nodes[std::size_t(node)])
       << " their outward normals enclose " << std::acos(cosine) * degrees
       << " degrees (right would be about 180). Is one of them the wrong side set?";
  throw InputError(text.str());
}

}  // namespace

SurfaceMatch matchSurfaces(const SurfaceCouple& couple, double tolerance) {
  return Matcher(couple, tolerance).run();
}

}  // namespace Haptos
