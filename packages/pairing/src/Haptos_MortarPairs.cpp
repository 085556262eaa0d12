// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_MortarPairs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "Haptos_FacetTree.hpp"
#include "Haptos_ProjectedFace.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

constexpr double kHeldNormal = 0.05;  // what prescribed components leave of a unit normal
constexpr double kAlongAxis = 1e-6;   // one minus the component of a direction that is an axis
constexpr double kFarthestMove = 0.25;  // of the element size: elements stay regular

// From a node along its normal to the nearest face of the primary surface, either way.
class PointwiseGap {
 public:
  PointwiseGap(const ContactSurface& secondary, const ContactSurface& primary) : s_(secondary), p_(primary), tree_(primary) {}

  std::optional<double> at(int node) {
    const auto i = std::size_t(node);
    const ProjectionPlane plane(s_.coordinates[i], s_.normals[i]);
    tree_.facetsNearLine(plane.origin, plane.normal, found_);
    std::optional<double> nearest;
    for (const int facet : found_) {
      if (Vec3::dot(plane.normal, p_.facetNormals[std::size_t(facet)]) >= opposing) continue;
      const ProjectedFace face(p_, p_.faceOfFacet[std::size_t(facet)], plane);
      const auto point = face.pointAt({0, 0});
      if (!point || distanceOutside(face.face.size, *point) > besideFace) continue;
      const auto x = face.sum(faceValues(face.face.size, *point).N);
      const double gap = Vec3::dot(Vec3::subtract(x, plane.origin), plane.normal);
      if (!nearest || std::abs(gap) < std::abs(*nearest)) nearest = gap;
    }
    return nearest;
  }

 private:
  const ContactSurface &s_, &p_;
  FacetTree tree_;
  std::vector<int> found_;
};

std::vector<NodeWeight> onMesh(const ContactSurface& surface, const std::vector<std::pair<int, double>>& entries) {
  std::vector<NodeWeight> weights;
  for (const auto& [node, weight] : entries) weights.push_back({surface.nodes[std::size_t(node)], weight});
  return weights;
}

// Rows of a pair, N, T1, T2 or by global axes, along which the node is held.
std::array<char, 3> heldRows(const std::array<char, 3>& isPrescribed, const LocalFrame& frame, bool isTied) {
  if (isTied) return isPrescribed;
  std::array<char, 3> held{};
  for (std::size_t d = 0; d < 3; ++d) {
    if (!isPrescribed[d]) continue;
    held[1] |= std::abs(frame.t1[d]) > 1 - kAlongAxis;
    held[2] |= std::abs(frame.t2[d]) > 1 - kAlongAxis;
  }
  return held;
}

// D x_s = M x_p for the rows of all kept nodes: D differs from the identity only where nodes stand for neighbours.
void moveTiedNodes(const MortarDraft& draft, const std::vector<MortarRow>& rows, ContactInterface& interface) {
  const ContactSurface& s = draft.secondary;
  std::vector<Vec3::Array> moves(s.numNodes(), Vec3::Array{});
  constexpr int kSweeps = 30;  // each leaves less than half of the rest
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (const MortarRow& row : rows) {
      Vec3::Array rest = row.gap;
      double own = 0;
      for (const auto& [node, weight] : row.secondary) {
        rest = Vec3::subtract(rest, Vec3::scale(weight, moves[std::size_t(node)]));
        if (node == row.node) own = weight;
      }
      if (own > 0) moves[std::size_t(row.node)] = Vec3::add(moves[std::size_t(row.node)], Vec3::scale(1 / std::max(own, 0.5), rest));
    }
  double largest = 0;
  std::size_t tooFar = 0;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const double length = Vec3::norm(moves[i]);
    if (!(length > roundOff * s.sizes[i])) continue;
    if (length > kFarthestMove * s.sizes[i]) {
      ++tooFar;
      continue;
    }
    interface.moves.push_back({s.nodes[i], moves[i]});
    largest = std::max(largest, length);
  }
  std::ostringstream text;
  if (largest > 0) {
    text << "'" << interface.name << "': " << interface.moves.size() << " nodes were moved onto the surface they are tied to, by at most " << largest;
    interface.remarks.push_back(text.str());
  }
  if (tooFar > 0)
    interface.notes.push_back("'" + interface.name + "': " + std::to_string(tooFar) + " tied nodes of '" + s.name +
                              "' lie off the opposite surface by more than a quarter of the element size; where both bodies turn "
                              "together, the tie is stressed");
}

}  // namespace

void barHeldNodes(const ContactSurroundings& around, MortarDraft& draft, std::vector<std::string>& notes) {
  draft.isBarred.resize(draft.secondary.numNodes(), 0);
  if (around.isPrescribed.empty()) return;
  std::size_t count = 0;
  for (std::size_t i = 0; i < draft.secondary.numNodes(); ++i) {
    const auto& held = around.isPrescribed[std::size_t(draft.secondary.nodes[i])];
    Vec3::Array left = draft.secondary.normals[i];
    for (std::size_t d = 0; d < 3; ++d)
      if (held[d]) left[d] = 0;
    const bool isHeld = draft.spec->tied ? held[0] && held[1] && held[2] : Vec3::norm(left) < kHeldNormal;
    if (!isHeld || draft.isBarred[i]) continue;
    draft.isBarred[i] = 1;
    count += draft.overlap.isCovered[i];
  }
  if (count > 0)
    notes.push_back("'" + draft.spec->name + "': " + std::to_string(count) + " nodes of '" + draft.secondary.name +
                    "' are held by prescribed displacements and have no multiplier; their neighbours stand for them");
}

void addMortarPairs(const ContactSurroundings& around, const MortarDraft& draft, ContactInterface& interface) {
  const ContactSurface& s = draft.secondary;
  const auto isKept = keptNodes(s, draft.overlap, draft.isBarred);
  const auto rows = dualMortarRows(s, draft.primary, draft.overlap, isKept);
  PointwiseGap gaps(s, draft.primary);
  for (const MortarRow& row : rows) {
    const auto i = std::size_t(row.node);
    const auto pointwise = row.isShared ? std::nullopt : gaps.at(row.node);
    ContactPair pair{s.nodes[i], onMesh(s, row.secondary), onMesh(draft.primary, row.primary),
                     makeFrame(s.normals[i], draft.spec->principalDirection), 0.0, row.w};
    pair.gap = pointwise.value_or(Vec3::dot(row.gap, pair.frame.normal));
    if (!around.isPrescribed.empty())
      pair.isPinned = heldRows(around.isPrescribed[std::size_t(pair.secondaryNode)], pair.frame, draft.spec->tied);
    interface.pairs.push_back(std::move(pair));
  }
  for (std::size_t i = 0; i < s.numNodes(); ++i) interface.unpairedNodes += !isKept[i] && !draft.isBarred[i];
  if (draft.spec->tied) moveTiedNodes(draft, rows, interface);
}

}  // namespace Haptos
