// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_FacetTree.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "Haptos_ContactSurface.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {
constexpr int leafSize = 4;  // facets whose boxes cost about what one more level would
}

// Boxes of facets, and a binary tree of boxes above them.
FacetTree::FacetTree(const ContactSurface& surface) {
  boxes_.reserve(surface.numFacets());
  for (int f = 0; f < int(surface.numFacets()); ++f) {
    Vec3::Array low = surface.coordinates[std::size_t(surface.facets[std::size_t(f)][0])], high = low;
    for (int i = 1; i < surface.facetSize(f); ++i)
      for (std::size_t c = 0; c < 3; ++c) {
        const double x = surface.coordinates[std::size_t(surface.facets[std::size_t(f)][std::size_t(i)])][c];
        low[c] = std::min(low[c], x);
        high[c] = std::max(high[c], x);
      }
    // room beside the facet, as its plane is found by nodes that lie a little beyond its edges
    const double margin = 0.25 * Vec3::norm(Vec3::subtract(high, low));
    Box box{Vec3::scale(0.5, Vec3::add(low, high)), Vec3::scale(0.5, Vec3::subtract(high, low))};
    for (double& half : box.half) half += margin;
    boxes_.push_back(box);
  }
  order_.resize(boxes_.size());
  std::iota(order_.begin(), order_.end(), 0);
  if (!order_.empty()) build(0, int(order_.size()));
}

// Halves by the median along the longest axis: a depth of log2 n whatever the surface.
int FacetTree::build(int begin, int end) {
  Box box = boxes_[std::size_t(order_[std::size_t(begin)])];
  for (int i = begin + 1; i < end; ++i) box = unite(box, boxes_[std::size_t(order_[std::size_t(i)])]);
  const int self = int(nodes_.size());
  nodes_.push_back({box, begin, end, -1, -1});
  if (end - begin <= leafSize) return self;

  const auto axis = std::size_t(std::max_element(box.half.begin(), box.half.end()) - box.half.begin());
  const int middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](int a, int b) {
    return boxes_[std::size_t(a)].centre[axis] < boxes_[std::size_t(b)].centre[axis];
  });
  const int left = build(begin, middle);
  const int right = build(middle, end);
  nodes_[std::size_t(self)].left = left;
  nodes_[std::size_t(self)].right = right;
  return self;
}

// The smallest box around both.
FacetTree::Box FacetTree::unite(const Box& a, const Box& b) {
  Box box;
  for (std::size_t c = 0; c < 3; ++c) {
    const double low = std::min(a.centre[c] - a.half[c], b.centre[c] - b.half[c]);
    const double high = std::max(a.centre[c] + a.half[c], b.centre[c] + b.half[c]);
    box.centre[c] = 0.5 * (low + high);
    box.half[c] = 0.5 * (high - low);
  }
  return box;
}

// Separating axes of an infinite line and a box: direction x e_i, i = 1, 2, 3.  No division, so lines along
// the axes are no special case.
bool FacetTree::meets(const Box& box, const std::array<double, 3>& origin,
                      const std::array<double, 3>& direction, double margin) {
  const auto moment = Vec3::cross(Vec3::subtract(box.centre, origin), direction);
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t a = (c + 1) % 3, b = (c + 2) % 3;
    if (std::abs(moment[c]) > (box.half[a] + margin) * std::abs(direction[b]) + (box.half[b] + margin) * std::abs(direction[a]))
      return false;
  }
  return true;
}

// Boxes that the line misses are left out with all that is in them; the line has no end on either side.
int FacetTree::facetsNearLine(const std::array<double, 3>& origin, const std::array<double, 3>& direction,
                              std::vector<int>& facets, double margin) const {
  facets.clear();
  if (nodes_.empty()) return 0;
  int compared = 0;
  const auto isMet = [&](const Box& box) {
    ++compared;
    return meets(box, origin, direction, margin);
  };
  std::vector<int> stack = {0};
  while (!stack.empty()) {
    const Node& node = nodes_[std::size_t(stack.back())];
    stack.pop_back();
    if (!isMet(node.box)) continue;
    if (node.left >= 0) {
      stack.push_back(node.right);
      stack.push_back(node.left);
      continue;
    }
    for (int i = node.begin; i < node.end; ++i)
      if (const int facet = order_[std::size_t(i)]; isMet(boxes_[std::size_t(facet)])) facets.push_back(facet);
  }
  return compared;
}

}  // namespace Haptos
