// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_RoundParts.hpp"

#include <algorithm>

namespace Haptos {
namespace {

using Point = std::array<double, 3>;

double squaredDistance(const Point& a, const Point& b) {
  double sum = 0;
  for (int d = 0; d < 3; ++d) sum += (a[d] - b[d]) * (a[d] - b[d]);
  return sum;
}

// Power diagram of the parts' centres: an element belongs where |x - c_p|^2 - w_p is least; w_p grows for parts that are too small.
class VoronoiParts {
 public:
  VoronoiParts(const DualGraph& graph, const std::vector<Point>& centroids, const std::vector<double>& wanted, std::vector<int>& part)
      : graph_(graph), centroids_(centroids), wanted_(wanted), part_(part), weights_(wanted.size(), 0.0) {
    measure();
  }

  // Every element chooses once, by the centres and weights before the sweep.  Returns the number of moves.
  std::size_t sweep() {
    std::size_t moved = 0;
    const std::vector<int> before = part_;
    for (std::size_t e = 0; e < part_.size(); ++e) {
      int& mine = part_[e];
      const int best = nearest(e, before);
      if (best == mine || sizes_[mine] == 1) continue;
      --sizes_[mine], ++sizes_[best];
      mine = best;
      ++moved;
    }
    measure();
    balance();
    return moved;
  }

 private:
  // Of the parts of side neighbours alone, so that no element jumps across a gap.
  int nearest(std::size_t e, const std::vector<int>& before) const {
    constexpr double kGain = 1e-6;  // of the part's own spread: ties move nothing
    const int own = before[e];
    int best = own;
    double least = power(e, own) - kGain * spread_[own];
    for (auto k = graph_.offsets[e]; k < graph_.offsets[e + 1]; ++k) {
      const int other = before[graph_.neighbours[k]];
      if (other == best) continue;
      const double value = power(e, other);
      if (value < least) least = value, best = other;
    }
    return best;
  }

  double power(std::size_t e, int p) const { return squaredDistance(centroids_[e], centres_[p]) - weights_[p]; }

  // Sizes, centres and spreads of the parts as they are.
  void measure() {
    sizes_.assign(wanted_.size(), 0);
    centres_.assign(wanted_.size(), Point{0, 0, 0});
    spread_.assign(wanted_.size(), 0.0);
    for (std::size_t e = 0; e < part_.size(); ++e) {
      ++sizes_[part_[e]];
      for (int d = 0; d < 3; ++d) centres_[part_[e]][d] += centroids_[e][d];
    }
    for (std::size_t p = 0; p < sizes_.size(); ++p)
      for (double& x : centres_[p]) x /= std::max(1, sizes_[p]);
    for (std::size_t e = 0; e < part_.size(); ++e)
      spread_[part_[e]] += squaredDistance(centroids_[e], centres_[part_[e]]) / sizes_[part_[e]];
  }

  // Moving all walls of a ball outwards by dr takes w = 4 R dr and adds 3 dr / R of its volume; half of that, for damping.
  void balance() {
    for (std::size_t p = 0; p < sizes_.size(); ++p) {
      const double radiusSquared = 5.0 / 3.0 * spread_[p];
      weights_[p] += 0.5 * 4.0 / 3.0 * radiusSquared * std::max(-0.5, std::min(0.5, 1.0 - sizes_[p] / wanted_[p]));
    }
  }

  const DualGraph& graph_;
  const std::vector<Point>& centroids_;
  const std::vector<double>& wanted_;
  std::vector<int>& part_;
  std::vector<double> weights_, spread_;  // [parts] squared lengths; spread is the mean squared distance to the centre
  std::vector<int> sizes_;                // [parts]
  std::vector<Point> centres_;            // [parts]
};

}  // namespace

// Lloyd's iteration: elements to the nearest centre, centres to the middle of their elements, until nothing moves.
void roundParts(const DualGraph& graph, const std::vector<Point>& centroids, const std::vector<double>& wanted, std::vector<int>& part) {
  constexpr int kSweeps = 60;  // twice as many gain nothing on the average, 30 are a little worse
  VoronoiParts parts(graph, centroids, wanted, part);
  for (int i = 0; i < kSweeps; ++i)
    if (parts.sweep() == 0) break;
}

}  // namespace Haptos
