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
  static constexpr double kRoundOff = 1e-12;

  std::array<bool, 3> isFree{};
  std::array<double, 2> prescribed{};
  double scale = 0;  // of what cancels in it

  // Whether s, a part of what is prescribed, is one.
  bool isDriven(double s) const { return std::abs(s) > kRoundOff * scale; }
};

SlipLeft slipLeft(const NodeDirectory& directory, const PairDraft& draft) {
  const LocalFrame& frame = draft.placed.pair.frame;
  SlipLeft left;
  for (const auto& [index, weight] : draft.nodes) {
    const NodeRecord& record = directory.records()[std::size_t(index)];
    for (std::size_t d = 0; d < 3; ++d) {
      if (!record.isPrescribed[d]) {
        left.isFree[d] = left.isFree[d] || weight != 0;
        continue;
      }
      const double moved = weight * record.prescribed[d];
      left.prescribed[0] += frame.t1[d] * moved, left.prescribed[1] += frame.t2[d] * moved;
      left.scale += std::abs(moved);
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

// Rows that are left out whatever they reach stay where supports drive one side along them.
void keepDrivenRows(const SlipLeft& left, ContactPair& pair) {
  for (std::size_t t = 0; t < 2; ++t) {
    const auto& axis = t == 0 ? pair.frame.t1 : pair.frame.t2;
    double reach = 0;
    for (std::size_t d = 0; d < 3; ++d)
      if (left.isFree[d]) reach += std::abs(axis[d]);
    if (reach < PairDraft::kRoundOff && left.isDriven(left.prescribed[t])) pair.isPinned[t + 1] = 0;
  }
}

// Half way between the axes, where multipliers that are stretched to equal coefficients have their axes as well as anywhere.  Rows along the axis that
// is left are as long as they would be anyhow, as the other one has nothing but what is prescribed.
FrameTurn halfTurn(const std::array<double, 2>& F, std::size_t left) {
  FrameTurn turn{std::sqrt(0.5), std::sqrt(0.5), false};
  turn.stretch[1 - left] = F[1 - left] / F[left];
  return turn;
}

// Where supports leave one direction e to slip and it is no axis of friction, both tangential rows would be multiples of one another, and forces along
// them could not be told apart.  With slip along e alone F^2 e / |F e| is what friction is, and |F e| its part along e: one row does, whose coefficient
// the law finds from the turn.  Friction along e depends on a slip across e that is prescribed: the law must see both, and where e is an axis the
// row of the other one is empty, so rows are turned half way.
void turnAxes(const std::array<double, 2>& F, const SlipLeft& left, ContactPair& pair) {
  const auto v = onlyDirection(pair.frame, left);
  if (!v) return;
  const auto [v1, v2] = *v;
  const auto [s1, s2] = left.prescribed;
  const bool isFirst = std::abs(v2) < PairDraft::kRoundOff, isAxis = isFirst || std::abs(v1) < PairDraft::kRoundOff;
  const bool isDriven = left.isDriven(s1 * v2 - s2 * v1);
  if (!isDriven && !isAxis) turn({v1, v2, true}, pair);
  // A coefficient 0 along e leaves nothing to find there, and along the other axis no force.
  if (isDriven && isAxis && F[0] > 0 && F[1] > 0) turn(halfTurn(F, isFirst ? 0 : 1), pair);
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
  ContactPair& pair = draft.placed.pair;
  SlipLeft left;
  if (interface.frictional && !interface.tied) {
    left = slipLeft(directory, draft);
    keepDrivenRows(left, pair);
    if (!pair.isPinned[1] && !pair.isPinned[2]) turnAxes(pair.coefficients.value_or(interface.coefficients), left, pair);
  }
  dropRoundOff(pair.frame);
  const LocalFrame& frame = pair.frame;
  draft.axes = {frame.normal, frame.t1, frame.t2};
  if (interface.tied) draft.axes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (std::size_t a = 0; a < 3; ++a)
    if (pair.isPinned[a]) draft.axes[a] = {0, 0, 0};
  RowShare::Pair& share = draft.share;
  share.interface = draft.placed.interface;
  share.position = draft.placed.position;
  share.isTied = interface.tied;
  share.c = {interface.tied ? 0.0 : pair.gap, 0.0, 0.0};
  share.pinned = {1, 1, 1};
  for (const auto& [index, weight] : draft.nodes) {
    const NodeRecord& record = directory.records()[std::size_t(index)];
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t d = 0; d < 3; ++d) {
        if (record.isPrescribed[d]) share.c[a] -= weight * draft.axes[a][d] * record.prescribed[d];
        else if (weight != 0 && draft.acts(a, d, record)) share.pinned[a] = 0;
      }
  }
  if (!pair.turn || !pair.turn->isStretched()) return;  // else axes say what is prescribed
  const auto driven = pair.turn->slipOfRows(left.prescribed[0], left.prescribed[1]);
  for (std::size_t t = 0; t < 2; ++t) share.c[t + 1] = -driven[t];
}

}  // namespace Haptos
