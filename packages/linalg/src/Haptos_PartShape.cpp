// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_PartShape.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {
namespace {

using Nodes = std::vector<int>;

Eigen::Map<const Eigen::Vector3d> at(const Coordinates& coordinates, int node) {
  return Eigen::Map<const Eigen::Vector3d>(coordinates[std::size_t(node)].data());
}

Nodes allOf(const Coordinates& coordinates) {
  Nodes all(coordinates.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

// Mean of d d^T over nodes, d from their mean: its eigenvalues are squares of the extents along the principal axes.
struct Spread {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();

  Spread(const Coordinates& coordinates, const Nodes& nodes) {
    for (const int node : nodes) mean += at(coordinates, node);
    mean /= double(nodes.size());
    for (const int node : nodes) {
      const Eigen::Vector3d d = at(coordinates, node) - mean;
      moments += d * d.transpose();
    }
    moments /= double(nodes.size());
  }
};

// A part is cut in halves, again and again: pieces of what is thin come out as plates or needles, whose thickness is that of the part once they are short
// enough to be straight.  A layer of nodes is no plate: the thickness is that of a piece with its neighbours, the length its own.
class PieceCutter {
 public:
  PieceCutter(const Coordinates& coordinates, const IndexLists& neighbours)
      : coordinates_(coordinates), neighbours_(neighbours), seenBy_(coordinates.size(), -1), pieces_{allOf(coordinates)} {}

  // Where pieces have few nodes, on the mean, or all of them in one place.
  bool isAtEnd() const {
    constexpr std::size_t kFew = 16;
    return !isCut_ || kFew * pieces_.size() > coordinates_.size();
  }

  // Cuts all pieces; squares of their lengths and thicknesses, means over nodes.
  std::pair<double, double> cut() {
    double length2 = 0, thickness2 = 0;
    std::vector<Nodes> halves;
    for (const Nodes& piece : pieces_) {
      const Spread spread(coordinates_, piece);
      const SymmetricEigen3 eigen(spread.moments);
      const double share = double(piece.size()) / double(coordinates_.size());
      length2 += share * eigen.values[2];
      thickness2 += share * SymmetricEigen3(Spread(coordinates_, withNeighbours(piece)).moments).values[0];
      std::array<Nodes, 2> both;
      for (const int node : piece) both[eigen.vectors.col(2).dot(at(coordinates_, node) - spread.mean) > 0 ? 1 : 0].push_back(node);
      for (Nodes& half : both)
        if (!half.empty()) halves.push_back(std::move(half));
    }
    isCut_ = halves.size() > pieces_.size();
    pieces_ = std::move(halves);
    return {length2, thickness2};
  }

 private:
  Nodes withNeighbours(const Nodes& piece) {
    Nodes all;
    ++calls_;
    for (const int node : piece)
      for (const int* other = neighbours_.begin(node); other != neighbours_.end(node); ++other)
        if (std::exchange(seenBy_[std::size_t(*other)], calls_) != calls_) all.push_back(*other);
    return all;
  }

  const Coordinates& coordinates_;
  const IndexLists& neighbours_;
  std::vector<int> seenBy_;  // [nodes] who met a node last
  int calls_ = 0;
  std::vector<Nodes> pieces_;
  bool isCut_ = true;  // some piece was, the last time
};

// 0 where no pieces are thin
double aspectOfBent(const Coordinates& coordinates, const IndexLists& neighbours) {
  constexpr double kThin = 4;  // pieces: curvature adds little to their thickness, and what is as long as thick stays out
  PieceCutter cutter(coordinates, neighbours);
  double whole = 0, thinnest = std::numeric_limits<double>::infinity();
  while (!cutter.isAtEnd()) {
    const auto [length2, thickness2] = cutter.cut();
    if (whole == 0) whole = length2;
    if (length2 > kThin * kThin * thickness2) thinnest = std::min(thinnest, thickness2);
  }
  return std::isfinite(thinnest) ? std::sqrt(whole / thinnest) : 0.0;
}

// What is bent fills little of its box: of rings, half rings and domes a share of 2.6 to 3.1 times their thickness over their extent.
double aspectByVolume(const PartVolume& part) {
  constexpr double kBent = 2.7;
  if (!(part.volume > 0)) return 0;
  const Eigen::Vector3d mean = part.first / part.volume;
  const Eigen::Matrix3d moments = part.second / part.volume - mean * mean.transpose();
  return kBent * std::sqrt(std::max(0.0, (12 * moments).determinant())) / part.volume;  // of a box the variance is a twelfth of the square
}

}  // namespace

double aspectOfPart(const Coordinates& coordinates, const IndexLists& neighbours, const PartVolume& volume) {
  const double asItLies = aspectOf(coordinates);
  if (isSlender(asItLies)) return asItLies;
  const double byVolume = aspectByVolume(volume);
  return std::max(asItLies, isSlender(byVolume) ? byVolume : aspectOfBent(coordinates, neighbours));
}

double aspectOf(const Coordinates& coordinates) {
  const Eigen::Vector3d squares = SymmetricEigen3(Spread(coordinates, allOf(coordinates)).moments).values;
  return squares[0] > 0 ? std::sqrt(squares[2] / squares[0]) : std::numeric_limits<double>::infinity();
}

bool isSlender(double aspect) {
  constexpr double kRatio = 10;  // ordinary meshes are to pay nothing (decisions/016)
  return aspect > kRatio;
}

}  // namespace Haptos
