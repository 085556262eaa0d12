// SPDX-License-Identifier: BSD-3-Clause
// Elements that an application brings, each by itself: what they are cut into depends on them alone.
#include <Teuchos_DefaultSerialComm.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <algorithm>
#include <random>
#include <set>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_ElementCut.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Rendezvous.hpp"

namespace {

using namespace Haptos;

// Far apart and in no order.
std::int64_t idOf(std::int64_t node, int body) { return 1000000007 * ((37 * node) % 1009) + body; }

// One body of bricks on [x, x + 1] x [0, 1]^2; matrices hold nothing but their element's number, which must arrive with it.
void addBox(int body, double x, std::array<int, 3> divisions, std::vector<ElementMatrix>& elements) {
  BoxSpec spec;
  spec.blockName = "box";
  spec.lower = {x, 0, 0};
  spec.upper = {x + 1, 1, 1};
  spec.divisions = divisions;
  const Mesh mesh = makeBoxes({spec});
  const auto& nodes = mesh.blocks[0].connectivity;
  for (std::size_t e = 0; e < mesh.blocks[0].numElements(); ++e) {
    ElementMatrix element{body, {}, std::vector<double>(576, double(elements.size())), {}};
    for (std::size_t i = 8 * e; i < 8 * e + 8; ++i) {
      element.nodes.push_back(idOf(nodes[i], body));
      element.places.push_back(mesh.coordinates[std::size_t(nodes[i])]);
    }
    elements.push_back(std::move(element));
  }
}

std::vector<ElementMatrix> twoBoxes() {
  std::vector<ElementMatrix> elements;
  addBox(0, 0, {8, 7, 5}, elements);
  addBox(1, 2, {6, 5, 4}, elements);
  return elements;
}

// What this rank brings of them, in an order of its own.
std::vector<ElementMatrix> dealt(const Communicator& comm, const std::vector<ElementMatrix>& all, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<ElementMatrix> mine;
  for (const auto& element : all)
    if (int(random() % unsigned(comm.getSize())) == comm.getRank()) mine.push_back(element);
  std::shuffle(mine.begin(), mine.end(), std::mt19937(seed + unsigned(comm.getRank())));
  return mine;
}

struct Part {
  int body;
  std::vector<double> elements;  // by their matrices
  auto parts() { return std::tie(body, elements); }
  bool operator==(const Part& other) const { return body == other.body && elements == other.elements; }
};

// Subdomains of all ranks, by number.
std::vector<Part> cut(const Communicator& comm, const std::vector<ElementMatrix>& mine, const PartitionOptions& options) {
  std::vector<Part> parts;
  for (const auto& part : cutElements(comm, mine, options)) {
    parts.push_back({part.body, {}});
    for (const auto& element : part.elements) parts.back().elements.push_back(element.K.back());
  }
  return gatheredOnAll(comm, parts);
}

PartitionOptions inParts(int subdomains) {
  PartitionOptions options;
  options.subdomains = subdomains;
  return options;
}

const Teuchos::SerialComm<int> alone;

}  // namespace

TEUCHOS_UNIT_TEST(ElementCut, DependsOnTheElementsAlone) {
  const auto comm = Tpetra::getDefaultComm();
  const auto all = twoBoxes();
  PartitionOptions inBlocks = inParts(12);  // as a large body is cut: 280 elements in 5 blocks of three parts or less
  inBlocks.wholeUpTo = 100, inBlocks.blockSize = 60;
  for (const auto& options : {inParts(7), inParts(0), inBlocks}) {
    const auto expected = cut(alone, all, options);
    TEST_EQUALITY(expected.size(), std::size_t(options.subdomains > 0 ? options.subdomains : 2));
    std::multiset<double> seen;
    for (const Part& part : expected) {
      TEST_ASSERT(!part.elements.empty());
      seen.insert(part.elements.begin(), part.elements.end());
    }
    TEST_EQUALITY(seen.size(), all.size());
    TEST_EQUALITY(std::set<double>(seen.begin(), seen.end()).size(), all.size());
    for (unsigned seed : {1u, 2u}) TEST_ASSERT(cut(*comm, dealt(*comm, all, seed), options) == expected);
    TEST_ASSERT(cut(*comm, comm->getRank() == comm->getSize() - 1 ? all : std::vector<ElementMatrix>{}, options) == expected);
  }
}

TEUCHOS_UNIT_TEST(ElementCut, AnEdgeInCommonIsNoSide) {
  const auto comm = Tpetra::getDefaultComm();
  std::vector<ElementMatrix> elements;
  addBox(0, 0, {2, 2, 1}, elements);
  elements = {elements[0], elements[3]};  // across the corner
  std::string text;
  try {
    cut(*comm, dealt(*comm, elements, 1), inParts(2));
  } catch (const InputError& e) {
    text = e.what();
  }
  TEST_ASSERT(text.find("Body 0 is in pieces") != std::string::npos);
  elements[1].body = 1;
  TEST_EQUALITY(cut(*comm, dealt(*comm, elements, 1), inParts(2)).size(), std::size_t(2));  // two bodies
}
