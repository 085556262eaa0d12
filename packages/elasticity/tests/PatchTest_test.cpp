// SPDX-License-Identifier: BSD-3-Clause
#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>

#include "ElasticityFixtures.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Fixtures;

struct Patch {
  Topology topology;
  Formulation formulation;
};

const std::array<Patch, 3> patches{{{Topology::Hex8, Formulation::Standard},
                                    {Topology::Hex8, Formulation::BBar},
                                    {Topology::Tet4, Formulation::Standard}}};

// The elements of a distorted patch have different volumes: the patch tests something.
bool isDistorted(const Solid& solid) {
  const auto& group = solid.groups[0];
  double smallest = 1.0, largest = 0.0;
  for (int e = 0; e < group.numElements(); ++e) {
    double volume = 0;
    withShape(group.topology, [&](auto shape) { volume = elementGradients<decltype(shape)>(solid.coordinates, group, e).volumes.sum(); });
    smallest = std::min(smallest, volume);
    largest = std::max(largest, volume);
  }
  return largest > 1.2 * smallest;
}

TEUCHOS_UNIT_TEST(PatchTest, LinearDisplacementLeavesInnerNodesInEquilibrium) {
  for (const auto& patch : patches) {
    const auto solid = makeSolid(patch.topology, {3, 3, 3}, 0.25);
    TEST_ASSERT(isDistorted(solid));
    const auto k = assembleStiffness(solid.coordinates, solid.groups, steel(), patch.formulation);
    const Eigen::VectorXd u = linearField(solid.coordinates, someGradient(), {0.1, -0.2, 0.3});
    const Eigen::VectorXd force = k * u;
    double inner = 0.0;
    int numInner = 0;
    for (std::size_t i = 0; i < solid.interior.size(); ++i)
      if (solid.interior[i])
        inner = std::max(inner, force.segment<3>(3 * Eigen::Index(i)).norm()), ++numInner;
    TEST_EQUALITY(numInner, 8);
    TEST_ASSERT(force.norm() > 1.0);  // the surface is loaded
    TEST_ASSERT(inner < 1e-12 * k.norm() * u.cwiseAbs().maxCoeff());
    TEST_ASSERT(inner < 1e-10 * force.norm());
  }
}

TEUCHOS_UNIT_TEST(PatchTest, StressOfLinearDisplacementIsExact) {
  const Eigen::Matrix3d H = someGradient();
  const auto moduli = elasticModuli(steel()[0]);
  const Eigen::Matrix3d sigma =
      moduli.shear * (H + H.transpose()) + moduli.lambda * H.trace() * Eigen::Matrix3d::Identity();
  const Stress expected{sigma(0, 0), sigma(1, 1), sigma(2, 2), sigma(0, 1), sigma(1, 2), sigma(2, 0)};
  for (const auto topology : {Topology::Hex8, Topology::Tet4}) {
    const auto solid = makeSolid(topology, {3, 3, 3}, 0.25);
    const auto stresses =
        elementStresses(solid.coordinates, solid.groups[0], steel()[0], linearField(solid.coordinates, H));
    TEST_EQUALITY(int(stresses.size()), solid.groups[0].numElements());
    for (const auto& stress : stresses)
      for (std::size_t c = 0; c < 6; ++c) TEST_FLOATING_EQUALITY(stress[c], expected[c], 1e-12);
  }
}

TEUCHOS_UNIT_TEST(PatchTest, VonMisesOfKnownStates) {
  TEST_FLOATING_EQUALITY(vonMises({7, 0, 0, 0, 0, 0}), 7.0, 1e-15);                 // uniaxial
  TEST_ASSERT(vonMises({5, 5, 5, 0, 0, 0}) == 0.0);                                 // hydrostatic
  TEST_FLOATING_EQUALITY(vonMises({0, 0, 0, 0, 2, 0}), 2 * std::sqrt(3.0), 1e-15);  // shear
}

}  // namespace
