// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>

#include "Haptos_IndexLists.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {

/// \brief How thin a subdomain is, by its nodes alone.
struct PartShape {
  double aspect = 1;     ///< its longest extent over its thickness, bent parts included
  /// What a node that moves alone meets over what the diagonal of K has for it: 1, but less in slender parts of flat or long elements, which are stiff
  /// across their thickness alone, and yield there where nothing touches their other side (decisions/058).
  double nodeStiffness = 1;
};

/// \brief What elements fill.
struct PartVolume {
  double volume = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();    ///< integral of x
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();   ///< of x x^T
};

/// \brief \param coordinates [nodes] \param neighbours of each node, those that K couples it with, itself included
/// \param volume of the elements, where these are known
PartShape shapeOfPart(const Coordinates& coordinates, const IndexLists& neighbours, const PartVolume& volume = {});

/// \brief Ratio of the extents along the principal axes, longest over shortest; infinite where all nodes lie in a plane.
double aspectOf(const Coordinates& coordinates);

/// \brief Whether a subdomain of this aspect is a needle, a plate or a shell.
bool isSlender(double aspect);

}  // namespace Haptos
