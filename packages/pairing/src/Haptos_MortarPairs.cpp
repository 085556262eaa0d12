// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_MortarPairs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "Haptos_ProjectedFace.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

constexpr double kAlongAxis = 1e-6;   // one minus the component of a direction that is an axis
constexpr double kFarthestMove = 0.25;  // of the element size: elements stay regular

// Rows of a pair, T1, T2 or by global axes, along which nodes of both sides are held, as at planes of symmetry.
std::array<char, 3> heldRows(const ContactSurroundings& around, const ContactPair& pair, bool isTied) {
  std::array<char, 3> held = around.isPrescribed[std::size_t(pair.secondaryNode)], rows{};
  for (std::size_t d = 0; d < 3; ++d)
    held[d] = held[d] && std::any_of(pair.primary.begin(), pair.primary.end(),
                                     [&](const NodeWeight& item) { return around.isPrescribed[std::size_t(item.node)][d] != 0; });
  if (isTied) return held;
  for (std::size_t d = 0; d < 3; ++d) {
    if (!held[d]) continue;
    rows[1] |= std::abs(pair.frame.t1[d]) > 1 - kAlongAxis;
    rows[2] |= std::abs(pair.frame.t2[d]) > 1 - kAlongAxis;
  }
  return rows;
}

// D (x_s + C^T m) = M x_p:  D C^T is the identity but for nodes that stand for neighbours, which corrections see to.
std::vector<Vec3::Array> movesOntoPrimary(const ContactSurface& s, const std::vector<MortarRow>& rows) {
  std::vector<Vec3::Array> moves(s.numNodes(), Vec3::Array{});
  // Nodes that stand for neighbours share their error out; each round leaves a part of it, a small one.
  constexpr int kMostCorrections = 1000;
  double rest = 1;
  for (int correction = 0; correction < kMostCorrections && rest > roundOff / 10; ++correction) {
    std::vector<Vec3::Array> rests;
    rest = 0;
    for (const MortarRow& row : rows) {
      rests.push_back(row.gap);
      for (const auto& [node, weight] : row.secondary)
        rests.back() = Vec3::subtract(rests.back(), Vec3::scale(weight, moves[std::size_t(node)]));
      rest = std::max(rest, Vec3::norm(rests.back()) / s.sizes[std::size_t(row.node)]);
    }
    for (std::size_t r = 0; r < rows.size(); ++r)
      for (const auto& [node, share] : rows[r].spread)
        moves[std::size_t(node)] = Vec3::add(moves[std::size_t(node)], Vec3::scale(share, rests[r]));
  }
  return moves;
}

void moveTiedNodes(const MortarDraft& draft, const std::vector<MortarRow>& rows, ContactInterface& interface) {
  const ContactSurface& s = draft.secondary;
  const auto moves = movesOntoPrimary(s, rows);
  double largest = 0;
  std::size_t tooFar = 0;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const double length = Vec3::norm(moves[i]);
    if (!(length > roundOff * s.sizes[i])) continue;
    // So far off it is no faceting any more: moving it would change the body that the user drew.
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

std::optional<double> gapOfRow(const MortarRow& row, const std::function<std::optional<double>(int)>& gapAt) {
  double sum = 0, least = 0;
  for (const auto& [node, weight] : row.secondary) {
    const auto gap = gapAt(node);
    if (!gap) return gapAt(row.node);
    sum += weight * *gap;
    least = std::min(least, *gap);
  }
  return std::max(sum, least);
}

bool hasMiddles(const ContactSurface& surface) {
  return std::any_of(surface.faces.begin(), surface.faces.end(), [](const SurfaceFace& face) { return !isLinear(face.size); });
}

std::vector<NodeWeight> onMesh(const ContactSurface& surface, const std::vector<std::pair<int, double>>& entries) {
  std::vector<NodeWeight> weights;
  for (const auto& [node, weight] : entries) weights.push_back({surface.nodes[std::size_t(node)], weight});
  return weights;
}

std::vector<MortarRow> rowsOfWholeSurface(const ContactSurface& surface, bool linearOnly) {
  const auto whole = wholeSurface(surface);
  return dualMortarRows(surface, surface, whole, chooseMultipliers(surface, whole, std::vector<Bar>(surface.numNodes(), Bar::None), linearOnly));
}

void addMortarPairs(const ContactSurroundings& around, const MortarDraft& draft, PointwiseGap& gaps, ContactInterface& interface) {
  const ContactSurface& s = draft.secondary;
  const auto multipliers = chooseMultipliers(s, draft.overlap, draft.bars, draft.spec->multiplierSpace == MultiplierSpace::Linear);
  const auto rows = dualMortarRows(s, *draft.primary, draft.overlap, multipliers);
  const auto& given = draft.spec->gapAt;
  const bool isOfFacets = !given && draft.spec->smoothing == PrimarySmoothing::None;
  const auto gapAt = [&](int node) { return given ? std::optional(given(s.nodes[std::size_t(node)])) : gaps.at(s, node); };
  for (const MortarRow& row : rows) {
    const auto i = std::size_t(row.node);
    const auto pointwise = row.isShared && isOfFacets ? std::nullopt : gapOfRow(row, gapAt);
    ContactPair pair{s.nodes[i], onMesh(s, row.secondary), onMesh(*draft.primary, row.primary),
                     draft.spec->frameAt(s.nodes[i], s.normals[i]), 0.0, row.w};
    pair.size = s.sizes[i];
    pair.gap = pointwise.value_or(Vec3::dot(row.gap, pair.frame.normal));
    if (!around.isPrescribed.empty()) pair.isPinned = heldRows(around, pair, draft.spec->tied);
    interface.pairs.push_back(std::move(pair));
  }
  if (draft.spec->tied) moveTiedNodes(draft, rows, interface);
}

}  // namespace Haptos
