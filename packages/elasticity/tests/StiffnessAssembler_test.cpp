// SPDX-License-Identifier: BSD-3-Clause
#include <Teuchos_Time.hpp>
#include <Teuchos_UnitTestHarness.hpp>

#include "DenseAlgebra.hpp"
#include "ElasticityFixtures.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_RigidBodyModes.hpp"
#include "Haptos_StiffnessAssembler.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Fixtures;

// Two materials and both topologies: a hex cube and, glued to its side x = 1, a tet cube.
// (Their common side is not conforming in the finite element sense; the algebra does not mind.)
Solid twoCubes() {
  auto solid = makeSolid(Topology::Hex8, {2, 2, 2}, 0.2);
  const auto other = makeSolid(Topology::Tet4, {2, 2, 2}, 0.2);
  std::vector<int> newIndex;
  for (const auto& x : other.coordinates) {
    const bool shared = x[0] == 0.0;
    if (shared) {
      const int j = int(std::lround(2 * x[1])), k = int(std::lround(2 * x[2]));
      newIndex.push_back(2 + 3 * (j + 3 * k));
    } else {
      newIndex.push_back(int(solid.coordinates.size()));
      solid.coordinates.push_back({x[0] + 1.0, x[1], x[2]});
    }
  }
  auto group = other.groups[0];
  for (int& node : group.connectivity) node = newIndex[std::size_t(node)];
  group.material = 1;
  solid.groups.push_back(group);
  return solid;
}

const std::vector<IsotropicMaterial> twoMaterials{{"steel", 2.1e5, 0.3}, {"aluminium", 6.9e4, 0.333}};

Eigen::MatrixXd denseOracle(const Solid& solid, const std::vector<IsotropicMaterial>& materials) {
  const auto n = 3 * Eigen::Index(solid.coordinates.size());
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(n, n);
  const auto add = [&](const auto& element, const int* nodes, int numNodes) {
    for (int a = 0; a < numNodes; ++a)
      for (int b = 0; b < numNodes; ++b)
        k.block<3, 3>(3 * nodes[a], 3 * nodes[b]) += element.template block<3, 3>(3 * a, 3 * b);
  };
  for (const auto& group : solid.groups)
    for (int e = 0; e < group.numElements(); ++e) {
      const auto moduli = elasticModuli(materials[std::size_t(group.material)]);
      withShape(group.topology, [&](auto shape) {
        using Shape = decltype(shape);
        ElementStiffness<Shape> element;
        elementStiffness<Shape>(elementGradients<Shape>(solid.coordinates, group, e), moduli, Formulation::BBar, element);
        add(element, group.nodes(e), nodesPerElement(group.topology));
      });
    }
  return k;
}

TEUCHOS_UNIT_TEST(StiffnessAssembler, EqualsDenseAssemblyOfMixedGroups) {
  const auto solid = twoCubes();
  TEST_EQUALITY(solid.coordinates.size(), std::size_t(27 + 18));
  const auto k = assembleStiffness(solid.coordinates, solid.groups, twoMaterials, Formulation::BBar);
  const auto oracle = denseOracle(solid, twoMaterials);
  TEST_ASSERT((Eigen::MatrixXd(k) - oracle).cwiseAbs().maxCoeff() < 1e-15 * oracle.norm());
  const Eigen::SparseMatrix<double> transposed = k.transpose();
  TEST_EQUALITY((k - transposed).norm(), 0.0);
}

TEUCHOS_UNIT_TEST(StiffnessAssembler, IsCompressedWithAscendingRows) {
  const auto solid = twoCubes();
  const auto k = assembleStiffness(solid.coordinates, solid.groups, twoMaterials, Formulation::Standard);
  TEST_ASSERT(k.isCompressed());
  TEST_EQUALITY(k.outerIndexPtr()[k.cols()], int(k.nonZeros()));
  int unsorted = 0;
  for (int j = 0; j < k.cols(); ++j)
    for (int p = k.outerIndexPtr()[j] + 1; p < k.outerIndexPtr()[j + 1]; ++p)
      if (k.innerIndexPtr()[p] <= k.innerIndexPtr()[p - 1]) ++unsorted;
  TEST_EQUALITY(unsorted, 0);
}

TEUCHOS_UNIT_TEST(StiffnessAssembler, ApplyEqualsAssembledMatrix) {
  for (const auto& solid : {twoCubes(), mixedSolid(2, 0.2, ElementOrder::Quadratic)}) {
    const Eigen::VectorXd u = someVector(3 * Eigen::Index(solid.coordinates.size()));
    for (const auto formulation : {Formulation::Standard, Formulation::BBar}) {
      const auto k = assembleStiffness(solid.coordinates, solid.groups, twoMaterials, formulation);
      Eigen::VectorXd ku = Eigen::VectorXd::Constant(u.size(), 1e30);  // must be overwritten
      applyStiffness(solid.coordinates, solid.groups, twoMaterials, formulation, u, ku);
      TEST_ASSERT((ku - k * u).norm() < 1e-14 * k.norm() * u.norm());
      TEST_ASSERT(ku.norm() > 1.0);
    }
  }
}

TEUCHOS_UNIT_TEST(StiffnessAssembler, RigidBodyModesSpanTheKernel) {
  for (const auto& solid : {makeSolid(Topology::Hex8, {3, 2, 4}, 0.2), makeSolid(Topology::Tet4, {3, 2, 4}, 0.2),
                            mixedSolid(2, 0.2, ElementOrder::Linear), mixedSolid(1, 0.2, ElementOrder::Quadratic)}) {
    const auto k = assembleStiffness(solid.coordinates, solid.groups, steel(), Formulation::BBar);
    const Eigen::MatrixXd R = rigidBodyModes(solid.coordinates);
    TEST_ASSERT((R.transpose() * k).norm() < 1e-14 * k.norm());
    // and only they: K + R R^T is definite
    const Eigen::MatrixXd regular = Eigen::MatrixXd(k) + k.norm() * R * R.transpose();
    TEST_ASSERT(Testing::choleskyRcond(regular) > 1e-6);
  }
}

TEUCHOS_UNIT_TEST(StiffnessAssembler, TranslatedCopyIsBitwiseEqual) {
  // Widths and shifts are powers of two, so that the coordinates themselves carry no round-off.
  const auto original = makeSolid(Topology::Hex8, {4, 4, 4});
  const auto copy = makeSolid(Topology::Hex8, {4, 4, 4}, 0.0, [](std::array<double, 3> x) {
    return std::array<double, 3>{x[0] + 64.0, x[1] - 8.0, x[2] + 1024.0};
  });
  const auto a = assembleStiffness(original.coordinates, original.groups, steel(), Formulation::Standard);
  const auto b = assembleStiffness(copy.coordinates, copy.groups, steel(), Formulation::Standard);
  TEST_EQUALITY((a - b).norm(), 0.0);
  TEST_EQUALITY((rigidBodyModes(original.coordinates) - rigidBodyModes(copy.coordinates)).norm(), 0.0);
}

TEUCHOS_UNIT_TEST(StiffnessAssembler, InvertedElementStopsAssembly) {
  auto solid = makeSolid(Topology::Hex8, {2, 1, 1});
  std::swap(solid.groups[0].connectivity[9], solid.groups[0].connectivity[11]);
  TEST_THROW(assembleStiffness(solid.coordinates, solid.groups, steel(), Formulation::Standard), InputError);
  const Eigen::VectorXd u = someVector(36);
  Eigen::VectorXd ku(36);
  TEST_THROW(applyStiffness(solid.coordinates, solid.groups, steel(), Formulation::Standard, u, ku),
             InputError);
}

TEUCHOS_UNIT_TEST(StiffnessAssembler, ThirtyCubedBlock) {
  const auto solid = makeSolid(Topology::Hex8, {30, 30, 30});
  Teuchos::Time clock("assemble", true);
  const auto k = assembleStiffness(solid.coordinates, solid.groups, steel(), Formulation::BBar);
  const double assembled = clock.stop();
  TEST_EQUALITY(k.nonZeros(), Eigen::Index(9) * 91 * 91 * 91);  // 3 (31) - 2 neighbours a direction
  const Eigen::VectorXd u = someVector(k.rows());
  Eigen::VectorXd ku(k.rows());
  clock.start(true);
  applyStiffness(solid.coordinates, solid.groups, steel(), Formulation::BBar, u, ku);
  out << "30^3 elements: assembly " << assembled << " s, matrix-free product " << clock.stop() << " s\n";
  TEST_ASSERT((ku - k * u).norm() < 1e-14 * k.norm() * u.norm());
}

}  // namespace
