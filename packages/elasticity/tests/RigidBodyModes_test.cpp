// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <Teuchos_UnitTestHarness.hpp>

#include "ElasticityFixtures.hpp"
#include "Haptos_RigidBodyModes.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Fixtures;
using Eigen::Vector3d;

double orthonormalityError(const Eigen::MatrixXd& R) {
  return (R.transpose() * R - Eigen::MatrixXd::Identity(R.cols(), R.cols())).cwiseAbs().maxCoeff();
}

Eigen::MatrixXd rawModes(const Coordinates& coordinates, const Vector3d& centre) {
  Eigen::MatrixXd raw(3 * Eigen::Index(coordinates.size()), 6);
  for (std::size_t i = 0; i < coordinates.size(); ++i)
    raw.middleRows<3>(3 * Eigen::Index(i)) = rigidMotion(Vector3d(coordinates[i].data()), centre);
  return raw;
}

TEUCHOS_UNIT_TEST(RigidBodyModes, RawMotionIsCrossProduct) {
  const Vector3d x(1.5, -2.0, 0.7), centre(0.2, 0.4, -0.6), t(1, 2, 3), w(-0.3, 0.5, 0.9);
  Eigen::Matrix<double, 6, 1> coefficients;
  coefficients << t, w;
  TEST_ASSERT((rigidMotion(x, centre) * coefficients - (t + w.cross(x - centre))).norm() < 1e-15);
}

TEUCHOS_UNIT_TEST(RigidBodyModes, OrthonormalAndSpanAllRigidMotions) {
  const Eigen::Matrix3d axes = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (const double stretch : {1.0, 100.0, 1e4}) {  // needles, not along a global axis, far from the origin
    const auto solid = makeSolid(Topology::Hex8, {4, 2, 2}, 0.0, [&](std::array<double, 3> x) {
      const Vector3d y = axes * Vector3d(stretch * x[0], x[1], x[2]) + Vector3d(10, 20, -30);
      return std::array<double, 3>{y(0), y(1), y(2)};
    });
    const Eigen::MatrixXd R = rigidBodyModes(solid.coordinates);
    TEST_EQUALITY(R.cols(), 6);
    TEST_ASSERT(orthonormalityError(R) < 1e-14);
    const Eigen::MatrixXd raw = rawModes(solid.coordinates, centroid(solid.coordinates));
    const Eigen::MatrixXd rest = raw - R * (R.transpose() * raw);
    TEST_ASSERT(rest.norm() < 1e-13 * raw.norm());
  }
}

TEUCHOS_UNIT_TEST(RigidBodyModes, DoNotDependOnUnitOfLength) {
  auto solid = makeSolid(Topology::Hex8, {3, 2, 2}, 0.2);
  const Eigen::MatrixXd R = rigidBodyModes(solid.coordinates);
  for (auto& x : solid.coordinates)
    for (double& c : x) c *= 1e-3;
  TEST_ASSERT((R - rigidBodyModes(solid.coordinates)).cwiseAbs().maxCoeff() < 1e-14);
}

TEUCHOS_UNIT_TEST(RigidBodyModes, PiecesMoveByThemselves) {
  auto coordinates = makeSolid(Topology::Hex8, {2, 1, 1}).coordinates;
  const auto other = makeSolid(Topology::Hex8, {1, 1, 1}).coordinates;
  std::vector<int> pieceOfNode(coordinates.size(), 1);  // numbered against the order of the nodes
  for (const auto& x : other) coordinates.push_back({x[0] + 5.0, x[1], x[2]}), pieceOfNode.push_back(0);
  const Eigen::MatrixXd R = rigidBodyModes(coordinates, pieceOfNode);
  TEST_EQUALITY(R.cols(), 12);
  TEST_ASSERT(orthonormalityError(R) < 1e-14);
  TEST_EQUALITY(R.topLeftCorner(36, 6).norm(), 0.0);
  TEST_EQUALITY(R.bottomRightCorner(24, 6).norm(), 0.0);
  const Eigen::MatrixXd alone = rigidBodyModes(other);
  TEST_ASSERT((R.bottomLeftCorner(24, 6) - alone).norm() < 1e-13);
}

TEUCHOS_UNIT_TEST(RigidBodyModes, MotionsAreNamed) {
  const Vector3d zero = Vector3d::Zero(), centre(1, 2, 0.5);
  TEST_EQUALITY(describeRigidMotion({Vector3d(-3, -3, 1e-9), zero, centre, 2.0}),
                "translation along (0.71, 0.71, 0)");
  TEST_EQUALITY(describeRigidMotion({Vector3d(-3, -3, 1e-9), zero, centre, 2.0}, MotionSense::AsGiven),
                "translation along (-0.71, -0.71, 0)");
  TEST_EQUALITY(describeRigidMotion({zero, Vector3d(0, 0, -0.1), Vector3d(1, 2, 3), 2.0}),
                "rotation about the axis (0, 0, 1) through (1, 2, 3)");
  // Rotation about the line x = 4, y = 2, seen from another centre.
  const Vector3d w(0, 0, 0.1), onAxis(4, 2, 7);
  TEST_EQUALITY(describeRigidMotion({w.cross(centre - onAxis), w, centre, 2.0}),
                "rotation about the axis (0, 0, 1) through (4, 2, 0.5)");
  TEST_EQUALITY(describeRigidMotion({Vector3d(0, 0, 0.3), w, centre, 2.0}),
                "rotation about the axis (0, 0, 1) through (1, 2, 0.5) with translation along the axis");
  TEST_EQUALITY(describeRigidMotion({zero, zero, centre, 2.0}), "no motion");
  // The same motion in millimetres.
  TEST_EQUALITY(describeRigidMotion({Vector3d(1000, 0, 0), 1e-12 * w, centre, 2000.0}),
                "translation along (1, 0, 0)");
}

}  // namespace
