// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>

#include "Haptos_IndexLists.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {

/// \brief What elements fill.
struct PartVolume {
  double volume = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();    ///< integral of x
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();   ///< of x x^T
};

/// \brief How thin a subdomain is, bent ones included: its longest extent over its thickness.
///
/// \param coordinates [nodes] \param neighbours of each node, those that K couples it with, itself included
/// \param volume of the elements, where these are known
double aspectOfPart(const Coordinates& coordinates, const IndexLists& neighbours, const PartVolume& volume = {});

/// \brief Ratio of the extents along the principal axes, longest over shortest; infinite where all nodes lie in a plane.
double aspectOf(const Coordinates& coordinates);

/// \brief Whether a subdomain of this aspect is a needle, a plate or a shell.
bool isSlender(double aspect);

}  // namespace Haptos
