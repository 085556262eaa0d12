// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_TouchedNodes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {
namespace {

// One of them, and what lies around it, seen along the normal.
class TouchedNode {
 public:
  TouchedNode(const Coordinates& coordinates, const IndexLists& neighbours, int node, const Eigen::Vector3d& outward)
      : coordinates_(coordinates), neighbours_(neighbours), inward_(-outward.normalized()), node_(node), below_(nextInward(node)) {}

  // The harmonic over the arithmetic mean of t^2, a^2 and a^2, a the shorter extent across the normal.
  double roundness() const {
    constexpr double kFlattest = 1e-6;  // nodes in a plane
    const double a2 = across2(), t2 = std::max(0.5 * std::pow(below_.depth, 2), kFlattest * a2);
    return t2 < a2 ? 9 / ((2 * a2 + t2) * (2 / a2 + 1 / t2)) : 1.0;
  }

  // Through the part: the node of the surface that is met there, before the way turns aside along a surface that is bent.
  int opposite() const {
    constexpr double kAside = 0.5;
    int node = node_;
    for (Step step = below_; step.node >= 0 && step.cosine > kAside * below_.cosine; step = nextInward(node)) node = step.node;
    return node;
  }

 private:
  Eigen::Map<const Eigen::Vector3d> at(int node) const { return Eigen::Map<const Eigen::Vector3d>(coordinates_[std::size_t(node)].data()); }

  struct Step {
    int node = -1;
    double depth = 0, cosine = 1e-4;  // what is less lies beside the node
  };

  // Mean square of the distances to neighbours, seen along the normal, in the direction in which it is least.
  double across2() const {
    Eigen::Matrix<double, 3, 2> plane;
    plane.col(0) = inward_.unitOrthogonal();
    plane.col(1) = inward_.cross(plane.col(0));
    Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
    for (const int* other = neighbours_.begin(node_); other != neighbours_.end(node_); ++other) {
      const Eigen::Vector2d d = plane.transpose() * (at(*other) - at(node_));
      squares += d * d.transpose() / double(neighbours_.end(node_) - neighbours_.begin(node_));
    }
    return SymmetricEigen2(squares).values[0];
  }

  // The neighbour that lies straightest inward, of several the farthest.
  Step nextInward(int node) const {
    constexpr double kSame = 1e-6;
    Step next;
    for (const int* other = neighbours_.begin(node); other != neighbours_.end(node); ++other) {
      const Eigen::Vector3d d = at(*other) - at(node);
      const double depth = d.dot(inward_), cosine = depth / d.norm();
      if (cosine > next.cosine + kSame || (cosine > next.cosine - kSame && depth > next.depth)) next = {*other, depth, std::max(cosine, next.cosine)};
    }
    return next;
  }

  const Coordinates& coordinates_;
  const IndexLists& neighbours_;
  Eigen::Vector3d inward_;  // unit
  int node_;
  Step below_;
};

}  // namespace

std::vector<double> stiffnessAlone(const Coordinates& coordinates, const IndexLists& neighbours, const TouchedNodes& touched) {
  const auto isTouched = [&](int node) { return std::binary_search(touched.nodes.begin(), touched.nodes.end(), node); };
  std::vector<double> result(touched.nodes.size(), 1.0);
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (touched.normals[i].isZero(0)) continue;
    const TouchedNode node(coordinates, neighbours, touched.nodes[i], touched.normals[i]);
    result[i] = node.roundness();
    if (result[i] == 1) continue;  // and no way through long elements is gone
    const int opposite = node.opposite();
    if (opposite != touched.nodes[i] && isTouched(opposite)) result[i] = 1;
  }
  return result;
}

}  // namespace Haptos
