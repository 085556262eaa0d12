// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Components.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "Haptos_Halo.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

using Index = std::int64_t;

std::vector<Index> neighboursOutside(const DualGraph& graph, Index first, Index end) {
  std::vector<Index> outside;
  for (Index neighbour : graph.neighbours)
    if (neighbour < first || neighbour >= end) outside.push_back(neighbour);
  std::sort(outside.begin(), outside.end());
  outside.erase(std::unique(outside.begin(), outside.end()), outside.end());
  return outside;
}

/// Few rounds are needed: a rank takes part with its components, not with its elements, and labels jump from root to root.
/// Components of this rank's elements alone, and how they hang together with those of others.
class LabelSpreading {
 public:
  LabelSpreading(const Communicator& comm, const ElementRange& own, const DualGraph& graph, const std::vector<int>& colour)
      : comm_(comm), own_(own), first_(own.firstElement()), halo_(comm, own, graph) {
    joinOwn(graph, colour);
    std::vector<int> outside;
    if (!colour.empty() || comm.getSize() > 1)
      outside = halo_.fetch([&](Index e) { return colour.empty() ? 0 : colour[std::size_t(e)]; });
    for (std::size_t e = 0; e + 1 < graph.offsets.size(); ++e)
      for (auto k = graph.offsets[e]; k < graph.offsets[e + 1]; ++k) {
        const int h = halo_.position(graph.neighbours[std::size_t(k)]);
        if (h >= 0 && (colour.empty() || colour[e] == outside[std::size_t(h)])) crossings_.emplace_back(part_[e], h);
      }
    std::sort(crossings_.begin(), crossings_.end());
    crossings_.erase(std::unique(crossings_.begin(), crossings_.end()), crossings_.end());
  }

  // [this rank's elements] lowest element of the component
  std::vector<Index> run() {
    for (bool changed = true; changed;) {
      const bool hooked = hook(), jumped = jump();
      changed = anyOfAll(comm_, hooked || jumped);
    }
    std::vector<Index> result;
    for (int p : part_) result.push_back(labels_[std::size_t(p)]);
    return result;
  }

 private:
  struct Hook {
    Index root, lower;
  };

  // Within the rank by union-find, which needs no messages; a component begins with its lowest element as label.
  void joinOwn(const DualGraph& graph, const std::vector<int>& colour) {
    DisjointSets sets(graph.offsets.size() - 1);
    for (std::size_t e = 0; e + 1 < graph.offsets.size(); ++e)
      for (auto k = graph.offsets[e]; k < graph.offsets[e + 1]; ++k) {
        const Index other = graph.neighbours[std::size_t(k)] - first_;
        if (other >= 0 && other < Index(e) && (colour.empty() || colour[e] == colour[std::size_t(other)])) sets.join(int(e), int(other));
      }
    int count = 0;
    part_ = sets.numbered(count);
    labels_.assign(std::size_t(count), -1);
    for (std::size_t e = 0; e < part_.size(); ++e)
      if (Index& label = labels_[std::size_t(part_[e])]; label < 0) label = first_ + Index(e);
  }

  bool lower(int part, Index label) {
    if (label >= labels_[std::size_t(part)]) return false;
    labels_[std::size_t(part)] = label;
    return true;
  }

  Index labelAt(Index place) const { return labels_[std::size_t(part_[std::size_t(place)])]; }

  // Takes lower labels from across the ranks, and passes them on to where the old label came from.
  bool hook() {
    const auto outside = halo_.fetch([&](Index e) { return labelAt(e); });
    std::vector<Hook> hooks;
    bool changed = false;
    for (const auto& [part, h] : crossings_) {
      const Index old = labels_[std::size_t(part)], found = outside[std::size_t(h)];
      if (!lower(part, found)) continue;
      hooks.push_back({old, found});
      changed = true;
    }
    for (const Hook& hook : sendItems(comm_, hooks, [&](const Hook& h) { return own_.elements.owner(h.root); }))
      if (lower(part_[std::size_t(hook.root - first_)], hook.lower)) changed = true;
    return changed;
  }

  // The label of the element that lends its number.
  bool jump() {
    std::vector<Index> roots = labels_;
    std::sort(roots.begin(), roots.end());
    roots.erase(std::unique(roots.begin(), roots.end()), roots.end());
    const auto above = RemoteValues(comm_, own_.elements, roots).fetch([&](Index place) { return labelAt(place); });
    bool changed = false;
    for (std::size_t p = 0; p < labels_.size(); ++p) {
      const auto at = std::lower_bound(roots.begin(), roots.end(), labels_[p]) - roots.begin();
      if (lower(int(p), above[std::size_t(at)])) changed = true;
    }
    return changed;
  }

  const Communicator& comm_;
  const ElementRange& own_;
  Index first_;
  Halo halo_;
  std::vector<int> part_;      // [own elements] component among them
  std::vector<Index> labels_;  // [parts] an element of the component over all ranks, in the end its lowest
  std::vector<std::pair<int, int>> crossings_;  // part, position in the halo
};

}  // namespace

Halo::Halo(const Communicator& comm, const ElementRange& own, const DualGraph& graph)
    : first_(own.firstElement()),
      end_(first_ + Index(own.numElements())),
      elements_(neighboursOutside(graph, first_, end_)),
      values_(comm, own.elements, elements_) {}

int Halo::position(Index neighbour) const {
  if (neighbour >= first_ && neighbour < end_) return -1;
  return int(std::lower_bound(elements_.begin(), elements_.end(), neighbour) - elements_.begin());
}

// Labels are elements; sizes are counted where they are known in part, and added up everywhere: components are few.
Components connectedComponents(const Communicator& comm, const ElementRange& own, const DualGraph& graph, const std::vector<int>& colour) {
  const auto labels = LabelSpreading(comm, own, graph, colour).run();
  struct Counted {
    Index label, elements;
  };
  std::vector<Counted> mine;
  {
    std::map<Index, Index> counts;
    for (Index label : labels) ++counts[label];
    for (const auto& [label, elements] : counts) mine.push_back({label, elements});
  }
  std::map<Index, Index> sizes;
  for (const Counted& one : gatheredOnAll(comm, mine)) sizes[one.label] += one.elements;
  Components result;
  for (const auto& [label, size] : sizes) {
    result.first.push_back(label);
    result.sizes.push_back(size);
  }
  for (Index label : labels)
    result.ofElement.push_back(int(std::lower_bound(result.first.begin(), result.first.end(), label) - result.first.begin()));
  return result;
}

std::vector<int> connectedComponents(const DualGraph& graph, const std::vector<int>& colour, int& count) {
  DisjointSets sets(graph.offsets.size() - 1);
  for (std::size_t e = 0; e + 1 < graph.offsets.size(); ++e)
    for (auto k = graph.offsets[e]; k < graph.offsets[e + 1]; ++k) {
      const auto other = graph.neighbours[std::size_t(k)];
      if (other < Index(e) && (colour.empty() || colour[e] == colour[std::size_t(other)])) sets.join(int(e), int(other));
    }
  return sets.numbered(count);
}

}  // namespace Haptos
