// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ThinBodies.hpp"

#include <Eigen/Core>
#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "Haptos_PartShape.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_TouchedNodes.hpp"

namespace Haptos {
namespace {

struct NodeNormal {
  std::int64_t node;
  std::array<double, 3> outward;
};

// Of all nodes of pairs, in steps: sums of these know no order.
std::vector<NodeNormal> normalsOf(const std::vector<PlacedPair>& pairs) {
  constexpr double kSteps = 1 << 20;
  std::vector<NodeNormal> normals;
  const auto add = [&](const std::vector<NodeWeight>& side, const std::array<double, 3>& n, double sign) {
    const auto step = [&](double x) { return std::round(sign * kSteps * x) / kSteps; };
    for (const auto& [node, weight] : side)
      if (weight != 0) normals.push_back({node, {step(n[0]), step(n[1]), step(n[2])}});
  };
  for (const auto& [interface, position, pair] : pairs) {
    add(pair.secondary, pair.frame.normal, 1);
    add(pair.primary, pair.frame.normal, -1);
  }
  return normals;
}

// Sums at the nodes of subdomains, one after the other; zero where no pair is.  Collective.
std::vector<std::array<double, 3>> normalsAt(const Communicator& comm, const EvenRanges& nodes, const std::vector<PlacedPair>& pairs,
                                             const std::vector<SubdomainNodes>& subdomains) {
  const std::int64_t first = nodes.begin(comm.getRank());
  std::vector<std::array<double, 3>> sums(std::size_t(nodes.count(comm.getRank())), std::array<double, 3>{});
  for (const auto& [node, outward] : sendItems(comm, normalsOf(pairs), [&](const NodeNormal& n) { return nodes.owner(n.node); }))
    sums[std::size_t(node - first)] = Vec3::add(sums[std::size_t(node - first)], outward);
  std::vector<std::int64_t> wanted;
  for (const auto& sub : subdomains) wanted.insert(wanted.end(), sub.nodes.begin(), sub.nodes.end());
  return RemoteValues(comm, nodes, wanted).fetch([&](std::int64_t place) { return sums[std::size_t(place)]; });
}

// Of each part, by normals of all nodes of parts.
std::vector<TouchedNodes> touchedNodes(const std::vector<std::array<double, 3>>& normals, const std::vector<PartOfBody>& parts) {
  std::vector<TouchedNodes> touched(parts.size());
  auto normal = normals.begin();
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (int node = 0; node < int(parts[i].coordinates.size()); ++node, ++normal) {
      const Eigen::Vector3d outward(normal->data());
      if (outward.isZero(0)) continue;
      touched[i].nodes.push_back(node);
      touched[i].normals.push_back(outward);
    }
  return touched;
}

// [bodies of all ranks] whether most of what is touched lies in slender parts: how a body was cut is not to show in it.  Collective.
std::vector<char> findThinBodies(const Communicator& comm, const std::vector<PartOfBody>& parts, const std::vector<TouchedNodes>& touched) {
  int last = -1;
  for (const PartOfBody& part : parts) last = std::max(last, part.body);
  std::vector<long> counts(2 * std::size_t(1 + largestOfAll(comm, last)), 0);  // touched nodes, those in slender parts
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (int k = 0; k <= int(isSlender(parts[i].aspect)); ++k) counts[2 * std::size_t(parts[i].body) + std::size_t(k)] += long(touched[i].nodes.size());
  counts = sumOfAll(comm, counts);
  std::vector<char> isThin;
  for (std::size_t body = 0; 2 * body < counts.size(); ++body) isThin.push_back(2 * counts[2 * body + 1] > counts[2 * body]);
  return isThin;
}

// Copies of a node get the largest of their values: at a rim of a part neighbours are missing.  Collective.
std::vector<double> largestOfCopies(const Communicator& comm, const EvenRanges& nodes, const std::vector<std::int64_t>& numbers, const std::vector<double>& values) {
  std::vector<double> largest(std::size_t(nodes.count(comm.getRank())), 0.0);
  const RemoteValues copies(comm, nodes, numbers);
  copies.give(values, [&](std::int64_t place, double value) { largest[std::size_t(place)] = std::max(largest[std::size_t(place)], value); });
  return copies.fetch([&](std::int64_t place) { return largest[std::size_t(place)]; });
}

}  // namespace

void weighThinBodies(const Communicator& comm, const EvenRanges& nodes, const std::vector<PartOfBody>& parts, const std::vector<PlacedPair>& pairs,
                     std::vector<SubdomainNodes>& weights) {
  TEUCHOS_ASSERT(parts.size() == weights.size());
  if (!anyOfAll(comm, std::any_of(parts.begin(), parts.end(), [](const PartOfBody& part) { return isSlender(part.aspect); }))) return;
  const std::vector<TouchedNodes> touched = touchedNodes(normalsAt(comm, nodes, pairs, weights), parts);
  const std::vector<char> isThin = findThinBodies(comm, parts, touched);
  std::vector<std::int64_t> numbers;
  std::vector<double> alone;
  std::vector<double*> stiffness;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!isThin[std::size_t(parts[i].body)]) continue;
    const auto values = stiffnessAlone(parts[i].coordinates, parts[i].neighbours(), touched[i]);
    alone.insert(alone.end(), values.begin(), values.end());
    for (const int node : touched[i].nodes) {
      numbers.push_back(weights[i].nodes[std::size_t(node)]);
      stiffness.push_back(&weights[i].stiffness[std::size_t(node)]);
    }
  }
  alone = largestOfCopies(comm, nodes, numbers, alone);
  for (std::size_t k = 0; k < alone.size(); ++k) *stiffness[k] *= alone[k];
}

}  // namespace Haptos
