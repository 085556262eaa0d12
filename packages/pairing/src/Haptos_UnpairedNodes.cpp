// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_UnpairedNodes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "Haptos_FacetTree.hpp"
#include "Haptos_ProjectedFace.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

constexpr double kEdge = 1e-3;    // of a face: so near beyond its edge a node is opposite, as displacements along edges are known to a tolerance
constexpr double kBehind = 0.25;  // of the element size: a node that starts so far behind a face comes in by another side

using Places = std::vector<Vec3::Array>;

// The primary surface where displacements have brought it.
class MovedSurface {
 public:
  MovedSurface(const ContactSurface& reference, const Vec3::Array* displacements) : x_(reference.coordinates), y_(movedBy(reference, displacements)), tree_(y_) {}

  // The row of a node with the nearest face that it has passed by more than `tolerance`; nothing where it has passed none.
  std::optional<ContactPair> pairOf(const UnpairedNodes::Node& node, const Vec3::Array& u, InitialPenetration penetration, double tolerance) {
    const ProjectionPlane plane(Vec3::add(node.place, u), node.pair.frame.normal);
    tree_.facetsNearLine(plane.origin, plane.normal, found_);
    std::sort(found_.begin(), found_.end());  // the tree's order depends on how it was built
    std::optional<Meeting> nearest;
    for (const int facet : found_) {
      auto meeting = meet(node, plane, facet, penetration);
      if (meeting && meeting->depth > tolerance && (!nearest || meeting->depth < nearest->depth)) nearest = std::move(meeting);
    }
    return nearest ? std::optional(std::move(nearest->pair)) : std::nullopt;
  }

 private:
  struct Meeting {
    ContactPair pair;
    double depth;
  };

  // \param plane at the moved node
  std::optional<Meeting> meet(const UnpairedNodes::Node& node, const ProjectionPlane& plane, int facet, InitialPenetration penetration) const {
    const auto& n = plane.normal;
    if (Vec3::dot(n, y_.facetNormals[std::size_t(facet)]) >= opposing) return {};
    const ProjectedFace face(y_, y_.faceOfFacet[std::size_t(facet)], plane);
    const auto point = face.pointAt({0, 0});
    if (!point || distanceOutside(face.face.size, *point) > kEdge) return {};
    const auto N = faceValues(face.face.size, *point).N;
    const double distance = Vec3::dot(n, Vec3::subtract(sumOf(face.face, N, x_), node.place));
    const double now = Vec3::dot(n, Vec3::subtract(sumOf(face.face, N, y_.coordinates), plane.origin));
    Meeting meeting{node.pair, 0};
    meeting.pair.gap = node.gap.value_or(distance);
    if (penetration == InitialPenetration::Ignore) meeting.pair.gap = std::max(meeting.pair.gap, 0.0);
    meeting.depth = distance - now - meeting.pair.gap;  // n . (u_s - sum N_l u_l) - gap
    if (meeting.depth > node.pair.size || distance < -kBehind * node.pair.size) return {};
    for (std::size_t i = 0; i < std::size_t(face.face.size); ++i)
      if (std::abs(N[i]) > roundOff) meeting.pair.primary.push_back({y_.nodes[std::size_t(face.face.nodes[i])], N[i]});
    return meeting;
  }

  static ContactSurface movedBy(ContactSurface surface, const Vec3::Array* displacements) {
    for (auto& x : surface.coordinates) x = Vec3::add(x, *displacements++);
    return surface;
  }
  static Vec3::Array sumOf(const SurfaceFace& face, const std::array<double, 9>& N, const Places& places) {
    Vec3::Array sum{};
    for (std::size_t i = 0; i < std::size_t(face.size); ++i) sum = Vec3::add(sum, Vec3::scale(N[i], places[std::size_t(face.nodes[i])]));
    return sum;
  }

  const Places& x_;
  ContactSurface y_;
  FacetTree tree_;
  std::vector<int> found_;
};

}  // namespace

UnpairedNodes::UnpairedNodes(std::vector<Node> nodes, const ContactSurface& primary, InitialPenetration penetration)
    : nodes_(std::move(nodes)), primary_(std::make_unique<ContactSurface>(primary)), penetration_(penetration) {
  std::sort(nodes_.begin(), nodes_.end(), [](const Node& a, const Node& b) { return a.pair.secondaryNode < b.pair.secondaryNode; });
}

UnpairedNodes::~UnpairedNodes() = default;

void UnpairedNodes::drop(const std::function<bool(const ContactPair&)>& isToDrop) {
  nodes_.erase(std::remove_if(nodes_.begin(), nodes_.end(), [&](const Node& node) { return isToDrop(node.pair); }), nodes_.end());
}

void UnpairedNodes::renumber(const std::vector<std::int64_t>& numbers) {
  for (auto& node : nodes_) {
    node.pair.secondaryNode = numbers[std::size_t(node.pair.secondaryNode)];
    for (auto& item : node.pair.secondary) item.node = numbers[std::size_t(item.node)];
  }
  for (auto& node : primary_->nodes) node = numbers[std::size_t(node)];
}

std::vector<std::int64_t> UnpairedNodes::meshNodes() const {
  std::vector<std::int64_t> all;
  for (const Node& node : nodes_) all.push_back(node.pair.secondaryNode);
  all.insert(all.end(), primary_->nodes.begin(), primary_->nodes.end());
  return all;
}

std::vector<ContactPair> UnpairedNodes::pairsUnder(const Places& displacements, double tolerance) const {
  std::vector<ContactPair> pairs;
  MovedSurface primary(*primary_, displacements.data() + nodes_.size());
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    auto pair = primary.pairOf(nodes_[i], displacements[i], penetration_, tolerance);
    // a node on a crease is here once for each of its normals
    if (pair && (pairs.empty() || pairs.back().secondaryNode != pair->secondaryNode)) pairs.push_back(std::move(*pair));
  }
  return pairs;
}

}  // namespace Haptos
