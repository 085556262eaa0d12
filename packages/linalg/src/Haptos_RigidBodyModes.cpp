// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_RigidBodyModes.hpp"

#include <Eigen/Geometry>
#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <cmath>
#include <sstream>

namespace Haptos {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double negligible = 1e-6;  // of a motion, in words: what round-off or a user's digits leave of a turn or a shift

Vector3d pointAt(const Coordinates& coordinates, Index node) {
  const auto& x = coordinates[std::size_t(node)];
  return {x[0], x[1], x[2]};
}

Vector3d centroidOf(const Coordinates& coordinates, const std::vector<Index>& nodes) {
  // Relative to the first node: translated copies then get the same digits.
  const Vector3d origin = pointAt(coordinates, nodes.front());
  Vector3d sum = Vector3d::Zero();
  for (const Index node : nodes) sum += pointAt(coordinates, node) - origin;
  return origin + sum / double(nodes.size());
}

// Without a list of pieces all nodes are one.
std::vector<std::vector<Index>> nodesOfPieces(Index numNodes, const std::vector<int>& pieceOfNode) {
  TEUCHOS_ASSERT(pieceOfNode.empty() || Index(pieceOfNode.size()) == numNodes);
  const int last = pieceOfNode.empty() ? 0 : *std::max_element(pieceOfNode.begin(), pieceOfNode.end());
  std::vector<std::vector<Index>> pieces(std::size_t(last) + 1);
  for (Index node = 0; node < numNodes; ++node)
    pieces[pieceOfNode.empty() ? 0 : std::size_t(pieceOfNode[std::size_t(node)])].push_back(node);
  return pieces;
}

// Gram-Schmidt, twice, as one pass loses digits where the rotations are nearly parallel (needles).
void orthonormalise(Eigen::MatrixXd& modes) {
  for (Index k = 0; k < modes.cols(); ++k) {
    const double before = modes.col(k).norm();
    for (int pass = 0; pass < 2; ++pass)
      for (Index l = 0; l < k; ++l) modes.col(k) -= modes.col(l).dot(modes.col(k)) * modes.col(l);
    const double after = modes.col(k).norm();
    TEUCHOS_ASSERT(after > 1e-12 * before);  // fails for nodes on one line
    modes.col(k) /= after;
  }
}

// Six motions about the centroid in lengths of the piece, so that shifts and turns are alike in size; then orthonormal.
Eigen::MatrixXd modesOfPiece(const Coordinates& coordinates, const std::vector<Index>& nodes) {
  const Vector3d centre = centroidOf(coordinates, nodes);
  double size = 0.0;
  for (const Index node : nodes) size = std::max(size, (pointAt(coordinates, node) - centre).norm());
  TEUCHOS_ASSERT(size > 0.0);
  Eigen::MatrixXd modes(3 * Index(nodes.size()), 6);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    modes.middleRows<3>(3 * Index(i)) =
        rigidMotion((pointAt(coordinates, nodes[i]) - centre) / size, Vector3d::Zero());
  orthonormalise(modes);
  return modes;
}

std::string format(Vector3d v, double zeroBelow, int digits) {
  std::ostringstream text;
  text.precision(digits);
  for (int i = 0; i < 3; ++i) text << (i == 0 ? "(" : ", ") << (std::abs(v(i)) < zeroBelow ? 0.0 : v(i));
  text << ")";
  return text.str();
}

// An axis has no sign: the first component that is printed is made positive.
std::string formatDirection(Vector3d direction, MotionSense sense = MotionSense::Either) {
  direction.normalize();
  if (sense == MotionSense::AsGiven) return format(direction, 0.005, 2);
  for (int i = 0; i < 3; ++i) {
    if (std::abs(direction(i)) < 0.005) continue;
    if (direction(i) < 0.0) direction = -direction;
    break;
  }
  return format(direction, 0.005, 2);
}

}  // namespace

// u = t + w x r in the columns t_x, t_y, t_z, w_x, w_y, w_z
Eigen::Matrix<double, 3, 6> rigidMotion(const Vector3d& x, const Vector3d& centre) {
  const Vector3d r = x - centre;
  Eigen::Matrix<double, 3, 6> motion;
  motion << 1, 0, 0, 0, r.z(), -r.y(),  //
      0, 1, 0, -r.z(), 0, r.x(),        //
      0, 0, 1, r.y(), -r.x(), 0;
  return motion;
}

Vector3d centroid(const Coordinates& coordinates) {
  TEUCHOS_ASSERT(!coordinates.empty());
  return centroidOf(coordinates, nodesOfPieces(Index(coordinates.size()), {}).front());
}

// Six columns a piece, zero on the others: pieces that touch in no node move by themselves.
Eigen::MatrixXd rigidBodyModes(const Coordinates& coordinates, const std::vector<int>& pieceOfNode) {
  const auto pieces = nodesOfPieces(Index(coordinates.size()), pieceOfNode);
  Eigen::MatrixXd modes = Eigen::MatrixXd::Zero(3 * Index(coordinates.size()), 6 * Index(pieces.size()));
  for (std::size_t piece = 0; piece < pieces.size(); ++piece) {
    TEUCHOS_ASSERT(pieces[piece].size() >= 3);
    const auto local = modesOfPiece(coordinates, pieces[piece]);
    for (std::size_t i = 0; i < pieces[piece].size(); ++i)
      modes.block<3, 6>(3 * pieces[piece][i], 6 * Index(piece)) = local.middleRows<3>(3 * Index(i));
  }
  return modes;
}

// A screw: axis, a point on it, and whether it also moves along.  What is negligible is not said.
std::string describeRigidMotion(const RigidMotion& motion, MotionSense sense) {
  const Vector3d &t = motion.translation, &w = motion.rotation;
  const double moved = t.norm(), turned = w.norm() * motion.size;
  if (!(moved > 0.0) && !(turned > 0.0)) return "no motion";
  if (turned <= negligible * moved) return "translation along " + formatDirection(t, sense);

  // u = 0 across the axis: w x (x - centre) + t_perpendicular = 0
  const Vector3d nearest = motion.centre + w.cross(t) / w.squaredNorm();
  const double scale = std::max(motion.size, nearest.cwiseAbs().maxCoeff());
  const double along = std::abs(t.dot(w)) / w.norm();
  return "rotation about the axis " + formatDirection(w) + " through " + format(nearest, 1e-5 * scale, 4) +
         (along > negligible * std::max(turned, moved) ? " with translation along the axis" : "");
}

}  // namespace Haptos
