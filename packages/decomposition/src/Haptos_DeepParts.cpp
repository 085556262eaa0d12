// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DeepParts.hpp"

#include <algorithm>
#include <cmath>

#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {
namespace {

constexpr double kFlat = 1e-3;  // thickness over length: such a motion has 1e-6 of the energy of others

// The plane, line or point that the centroids of some elements lie in: v^T (x - mean) = 0 for the axes v.
struct Hull {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes;  // columns
  int thin = 3;          // the first so many are normal to all centroids

  Hull(const std::vector<std::array<double, 3>>& centroids, const std::vector<int>& elements) {
    for (int e : elements) mean += Eigen::Vector3d(centroids[std::size_t(e)].data()) / double(elements.size());
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (int e : elements) {
      const Eigen::Vector3d d = Eigen::Vector3d(centroids[std::size_t(e)].data()) - mean;
      spread += d * d.transpose();
    }
    const SymmetricEigen3 eigen(spread);
    axes = eigen.vectors;
    while (thin > 0 && eigen.values[thin - 1] > kFlat * kFlat * eigen.values[2]) --thin;
  }
  bool isFlat() const { return thin > 0; }
  double distance(const std::array<double, 3>& x) const {
    const Eigen::Vector3d d = Eigen::Vector3d(x.data()) - mean;
    double squares = 0;
    for (int j = 0; j < thin; ++j) squares += d.dot(axes.col(j)) * d.dot(axes.col(j));
    return std::sqrt(squares);
  }
};

class Deepening {
 public:
  Deepening(const DualGraph& graph, const std::vector<std::array<double, 3>>& centroids, const std::vector<char>& needsDepth, std::vector<int>& part)
      : graph_(graph), centroids_(centroids), needsDepth_(needsDepth), part_(part) {
    members_.resize(std::size_t(*std::max_element(part.begin(), part.end()) + 1));
    for (std::size_t e = 0; e < part.size(); ++e) members_[std::size_t(part[e])].push_back(int(e));
  }

  void run() {
    for (int p = 0; p < int(members_.size()); ++p)
      while (isFlat(members_[std::size_t(p)]) && grow(p)) continue;
  }

 private:
  bool isFlat(const std::vector<int>& elements) const {
    return std::all_of(elements.begin(), elements.end(), [&](int e) { return needsDepth_[std::size_t(e)] != 0; }) && Hull(centroids_, elements).isFlat();
  }

  template <class Visit>
  void forNeighbours(int e, Visit&& visit) const {
    for (auto k = graph_.offsets[std::size_t(e)]; k < graph_.offsets[std::size_t(e) + 1]; ++k) visit(int(graph_.neighbours[std::size_t(k)]));
  }

  std::vector<int> without(int e) const {
    std::vector<int> others = members_[std::size_t(part_[std::size_t(e)])];
    others.erase(std::find(others.begin(), others.end(), e));
    return others;
  }

  bool isConnected(const std::vector<int>& elements) const {
    std::vector<int> walk{elements.front()};
    for (std::size_t at = 0; at < walk.size(); ++at)
      forNeighbours(walk[at], [&](int other) {
        const bool isNew = std::find(walk.begin(), walk.end(), other) == walk.end();
        if (isNew && std::binary_search(elements.begin(), elements.end(), other)) walk.push_back(other);
      });
    return walk.size() == elements.size();
  }

  // Flat before, flat behind: its turn comes.
  bool canSpare(int e) const {
    const auto others = without(e);
    return !others.empty() && isConnected(others) && (!isFlat(others) || isFlat(members_[std::size_t(part_[std::size_t(e)])]));
  }

  // Takes the neighbour farthest from the hull, the first of several.
  bool grow(int p) {
    const Hull hull(centroids_, members_[std::size_t(p)]);
    int best = -1;
    double farthest = 0;
    for (int e : members_[std::size_t(p)])
      forNeighbours(e, [&](int other) {
        const double distance = hull.distance(centroids_[std::size_t(other)]);
        if (part_[std::size_t(other)] != p && distance > (1 + kFlat) * farthest && canSpare(other)) best = other, farthest = distance;
      });
    if (best < 0) return false;
    auto& from = members_[std::size_t(part_[std::size_t(best)])];
    auto& to = members_[std::size_t(p)];
    from.erase(std::find(from.begin(), from.end(), best));
    to.insert(std::lower_bound(to.begin(), to.end(), best), best);
    part_[std::size_t(best)] = p;
    return true;
  }

  const DualGraph& graph_;
  const std::vector<std::array<double, 3>>& centroids_;
  const std::vector<char>& needsDepth_;
  std::vector<int>& part_;
  std::vector<std::vector<int>> members_;  // [parts] ascending
};

}  // namespace

void deepenParts(const DualGraph& graph, const std::vector<std::array<double, 3>>& centroids, const std::vector<char>& needsDepth,
                 std::vector<int>& part) {
  if (needsDepth.empty() || part.empty()) return;
  Deepening(graph, centroids, needsDepth, part).run();
}

}  // namespace Haptos
