// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SubdomainOrder.hpp"

#include <metis.h>

#include <Teuchos_TestForException.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>

namespace Haptos {
namespace {

// What a contact pair is exchanged for a shared node: by F and M alike, and in every inner step on contact rows besides.
constexpr idx_t kContactExchanges = 6;

constexpr std::size_t kSmallest = 4;  // subdomains that a rank will hardly have to share with others

// Subdomains at every node in CSR form, ascending.
struct NodeSubdomains {
  std::vector<std::size_t> offsets;
  std::vector<int> subdomains;
  const int* begin(std::int64_t node) const { return subdomains.data() + offsets[std::size_t(node)]; }
  const int* end(std::int64_t node) const { return subdomains.data() + offsets[std::size_t(node) + 1]; }
};

NodeSubdomains subdomainsOfNodes(const Mesh& mesh, const Partition& partition) {
  std::vector<std::vector<std::int64_t>> nodesOf(std::size_t(partition.count));
  std::size_t element = 0;
  for (const auto& block : mesh.blocks) {
    const auto n = nodesPerElement(block.topology);
    for (auto nodes = block.connectivity.begin(); nodes != block.connectivity.end(); nodes += n, ++element) {
      auto& mine = nodesOf[std::size_t(partition.ofElement[element])];
      mine.insert(mine.end(), nodes, nodes + n);
    }
  }
  NodeSubdomains result;
  result.offsets.assign(mesh.numNodes() + 1, 0);
  for (auto& nodes : nodesOf) {
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    for (auto node : nodes) ++result.offsets[std::size_t(node) + 1];
  }
  std::partial_sum(result.offsets.begin(), result.offsets.end(), result.offsets.begin());
  result.subdomains.resize(result.offsets.back());
  std::vector<std::size_t> next(result.offsets.begin(), result.offsets.end() - 1);
  for (int s = 0; s < partition.count; ++s)
    for (auto node : nodesOf[std::size_t(s)]) result.subdomains[next[std::size_t(node)]++] = s;
  return result;
}

class SubdomainGraph {
 public:
  SubdomainGraph(const NodeSubdomains& of, const std::vector<ContactInterface>& interfaces, int count)
      : work_(std::size_t(count)), contactNodes_(work_.size(), 0), couplings_(work_.size()), position_(work_.size(), -1) {
    std::vector<int> numNodes(work_.size(), 0);
    for (std::int64_t node = 0; node + 1 < std::int64_t(of.offsets.size()); ++node)
      for (const int* a = of.begin(node); a != of.end(node); ++a) {
        ++numNodes[std::size_t(*a)];
        for (const int* b = of.begin(node); b != a; ++b) couple(*a, *b, 1);
      }
    setWork(numNodes);
    for (const auto& interface : interfaces)
      for (const auto& pair : interface.pairs) addPair(of, pair, interface.tied);
  }

  /// 0 or 1 for each of these subdomains: the two halves.
  std::vector<idx_t> halve(const std::vector<int>& subdomains);

 private:
  // METIS takes whole numbers, whose sum must stay within an idx_t.
  void setWork(const std::vector<int>& numNodes) {
    constexpr double kLargestSum = 1e9;
    double sum = 0;
    for (int n : numNodes) sum += workOfSubdomain(n);
    const double unit = std::max(1.0, sum / kLargestSum);
    for (std::size_t s = 0; s < work_.size(); ++s) work_[s] = std::max<idx_t>(1, idx_t(std::lround(workOfSubdomain(numNodes[s]) / unit)));
  }

  void couple(int a, int b, idx_t weight) {
    if (a == b) return;
    couplings_[std::size_t(a)][b] += weight;
    couplings_[std::size_t(b)][a] += weight;
  }

  void addPair(const NodeSubdomains& of, const ContactPair& pair, bool tied) {
    for (const auto* side : {&pair.secondary, &pair.primary})
      for (const NodeWeight& i : *side)
        for (const int* a = of.begin(i.node); a != of.end(i.node) && !tied; ++a) ++contactNodes_[std::size_t(*a)];
    for (const NodeWeight& i : pair.secondary)
      for (const NodeWeight& j : pair.primary)
        for (const int* a = of.begin(i.node); a != of.end(i.node); ++a)
          for (const int* b = of.begin(j.node); b != of.end(j.node); ++b) couple(*a, *b, tied ? 1 : kContactExchanges);
  }

  std::vector<idx_t> work_, contactNodes_;         // [subdomains]
  std::vector<std::map<int, idx_t>> couplings_;    // [subdomains] both ways
  std::vector<idx_t> position_;                    // [subdomains] among those that are halved, -1: not there
};

std::vector<idx_t> SubdomainGraph::halve(const std::vector<int>& subdomains) {
  const auto touches = [&](int s) { return contactNodes_[std::size_t(s)] > 0; };
  const bool hasContact = std::any_of(subdomains.begin(), subdomains.end(), touches);
  std::vector<idx_t> offsets{0}, neighbours, weights, loads;
  for (std::size_t i = 0; i < subdomains.size(); ++i) position_[std::size_t(subdomains[i])] = idx_t(i);
  for (int s : subdomains) {
    for (const auto& [other, weight] : couplings_[std::size_t(s)]) {
      if (position_[std::size_t(other)] < 0) continue;
      neighbours.push_back(position_[std::size_t(other)]);
      weights.push_back(weight);
    }
    offsets.push_back(idx_t(neighbours.size()));
    loads.push_back(work_[std::size_t(s)]);
    if (hasContact) loads.push_back(contactNodes_[std::size_t(s)]);
  }
  for (int s : subdomains) position_[std::size_t(s)] = -1;
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  options[METIS_OPTION_NUMBERING] = 0;
  real_t imbalance[] = {1.005, 1.05};  // contact is the smaller part of the work
  idx_t n = idx_t(subdomains.size()), constraints = hasContact ? 2 : 1, parts = 2, cut = 0;
  std::vector<idx_t> half(subdomains.size(), 0);
  const int status = METIS_PartGraphRecursive(&n, &constraints, offsets.data(), neighbours.data(), loads.data(), nullptr,
                                              weights.data(), &parts, nullptr, imbalance, options, &cut, half.data());
  TEUCHOS_TEST_FOR_EXCEPTION(status != METIS_OK, std::runtime_error, "METIS_PartGraphRecursive failed with status " << status);
  return half;
}

// Appends these subdomains to the order.
void bisect(SubdomainGraph& graph, const std::vector<int>& subdomains, std::vector<int>& order) {
  std::vector<int> halves[2];
  if (subdomains.size() > kSmallest) {
    const auto half = graph.halve(subdomains);
    for (std::size_t i = 0; i < subdomains.size(); ++i) halves[half[i]].push_back(subdomains[i]);
  }
  if (halves[0].empty() || halves[1].empty()) {  // few, or no cut was found: they stay as they are
    order.insert(order.end(), subdomains.begin(), subdomains.end());
    return;
  }
  for (const auto& half : halves) bisect(graph, half, order);
}

}  // namespace

double workOfSubdomain(int numNodes) { return std::pow(double(numNodes), 4.0 / 3.0); }

void orderSubdomains(const Mesh& mesh, const std::vector<ContactInterface>& interfaces, Partition& partition) {
  SubdomainGraph graph(subdomainsOfNodes(mesh, partition), interfaces, partition.count);
  std::vector<int> all(std::size_t(partition.count)), order, number(all.size());
  std::iota(all.begin(), all.end(), 0);
  bisect(graph, all, order);
  const auto bodies = partition.bodyOfSubdomain;
  for (std::size_t i = 0; i < order.size(); ++i) {
    number[std::size_t(order[i])] = int(i);
    partition.bodyOfSubdomain[i] = bodies[std::size_t(order[i])];
  }
  for (int& s : partition.ofElement) s = number[std::size_t(s)];
}

}  // namespace Haptos
