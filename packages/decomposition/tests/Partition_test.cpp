// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Partition.hpp"

#include <Teuchos_DefaultSerialComm.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <set>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_RoundParts.hpp"
#include "Haptos_SmoothWalls.hpp"

namespace {

using namespace Haptos;

Mesh box(std::array<int, 3> divisions, Topology topology = Topology::Hex8) {
  BoxSpec spec;
  spec.blockName = "box";
  spec.divisions = divisions;
  spec.topology = topology;
  return makeBoxes({spec});
}

const Teuchos::SerialComm<int> alone;

DualGraph graphOf(const Mesh& mesh) { return buildDualGraph(alone, wholeMesh(mesh)); }

Bodies bodiesOf(const Mesh& mesh) { return findBodies(alone, wholeMesh(mesh), graphOf(mesh)); }

Partition cut(const Mesh& mesh, const PartitionOptions& options) {
  return partitionMesh(alone, wholeMesh(mesh), graphOf(mesh), bodiesOf(mesh), options);
}

PartitionOptions metis(int subdomains, int seed = 1) {
  PartitionOptions options;
  options.subdomains = subdomains;
  options.seed = seed;
  return options;
}

PartitionOptions bricks(std::vector<int> part) {
  PartitionOptions options;
  options.method = PartitionMethod::Bricks;
  options.bricks = std::move(part);
  return options;
}

// Neighbours through whole sides, found from sets of nodes: independent of the dual graph.
std::vector<std::vector<int>> neighboursThroughSides(const Mesh& mesh) {
  std::map<std::set<std::int64_t>, std::vector<int>> sides;
  int element = 0;
  for (const auto& block : mesh.blocks) {
    const int n = nodesPerElement(block.topology);
    for (std::size_t e = 0; e < block.numElements(); ++e, ++element)
      for (int s = 0; s < sidesPerElement(block.topology); ++s) {
        std::set<std::int64_t> nodes;
        for (const int i : sideNodes(block.topology, s)) nodes.insert(block.connectivity[e * n + i]);
        sides[nodes].push_back(element);
      }
  }
  std::vector<std::vector<int>> result(element);
  for (const auto& [nodes, elements] : sides)
    if (elements.size() == 2) {
      result[elements[0]].push_back(elements[1]);
      result[elements[1]].push_back(elements[0]);
    }
  return result;
}

// Number of side-connected pieces of all parts; equals the number of parts if every part is connected.
int countPieces(const Mesh& mesh, const std::vector<int>& part) {
  const auto neighbours = neighboursThroughSides(mesh);
  std::vector<char> seen(part.size(), 0);
  int pieces = 0;
  for (std::size_t start = 0; start < part.size(); ++start) {
    if (seen[start]) continue;
    ++pieces;
    std::queue<int> front;
    front.push(int(start));
    seen[start] = 1;
    for (; !front.empty(); front.pop())
      for (int other : neighbours[front.front()])
        if (!seen[other] && part[other] == part[front.front()]) seen[other] = 1, front.push(other);
  }
  return pieces;
}

void checkParts(const Mesh& mesh, const Partition& partition, Teuchos::FancyOStream& out, bool& success) {
  const std::set<int> used(partition.ofElement.begin(), partition.ofElement.end());
  TEST_EQUALITY(int(used.size()), partition.count);
  TEST_EQUALITY(*used.begin(), 0);
  TEST_EQUALITY(*used.rbegin(), partition.count - 1);
  TEST_EQUALITY(countPieces(mesh, partition.ofElement), partition.count);
  TEST_EQUALITY(int(partition.bodyOfSubdomain.size()), partition.count);
  TEST_ASSERT(std::is_sorted(partition.bodyOfSubdomain.begin(), partition.bodyOfSubdomain.end()));
  const Bodies bodies = bodiesOf(mesh);
  for (std::size_t e = 0; e < partition.ofElement.size(); ++e)
    TEST_EQUALITY(bodies.ofPiece[bodies.pieces.ofElement[e]], partition.bodyOfSubdomain[partition.ofElement[e]]);
}

// Two cubes that share the two nodes of one edge.
Mesh hinge() {
  BoxSpec left, right;
  left.blockName = "left";
  right.blockName = "right";
  left.divisions = right.divisions = {2, 2, 2};
  right.lower = {1, 0, 1};
  right.upper = {2, 1, 2};
  Mesh mesh = makeBoxes({left, right});
  for (auto& node : mesh.blocks[1].connectivity)
    for (std::int64_t other = 0; other < 27; ++other)
      if (mesh.coordinates[other] == mesh.coordinates[node]) {
        node = other;
        break;
      }
  return mesh;
}

}  // namespace

TEUCHOS_UNIT_TEST(Partition, MetisPartsAreConnectedThroughSides) {
  for (const auto topology : {Topology::Hex8, Topology::Tet4})
    for (const auto& divisions : {std::array<int, 3>{7, 5, 3}, std::array<int, 3>{12, 2, 1}, std::array<int, 3>{9, 9, 1}}) {
      const Mesh mesh = box(divisions, topology);
      for (int parts : {1, 4, 11, 17})
        for (int seed : {1, 2, 3}) {
          const Partition partition = cut(mesh, metis(parts, seed));
          checkParts(mesh, partition, out, success);
          TEST_EQUALITY(partition.count, parts);
        }
    }
}

// A 6 x 1 x 1 row coloured 0 0 1 0 2 2: the single 0 touches parts 1 and 2 by one side each.
TEUCHOS_UNIT_TEST(Partition, FragmentsAreMended) {
  const Mesh row = box({6, 1, 1});
  const Partition partition = cut(row, bricks({0, 0, 1, 0, 2, 2}));
  TEST_EQUALITY(partition.mended, 1);
  TEST_EQUALITY(partition.count, 3);
  TEST_EQUALITY(partition.ofElement[0], 0);
  TEST_EQUALITY(partition.ofElement[1], 0);
  TEST_ASSERT(partition.ofElement[3] != 0);
  checkParts(row, partition, out, success);
}

// The single 2 in the middle touches part 0 by three sides and part 1 by one.
TEUCHOS_UNIT_TEST(Partition, FragmentGoesToTheNeighbourWithMostSides) {
  const Mesh plate = box({5, 3, 1});
  const Partition partition = cut(plate, bricks({0, 0, 0, 2, 2,
                                                 0, 2, 0, 2, 2,
                                                 1, 1, 1, 1, 1}));
  TEST_EQUALITY(partition.mended, 1);
  TEST_EQUALITY(partition.count, 3);
  TEST_EQUALITY(partition.ofElement[6], partition.ofElement[0]);
  TEST_EQUALITY(partition.ofElement[8], partition.ofElement[3]);
  checkParts(plate, partition, out, success);
}

// Every cell is a fragment by itself, and its neighbours are too: they must not change places for ever.
TEUCHOS_UNIT_TEST(Partition, ChequeredColoursAreMended) {
  const Mesh mesh = box({6, 5, 2});
  std::vector<int> colours;
  for (std::size_t e = 0; e < mesh.numElements(); ++e) colours.push_back(int(e % 6 + e / 6) % 3);
  const int before = countPieces(mesh, colours);
  const Partition partition = cut(mesh, bricks(colours));
  TEST_ASSERT(before > partition.count);
  TEST_ASSERT(partition.mended > 20 && partition.mended <= before - 3);
  TEST_EQUALITY(partition.count, 3);
  checkParts(mesh, partition, out, success);
}

TEUCHOS_UNIT_TEST(Partition, HingedBodyIsCutAtTheHinge) {
  const Mesh mesh = hinge();
  TEST_EQUALITY(bodiesOf(mesh).count(), 1);
  PartitionOptions block;
  block.method = PartitionMethod::Block;
  const Partition whole = cut(mesh, block);
  TEST_EQUALITY(whole.count, 2);
  TEST_EQUALITY(whole.bodyOfSubdomain[1], 0);
  checkParts(mesh, whole, out, success);
  const Partition parts = cut(mesh, metis(5));
  TEST_EQUALITY(parts.count, 5);
  checkParts(mesh, parts, out, success);
  TEST_THROW(cut(mesh, metis(1)), InputError);
}

// The middle layer of nodes pushed together along y: elements above and below share sides that are lines, up to round-off.
TEUCHOS_UNIT_TEST(Partition, SidesWithoutAreaAreRefused) {
  for (const double width : {0.0, 1e-12, 1e-6}) {
    Mesh mesh = box({2, 2, 2});
    for (auto& x : mesh.coordinates)
      if (x[2] == 0.5) x[1] *= width;
    std::string message;
    try {
      graphOf(mesh);
    } catch (const InputError& e) {
      message = e.what();
    }
    out << message << "\n";
    TEST_EQUALITY(message.find("elements 1 and 5 share a side without area") != std::string::npos, width < 1e-10);
  }
}

TEUCHOS_UNIT_TEST(Partition, BodiesAreCutByThemselves) {
  BoxSpec small, large;
  small.blockName = "small";
  small.divisions = {2, 1, 1};
  large.blockName = "large";
  large.lower = {0, 0, 2};
  large.upper = {1, 1, 3};
  large.divisions = {4, 4, 4};
  const Mesh mesh = makeBoxes({small, large});
  const Partition partition = cut(mesh, metis(9));
  checkParts(mesh, partition, out, success);
  TEST_EQUALITY(partition.count, 9);
  TEST_EQUALITY(partition.bodyOfSubdomain.front(), 0);
  TEST_EQUALITY(std::count(partition.bodyOfSubdomain.begin(), partition.bodyOfSubdomain.end(), 0), 1);
}

TEUCHOS_UNIT_TEST(Partition, OneElementPerSubdomainAndNoMore) {
  const Mesh mesh = box({3, 2, 1});
  const Partition partition = cut(mesh, metis(6));
  TEST_EQUALITY(partition.count, 6);
  checkParts(mesh, partition, out, success);
  TEST_THROW(cut(mesh, metis(7)), InputError);
}

TEUCHOS_UNIT_TEST(DualGraph, CouplingIsAreaOverDistance) {
  BoxSpec spec;
  spec.upper = {6, 2, 0.2};
  spec.divisions = {3, 2, 2};  // cells of 2 x 1 x 0.1
  const DualGraph graph = graphOf(makeBoxes({spec}));
  TEST_EQUALITY(graph.couplings.size(), graph.neighbours.size());
  for (int e = 0; e < 12; ++e)
    for (auto k = graph.offsets[e]; k < graph.offsets[e + 1]; ++k) {
      const int step = std::abs(int(graph.neighbours[k]) - e);
      TEST_FLOATING_EQUALITY(graph.couplings[k], step == 1 ? 0.05 : step == 3 ? 0.2 : 20.0, 1e-12);
    }
  // a tetrahedron of Kuhn's subdivision has sides of area 1/2 and sqrt(2)/2
  const DualGraph kuhn = graphOf(box({1, 1, 1}, Topology::Tet4));
  for (double coupling : kuhn.couplings) TEST_FLOATING_EQUALITY(coupling, std::sqrt(0.5) / std::sqrt(2.0 / 16.0), 1e-12);
}

// Layers of flat elements are far stiffer across than along: cuts stand across the plate.
TEUCHOS_UNIT_TEST(Partition, FlatElementsStayTogetherAcrossThePlate) {
  BoxSpec spec;
  spec.upper = {1, 1, 0.003};
  spec.divisions = {10, 10, 3};
  const Mesh mesh = makeBoxes({spec});
  for (int seed : {1, 2, 3}) {
    const Partition partition = cut(mesh, metis(6, seed));
    for (int e = 0; e < 100; ++e)
      for (int layer : {1, 2}) TEST_EQUALITY(partition.ofElement[e], partition.ofElement[e + 100 * layer]);
  }
}

TEUCHOS_UNIT_TEST(Partition, MetisPartsAreRoundAndOfOneSize) {
  const Mesh mesh = box({12, 12, 12});
  const auto x = elementCentroids(mesh);
  for (int seed : {1, 2, 3}) {
    const Partition partition = cut(mesh, metis(20, seed));
    std::vector<int> size(20, 0);
    std::vector<std::array<double, 3>> centre(20, {0, 0, 0});
    for (int e = 0; e < 1728; ++e) {
      ++size[partition.ofElement[e]];
      for (int d = 0; d < 3; ++d) centre[partition.ofElement[e]][d] += x[e][d];
    }
    double spread = 0;  // mean squared distance to the centre of the part
    for (int e = 0; e < 1728; ++e)
      for (int d = 0; d < 3; ++d)
        spread += std::pow(x[e][d] - centre[partition.ofElement[e]][d] / size[partition.ofElement[e]], 2) / 1728;
    const auto [least, most] = std::minmax_element(size.begin(), size.end());
    TEST_COMPARE(*least, >, 0.8 * 1728 / 20);
    TEST_COMPARE(*most, <, 1.2 * 1728 / 20);
    TEST_COMPARE(spread, <, 1.1 * std::pow(1.0 / 20, 2.0 / 3) / 4);  // 1.1 times that of cubes of this volume
  }
}

// Halves that meet in a comb: the teeth are taken in.
TEUCHOS_UNIT_TEST(RoundParts, TakesTeethIn) {
  const Mesh mesh = box({8, 8, 1});
  std::vector<int> part(64);
  for (int e = 0; e < 64; ++e) part[e] = e % 8 < ((e / 8) % 2 ? 7 : 1);
  roundParts(graphOf(mesh), elementCentroids(mesh), {32.0, 32.0}, part);
  TEST_EQUALITY(std::count(part.begin(), part.end(), 0), 32);
  for (int e = 0; e < 64; ++e) TEST_EQUALITY(part[e], e % 8 < 4 ? 1 : 0);
  std::vector<int> single{0, 1};  // no part loses its last element
  const Mesh pair = box({2, 1, 1});
  roundParts(graphOf(pair), elementCentroids(pair), {2.0, 0.001}, single);
  TEST_EQUALITY(std::count(single.begin(), single.end(), 0), 1);
}

std::size_t sidesCut(const DualGraph& graph, const std::vector<int>& part) {
  std::size_t cut = 0;
  for (std::size_t e = 0; e < part.size(); ++e)
    for (auto k = graph.offsets[e]; k < graph.offsets[e + 1]; ++k) cut += part[std::size_t(graph.neighbours[std::size_t(k)])] != part[e];
  return cut / 2;
}

// Halves of a box whose wall has a tooth of two by two by two elements: it goes, and a flat wall stays.
TEUCHOS_UNIT_TEST(SmoothWalls, TakesTeethOff) {
  const Mesh mesh = box({8, 8, 8});
  const DualGraph graph = graphOf(mesh);
  std::vector<int> flat(512), part;
  for (int e = 0; e < 512; ++e) flat[std::size_t(e)] = e % 8 < 4 ? 0 : 1;
  part = flat;
  smoothWalls(graph, part);
  TEST_ASSERT(part == flat);
  for (int x : {4, 5})
    for (int y : {3, 4})
      for (int z : {3, 4}) part[std::size_t(x + 8 * y + 64 * z)] = 0;
  TEST_EQUALITY(sidesCut(graph, part), 80);
  smoothWalls(graph, part);
  TEST_ASSERT(part == flat);
}

// A wall through tetrahedra that knows their centroids alone cuts a third more sides than one between cells.
TEUCHOS_UNIT_TEST(SmoothWalls, FindsWallsOfTetrahedra) {
  const Mesh mesh = box({6, 6, 6}, Topology::Tet4);
  const DualGraph graph = graphOf(mesh);
  std::vector<int> part;
  for (const auto& x : elementCentroids(mesh)) part.push_back(x[0] + 0.05 * x[1] < 0.57 ? 0 : 1);
  const std::size_t jagged = sidesCut(graph, part);
  smoothWalls(graph, part);
  out << jagged << " sides, then " << sidesCut(graph, part) << "\n";
  TEST_EQUALITY(sidesCut(graph, part), 72);  // two of each of 36 cells
  TEST_COMPARE(double(jagged), >, 1.3 * 72);
}

// What is cut falls most where a small part is taken in as a whole: none becomes more than a fifth smaller than the mean.
TEUCHOS_UNIT_TEST(SmoothWalls, LeavesPartsTheirSize) {
  const Mesh mesh = box({12, 12, 12});
  const DualGraph graph = graphOf(mesh);
  for (int seed = 1; seed <= 10; ++seed) {
    std::vector<int> part(1728);
    for (std::size_t e = 0; e < part.size(); ++e) part[e] = int(e % 12 / 4 + e / 12 % 12 / 4 * 3 + e / 144 / 4 * 9);  // 27 cubes
    for (std::size_t e = std::size_t(seed); e < part.size(); e += 7 + std::size_t(seed)) part[e] = (part[e] + seed) % 27;
    std::vector<int> before(27, 0), after(27, 0);
    for (int p : part) ++before[std::size_t(p)];
    smoothWalls(graph, part);
    for (int p : part) ++after[std::size_t(p)];
    for (std::size_t p = 0; p < 27; ++p) TEST_ASSERT(after[p] >= std::min(before[p], 52) && after[p] <= std::max(before[p], 76));
  }
  // Layers, two and one element thick by turns: the thin ones, of two thirds of the mean, give nothing away.
  std::vector<int> layers(1728);
  for (std::size_t e = 0; e < layers.size(); ++e) layers[e] = int(e / 144 / 3 * 2 + e / 144 % 3 / 2);
  std::vector<int> smooth = layers;
  smoothWalls(graph, smooth);
  for (int p = 0; p < 8; ++p) TEST_COMPARE(std::count(smooth.begin(), smooth.end(), p), >=, p % 2 == 0 ? 173 : 144);
  std::vector<int> single{0, 1};
  smoothWalls(graphOf(box({2, 1, 1})), single);
  TEST_ASSERT(single == std::vector<int>({0, 1}));
}

TEUCHOS_UNIT_TEST(Partition, RanksGetContiguousGroups) {
  const auto ranks = dealToRanks({1, 1, 1, 1, 4, 1, 1}, 3);
  TEST_ASSERT(std::is_sorted(ranks.begin(), ranks.end()));
  TEST_EQUALITY(ranks.front(), 0);
  TEST_EQUALITY(ranks.back(), 2);
  for (int rank : dealToRanks({2, 1}, 5)) TEST_ASSERT(rank >= 0 && rank < 5);  // ranks without subdomains
}

// Parts that reach into two bodies cannot stay one.
TEUCHOS_UNIT_TEST(Partition, BricksAcrossBodiesAreSplit) {
  BoxSpec lower, upper;
  lower.blockName = "lower";
  lower.divisions = upper.divisions = {2, 1, 1};
  upper.blockName = "upper";
  upper.lower = {0, 0, 2};
  upper.upper = {1, 1, 3};
  const Mesh mesh = makeBoxes({lower, upper});
  const Partition partition = cut(mesh, bricks({0, 0, 0, 0}));
  TEST_EQUALITY(partition.count, 2);
  TEST_ASSERT(partition.mended > 0);
  checkParts(mesh, partition, out, success);
}
