// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_PairDraft.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace Haptos {

// Nodes on both sides cancel as far as their weights do: the jump of such a node is no jump.
void findNodes(const NodeDirectory& directory, PairDraft& draft) {
  for (const auto* side : {&draft.placed.pair.secondary, &draft.placed.pair.primary})
    for (const auto& [node, weight] : *side) {
      const int record = directory.find(node);
      const double signedWeight = side == &draft.placed.pair.secondary ? weight : -weight;
      const auto known = std::find_if(draft.nodes.begin(), draft.nodes.end(), [&](const auto& n) { return n.first == record; });
      if (known == draft.nodes.end()) draft.nodes.emplace_back(record, signedWeight);
      else known->second += signedWeight;
    }
}

namespace {

// What supports leave of a pair's slip: which components are free, and the slip that they prescribe along t1 and t2.
struct SlipLeft {
  std::array<bool, 3> isFree{};
  std::array<double, 2> prescribed{};
};

SlipLeft slipLeft(const NodeDirectory& directory, const PairDraft& draft) {
  const LocalFrame& frame = draft.placed.pair.frame;
  SlipLeft left;
  for (const auto& [index, weight] : draft.nodes) {
    const NodeRecord& record = directory.records()[std::size_t(index)];
    for (std::size_t d = 0; d < 3; ++d) {
      if (!record.isPrescribed[d]) left.isFree[d] = left.isFree[d] || weight != 0;
      else left.prescribed[0] += weight * frame.t1[d] * record.prescribed[d], left.prescribed[1] += weight * frame.t2[d] * record.prescribed[d];
    }
  }
  return left;
}

// The direction v = (t1, t2) that is left, if it is one: in plane strain, or where a support drives the other.
std::optional<std::array<double, 2>> onlyDirection(const LocalFrame& frame, const SlipLeft& left) {
  constexpr double kRankOne = 1e-14;
  double a = 0, b = 0, c = 0;  // sum over free components of (t1, t2)^T (t1, t2)
  for (std::size_t d = 0; d < 3; ++d)
    if (left.isFree[d]) a += frame.t1[d] * frame.t1[d], b += frame.t1[d] * frame.t2[d], c += frame.t2[d] * frame.t2[d];
  if (a * c - b * b > kRankOne * (a + c) * (a + c)) return {};
  const double length = a > c ? std::hypot(a, b) : std::hypot(b, c);
  if (!(length > 0)) return {};
  if (a > c) return std::array{a / length, b / length};
  return std::array{b / length, c / length};
}

void turn(const FrameTurn& by, ContactPair& pair) {
  const LocalFrame frame = pair.frame;
  for (std::size_t d = 0; d < 3; ++d) {
    pair.frame.t1[d] = by.c * frame.t1[d] + by.s * frame.t2[d];
    pair.frame.t2[d] = by.c * frame.t2[d] - by.s * frame.t1[d];
  }
  pair.turn = by;
}

// Where supports leave one direction e to slip and it is no axis of friction, both tangential rows would be multiples of one another, and forces along
// them could not be told apart.  With slip along e alone F^2 e / |F e| is what friction is, and |F e| its part along e: one row does, whose coefficient
// the law finds from the turn.  Friction along e depends on a slip across e that is prescribed: the law must see both, and where e is an axis the
// row of the other one is empty; where coefficients are equal other axes do as well, half way between.
void turnAxes(const NodeDirectory& directory, bool isIsotropic, PairDraft& draft) {
  constexpr double kAcross = 1e-12;
  ContactPair& pair = draft.placed.pair;
  const SlipLeft left = slipLeft(directory, draft);
  const auto v = onlyDirection(pair.frame, left);
  if (!v) return;
  const auto [v1, v2] = *v;
  const auto [s1, s2] = left.prescribed;
  const bool isAxis = std::abs(v1) < PairDraft::kRoundOff || std::abs(v2) < PairDraft::kRoundOff;
  const bool isDriven = std::abs(s1 * v2 - s2 * v1) > kAcross * std::hypot(s1, s2);
  if (!isDriven && !isAxis) turn({v1, v2, true}, pair);
  if (isDriven && isAxis && isIsotropic) turn({std::sqrt(0.5), std::sqrt(0.5), false}, pair);
}

// What rows leave out of their axes is nowhere: a multiplier that is turned to global axes and back would return to an empty row by it.
void dropRoundOff(LocalFrame& frame) {
  for (auto* axis : {&frame.normal, &frame.t1, &frame.t2})
    for (double& value : *axis)
      if (std::abs(value) < PairDraft::kRoundOff) value = 0;
}

}  // namespace

// c of a row is its gap minus what prescribed displacements contribute to the jump.
void makeRows(const NodeDirectory& directory, const InterfaceRows& interface, PairDraft& draft) {
  const PlacedPair& placed = draft.placed;
  const auto& F = placed.pair.coefficients;
  if (interface.frictional && !interface.tied && !placed.pair.isPinned[1] && !placed.pair.isPinned[2])
    turnAxes(directory, F ? (*F)[0] == (*F)[1] : interface.isIsotropic, draft);
  dropRoundOff(draft.placed.pair.frame);
  const LocalFrame& frame = placed.pair.frame;
  draft.axes = {frame.normal, frame.t1, frame.t2};
  if (interface.tied) draft.axes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (std::size_t a = 0; a < 3; ++a)
    if (placed.pair.isPinned[a]) draft.axes[a] = {0, 0, 0};
  RowShare::Pair& share = draft.share;
  share.interface = placed.interface;
  share.position = placed.position;
  share.isTied = interface.tied;
  share.c = {interface.tied ? 0.0 : placed.pair.gap, 0.0, 0.0};
  share.pinned = {1, 1, 1};
  for (const auto& [index, weight] : draft.nodes) {
    const NodeRecord& record = directory.records()[std::size_t(index)];
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t d = 0; d < 3; ++d) {
        if (record.isPrescribed[d]) share.c[a] -= weight * draft.axes[a][d] * record.prescribed[d];
        else if (weight != 0 && draft.acts(a, d, record)) share.pinned[a] = 0;
      }
  }
}

}  // namespace Haptos
