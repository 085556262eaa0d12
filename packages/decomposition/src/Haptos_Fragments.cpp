// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Fragments.hpp"

#include <Teuchos_Comm.hpp>
#include <algorithm>

#include "Haptos_Halo.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

using Index = std::int64_t;

// Part -> its largest fragment, the first one of several; only of fragments for which `counts` holds.
template <class Counts>
std::map<int, int> largestOf(const std::vector<int>& part, const std::vector<Index>& sizes, Counts&& counts) {
  std::map<int, int> result;
  for (int f = 0; f < int(part.size()); ++f) {
    if (!counts(f)) continue;
    const auto [it, isNew] = result.emplace(part[f], f);
    if (!isNew && sizes[f] > sizes[it->second]) it->second = f;
  }
  return result;
}

// Of each lost fragment: its neighbours' parts and the sides shared with their main fragments.
using Shared = std::map<int, std::map<int, Index>>;

// One round: joins what has grown together, finds the lost ones.
Shared lostFragments(const Fragments& f, DisjointSets& sets, int& unused) {
  for (int a = 0; a < int(f.sides.size()); ++a)
    for (const auto& [b, count] : f.sides[a])
      if (f.part[a] == f.part[b]) sets.join(a, b);
  std::vector<Index> sizes(f.part.size(), 0);
  for (int a = 0; a < int(sizes.size()); ++a) sizes[sets.lowest(a)] += f.sizes[a];
  // A part keeps its largest fragment, the others are lost.
  const auto mainOf = largestOf(f.part, sizes, [&](int a) { return sets.lowest(a) == a; });
  unused = mainOf.rbegin()->first + 1;
  Shared shared;
  for (int a = 0; a < int(sizes.size()); ++a) {
    const int mine = sets.lowest(a);
    if (mainOf.at(f.part[a]) == mine) continue;
    auto& sides = shared[mine];
    for (const auto& [b, count] : f.sides[a])
      if (mainOf.at(f.part[b]) == sets.lowest(b)) sides[f.part[b]] += count;
  }
  return shared;
}

struct FragmentSide {
  int from, to;
  Index count;
};

struct FragmentOrigin {
  int fragment, part, piece;
};

// Sides of lost fragments to any others, as far as this rank's elements have them.
template <class FragmentAt>
std::vector<FragmentSide> sidesOfLost(const DualGraph& graph, const std::vector<int>& fragment, const std::vector<char>& isLost,
                                      FragmentAt&& fragmentAt) {
  std::map<std::pair<int, int>, Index> counts;
  for (std::size_t e = 0; e < fragment.size(); ++e) {
    if (!isLost[std::size_t(fragment[e])]) continue;
    for (auto k = graph.offsets[e]; k < graph.offsets[e + 1]; ++k)
      if (const int other = fragmentAt(graph.neighbours[std::size_t(k)]); other != fragment[e]) ++counts[{fragment[e], other}];
  }
  std::vector<FragmentSide> sides;
  for (const auto& [ends, count] : counts) sides.push_back({ends.first, ends.second, count});
  return sides;
}

std::vector<char> findLost(const Fragments& fragments) {
  std::vector<char> isLost(fragments.part.size(), 1);
  for (const auto& [part, main] : largestOf(fragments.part, fragments.sizes, [](int) { return true; })) isLost[std::size_t(main)] = 0;
  return isLost;
}

void setSides(const std::vector<FragmentSide>& sides, Fragments& fragments) {
  fragments.sides.resize(fragments.part.size());
  for (const auto& side : sides) fragments.sides[std::size_t(side.from)][side.to] += side.count;
}

// Parts without gaps, in the order of their old numbers.
int compress(std::vector<int>& part) {
  std::map<int, int> number;
  for (int p : part) number.emplace(p, 0);
  int next = 0;
  for (auto& [old, now] : number) now = next++;
  for (int& p : part) p = number[p];
  return next;
}

}  // namespace

// In rounds: a fragment that reaches no main one now may do so when its neighbours have moved.
int mendFragments(Fragments& f) {
  if (f.part.empty()) return 0;
  for (int moved = 0;;) {
    DisjointSets sets(f.part.size());
    int unused = 0;
    const Shared shared = lostFragments(f, sets, unused);
    if (shared.empty()) return moved;
    std::map<int, int> target;
    for (const auto& [fragment, parts] : shared)
      if (!parts.empty())
        // To the neighbour with most common sides, the lowest part where two have as many.
        target[fragment] = std::max_element(parts.begin(), parts.end(), [](auto& a, auto& b) { return a.second < b.second; })->first;
    // No lost fragment touches a main one: the first of them becomes a part of its own, and the next round has one more to touch.
    if (target.empty()) target[shared.begin()->first] = unused;
    for (int a = 0; a < int(f.part.size()); ++a)
      if (const auto it = target.find(sets.lowest(a)); it != target.end()) f.part[a] = it->second;
    moved += int(target.size());
  }
}

// Fragments and their shared sides first; elements follow their fragment.
int mendParts(const DualGraph& graph, std::vector<int>& part) {
  int count = 0;
  const auto fragment = connectedComponents(graph, part, count);
  Fragments fragments;
  fragments.part.resize(std::size_t(count));
  fragments.sizes.assign(std::size_t(count), 0);
  for (std::size_t e = 0; e < part.size(); ++e) {
    fragments.part[std::size_t(fragment[e])] = part[e];
    ++fragments.sizes[std::size_t(fragment[e])];
  }
  setSides(sidesOfLost(graph, fragment, findLost(fragments), [&](Index other) { return fragment[std::size_t(other)]; }), fragments);
  const int moved = mendFragments(fragments);
  for (std::size_t e = 0; e < part.size(); ++e) part[e] = fragments.part[std::size_t(fragment[e])];
  return moved;
}

// The fragments of a large mesh are few and known to all; they are mended alike on every rank, from sides that all have gathered.
MendedParts mendParts(const Communicator& comm, const ElementRange& own, const DualGraph& graph, const Components& pieces,
                      std::vector<int>& part) {
  const Components found = connectedComponents(comm, own, graph, part);
  std::vector<FragmentOrigin> origins;
  for (int f = 0; f < found.count(); ++f)
    if (const Index e = found.first[std::size_t(f)] - own.firstElement(); e >= 0 && e < Index(part.size()))
      origins.push_back({f, part[std::size_t(e)], pieces.ofElement[std::size_t(e)]});
  Fragments fragments;
  fragments.sizes = found.sizes;
  fragments.part.resize(found.first.size());
  std::vector<int> pieceOf(found.first.size());
  for (const auto& origin : gatheredOnAll(comm, origins)) {
    fragments.part[std::size_t(origin.fragment)] = origin.part;
    pieceOf[std::size_t(origin.fragment)] = origin.piece;
  }
  // Neighbours of this rank's elements on other ranks, and which fragments they are in.
  const Halo halo(comm, own, graph);
  const auto outside = halo.fetch([&](Index e) { return found.ofElement[std::size_t(e)]; });
  const auto fragmentAt = [&](Index neighbour) {
    const int h = halo.position(neighbour);
    return h >= 0 ? outside[std::size_t(h)] : found.ofElement[std::size_t(neighbour - own.firstElement())];
  };
  setSides(gatheredOnAll(comm, sidesOfLost(graph, found.ofElement, findLost(fragments), fragmentAt)), fragments);
  MendedParts result;
  result.moved = mendFragments(fragments);
  result.firstPiece.assign(std::size_t(compress(fragments.part)), -1);
  for (std::size_t f = 0; f < pieceOf.size(); ++f)
    if (int& piece = result.firstPiece[std::size_t(fragments.part[f])]; piece < 0) piece = pieceOf[f];
  for (std::size_t e = 0; e < part.size(); ++e) part[e] = fragments.part[std::size_t(found.ofElement[e])];
  return result;
}

}  // namespace Haptos
