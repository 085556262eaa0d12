// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_HardElements.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>

#include "Haptos_ElementShape.hpp"

namespace {

using namespace Haptos;

// One element with corners at those of a box.
Subdomain boxOf(Topology topology, double x, double y, double z) {
  Subdomain sub;
  const std::array<std::array<double, 3>, 8> corners{{{0, 0, 0}, {x, 0, 0}, {x, y, 0}, {0, y, 0}, {0, 0, z}, {x, 0, z}, {x, y, z}, {0, y, z}}};
  sub.coordinates.assign(corners.begin(), corners.end());
  sub.coordinates.resize(std::size_t(elementShape(topology).numNodes));  // middle nodes are not looked at
  ElementGroup group;
  group.topology = topology;
  for (int i = 0; i < elementShape(topology).numNodes; ++i) group.connectivity.push_back(i);
  sub.groups.push_back(group);
  return sub;
}

bool isHard(const std::vector<Subdomain>& subdomains, double poissonsRatio) {
  IsotropicMaterial material;
  material.youngsModulus = 1;
  material.poissonsRatio = poissonsRatio;
  return hasHardElements(*Tpetra::getDefaultComm(), subdomains, {material});
}

}  // namespace

TEUCHOS_UNIT_TEST(HardElements, ByShapeOrderAndMaterial) {
  const Subdomain cube = boxOf(Topology::Hex8, 1, 1, 1);
  TEST_ASSERT(!isHard({}, 0.49));
  TEST_ASSERT(!isHard({cube}, 0.3));
  TEST_ASSERT(!isHard({cube}, 0.4));
  TEST_ASSERT(isHard({cube}, 0.41));
  TEST_ASSERT(!isHard({boxOf(Topology::Hex8, 1, 1, 3.9)}, 0.3));
  TEST_ASSERT(isHard({boxOf(Topology::Hex8, 1, 1, 4.1)}, 0.3));
  TEST_ASSERT(isHard({boxOf(Topology::Hex8, 0.2, 1, 1)}, 0.3));
  TEST_ASSERT(isHard({boxOf(Topology::Hex8, 1e-3, 1, 0)}, 0.3));  // flat: refused elsewhere
  TEST_ASSERT(isHard({boxOf(Topology::Hex20, 1, 1, 1)}, 0.3));
  TEST_ASSERT(isHard({cube, boxOf(Topology::Hex27, 1, 1, 1)}, 0.3));
  // single slivers are in every mesh
  Subdomain mixed = cube;
  const Subdomain sliver = boxOf(Topology::Hex8, 1, 1, 6);
  ElementGroup more = sliver.groups[0];
  for (int& node : more.connectivity) node += 8;
  mixed.coordinates.insert(mixed.coordinates.end(), sliver.coordinates.begin(), sliver.coordinates.end());
  mixed.groups.push_back(more);
  TEST_ASSERT(!isHard({mixed}, 0.3));
}

// One rank's elements are all ranks' matter.
TEUCHOS_UNIT_TEST(HardElements, OnAnyRank) {
  std::vector<Subdomain> mine;
  if (Tpetra::getDefaultComm()->getRank() == 0) mine.push_back(boxOf(Topology::Hex20, 1, 1, 1));
  TEST_ASSERT(isHard(mine, 0.3));
}
