// SPDX-License-Identifier: BSD-3-Clause
// A plate in two parts, one of them on a block, the other one on a rigid plane, dealt to the ranks whoever has the pairs.
#include "Haptos_ThinBodies.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <array>
#include <cmath>
#include <vector>

#include "Haptos_NodeNeighbours.hpp"

namespace {

using namespace Haptos;

constexpr int kAcross = 6;  // elements along y
constexpr double kThickness = 0.02;

// n x 6 x 1 elements of HEX8 from x = from to from + 1; nodes are numbered from `first`, those at its left end as `left` has them.
struct Box {
  int n;
  Coordinates coordinates;
  std::vector<std::int64_t> nodes;
  std::vector<ElementGroup> groups = std::vector<ElementGroup>(1);

  Box(int divisions, std::int64_t first, double from, double bottom, double top, const Box* left = nullptr) : n(divisions) {
    for (int k = 0; k < 2; ++k)
      for (int j = 0; j <= kAcross; ++j)
        for (int i = 0; i <= n; ++i) {
          nodes.push_back(left && i == 0 ? left->nodes[std::size_t(left->at(left->n, j, k))] : first + std::int64_t(nodes.size()));
          coordinates.push_back({from + double(i) / n, double(j) / kAcross, k == 0 ? bottom : top});
        }
    for (int j = 0; j < kAcross; ++j)
      for (int i = 0; i < n; ++i)
        for (int k = 0; k < 2; ++k)
          for (const auto& [a, b] : {std::array{0, 0}, {1, 0}, {1, 1}, {0, 1}}) groups[0].connectivity.push_back(at(i + a, j + b, k));
  }
  int at(int i, int j, int k) const { return (k * (kAcross + 1) + j) * (n + 1) + i; }
  int numNodes() const { return int(nodes.size()); }
  std::int64_t bottom(int node) const { return nodes[std::size_t(node)]; }
  std::int64_t top(int node) const { return nodes[std::size_t(numNodes() / 2 + node)]; }
};

struct Scene {
  Box block{6, 0, 0, -1, 0}, plate{6, 98, 0, 0, kThickness}, more{3, 196, 1, 0, kThickness, &plate};
  std::array<const Box*, 3> boxes{&block, &plate, &more};
  std::vector<SubdomainNodes> weights;
  std::vector<int> own;  // boxes

  // Pressed: the plate, from above, as far as the block goes.
  explicit Scene(bool isPressed, const std::array<double, 3>& aspects = {1, 50, 50}) {
    const auto comm = Tpetra::getDefaultComm();
    std::vector<PartOfBody> parts;
    for (int b = 0; b < int(boxes.size()); ++b) {
      if ((b + 1) % comm->getSize() != comm->getRank()) continue;
      const Box& box = *boxes[std::size_t(b)];
      own.push_back(b);
      weights.push_back({b, box.nodes, std::vector<double>(std::size_t(box.numNodes()), 3.0)});
      const auto neighbours = [&box] { return nodeNeighbours(box.numNodes(), box.groups); };
      parts.push_back({b == 0 ? 0 : 1, aspects[std::size_t(b)], box.coordinates, neighbours});
    }
    std::vector<PlacedPair> pairs, mine;
    for (int node = 0; node < plate.numNodes() / 2; ++node) {
      pairs.push_back(pair(plate.bottom(node), block.top(node), -1));
      if (isPressed) pairs.push_back(pair(plate.top(node), -1, 1));
    }
    for (int node = 0; node < more.numNodes() / 2; ++node) pairs.push_back(pair(more.bottom(node), -1, -1));
    for (std::size_t i = 0; i < pairs.size(); ++i)
      if (int(i) % comm->getSize() == comm->getRank()) mine.push_back(pairs[i]);
    weighThinBodies(*comm, EvenRanges{252, comm->getSize()}, parts, mine, weights);
  }
  static PlacedPair pair(std::int64_t secondary, std::int64_t primary, double up) {
    ContactPair geometry{};
    geometry.secondaryNode = secondary;
    geometry.secondary = {{secondary, 1.0}};
    if (primary >= 0) geometry.primary = {{primary, 1.0}};
    geometry.frame = {{0, 0, up}, {1, 0, 0}, {0, up, 0}};
    return {0, int(secondary), geometry};
  }
};

double softened(double a2) {
  const double t2 = 0.5 * kThickness * kThickness;
  return 3 * 9 / ((2 * a2 + t2) * (2 / a2 + 1 / t2));
}

TEUCHOS_UNIT_TEST(ThinBodies, APlateIsSofterWhereItIsTouched) {
  const Scene scene(false);
  const double a = 1.0 / kAcross;
  for (std::size_t i = 0; i < scene.weights.size(); ++i) {
    const Box& box = *scene.boxes[std::size_t(scene.own[i])];
    const auto& values = scene.weights[i].stiffness;
    const auto value = [&](int x, int y, int z) { return values[std::size_t(box.at(x, y, z))]; };
    for (int x = 0; x <= box.n; ++x)
      for (int y = 0; y <= kAcross; ++y) {
        TEST_EQUALITY(value(x, y, 1), 3.0);
        TEST_COMPARE(value(x, y, 0), <, &box == &scene.block ? 3.1 : 3 * 9.5 * kThickness * kThickness / (a * a));
        TEST_EQUALITY(value(x, y, 0) == 3.0, &box == &scene.block);
      }
    if (&box == &scene.block) continue;
    TEST_FLOATING_EQUALITY(value(1, 3, 0), softened(2 * a * a / 3), 1e-12);
    // at the seam as the part with short elements has it, which has neighbours on one side only
    TEST_FLOATING_EQUALITY(value(&box == &scene.plate ? box.n : 0, 3, 0), softened(a * a / 2), 1e-12);
  }
}

TEUCHOS_UNIT_TEST(ThinBodies, NotBetweenTwoOthers) {
  const Scene scene(true);
  for (std::size_t i = 0; i < scene.weights.size(); ++i) {
    const Box& box = *scene.boxes[std::size_t(scene.own[i])];
    for (int node = 0; node < box.numNodes(); ++node) {
      const bool isAlone = &box == &scene.more && node < box.numNodes() / 2 && box.coordinates[std::size_t(node)][0] > 1;
      TEST_EQUALITY(scene.weights[i].stiffness[std::size_t(node)] < 3, isAlone);
    }
  }
}

// 49 of the nodes in pairs are of the part on the block, 28 of the other one: the body counts as the former does.
TEUCHOS_UNIT_TEST(ThinBodies, PartsOfABodyAreAlike) {
  const Scene all(false), most(false, {1, 50, 1}), few(false, {1, 1, 50});
  for (std::size_t i = 0; i < all.weights.size(); ++i) {
    TEST_EQUALITY(all.weights[i].stiffness == most.weights[i].stiffness, true);
    for (const double value : few.weights[i].stiffness) TEST_EQUALITY(value, 3.0);
  }
}

}  // namespace
