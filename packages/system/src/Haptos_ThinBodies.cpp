// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ThinBodies.hpp"

#include <Eigen/Core>
#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "Haptos_BodyMeans.hpp"
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

TouchedNodes touchedNodes(const std::array<double, 3>* normals, std::size_t count) {
  TouchedNodes touched;
  for (std::size_t node = 0; node < count; ++node) {
    const Eigen::Vector3d outward(normals[node].data());
    if (outward.isZero(0)) continue;
    touched.nodes.push_back(int(node));
    touched.normals.push_back(outward);
  }
  return touched;
}

}  // namespace

void weighThinBodies(const Communicator& comm, const EvenRanges& nodes, const std::vector<PartOfBody>& parts, const std::vector<PlacedPair>& pairs,
                     std::vector<SubdomainNodes>& weights) {
  TEUCHOS_ASSERT(parts.size() == weights.size());
  if (!anyOfAll(comm, std::any_of(parts.begin(), parts.end(), [](const PartOfBody& part) { return isSlender(part.aspect); }))) return;
  const auto normals = normalsAt(comm, nodes, pairs, weights);
  BodyMeans alone(comm);
  std::size_t at = 0;
  for (const PartOfBody& part : parts) {
    const TouchedNodes touched = touchedNodes(normals.data() + at, part.coordinates.size());
    at += part.coordinates.size();
    alone.add(part.body, isSlender(part.aspect) ? stiffnessAlone(part.coordinates, part.neighbours(), touched)
                                                : std::vector<double>(touched.nodes.size(), 1.0));
  }
  alone.sum();
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (double& value : weights[i].stiffness) value *= alone.of(parts[i].body);
}

}  // namespace Haptos
