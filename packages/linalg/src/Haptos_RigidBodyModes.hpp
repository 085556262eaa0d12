// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "Haptos_Vec3.hpp"

namespace Haptos {

/// \brief Displacement at x of the six unit rigid motions: columns e_x, e_y, e_z, then e_i x (x - centre).
Eigen::Matrix<double, 3, 6> rigidMotion(const Eigen::Vector3d& x, const Eigen::Vector3d& centre);

/// \brief Mean of the nodes.
Eigen::Vector3d centroid(const Coordinates& coordinates);

/// \brief Orthonormal basis R of the rigid motions of a subdomain, R^T R = I, the kernel of its stiffness.
///
/// Every connected piece moves by itself: columns `6 piece + 0..2` are its translations along x, y, z,
/// columns `6 piece + 3..5` its rotations about its centroid, made orthogonal to each other.  Entries do
/// not depend on the unit of length.
///
/// \param pieceOfNode [numNodes], pieces counted from 0 without gaps; empty means one piece.
/// \return [3 numNodes x 6 pieces], row `3 node + direction`.
/// Every piece needs three nodes that do not lie on one line (any solid element has them).
Eigen::MatrixXd rigidBodyModes(const Coordinates& coordinates, const std::vector<int>& pieceOfNode = {});

/// \brief A rigid motion u(x) = translation + rotation x (x - centre) of a body of a given size.
struct RigidMotion {
  Eigen::Vector3d translation;
  Eigen::Vector3d rotation;  ///< in radians
  Eigen::Vector3d centre;
  double size;  ///< largest distance of the body's nodes from `centre`, > 0: tells which part matters
};

/// \brief Whether a motion stands for its opposite as well, as one that nothing holds does, or has a way: that which loads drive.
enum class MotionSense { Either, AsGiven };

/// \brief "translation along (0.71, 0.71, 0)", "rotation about the axis (0, 0, 1) through (1, 2, 3)", the
/// latter "with translation along the axis" where it is a screw; "no motion" for zero.
///
/// Directions are of unit length with a positive first component, but for the way of a translation where that is asked for; the point
/// of the axis is the one nearest to `centre`.  A part that moves no node by more than 1e-6 of the other is left out.
std::string describeRigidMotion(const RigidMotion& motion, MotionSense sense = MotionSense::Either);

}  // namespace Haptos
