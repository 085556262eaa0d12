// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <vector>

#include "Haptos_IndexLists.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {

/// \brief Nodes of a part that contacts and ties touch.
struct TouchedNodes {
  std::vector<int> nodes;                ///< local, ascending
  std::vector<Eigen::Vector3d> normals;  ///< [nodes] outward, of any length
};

/// \brief What touched nodes of a slender part meet that move alone, over what the diagonal of K has for them: [touched], in (0, 1].
///
/// With elements a x a x t of a plate K has E a^2 / t at a node of its surface, and E t is what the node meets, as it yields across the thickness; not where
/// the other side is touched as well, nor where elements are longer along the normal than across it (decisions/058).
/// \param coordinates [nodes] \param neighbours of each node, those that K couples it with, itself included
std::vector<double> stiffnessAlone(const Coordinates& coordinates, const IndexLists& neighbours, const TouchedNodes& touched);

}  // namespace Haptos
