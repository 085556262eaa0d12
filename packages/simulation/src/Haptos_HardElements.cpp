// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_HardElements.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_ElementShape.hpp"
#include "Haptos_Reductions.hpp"

namespace Haptos {
namespace {

// Largest by least extent of the corners along their principal axes.
double stretchOf(const Coordinates& coordinates, const int* nodes, int numCorners) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (int i = 0; i < numCorners; ++i) mean += Eigen::Vector3d(coordinates[std::size_t(nodes[i])].data()) / numCorners;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (int i = 0; i < numCorners; ++i) {
    const Eigen::Vector3d d = Eigen::Vector3d(coordinates[std::size_t(nodes[i])].data()) - mean;
    spread += d * d.transpose();
  }
  const Eigen::Vector3d squares = SymmetricEigen3(spread).values;
  return std::sqrt(squares[2] / std::max(squares[0], 1e-30 * squares[2]));
}

// On the mean: single slivers are in every mesh of tetrahedra.
bool isStretched(const Subdomain& sub) {
  constexpr double kStretched = 4;
  double sum = 0;
  int count = 0;
  for (const ElementGroup& group : sub.groups)
    for (int e = 0; e < group.numElements(); ++e, ++count) sum += stretchOf(sub.coordinates, group.nodes(e), elementShape(group.topology).numCorners);
  return sum > kStretched * count;
}

bool isHard(const Subdomain& sub, const std::vector<IsotropicMaterial>& materials) {
  const auto isHardGroup = [&](const ElementGroup& group) {
    return elementShape(group.topology).hasMidNodes() || materials[std::size_t(group.material)].poissonsRatio > kNearlyIncompressible;
  };
  return std::any_of(sub.groups.begin(), sub.groups.end(), isHardGroup) || isStretched(sub);
}

}  // namespace

bool hasHardElements(const Communicator& comm, const std::vector<Subdomain>& subdomains, const std::vector<IsotropicMaterial>& materials) {
  return anyOfAll(comm, std::any_of(subdomains.begin(), subdomains.end(), [&](const Subdomain& sub) { return isHard(sub, materials); }));
}

}  // namespace Haptos
