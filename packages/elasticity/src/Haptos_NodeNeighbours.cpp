// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NodeNeighbours.hpp"

#include <Teuchos_Assert.hpp>
#include <algorithm>

namespace Haptos {
namespace {

struct ElementReference {
  const int* nodes;
  int numNodes;
};

// Groups may have different shapes; here only their nodes count.
std::vector<ElementReference> listElements(const std::vector<ElementGroup>& groups) {
  std::vector<ElementReference> elements;
  for (const auto& group : groups)
    for (int e = 0; e < group.numElements(); ++e)
      elements.push_back({group.nodes(e), nodesPerElement(group.topology)});
  return elements;
}

// By counting: how many each node has, where its list begins, then the elements in their order.
IndexLists elementsOfNodes(int numNodes, const std::vector<ElementReference>& elements) {
  IndexLists lists;
  lists.offsets.assign(std::size_t(numNodes) + 1, 0);
  for (const auto& element : elements)
    for (int a = 0; a < element.numNodes; ++a) {
      TEUCHOS_ASSERT(element.nodes[a] >= 0 && element.nodes[a] < numNodes);
      ++lists.offsets[std::size_t(element.nodes[a]) + 1];
    }
  for (std::size_t i = 0; i < std::size_t(numNodes); ++i) lists.offsets[i + 1] += lists.offsets[i];
  // The second pass fills what the first counted; `next` is where each list goes on.
  lists.items.resize(std::size_t(lists.offsets.back()));
  auto next = lists.offsets;
  for (std::size_t e = 0; e < elements.size(); ++e)
    for (int a = 0; a < elements[e].numNodes; ++a)
      lists.items[std::size_t(next[std::size_t(elements[e].nodes[a])]++)] = int(e);
  return lists;
}

}  // namespace

IndexLists nodeNeighbours(int numNodes, const std::vector<ElementGroup>& groups) {
  const auto elements = listElements(groups);
  const auto elementsOf = elementsOfNodes(numNodes, elements);
  IndexLists lists;
  lists.offsets.reserve(std::size_t(numNodes) + 1);
  lists.offsets.push_back(0);
  // Who saw a node last tells whether it is in the list already: no set, no clearing.
  std::vector<int> seenBy(std::size_t(numNodes), -1);
  for (int node = 0; node < numNodes; ++node) {
    for (const int* e = elementsOf.begin(node); e != elementsOf.end(node); ++e) {
      const auto& element = elements[std::size_t(*e)];
      for (int a = 0; a < element.numNodes; ++a) {
        int& seen = seenBy[std::size_t(element.nodes[a])];
        if (seen == node) continue;
        seen = node;
        lists.items.push_back(element.nodes[a]);
      }
    }
    std::sort(lists.items.begin() + lists.offsets.back(), lists.items.end());
    lists.offsets.push_back(std::int64_t(lists.items.size()));
  }
  return lists;
}

}  // namespace Haptos
