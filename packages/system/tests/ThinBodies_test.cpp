// SPDX-License-Identifier: BSD-3-Clause
// A plate in two parts on a block, dealt to the ranks: bodies are weighed, whoever has the pairs.
#include "Haptos_ThinBodies.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <array>
#include <cmath>
#include <vector>

#include "Haptos_NodeNeighbours.hpp"
#include "Haptos_PartShape.hpp"

namespace {

using namespace Haptos;

// n x n x 1 elements of HEX8; nodes are numbered from `first`.
struct Box {
  int n;
  std::int64_t first;
  Coordinates coordinates;
  std::vector<std::int64_t> nodes;
  std::vector<ElementGroup> groups = std::vector<ElementGroup>(1);

  Box(int divisions, std::int64_t firstNode, double from, double bottom, double top) : n(divisions), first(firstNode) {
    for (int k = 0; k < 2; ++k)
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
          nodes.push_back(first + std::int64_t(coordinates.size()));
          coordinates.push_back({from + double(i) / n, double(j) / n, k == 0 ? bottom : top});
        }
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        for (int k = 0; k < 2; ++k)
          for (const auto& [a, b] : {std::array{0, 0}, {1, 0}, {1, 1}, {0, 1}}) groups[0].connectivity.push_back((k * (n + 1) + j + b) * (n + 1) + i + a);
  }
  int numNodes() const { return int(nodes.size()); }
  std::int64_t at(bool isTop, int node) const { return first + (isTop ? numNodes() / 2 : 0) + node; }
};

struct Scene {
  // a block, and a plate in two parts: the second one is touched nowhere
  std::vector<Box> boxes{{6, 0, 0, -1, 0}, {6, 98, 0, 0, 0.02}, {6, 196, 1, 0, 0.02}};
  std::vector<SubdomainNodes> weights;
  std::vector<int> own;  // boxes

  explicit Scene(bool isPressedFromAbove) {
    const auto comm = Tpetra::getDefaultComm();
    std::vector<PartOfBody> parts;
    std::vector<PlacedPair> pairs;
    for (int b = 0; b < int(boxes.size()); ++b) {
      if ((b + 1) % comm->getSize() != comm->getRank()) continue;
      const Box& box = boxes[std::size_t(b)];
      own.push_back(b);
      weights.push_back({b, box.nodes, std::vector<double>(std::size_t(box.numNodes()), 3.0)});
      const auto neighbours = [&box] { return nodeNeighbours(box.numNodes(), box.groups); };
      parts.push_back({b == 0 ? 0 : 1, aspectOfPart(box.coordinates, neighbours()), box.coordinates, neighbours});
    }
    for (int node = comm->getRank(); node < 49; node += comm->getSize()) {
      pairs.push_back(pair(boxes[1].at(false, node), boxes[0].at(true, node), -1));
      if (isPressedFromAbove) pairs.push_back(pair(boxes[1].at(true, node), -1, 1));  // a rigid plane
    }
    weighThinBodies(*comm, EvenRanges{294, comm->getSize()}, parts, pairs, weights);
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

TEUCHOS_UNIT_TEST(ThinBodies, APlateOnABlockIsSofter) {
  const Scene scene(false);
  const double a2 = 1.0 / 36, t2 = 0.02 * 0.02;
  for (std::size_t i = 0; i < scene.weights.size(); ++i)
    for (const double value : scene.weights[i].stiffness) {
      TEST_EQUALITY(value, scene.weights[i].stiffness[0]);
      if (scene.own[i] == 0) TEST_EQUALITY(value, 3.0);
      if (scene.own[i] > 0) TEST_ASSERT(value > 3 * 3 * t2 / a2 && value < 3 * 6 * t2 / a2);
    }
}

TEUCHOS_UNIT_TEST(ThinBodies, NotBetweenTwoOthers) {
  for (const auto& part : Scene(true).weights)
    for (const double value : part.stiffness) TEST_EQUALITY(value, 3.0);
}

}  // namespace
