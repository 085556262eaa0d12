// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CoordinateBlocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "Haptos_Reductions.hpp"

namespace Haptos {
namespace {

using Index = std::int64_t;
using Key = std::uint64_t;
using Point = std::array<double, 3>;

// Order of whole numbers as that of doubles; -0 is 0.
Key keyOf(double x) {
  x += 0.0;
  Key bits;
  std::memcpy(&bits, &x, sizeof bits);
  constexpr Key sign = Key(1) << 63;
  return bits & sign ? ~bits : bits | sign;
}

struct Region {
  int set, blocks;
};

/// A cut of a region: points whose key along `axis` is below `bound` go to the left.
struct Cut {
  int axis = 0;
  Key bound = 0;
  Index left = 0, size = 0;  ///< points
  bool isPossible() const { return left > 0 && left < size; }
};

class Bisection {
 public:
  Bisection(const Communicator& comm, const std::vector<Point>& points, const std::vector<int>& setOf, const std::vector<int>& blocks)
      : comm_(comm), points_(points), regionOf(setOf) {
    for (std::size_t s = 0; s < blocks.size(); ++s) regions.push_back({int(s), blocks[s]});
  }

  // Cuts every region that is to be cut; false: there was none.
  bool step() {
    const bool any = std::any_of(regions.begin(), regions.end(), [](const Region& r) { return r.blocks > 1; });
    if (any) apply(findCuts());
    return any;
  }

 private:
  const Communicator& comm_;
  const std::vector<Point>& points_;

  template <class Visit>
  void forEachPoint(Visit&& visit) const {  // of regions that are to be cut
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (const int r = regionOf[i]; r >= 0 && regions[std::size_t(r)].blocks > 1) visit(std::size_t(r), points_[i]);
  }

  // Largest x as least -x: one reduction for both.
  std::vector<Cut> longestAxes() const {
    std::vector<double> least(6 * regions.size(), std::numeric_limits<double>::infinity());  // of x and of -x
    forEachPoint([&](std::size_t r, const Point& x) {
      for (std::size_t d = 0; d < 3; ++d) {
        least[6 * r + d] = std::min(least[6 * r + d], x[d]);
        least[6 * r + 3 + d] = std::min(least[6 * r + 3 + d], -x[d]);
      }
    });
    least = leastOfAll(comm_, least);
    std::vector<Cut> cuts(regions.size());
    for (std::size_t r = 0; r < cuts.size(); ++r) {
      const auto extent = [&](int d) { return -least[6 * r + 3 + std::size_t(d)] - least[6 * r + std::size_t(d)]; };
      for (int d : {1, 2})
        if (extent(d) > extent(cuts[r].axis)) cuts[r].axis = d;
    }
    return cuts;
  }

  // How many points of each region agree in the digits found, by their next one: [regions x 256].
  std::vector<Index> countDigits(const std::vector<Cut>& cuts, int shift) const {
    std::vector<Index> counts(256 * regions.size(), 0);
    forEachPoint([&](std::size_t r, const Point& x) {
      const Key key = keyOf(x[std::size_t(cuts[r].axis)]);
      if (shift == 56 || (key >> (shift + 8)) == (cuts[r].bound >> (shift + 8))) ++counts[256 * r + ((key >> shift) & 255)];
    });
    return sumOfAll(comm_, counts);
  }

  // The value of the point at which the left share is full, digit by digit; then the nearer end of its layer.
  std::vector<Cut> findCuts() const {
    auto cuts = longestAxes();
    std::vector<double> wanted(regions.size(), 0);
    std::vector<Index> layer(regions.size(), 0);
    for (int shift = 56; shift >= 0; shift -= 8) {
      const auto counts = countDigits(cuts, shift);
      for (std::size_t r = 0; r < regions.size(); ++r) {
        const Index* count = counts.data() + 256 * r;
        if (shift == 56) {
          for (int digit = 0; digit < 256; ++digit) cuts[r].size += count[digit];
          wanted[r] = double(cuts[r].size) * (regions[r].blocks / 2) / regions[r].blocks;
        }
        int digit = 0;
        while (digit < 255 && double(cuts[r].left + count[digit]) < wanted[r]) cuts[r].left += count[digit++];
        cuts[r].bound |= Key(digit) << shift;
        layer[r] = count[digit];
      }
    }
    for (std::size_t r = 0; r < regions.size(); ++r) {
      Cut& cut = cuts[r];
      const double below = wanted[r] - double(cut.left), above = double(cut.left + layer[r]) - wanted[r];
      const bool takeLayer = cut.left == 0 || (above <= below && cut.left + layer[r] < cut.size);
      if (takeLayer) cut.left += layer[r], ++cut.bound;
    }
    return cuts;
  }

  // Blocks are shared out to the sides by the points that the cut really leaves there, at least one to each.
  void apply(const std::vector<Cut>& cuts) {
    std::vector<Region> next;
    std::vector<int> number;  // [regions] of what is left of the cut
    for (std::size_t r = 0; r < regions.size(); ++r) {
      number.push_back(int(next.size()));
      const auto [set, blocks] = regions[r];
      if (blocks == 1 || !cuts[r].isPossible()) {
        next.push_back({set, 1});
        continue;
      }
      const auto share = std::lround(double(blocks) * double(cuts[r].left) / double(cuts[r].size));
      const int left = std::max(1, std::min(blocks - 1, int(share)));
      next.push_back({set, left});
      next.push_back({set, blocks - left});
    }
    for (std::size_t i = 0; i < points_.size(); ++i) {
      int& r = regionOf[i];
      if (r < 0) continue;
      const Cut& cut = cuts[std::size_t(r)];
      const bool isCut = regions[std::size_t(r)].blocks > 1 && cut.isPossible();
      r = number[std::size_t(r)] + int(isCut && keyOf(points_[i][std::size_t(cut.axis)]) >= cut.bound);
    }
    regions = std::move(next);
  }

 public:
  std::vector<int> regionOf;  // [points]
  std::vector<Region> regions;
};

}  // namespace

std::vector<int> cutIntoBlocks(const Communicator& comm, const std::vector<Point>& points, const std::vector<int>& setOf,
                               const std::vector<int>& blocks, std::vector<int>& blockOf) {
  Bisection bisection(comm, points, setOf, blocks);
  while (bisection.step()) {
  }
  blockOf = std::move(bisection.regionOf);
  std::vector<int> sets;
  for (const auto& region : bisection.regions) sets.push_back(region.set);
  return sets;
}

}  // namespace Haptos
