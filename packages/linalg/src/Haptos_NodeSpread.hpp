// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <vector>

#include "Haptos_Vec3.hpp"

namespace Haptos {

/// \brief Mean of d d^T over nodes, d from their mean: its eigenvalues are squares of the extents along the principal axes.
struct NodeSpread {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();

  /// \param coordinates [all nodes of the part] \param nodes one at least
  NodeSpread(const Coordinates& coordinates, const std::vector<int>& nodes) {
    for (const int node : nodes) mean += at(coordinates, node);
    mean /= double(nodes.size());
    for (const int node : nodes) {
      const Eigen::Vector3d d = at(coordinates, node) - mean;
      moments += d * d.transpose();
    }
    moments /= double(nodes.size());
  }

  static Eigen::Map<const Eigen::Vector3d> at(const Coordinates& coordinates, int node) {
    return Eigen::Map<const Eigen::Vector3d>(coordinates[std::size_t(node)].data());
  }
};

}  // namespace Haptos
