// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <map>

#include "ElasticityFixtures.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_NodalLoads.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Fixtures;
using Eigen::Vector3d;
using Eigen::VectorXd;

const std::vector<Topology> topologies = allTopologies();

// Sides that belong to one element only.
std::vector<GroupSide> surfaceSides(const ElementGroup& group) {
  std::map<std::vector<int>, std::vector<GroupSide>> byNodes;
  for (int e = 0; e < group.numElements(); ++e)
    for (int s = 0; s < sidesPerElement(group.topology); ++s) {
      std::vector<int> key;
      for (const int position : sideNodes(group.topology, s)) key.push_back(group.nodes(e)[position]);
      std::sort(key.begin(), key.end());
      byNodes[key].push_back({e, s});
    }
  std::vector<GroupSide> sides;
  for (const auto& entry : byNodes)
    if (entry.second.size() == 1) sides.push_back(entry.second.front());
  return sides;
}

std::vector<GroupSide> sidesAt(const Solid& solid, int axis, double place) {
  std::vector<GroupSide> sides;
  const auto& group = solid.groups[0];
  for (const auto& side : surfaceSides(group)) {
    bool all = true;
    for (const int position : sideNodes(group.topology, side.side))
      all = all && solid.coordinates[std::size_t(group.nodes(side.element)[position])][std::size_t(axis)] == place;
    if (all) sides.push_back(side);
  }
  return sides;
}

VectorXd zeroLoad(const Solid& solid) { return VectorXd::Zero(3 * Eigen::Index(solid.coordinates.size())); }

Vector3d resultant(const VectorXd& f) {
  return Eigen::Map<const Eigen::Matrix3Xd>(f.data(), 3, f.size() / 3).rowwise().sum();
}

Vector3d moment(const Solid& solid, const VectorXd& f) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < solid.coordinates.size(); ++i)
    sum += Vector3d(solid.coordinates[i].data()).cross(f.segment<3>(3 * Eigen::Index(i)));
  return sum;
}

TEUCHOS_UNIT_TEST(NodalLoads, BodyForceHasExactResultantAndMoment) {
  for (const auto topology : topologies) {
    const auto solid = makeSolid(topology, {2, 3, 2});
    auto f = zeroLoad(solid);
    addBodyForce(
        solid.coordinates, solid.groups[0],
        [](double x, double y, double z) {
          return std::array<double, 3>{1 + 2 * x, 3 * z, -4 + y};
        },
        f);
    TEST_ASSERT((resultant(f) - Vector3d(2.0, 1.5, -3.5)).norm() < 1e-14);
    // integrals over the unit cube of r x force
    const Vector3d expected(0.5 * -4 + 1.0 / 3 - 1.0, (0.5 + 0.5) - (-4 * 0.5 + 0.25), 0.75 - (0.5 + 0.5));
    TEST_ASSERT((moment(solid, f) - expected).norm() < 1e-14);
  }
}

TEUCHOS_UNIT_TEST(NodalLoads, BodyForceOnDistortedMeshSumsToVolume) {
  for (const auto topology : topologies) {
    const auto solid = makeSolid(topology, {3, 3, 3}, 0.25);
    auto f = zeroLoad(solid);
    addBodyForce(
        solid.coordinates, solid.groups[0],
        [](double, double, double) {
          return std::array<double, 3>{0, 0, -9.81};
        },
        f);
    TEST_ASSERT((resultant(f) - Vector3d(0, 0, -9.81)).norm() < 1e-13);
    TEST_ASSERT((moment(solid, f) - Vector3d(-4.905, 4.905, 0)).norm() < 1e-13);
  }
}

TEUCHOS_UNIT_TEST(NodalLoads, TractionHasExactResultantAndMoment) {
  for (const auto topology : topologies) {
    const auto solid = makeSolid(topology, {2, 3, 4});
    const auto sides = sidesAt(solid, 0, 1.0);
    TEST_EQUALITY(int(sides.size()), elementShape(topology).numCorners == 4 ? 24 : 12);
    auto f = zeroLoad(solid);
    addTraction(
        solid.coordinates, solid.groups[0], sides,
        [](double, double y, double z) {
          return std::array<double, 3>{20 + y, 20 * z, 1.0};
        },
        f);
    TEST_ASSERT((resultant(f) - Vector3d(20.5, 10.0, 1.0)).norm() < 1e-13);
    const Vector3d expected(0.5 - 20.0 / 3, (20 * 0.5 + 0.25) - 1.0, 10.0 - (10 + 1.0 / 3));
    TEST_ASSERT((moment(solid, f) - expected).norm() < 1e-13);
    for (std::size_t i = 0; i < solid.coordinates.size(); ++i)
      if (solid.coordinates[i][0] < 1.0) TEST_EQUALITY(f.segment<3>(3 * Eigen::Index(i)).norm(), 0.0);
  }
}

TEUCHOS_UNIT_TEST(NodalLoads, PressurePushesIntoTheBody) {
  for (const auto topology : topologies) {
    const auto solid = makeSolid(topology, {2, 2, 2});
    for (int axis = 0; axis < 3; ++axis)
      for (const double place : {0.0, 1.0}) {
        auto f = zeroLoad(solid);
        addPressure(
            solid.coordinates, solid.groups[0], sidesAt(solid, axis, place),
            [](double, double, double) { return 100.0; }, f);
        const Vector3d expected = (place == 0.0 ? 100.0 : -100.0) * Vector3d::Unit(axis);
        TEST_ASSERT((resultant(f) - expected).norm() < 1e-12);
      }
  }
}

// Archimedes: constant pressure on a closed surface, flat or not, has no resultant and no moment;
// pressure growing with depth lifts by the volume.
TEUCHOS_UNIT_TEST(NodalLoads, PressureOnClosedSurface) {
  const auto bend = [](std::array<double, 3> x) {
    return std::array<double, 3>{x[0] + 0.2 * x[1] * x[1], x[1] - 0.1 * x[0] * x[2],
                                 x[2] + 0.3 * x[0] * x[1]};
  };
  for (const auto topology : topologies) {
    const auto solid = makeSolid(topology, {3, 2, 3}, 0.2, bend);
    const auto sides = surfaceSides(solid.groups[0]);
    const int corners = elementShape(topology).numCorners;  // of tetrahedra all sides are halves, of wedges those at z- and z+
    TEST_EQUALITY(int(sides.size()), corners == 4 ? 84 : corners == 6 ? 54 : 42);
    auto f = zeroLoad(solid), depth = zeroLoad(solid), weight = zeroLoad(solid);
    addPressure(
        solid.coordinates, solid.groups[0], sides, [](double, double, double) { return 100.0; }, f);
    TEST_ASSERT(f.norm() > 10.0);
    TEST_ASSERT(resultant(f).norm() < 1e-12);
    TEST_ASSERT(moment(solid, f).norm() < 1e-12);
    addPressure(
        solid.coordinates, solid.groups[0], sides, [](double, double, double z) { return 50 - 7 * z; },
        depth);
    addBodyForce(
        solid.coordinates, solid.groups[0],
        [](double, double, double) {
          return std::array<double, 3>{0, 0, 7};
        },
        weight);
    TEST_ASSERT((resultant(depth) - resultant(weight)).norm() < 1e-12);
  }
}

TEUCHOS_UNIT_TEST(NodalLoads, ValuesThatAreNotFiniteAreRefused) {
  const auto solid = makeSolid(Topology::Hex8, {2, 1, 1});
  auto f = zeroLoad(solid);
  try {
    addPressure(
        solid.coordinates, solid.groups[0], sidesAt(solid, 0, 1.0),
        [](double x, double, double) { return std::log(0.5 - x); }, f);
    TEST_ASSERT(false);
  } catch (const InputError& error) {
    out << error.what() << "\n";
    TEST_ASSERT(std::string(error.what()).find("element 1002 (HEX8) of block \"cube\"") != std::string::npos);
  }
  TEST_THROW(addBodyForce(
                 solid.coordinates, solid.groups[0],
                 [](double, double, double) {
                   return std::array<double, 3>{0, HUGE_VAL, 0};
                 },
                 f),
             InputError);
  TEST_THROW(addTraction(
                 solid.coordinates, solid.groups[0], sidesAt(solid, 0, 0.0),
                 [](double, double, double) {
                   return std::array<double, 3>{0, 0, std::nan("")};
                 },
                 f),
             InputError);
}

}  // namespace
