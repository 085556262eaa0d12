// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SmoothWalls.hpp"

#include <algorithm>
#include <utility>

namespace Haptos {
namespace {

using Shares = std::vector<std::pair<int, double>>;  // part, what has come of it; ascending parts

void add(int part, double share, Shares& shares) {
  const auto at = std::lower_bound(shares.begin(), shares.end(), part, [](const auto& s, int p) { return s.first < p; });
  if (at != shares.end() && at->first == part) at->second += share;
  else shares.insert(at, {part, share});
}

class Walls {
 public:
  Walls(const DualGraph& graph, std::vector<int>& part) : graph_(graph), part_(part), now_(part.size()), next_(part.size()) {
    sizes_.resize(part.empty() ? 0 : std::size_t(*std::max_element(part.begin(), part.end())) + 1);
    for (int p : part) ++sizes_[std::size_t(p)];
    for (std::size_t e = 0; e < part.size(); ++e) {
      double sum = 0;
      for (auto k = graph.offsets[e]; k < graph.offsets[e + 1]; ++k) sum += graph.couplings[std::size_t(k)];
      sums_.push_back(sum);
    }
  }

  // Walks, and lets every element choose once.  Returns the number of moves.
  std::size_t sweep() {
    constexpr int kSteps = 12;              // a third of them stays in place: teeth of up to three elements (decisions/048)
    constexpr double kMargin = 1.05; // to what is left of the own part: a flat wall stays
    for (auto& shares : now_) shares.clear();
    for (int i = 0; i < kSteps; ++i) walk();
    std::size_t moved = 0;
    for (std::size_t e = 0; e < part_.size(); ++e) moved += move(e, now_[e], kMargin);
    return moved;
  }

  // One after the other, so that what is cut falls with every move.
  std::size_t takeMajorities() {
    constexpr double kMargin = 1.01;  // round-off moves nothing
    std::size_t moved = 0;
    for (std::size_t e = 0; e < part_.size(); ++e) {
      Shares shares;
      for (auto k = graph_.offsets[e]; k < graph_.offsets[e + 1]; ++k)
        add(part_[std::size_t(graph_.neighbours[std::size_t(k)])], graph_.couplings[std::size_t(k)], shares);
      moved += move(e, shares, kMargin);
    }
    return moved;
  }

 private:
  // u_e := u_e / 3 + 2/3 sum_f c_ef u_f / sum_f c_ef for every part.  No shares: all is the own part's, as it is away from walls.
  void walk() {
    constexpr double kStays = 1.0 / 3.0;
    for (std::size_t e = 0; e < part_.size(); ++e) {
      next_[e].clear();
      if (isInside(e)) continue;
      addTo(next_[e], e, kStays);
      for (auto k = graph_.offsets[e]; k < graph_.offsets[e + 1]; ++k)
        addTo(next_[e], std::size_t(graph_.neighbours[std::size_t(k)]), (1 - kStays) * graph_.couplings[std::size_t(k)] / sums_[e]);
    }
    now_.swap(next_);
  }

  void addTo(Shares& shares, std::size_t from, double times) const {
    if (now_[from].empty()) add(part_[from], times, shares);
    for (const auto& [p, share] : now_[from]) add(p, times * share, shares);
  }

  bool isInside(std::size_t e) const {
    if (!now_[e].empty() || sums_[e] == 0) return now_[e].empty();
    for (auto k = graph_.offsets[e]; k < graph_.offsets[e + 1]; ++k) {
      const auto f = std::size_t(graph_.neighbours[std::size_t(k)]);
      if (!now_[f].empty() || part_[f] != part_[e]) return false;
    }
    return true;
  }

  // To the part with most shares that has room, if the own one can spare an element.
  bool move(std::size_t e, const Shares& shares, double margin) {
    constexpr double kUneven = 0.2;  // sizes, of their mean: curvature alone would take small parts in
    const double mean = double(part_.size()) / double(sizes_.size());
    const int own = part_[e];
    if (sizes_[std::size_t(own)] - 1 < std::max(1.0, (1 - kUneven) * mean)) return false;
    double most = 0;
    for (const auto& [p, share] : shares)
      if (p == own) most = margin * share;
    for (const auto& [p, share] : shares)
      if (p != own && share > most && sizes_[std::size_t(p)] + 1 <= (1 + kUneven) * mean) most = share, part_[e] = p;
    if (part_[e] == own) return false;
    --sizes_[std::size_t(own)], ++sizes_[std::size_t(part_[e])];
    return true;
  }

  const DualGraph& graph_;
  std::vector<int>& part_;
  std::vector<int> sizes_;           // [parts]
  std::vector<double> sums_;         // [elements] of all couplings
  std::vector<Shares> now_, next_;   // [elements]
};

}  // namespace

void smoothWalls(const DualGraph& graph, std::vector<int>& part) {
  constexpr int kSweeps = 5, kLast = 20;  // ten sweeps bring no more; the last ones end by themselves after three or four
  Walls walls(graph, part);
  for (int i = 0; i < kSweeps && walls.sweep() > 0; ++i) {}
  for (int i = 0; i < kLast && walls.takeMajorities() > 0; ++i) {}
}

}  // namespace Haptos
