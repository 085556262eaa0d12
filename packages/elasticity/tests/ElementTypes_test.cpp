// SPDX-License-Identifier: BSD-3-Clause
// What holds for the elements of every topology.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>
#include <map>

#include "DenseAlgebra.hpp"
#include "ElasticityFixtures.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_NodalLoads.hpp"
#include "Haptos_ReferenceElement.hpp"
#include "Haptos_RigidBodyModes.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Fixtures;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// Corners of the reference cells; middles by Exodus' manual (the table of edges is tested in packages/mesh), centres of HEX27 by hand.
Matrix3Xd referenceNodes(Topology topology) {
  const ElementShape& shape = elementShape(topology);
  Matrix3Xd x(3, shape.numNodes);
  if (shape.numCorners == 8)
    x.leftCols(8) << -1, 1, 1, -1, -1, 1, 1, -1, -1, -1, 1, 1, -1, -1, 1, 1, -1, -1, -1, -1, 1, 1, 1, 1;
  else if (shape.numCorners == 4) x.leftCols(4) << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  else if (shape.numCorners == 6) x.leftCols(6) << 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, -1, -1, -1, 1, 1, 1;
  else x.leftCols(5) << -1, 1, 1, -1, 0, -1, -1, 1, 1, 0, 0, 0, 0, 0, 1;
  if (!shape.hasMidNodes()) return x;
  for (int i = 0; i < shape.numEdges; ++i)
    x.col(shape.numCorners + i) = 0.5 * (x.col(shape.edges[std::size_t(i)][0]) + x.col(shape.edges[std::size_t(i)][1]));
  if (topology == Topology::Hex27) x.rightCols(7) << 0, 0, 0, -1, 1, 0, 0, 0, 0, 0, 0, 0, -1, 1, 0, -1, 1, 0, 0, 0, 0;
  return x;
}

Solid singleElement(Topology topology, const std::function<Vector3d(const Vector3d&)>& map) {
  Solid solid;
  const Matrix3Xd nodes = referenceNodes(topology);
  ElementGroup group;
  group.topology = topology;
  group.blockName = "single";
  for (int a = 0; a < nodes.cols(); ++a) {
    const Vector3d x = map(nodes.col(a));
    solid.coordinates.push_back({x[0], x[1], x[2]});
    group.connectivity.push_back(a);
  }
  solid.groups.push_back(group);
  return solid;
}

Vector3d affine(const Vector3d& x) { return Vector3d(3 + 1.2 * x[0] + 0.3 * x[1], -1 + 0.9 * x[1] - 0.2 * x[2], 0.4 * x[0] + 1.1 * x[2]); }

Vector3d curved(const Vector3d& x) {
  return affine(x) + 0.12 * Vector3d(x[1] * x[1] - x[0] * x[2], x[2] * x[2] + x[0] * x[1], x[0] * x[0] - 0.5 * x[1] * x[2]);
}

/// A quadratic field and its gradient.
struct Quadratic {
  double c = 0.3;
  Vector3d b{0.7, -0.4, 0.9};
  Matrix3d a = (Matrix3d() << 0.5, 0.2, -0.3, 0.2, -0.8, 0.6, -0.3, 0.6, 0.1).finished();
  double operator()(const Vector3d& x) const { return c + b.dot(x) + x.dot(a * x); }
  Vector3d gradient(const Vector3d& x) const { return b + 2 * a * x; }
};

bool isQuadratic(Topology topology) { return elementShape(topology).hasMidNodes(); }

}  // namespace

TEUCHOS_UNIT_TEST(ElementTypes, FunctionsAreOneAtTheirNode) {
  for (const Topology topology : allTopologies()) {
    const Matrix3Xd nodes = referenceNodes(topology);
    const auto table = shapeFunctionsAt(topology, nodes);
    TEST_EQUALITY(table.numNodes(), nodesPerElement(topology));
    TEST_COMPARE((table.values - MatrixXd::Identity(nodes.cols(), nodes.cols())).cwiseAbs().maxCoeff(), <, 1e-13);
  }
}

TEUCHOS_UNIT_TEST(ElementTypes, PolynomialsAreReproduced) {
  const Quadratic q;
  for (const Topology topology : allTopologies()) {
    const Matrix3Xd nodes = referenceNodes(topology);
    for (const ReferenceElement* rule : {&stiffnessRule(topology), &bodyLoadRule(topology)})
      for (int p = 0; p < rule->numPoints(); ++p) {
        const Vector3d x = rule->points.col(p);
        double sum = 0, value = 0;
        Vector3d place = Vector3d::Zero(), gradient = Vector3d::Zero();
        for (int a = 0; a < rule->numNodes(); ++a) {
          const double n = rule->values(a, p);
          sum += n;
          place += n * nodes.col(a);
          value += n * q(nodes.col(a));
          gradient += q(nodes.col(a)) * rule->gradients.block<3, 1>(3 * a, p);
        }
        TEST_FLOATING_EQUALITY(sum, 1.0, 1e-13);
        TEST_COMPARE((place - x).norm(), <, 1e-13);
        if (!isQuadratic(topology)) continue;
        TEST_COMPARE(std::abs(value - q(x)), <, 1e-13);
        TEST_COMPARE((gradient - q.gradient(x)).norm(), <, 1e-12);
      }
  }
}

TEUCHOS_UNIT_TEST(ElementTypes, GradientsAreDerivatives) {
  constexpr double h = 1e-5;
  for (const Topology topology : allTopologies()) {
    const auto& rule = stiffnessRule(topology);
    for (int k = 0; k < 3; ++k) {
      Matrix3Xd before = rule.points, after = rule.points;
      before.row(k).array() -= h;
      after.row(k).array() += h;
      const MatrixXd difference = (shapeFunctionsAt(topology, after).values - shapeFunctionsAt(topology, before).values) / (2 * h);
      for (int a = 0; a < rule.numNodes(); ++a)
        TEST_COMPARE((difference.row(a) - rule.gradients.row(3 * a + k)).cwiseAbs().maxCoeff(), <, 2e-9);
    }
  }
}

TEUCHOS_UNIT_TEST(ElementTypes, RulesHavePositiveWeightsThatSumToTheCell) {
  const std::map<int, double> volumes{{8, 8.0}, {4, 1.0 / 6}, {6, 1.0}, {5, 4.0 / 3}};
  for (const Topology topology : allTopologies())
    for (const ReferenceElement* rule : {&stiffnessRule(topology), &bodyLoadRule(topology)}) {
      TEST_COMPARE(rule->weights.minCoeff(), >, 0.0);
      TEST_FLOATING_EQUALITY(rule->weights.sum(), volumes.at(elementShape(topology).numCorners), 1e-13);
    }
}

// Gauss: the integral of x n^T over the closed surface is the volume times I, that of n is 0.  A side with wrong nodes, a wrong
// order of middles or a normal inward breaks it; the order of the sides themselves is tested against the manual in packages/mesh.
TEUCHOS_UNIT_TEST(ElementTypes, SidesEncloseTheVolume) {
  for (const Topology topology : allTopologies())
    for (const bool isCurved : {false, true}) {
      const Solid solid = singleElement(topology, isCurved ? curved : affine);
      const auto& group = solid.groups[0];
      std::vector<GroupSide> sides;
      for (int s = 0; s < sidesPerElement(topology); ++s) sides.push_back({0, s});
      const auto sumOf = [](const VectorXd& f) -> Vector3d { return Eigen::Map<const Matrix3Xd>(f.data(), 3, f.size() / 3).rowwise().sum(); };
      VectorXd f = VectorXd::Zero(3 * Eigen::Index(solid.coordinates.size())), volume = f, uniform = f;
      addBodyForce(solid.coordinates, group, [](double, double, double) { return std::array<double, 3>{1, 0, 0}; }, volume);
      const double v = sumOf(volume)[0];
      TEST_COMPARE(v, >, 0.05);
      addPressure(solid.coordinates, group, sides, [](double, double, double) { return 1.0; }, uniform);
      TEST_COMPARE(uniform.norm(), >, 0.1);
      TEST_COMPARE(sumOf(uniform).norm(), <, 1e-13);
      for (int k = 0; k < 3; ++k) {
        f.setZero();
        addPressure(solid.coordinates, group, sides, [&](double x, double y, double z) { return -std::array<double, 3>{x, y, z}[std::size_t(k)]; }, f);
        TEST_COMPARE((sumOf(f) - v * Vector3d::Unit(k)).norm(), <, 1e-12);
      }
      if (isCurved) continue;
      const Matrix3d map = (Matrix3d() << 1.2, 0.3, 0, 0, 0.9, -0.2, 0.4, 0, 1.1).finished();
      const std::map<int, double> volumes{{8, 8.0}, {4, 1.0 / 6}, {6, 1.0}, {5, 4.0 / 3}};
      TEST_FLOATING_EQUALITY(v, volumes.at(elementShape(topology).numCorners) * map.determinant(), 1e-13);
    }
}

// Area and normal of every side of an affine element, from its corners; consistent loads of a uniform pressure by the closed forms.
TEUCHOS_UNIT_TEST(ElementTypes, AreaNormalAndConsistentLoadOfEverySide) {
  const std::map<SideShape, std::array<double, 3>> shares{{SideShape::Triangle3, {1.0 / 3, 0, 0}},
                                                          {SideShape::Triangle6, {0, 1.0 / 3, 0}},
                                                          {SideShape::Quad4, {1.0 / 4, 0, 0}},
                                                          {SideShape::Quad8, {-1.0 / 12, 1.0 / 3, 0}},
                                                          {SideShape::Quad9, {1.0 / 36, 1.0 / 9, 4.0 / 9}}};
  for (const Topology topology : allTopologies()) {
    const Solid solid = singleElement(topology, affine);
    for (int s = 0; s < sidesPerElement(topology); ++s) {
      const SideNodes& side = sideNodes(topology, s);
      const auto at = [&](int i) -> Vector3d { return Vector3d(solid.coordinates[std::size_t(side[i])].data()); };
      const Vector3d twice = side.numCorners == 3 ? Vector3d((at(1) - at(0)).cross(at(2) - at(0))) : Vector3d((at(2) - at(0)).cross(at(3) - at(1)));
      VectorXd f = VectorXd::Zero(3 * Eigen::Index(solid.coordinates.size()));
      addPressure(solid.coordinates, solid.groups[0], {{0, s}}, [](double, double, double) { return -1.0; }, f);
      const auto& share = shares.at(side.shape);
      for (int i = 0; i < side.numNodes; ++i) {
        const double wanted = share[i < side.numCorners ? 0 : i < 2 * side.numCorners ? 1 : 2];
        TEST_COMPARE((f.segment<3>(3 * side[i]) - 0.5 * wanted * twice).norm(), <, 1e-13);
        f.segment<3>(3 * side[i]).setZero();
      }
      TEST_EQUALITY(f.norm(), 0.0);
    }
  }
}

// Six motions without energy and no more, in either formulation.
TEUCHOS_UNIT_TEST(ElementTypes, StiffnessHasSixZeros) {
  for (const Topology topology : allTopologies())
    for (const auto formulation : {Formulation::Standard, Formulation::BBar}) {
      const Solid solid = singleElement(topology, curved);
      const MatrixXd k = assembleStiffness(solid.coordinates, solid.groups, steel(), formulation);
      const MatrixXd transposed = k.transpose();
      TEST_EQUALITY((k - transposed).norm(), 0.0);
      const VectorXd eigenvalues = Testing::symmetricEigenvalues(k);
      const double largest = eigenvalues[eigenvalues.size() - 1];
      TEST_COMPARE(eigenvalues.head(6).cwiseAbs().maxCoeff(), <, 1e-13 * largest);
      out << topologyName(topology) << ": " << eigenvalues[6] / largest << "\n";
      TEST_COMPARE(eigenvalues[6], >, 1e-5 * largest);
      const MatrixXd R = rigidBodyModes(solid.coordinates);
      TEST_COMPARE((k * R).norm(), <, 1e-13 * k.norm());
    }
}

TEUCHOS_UNIT_TEST(ElementTypes, ForceEqualsStiffnessTimesDisplacement) {
  for (const Topology topology : allTopologies())
    for (const auto formulation : {Formulation::Standard, Formulation::BBar}) {
      const Solid solid = singleElement(topology, curved);
      const MatrixXd k = assembleStiffness(solid.coordinates, solid.groups, steel(), formulation);
      const VectorXd u = someVector(k.rows());
      VectorXd ku = u;
      applyStiffness(solid.coordinates, solid.groups, steel(), formulation, u, ku);
      TEST_COMPARE((ku - k * u).norm(), <, 1e-14 * k.norm() * u.norm());
    }
}

// By K as a matrix 1e8 leaves 1e-8 of the force of a displacement by 1.
TEUCHOS_UNIT_TEST(ElementTypes, BodiesThatGoFarKeepTheirDigits) {
  for (const Topology topology : allTopologies()) {
    const Solid solid = singleElement(topology, curved);
    const VectorXd far = VectorXd::Constant(3 * Eigen::Index(solid.coordinates.size()), 1e8);
    VectorXd force = far;
    applyStiffness(solid.coordinates, solid.groups, steel(), Formulation::Standard, far, force);
    TEST_EQUALITY(force.norm(), 0.0);
  }
}

// tr K_aa = (lambda + 4 shear) int |grad N_a|^2
TEUCHOS_UNIT_TEST(ElementTypes, WeightsAreTheDiagonalOfTheStiffness) {
  const ElasticModuli moduli = elasticModuli(steel()[0]);
  for (const Topology topology : allTopologies()) {
    const Solid solid = singleElement(topology, curved);
    const MatrixXd k = assembleStiffness(solid.coordinates, solid.groups, steel(), Formulation::Standard);
    const auto weights = nodalStiffness(solid.coordinates, solid.groups, {steel()[0].youngsModulus});
    TEST_EQUALITY(3 * Eigen::Index(weights.size()), k.rows());
    for (Eigen::Index a = 0; a < Eigen::Index(weights.size()); ++a)
      TEST_FLOATING_EQUALITY(k.diagonal().segment<3>(3 * a).sum(),
                             (moduli.lambda + 4 * moduli.shear) / steel()[0].youngsModulus * weights[std::size_t(a)], 1e-12);
  }
}

TEUCHOS_UNIT_TEST(ElementTypes, BadElementsAreRefusedByTheirPlace) {
  const auto refusal = [&](const Solid& solid) -> std::string {
    try {
      checkElements(solid.coordinates, solid.groups[0]);
      return "";
    } catch (const InputError& error) {
      out << error.what() << "\n";
      return error.what();
    }
  };
  for (const Topology topology : allTopologies()) {
    const ElementShape& shape = elementShape(topology);
    TEST_EQUALITY(refusal(singleElement(topology, curved)), "");
    const auto mirrored = refusal(singleElement(topology, [](const Vector3d& x) { return Vector3d(-x[0], x[1], x[2]); }));
    TEST_INEQUALITY(mirrored.find("element 1 (" + std::string(shape.name) + ") of block \"single\" is inverted"), std::string::npos);
    const auto flat = refusal(singleElement(topology, [](const Vector3d& x) { return Vector3d(x[0], x[1], 0); }));
    TEST_INEQUALITY(flat.find("is degenerate"), std::string::npos);
    Solid lost = singleElement(topology, curved);
    lost.coordinates.back()[1] = std::nan("");
    TEST_INEQUALITY(refusal(lost).find("not finite"), std::string::npos);
    if (!shape.hasMidNodes()) continue;
    for (int i = 0; i < shape.numEdges; ++i) {
      Solid collapsed = singleElement(topology, affine);
      const auto& edge = shape.edges[std::size_t(i)];
      collapsed.coordinates[std::size_t(shape.numCorners + i)] = collapsed.coordinates[std::size_t(edge[0])];
      const auto message = refusal(collapsed);
      TEST_INEQUALITY(message.find("has its node " + std::to_string(shape.numCorners + i + 1) + ", which belongs in the middle between its nodes " +
                                   std::to_string(edge[0] + 1) + " and " + std::to_string(edge[1] + 1)),
                      std::string::npos);
      for (std::size_t d = 0; d < 3; ++d)  // a crack tip's quarter point is fine
        collapsed.coordinates[std::size_t(shape.numCorners + i)][d] =
            0.75 * collapsed.coordinates[std::size_t(edge[0])][d] + 0.25 * collapsed.coordinates[std::size_t(edge[1])][d];
      TEST_EQUALITY(refusal(collapsed), "");
    }
  }
}
