// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SubdomainOrder.hpp"

#include <metis.h>

#include <Teuchos_TestForException.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "Haptos_Error.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

using Index = std::int64_t;

// What a contact pair is exchanged for a shared node: by F and M alike, and in every inner step on contact rows besides.
constexpr idx_t kContactExchanges = 6;

constexpr std::size_t kSmallest = 4;  // subdomains that a rank will hardly have to share with others

struct NodeSubdomain {
  Index node;
  int subdomain;
};

bool operator<(const NodeSubdomain& a, const NodeSubdomain& b) { return std::tie(a.node, a.subdomain) < std::tie(b.node, b.subdomain); }
bool operator==(const NodeSubdomain& a, const NodeSubdomain& b) { return a.node == b.node && a.subdomain == b.subdomain; }

struct Link {
  int a, b, nodes;
};

void sortOnce(std::vector<NodeSubdomain>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

// Subdomains of this rank's elements at its nodes (positions), subdomain after subdomain.
std::vector<NodeSubdomain> subdomainsAtNodes(const Mesh& mesh, const Partition& partition) {
  std::vector<const Index*> nodesOf;
  std::vector<int> sizes, order(partition.ofElement.size());
  for (const auto& block : mesh.blocks)
    for (std::size_t at = 0; at < block.connectivity.size(); at += std::size_t(nodesPerElement(block.topology))) {
      nodesOf.push_back(block.connectivity.data() + at);
      sizes.push_back(nodesPerElement(block.topology));
    }
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return partition.ofElement[a] < partition.ofElement[b]; });
  std::vector<NodeSubdomain> result;
  std::vector<int> last(mesh.numNodes(), -1);
  for (int e : order)
    for (int i = 0; i < sizes[e]; ++i)
      if (int& seen = last[std::size_t(nodesOf[e][i])]; seen != partition.ofElement[e])
        result.push_back({nodesOf[e][i], seen = partition.ofElement[e]});
  std::stable_sort(result.begin(), result.end(), [](const NodeSubdomain& a, const NodeSubdomain& b) { return a.node < b.node; });
  return result;
}

/// Which subdomains share nodes, counted node by node.
class LinkCounter {
 public:
  explicit LinkCounter(int subdomains) : numNodes(std::size_t(subdomains), 0) {}

  // Every node with all its subdomains.
  void add(const std::vector<NodeSubdomain>& sorted) {
    for (std::size_t i = 0, first = 0; i < sorted.size(); ++i) {
      if (sorted[i].node != sorted[first].node) first = i;
      ++numNodes[std::size_t(sorted[i].subdomain)];
      for (std::size_t k = first; k < i; ++k) ++shared_[{sorted[k].subdomain, sorted[i].subdomain}];
    }
  }
  std::vector<Link> links() const {
    std::vector<Link> result;
    for (const auto& [ends, nodes] : shared_) result.push_back({ends.first, ends.second, nodes});
    return result;
  }

  std::vector<int> numNodes;  // [subdomains]

 private:
  std::map<std::pair<int, int>, int> shared_;
};

// Nodes that other ranks have elements at are counted by the rank in whose range they lie.
LinkCounter countLinks(const Communicator& comm, const OwnElements& own, const std::vector<NodeSubdomain>& mine, int subdomains) {
  LinkCounter counter(subdomains);
  std::vector<NodeSubdomain> here, shared;
  for (const auto& one : mine)
    if (own.isShared[std::size_t(one.node)]) shared.push_back({own.part.nodes[std::size_t(one.node)], one.subdomain});
    else here.push_back(one);
  counter.add(here);
  auto met = sendItems(comm, shared, [&](const NodeSubdomain& s) { return own.nodes.owner(s.node); });
  sortOnce(met);
  counter.add(met);
  return counter;
}

std::set<Index> nodesOfPairs(const std::vector<ContactInterface>& interfaces) {
  std::set<Index> nodes;
  for (const auto& interface : interfaces)
    for (const auto& pair : interface.pairs)
      for (const auto* side : {&pair.secondary, &pair.primary})
        for (const NodeWeight& i : *side) nodes.insert(i.node);
  return nodes;
}

// Subdomains at the nodes of rank 0's pairs, on rank 0.  Collective.
std::vector<NodeSubdomain> subdomainsAtPairs(const Communicator& comm, const OwnElements& own, const std::vector<NodeSubdomain>& mine,
                                             const std::vector<ContactInterface>& interfaces) {
  std::vector<Index> nodes;
  if (comm.getRank() == 0) {
    const auto all = nodesOfPairs(interfaces);
    nodes.assign(all.begin(), all.end());
  }
  nodes = gatheredOnAll(comm, nodes);
  std::vector<NodeSubdomain> found;
  for (const auto& one : mine)
    if (const Index node = own.part.nodes[std::size_t(one.node)]; std::binary_search(nodes.begin(), nodes.end(), node))
      found.push_back({node, one.subdomain});
  auto result = gatheredOnRoot(comm, found);
  sortOnce(result);
  return result;
}

class SubdomainGraph {
 public:
  SubdomainGraph(const std::vector<int>& numNodes, const std::vector<Link>& links)
      : work_(numNodes.size()), contactNodes_(work_.size(), 0), couplings_(work_.size()), position_(work_.size(), -1) {
    setWork(numNodes);
    for (const Link& link : links) couple(link.a, link.b, link.nodes);
  }

  /// \param at subdomains at the nodes of the pairs, sorted
  void addPairs(const std::vector<ContactInterface>& interfaces, const std::vector<NodeSubdomain>& at) {
    for (const auto& interface : interfaces)
      for (const auto& pair : interface.pairs) addPair(at, pair, interface.tied);
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

  template <class Visit>
  static void forEachAt(const std::vector<NodeSubdomain>& at, Index node, Visit&& visit) {
    for (auto it = std::lower_bound(at.begin(), at.end(), NodeSubdomain{node, -1}); it != at.end() && it->node == node; ++it)
      visit(it->subdomain);
  }

  void addPair(const std::vector<NodeSubdomain>& at, const ContactPair& pair, bool tied) {
    for (const auto* side : {&pair.secondary, &pair.primary})
      for (const NodeWeight& i : *side)
        if (!tied) forEachAt(at, i.node, [&](int s) { ++contactNodes_[std::size_t(s)]; });
    for (const NodeWeight& i : pair.secondary)
      for (const NodeWeight& j : pair.primary)
        forEachAt(at, i.node, [&](int a) { forEachAt(at, j.node, [&](int b) { couple(a, b, tied ? 1 : kContactExchanges); }); });
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

std::vector<int> countNodes(const Communicator& comm, const OwnElements& own, const Partition& partition) {
  return sumOfAll(comm, countLinks(comm, own, subdomainsAtNodes(own.part.mesh, partition), partition.count).numNodes);
}

std::vector<int> orderSubdomains(const Communicator& comm, const OwnElements& own, const std::vector<ContactInterface>& interfaces,
                                 Partition& partition) {
  const auto mine = subdomainsAtNodes(own.part.mesh, partition);
  const auto counter = countLinks(comm, own, mine, partition.count);
  const auto atPairs = subdomainsAtPairs(comm, own, mine, interfaces);
  const auto numNodes = sumOfAll(comm, counter.numNodes);
  const auto links = gatheredOnRoot(comm, counter.links());
  std::vector<int> order;
  runOnRoot(comm, [&] {
    SubdomainGraph graph(numNodes, links);
    graph.addPairs(interfaces, atPairs);
    std::vector<int> all(numNodes.size());
    std::iota(all.begin(), all.end(), 0);
    bisect(graph, all, order);
  });
  order = gatheredOnAll(comm, order);
  std::vector<int> number(order.size()), ordered;
  const Partition before = partition;
  for (std::size_t i = 0; i < order.size(); ++i) {
    number[std::size_t(order[i])] = int(i);
    partition.bodyOfSubdomain[i] = before.bodyOfSubdomain[std::size_t(order[i])];
    partition.pieceOfSubdomain[i] = before.pieceOfSubdomain[std::size_t(order[i])];
    ordered.push_back(numNodes[std::size_t(order[i])]);
  }
  for (int& s : partition.ofElement) s = number[std::size_t(s)];
  return ordered;
}

}  // namespace Haptos
