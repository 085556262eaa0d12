// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SmoothWalls.hpp"

#include <algorithm>
#include <cmath>

namespace Haptos {
namespace {

// What of each part has come to the elements, one element after the other.
struct Shares {
  struct Share {
    int part;
    double value;
  };
  std::vector<std::size_t> offsets{0};  // [elements + 1]
  std::vector<Share> items;

  const Share* begin(std::size_t e) const { return items.data() + offsets[e]; }
  const Share* end(std::size_t e) const { return items.data() + offsets[e + 1]; }
  bool isAll(std::size_t e, int part) const { return offsets[e + 1] == offsets[e] + 1 && begin(e)->part == part; }
};

// The shares of one element in the making.
class Sum {
 public:
  explicit Sum(std::size_t parts) : values_(parts, 0.0) {}
  void add(int part, double value) {
    if (values_[std::size_t(part)] == 0) touched_.push_back(part);
    values_[std::size_t(part)] += value;
  }
  void moveTo(Shares& shares) {
    constexpr double kLost = 0.01;  // will not be the most anywhere
    for (int p : touched_) {
      if (values_[std::size_t(p)] > kLost) shares.items.push_back({p, values_[std::size_t(p)]});
      values_[std::size_t(p)] = 0;
    }
    touched_.clear();
    shares.offsets.push_back(shares.items.size());
  }

 private:
  std::vector<double> values_;  // [parts]
  std::vector<int> touched_;
};

class Walls {
 public:
  Walls(const DualGraph& graph, std::vector<int>& part)
      : graph_(graph), part_(part), sizes_(part.empty() ? 0 : std::size_t(*std::max_element(part.begin(), part.end())) + 1), sum_(sizes_.size()) {
    for (int p : part) ++sizes_[std::size_t(p)];
    for (std::size_t e = 0; e < part.size(); ++e) {
      double all = 0;
      forEachNeighbour(e, [&](std::size_t, double coupling) { all += coupling; });
      weights_.push_back(all > 0 ? 1 / all : 0.0);
    }
  }

  // Walks, and lets every element choose once.  Returns the number of moves.
  std::size_t sweep() {
    constexpr double kMargin = 1.05;  // to what is left of the own part: a flat wall stays
    const int steps = stepsOfWalk();
    Shares shares;
    for (int p : part_) sum_.add(p, 1.0), sum_.moveTo(shares);
    for (int i = 0; i < steps; ++i) shares = walked(shares);
    std::size_t moved = 0;
    for (std::size_t e = 0; e < part_.size(); ++e) moved += move(e, shares.begin(e), shares.end(e), kMargin);
    return moved;
  }

  // One after the other, so that what is cut falls with every move.
  std::size_t takeMajorities() {
    constexpr double kMargin = 1.01;  // round-off moves nothing
    std::size_t moved = 0;
    Shares shares;  // of one element
    for (std::size_t e = 0; e < part_.size(); ++e) {
      shares.items.clear();
      shares.offsets.resize(1);
      forEachNeighbour(e, [&](std::size_t f, double coupling) { sum_.add(part_[f], weights_[e] * coupling); });
      sum_.moveTo(shares);
      moved += move(e, shares.begin(0), shares.end(0), kMargin);
    }
    return moved;
  }

 private:
  // Not farther than through a part.  Long elements take more than others, as what is weak between them is a wall for long: 24 are enough, 12
  // are not (decisions/048).
  int stepsOfWalk() const {
    const double perPart = double(part_.size()) / double(sizes_.size());
    return int(std::lround(std::min(24.0, 0.75 * std::cbrt(perPart * perPart))));
  }

  template <class Take>
  void forEachNeighbour(std::size_t e, const Take& take) const {
    for (auto k = std::size_t(graph_.offsets[e]); k < std::size_t(graph_.offsets[e + 1]); ++k)
      take(std::size_t(graph_.neighbours[k]), graph_.couplings[k]);
  }

  // u_e := u_e / 3 + 2/3 sum_f c_ef u_f / sum_f c_ef for every part
  Shares walked(const Shares& u) {
    constexpr double kStays = 1.0 / 3.0;
    Shares next;
    next.items.reserve(u.items.size());
    next.offsets.reserve(u.offsets.size());
    for (std::size_t e = 0; e < part_.size(); ++e) {
      const auto add = [&](std::size_t from, double times) {
        for (auto s = u.begin(from); s != u.end(from); ++s) sum_.add(s->part, times * s->value);
      };
      if (isInside(e, u)) {
        add(e, 1.0);
      } else {
        add(e, kStays);
        forEachNeighbour(e, [&](std::size_t f, double coupling) { add(f, (1 - kStays) * weights_[e] * coupling); });
      }
      sum_.moveTo(next);
    }
    return next;
  }

  // Nothing of another part is here or at a neighbour.
  bool isInside(std::size_t e, const Shares& u) const {
    bool inside = u.offsets[e + 1] == u.offsets[e] + 1;
    const int own = inside ? u.begin(e)->part : part_[e];
    for (auto k = std::size_t(graph_.offsets[e]); inside && k < std::size_t(graph_.offsets[e + 1]); ++k)
      inside = u.isAll(std::size_t(graph_.neighbours[k]), own);
    return inside || weights_[e] == 0;
  }

  // To the part with most shares that has room, if the own one can spare an element.
  bool move(std::size_t e, const Shares::Share* begin, const Shares::Share* end, double margin) {
    constexpr double kUneven = 0.2;  // sizes, of their mean: curvature alone would take small parts in
    const double mean = double(part_.size()) / double(sizes_.size());
    const int own = part_[e];
    if (sizes_[std::size_t(own)] - 1 < std::max(1.0, (1 - kUneven) * mean)) return false;
    double most = 0;
    for (auto s = begin; s != end; ++s)
      if (s->part == own) most = margin * s->value;
    for (auto s = begin; s != end; ++s)
      if (s->part != own && s->value > most && sizes_[std::size_t(s->part)] + 1 <= (1 + kUneven) * mean) most = s->value, part_[e] = s->part;
    if (part_[e] == own) return false;
    --sizes_[std::size_t(own)], ++sizes_[std::size_t(part_[e])];
    return true;
  }

  const DualGraph& graph_;
  std::vector<int>& part_;
  std::vector<int> sizes_;       // [parts]
  std::vector<double> weights_;  // [elements] 1 / sum of all couplings
  Sum sum_;
};

}  // namespace

void smoothWalls(const DualGraph& graph, std::vector<int>& part) {
  constexpr int kSweeps = 3, kLast = 20;  // ten sweeps bring 2 % more; the last ones end by themselves after three or four
  Walls walls(graph, part);
  for (int i = 0; i < kSweeps && walls.sweep() > 0; ++i) {}
  for (int i = 0; i < kLast && walls.takeMajorities() > 0; ++i) {}
}

}  // namespace Haptos
