// SPDX-License-Identifier: BSD-3-Clause
// Ranks that hold shares of a mesh find what one that holds the whole finds, and none does much more than its share.
#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_DefaultSerialComm.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_ContactPairs.hpp"
#include "Haptos_CoordinateBlocks.hpp"
#include "Haptos_ElasticStiffness.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Exchange.hpp"
#include "Haptos_PieceCut.hpp"
#include "Haptos_Subdomain.hpp"
#include "Haptos_SubdomainCopies.hpp"
#include "Haptos_SubdomainOrder.hpp"

namespace {

using namespace Haptos;
using Index = std::int64_t;

const Teuchos::SerialComm<int> alone;

BoxSpec box(const std::string& name, double x, std::array<int, 3> divisions, Topology topology = Topology::Hex8) {
  BoxSpec spec;
  spec.blockName = name;
  spec.lower = {x, 0, 0};
  spec.upper = {x + 1, 1, 1};
  spec.divisions = divisions;
  spec.topology = topology;
  spec.sideSetNames = {name + "_left", name + "_right", "", "", "", "top"};
  return spec;
}

// Nodes at one place become one.
void merge(Mesh& mesh) {
  std::map<std::array<double, 3>, Index> first;
  std::vector<Index> number;
  for (std::size_t i = 0; i < mesh.numNodes(); ++i) number.push_back(first.emplace(mesh.coordinates[i], Index(i)).first->second);
  for (auto& block : mesh.blocks)
    for (Index& node : block.connectivity) node = number[std::size_t(node)];
}

// The elements of every block, and all nodes, in a random order: ranges of either are scattered over the bodies.
void shuffle(Mesh& mesh) {
  std::mt19937 random(7);
  const auto permuted = [&](std::size_t n) {
    std::vector<Index> place(n);
    std::iota(place.begin(), place.end(), Index(0));
    std::shuffle(place.begin(), place.end(), random);
    return place;
  };
  const auto nodePlace = permuted(mesh.numNodes());
  const auto coordinates = mesh.coordinates;
  for (std::size_t i = 0; i < coordinates.size(); ++i) mesh.coordinates[std::size_t(nodePlace[i])] = coordinates[i];
  std::vector<Index> elementPlace;
  Index first = 0;
  for (auto& block : mesh.blocks) {
    const auto n = std::size_t(nodesPerElement(block.topology));
    const auto place = permuted(block.numElements());
    const auto before = block.connectivity;
    for (std::size_t e = 0; e < place.size(); ++e) {
      for (std::size_t i = 0; i < n; ++i) block.connectivity[std::size_t(place[e]) * n + i] = nodePlace[std::size_t(before[e * n + i])];
      elementPlace.push_back(first + place[e]);
    }
    first += Index(place.size());
  }
  for (auto& set : mesh.sideSets)
    for (auto& side : set.sides) side.element = elementPlace[std::size_t(side.element)];
}

// Six bodies of all kinds, two of them hinged at an edge, two side by side in one piece; a node without elements.
Mesh variedMesh(bool shuffled) {
  auto hinged = box("hinged", 21, {3, 3, 3});
  hinged.lower[2] = 1, hinged.upper[2] = 2;
  std::vector<BoxSpec> boxes{box("hexes", 0, {12, 5, 6}),           box("small", 5, {1, 1, 1}),
                             box("tets", 10, {5, 4, 6}, Topology::Tet4), box("cube", 20, {3, 3, 3}), hinged,
                             box("left", 30, {4, 4, 4}),            box("right", 31, {4, 4, 4})};
  Mesh mesh = makeBoxes(boxes);
  merge(mesh);
  if (shuffled) shuffle(mesh);
  return mesh;
}

struct Cut {
  OwnElements own;
  DualGraph graph;
  Bodies bodies;
  Partition partition;
};

Cut cutOn(const Communicator& comm, const MeshShare& share, const PartitionOptions& options) {
  Cut cut;
  cut.own = completeElements(comm, share);
  cut.graph = buildDualGraph(comm, cut.own);
  cut.bodies = findBodies(comm, cut.own, cut.graph);
  cut.partition = partitionMesh(comm, cut.own, cut.graph, cut.bodies, options);
  return cut;
}

PartitionOptions metis(int subdomains, Index wholeUpTo = 1000000, Index blockSize = 100) {
  PartitionOptions options;
  options.subdomains = subdomains;
  options.wholeUpTo = wholeUpTo;
  options.blockSize = blockSize;
  return options;
}

template <class T>
std::vector<T> slice(const std::vector<T>& all, Index begin, std::size_t size) {
  return {all.begin() + begin, all.begin() + begin + Index(size)};
}

}  // namespace

TEUCHOS_UNIT_TEST(DistributedCut, EqualsThatOfOneRank) {
  const auto comm = Tpetra::getDefaultComm();
  for (bool shuffled : {false, true})
    for (const auto& options : {metis(0), metis(60), metis(60, 50), metis(25, 200, 40)}) {
      const Mesh mesh = variedMesh(shuffled);
      const Cut one = cutOn(alone, sliceOfMesh(mesh, 0, 1), options), many = cutOn(*comm, scatterMesh(*comm, mesh), options);
      const Index first = many.own.firstElement();
      const std::size_t mine = many.own.part.elements.size();
      for (std::size_t e = 0; e < mine; ++e) {
        const auto row = std::size_t(first) + e, k = std::size_t(many.graph.offsets[e]), l = std::size_t(one.graph.offsets[row]);
        const auto length = std::size_t(many.graph.offsets[e + 1]) - k;
        TEST_EQUALITY(length, std::size_t(one.graph.offsets[row + 1]) - l);
        TEST_COMPARE_ARRAYS(slice(many.graph.neighbours, Index(k), length), slice(one.graph.neighbours, Index(l), length));
        TEST_COMPARE_ARRAYS(slice(many.graph.couplings, Index(k), length), slice(one.graph.couplings, Index(l), length));
      }
      TEST_EQUALITY(many.bodies.count(), 5);
      TEST_EQUALITY(many.bodies.pieces.count(), 6);
      TEST_COMPARE_ARRAYS(many.bodies.names, one.bodies.names);
      TEST_COMPARE_ARRAYS(many.bodies.ofPiece, one.bodies.ofPiece);
      TEST_COMPARE_ARRAYS(many.bodies.pieces.ofElement, slice(one.bodies.pieces.ofElement, first, mine));
      TEST_EQUALITY(many.partition.count, one.partition.count);
      TEST_EQUALITY(many.partition.mended, one.partition.mended);
      TEST_COMPARE_ARRAYS(many.partition.ofElement, slice(one.partition.ofElement, first, mine));
      TEST_COMPARE_ARRAYS(many.partition.bodyOfSubdomain, one.partition.bodyOfSubdomain);
      // parts are connected, whatever blocks they were cut from
      int pieces = 0;
      connectedComponents(one.graph, one.partition.ofElement, pieces);
      TEST_EQUALITY(pieces, one.partition.count);
    }
}

TEUCHOS_UNIT_TEST(DistributedCut, SubdomainsAreThoseOfOneRank) {
  const auto comm = Tpetra::getDefaultComm();
  const Mesh mesh = makeTwoBeams({1, 6});
  const auto interfaces = [&] {
    ContactSpec spec;
    spec.name = "contact";
    spec.secondarySideSet = "upper_contact";
    spec.primarySideSet = "lower_contact";
    return buildContact(mesh, {spec});
  }();
  Cut one = cutOn(alone, sliceOfMesh(mesh, 0, 1), metis(17)), many = cutOn(*comm, scatterMesh(*comm, mesh), metis(17));
  const auto before = one.partition.ofElement;
  const auto nodesOfOne = orderSubdomains(alone, one.own, interfaces, one.partition);
  const auto nodesOfMany = orderSubdomains(*comm, many.own, comm->getRank() == 0 ? interfaces : std::vector<ContactInterface>{}, many.partition);
  TEST_ASSERT(before != one.partition.ofElement);
  TEST_COMPARE_ARRAYS(nodesOfMany, nodesOfOne);
  TEST_COMPARE_ARRAYS(countNodes(*comm, many.own, many.partition), nodesOfOne);
  const auto whole = extractSubdomains(mesh, one.partition, {0, 1});
  const auto rankOf = dealToRanks(std::vector<double>(17, 1.0), comm->getSize());
  const auto mine = dealSubdomains(*comm, many.own, many.partition, rankOf, {0, 1});
  TEST_EQUALITY(std::count(rankOf.begin(), rankOf.end(), comm->getRank()), std::ptrdiff_t(mine.size()));
  for (const auto& sub : mine) {
    const Subdomain& same = whole[std::size_t(sub.id)];
    TEST_EQUALITY(rankOf[std::size_t(sub.id)], comm->getRank());
    TEST_EQUALITY(sub.body, same.body);
    TEST_COMPARE_ARRAYS(sub.nodes, same.nodes);
    TEST_COMPARE_ARRAYS(sub.elements, same.elements);
    TEST_ASSERT(sub.coordinates == same.coordinates);
    TEST_EQUALITY(nodesOfOne[std::size_t(sub.id)], sub.numNodes());
    for (std::size_t g = 0; g < sub.groups.size(); ++g) {
      TEST_COMPARE_ARRAYS(sub.groups[g].connectivity, same.groups[g].connectivity);
      TEST_COMPARE_ARRAYS(sub.groups[g].elementNumbers, same.groups[g].elementNumbers);
      TEST_EQUALITY(sub.groups[g].material, same.groups[g].material);
    }
    TEST_ASSERT(std::equal(sub.sides.begin(), sub.sides.end(), same.sides.begin(), same.sides.end(), [](const auto& a, const auto& b) {
      return a.sideSet == b.sideSet && a.group == b.group && a.element == b.element && a.side == b.side;
    }));
  }
}

// A third element at a side, wherever the three are held.
TEUCHOS_UNIT_TEST(DistributedCut, DoubledElementIsRefusedOnAllRanks) {
  const auto comm = Tpetra::getDefaultComm();
  for (std::size_t copied : {std::size_t(0), std::size_t(17), std::size_t(63)}) {
    Mesh mesh = makeBoxes({box("box", 0, {4, 4, 4})});
    auto& nodes = mesh.blocks[0].connectivity;
    const std::vector<Index> doubled(nodes.begin() + long(8 * copied), nodes.begin() + long(8 * copied + 8));
    nodes.insert(nodes.end(), doubled.begin(), doubled.end());
    mesh.elementNumbers.push_back(1000);
    std::string message;
    try {
      buildDualGraph(*comm, completeElements(*comm, scatterMesh(*comm, mesh)));
    } catch (const InputError& error) {
      message = error.what();
    }
    TEST_ASSERT(message.find(" 1000 share one side") != std::string::npos);
    TEST_ASSERT(message.find(std::to_string(copied + 1)) != std::string::npos);
  }
}

// More pieces than ranks: they are spread, and what a rank holds of them falls with the ranks.
TEUCHOS_UNIT_TEST(DistributedCut, WorkIsShared) {
  const auto comm = Tpetra::getDefaultComm();
  const int ranks = comm->getSize();
  const auto share = shareTwoBeams({1, 12}, comm->getRank(), ranks);
  const Cut cut = cutOn(*comm, share, metis(40, 500, 400));
  const auto rankOf = dealToRanks(std::vector<double>(std::size_t(cut.partition.count), 1.0), ranks);
  const auto mine = dealSubdomains(*comm, cut.own, cut.partition, rankOf, {0, 1});
  Index held = 0;
  for (const auto& sub : mine) held += Index(sub.elements.size());
  const double total = double(cut.own.elements.size);
  const Index work[] = {Index(cut.own.part.elements.size()), cut.partition.elementsCut, held, Index(cut.own.part.nodes.size())};
  Index largest[4], sum[4];
  Teuchos::reduceAll(*comm, Teuchos::REDUCE_MAX, 4, work, largest);
  Teuchos::reduceAll(*comm, Teuchos::REDUCE_SUM, 4, work, sum);
  for (int i = 0; i < 3; ++i) {
    TEST_EQUALITY(sum[i], Index(total));
    TEST_COMPARE(double(largest[i]), <=, 1.5 * total / ranks);
  }
  TEST_COMPARE(double(largest[3]), <=, 1.5 * double(cut.own.nodes.size) / ranks);
}

TEUCHOS_UNIT_TEST(DistributedCut, FailureIsThrownOnAllRanks) {
  const auto comm = Tpetra::getDefaultComm();
  const Mesh mesh = variedMesh(false);
  TEST_THROW(cutOn(*comm, scatterMesh(*comm, mesh), metis(5)), InputError);        // six pieces
  TEST_THROW(cutOn(*comm, scatterMesh(*comm, mesh), metis(1000000)), InputError);  // more than elements
}

// Layers stay together; numbers of points are as even as layers allow.
TEUCHOS_UNIT_TEST(CoordinateBlocks, CutsBetweenLayersAcrossTheLongestAxis) {
  const auto comm = Tpetra::getDefaultComm();
  const auto share = shareBoxes({box("long", 0, {13, 3, 2})}, comm->getRank(), comm->getSize());
  OwnElements own = completeElements(*comm, share);
  for (auto& x : own.part.mesh.coordinates) x[0] *= 5;
  const auto x = elementCentroids(own.part.mesh);
  std::vector<int> block;
  const auto sets = cutIntoBlocks(*comm, x, std::vector<int>(x.size(), 0), {3}, block);
  TEST_EQUALITY(sets.size(), std::size_t(3));
  for (std::size_t e = 0; e < x.size(); ++e) {  // 4, 5 and 4 layers, or 4, 4 and 5: the first cut is at 13/3, the second in the middle
    const int layer = int(13 * x[e][0] / 5);
    TEST_EQUALITY(block[e], layer < 4 ? 0 : layer < 9 ? block[e] : 2);
    TEST_ASSERT(layer < 4 || block[e] > 0);
  }
  // all points at one place cannot be cut
  const std::vector<std::array<double, 3>> same(x.size(), {1, 2, 3});
  TEST_EQUALITY(cutIntoBlocks(*comm, same, std::vector<int>(x.size(), 0), {4}, block).size(), std::size_t(1));
}

// Subdomains that are a class by an assembly are one by the guess, too; it is the same on any number of ranks.
TEUCHOS_UNIT_TEST(SubdomainCopies, AreThoseThatShareAnAssembly) {
  const auto comm = Tpetra::getDefaultComm();
  const Mesh beams = makeTwoBeams({1, 12});
  for (const auto& [mesh, options] : {std::pair(beams, metis(160, 500, 300)), {variedMesh(false), metis(60)}, {variedMesh(true), metis(60)}})
    for (bool alike : {true, false}) {
      std::vector<int> materialOfBlock(mesh.blocks.size(), 0), expected;
      if (!alike) std::iota(materialOfBlock.begin(), materialOfBlock.end(), 0);
      const Cut one = cutOn(alone, sliceOfMesh(mesh, 0, 1), options), many = cutOn(*comm, scatterMesh(*comm, mesh), options);
      const auto copyOf = findCopies(alone, one.own, one.partition, materialOfBlock);
      TEST_COMPARE_ARRAYS(findCopies(*comm, many.own, many.partition, materialOfBlock), copyOf);
      const auto subdomains = extractSubdomains(mesh, one.partition, materialOfBlock);
      const ElasticStiffness stiffness(subdomains, std::vector<IsotropicMaterial>(mesh.blocks.size()), Formulation::Standard);
      for (int s = 0; s < one.partition.count; ++s) expected.push_back(stiffness.copyOf(s) >= 0 ? stiffness.copyOf(s) : s);
      for (std::size_t s = 0; s < expected.size(); ++s) TEST_EQUALITY(copyOf[s], copyOf[std::size_t(expected[s])]);
      if (options.wholeUpTo > 500) continue;
      TEST_COMPARE_ARRAYS(copyOf, expected);  // blocks are copies, and their parts
      TEST_COMPARE(double(std::set<int>(copyOf.begin(), copyOf.end()).size()), <, (alike ? 0.3 : 0.6) * one.partition.count);
    }
}

// A rank of copies gets more subdomains, as many as balance what it does once a copy.
TEUCHOS_UNIT_TEST(SubdomainCopies, RanksShareWorkThatCopiesShare) {
  std::vector<int> distinct(80), halfCopies;
  std::iota(distinct.begin(), distinct.end(), 0);
  for (int s : distinct) halfCopies.push_back(std::min(s, 40));
  const std::vector<double> work(80, 1.0);
  for (int ranks : {2, 3, 4, 8}) {
    const auto plain = dealToRanks(work, ranks), dealt = dealCopiesToRanks(work, halfCopies, ranks);
    TEST_ASSERT(std::is_sorted(dealt.begin(), dealt.end()));
    const auto sums = workOfRanks(work, halfCopies, dealt, ranks), before = workOfRanks(work, halfCopies, plain, ranks);
    TEST_COMPARE(*std::max_element(sums.begin(), sums.end()), <, 0.9 * *std::max_element(before.begin(), before.end()));
    TEST_COMPARE(*std::max_element(sums.begin(), sums.end()), <, 1.1 * std::accumulate(sums.begin(), sums.end(), 0.0) / ranks);
    TEST_COMPARE_ARRAYS(dealCopiesToRanks(work, distinct, ranks), plain);
  }
}
