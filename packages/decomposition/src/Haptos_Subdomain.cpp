// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Subdomain.hpp"

#include <Teuchos_Comm.hpp>
#include <algorithm>
#include <map>

#include "Haptos_PartialMesh.hpp"
#include "Haptos_Partition.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

struct Place {
  int subdomain, group, element;
};

// Elements in mesh order, so that congruent subdomains get the same local order.
std::vector<Place> dealElements(const Mesh& mesh, const Partition& partition, const std::vector<int>& materialOfBlock,
                                std::vector<Subdomain>& subdomains) {
  std::vector<Place> places(mesh.numElements());
  std::int64_t element = 0;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const auto& block = mesh.blocks[b];
    const int perElement = nodesPerElement(block.topology);
    for (std::size_t e = 0; e < block.numElements(); ++e, ++element) {
      Subdomain& sub = subdomains[partition.ofElement[element]];
      if (sub.blockOfGroup.empty() || sub.blockOfGroup.back() != int(b)) {
        sub.blockOfGroup.push_back(int(b));
        sub.groups.emplace_back();
        sub.groups.back().topology = block.topology;
        sub.groups.back().material = materialOfBlock[b];
        sub.groups.back().blockName = block.name.empty() ? std::to_string(block.id) : block.name;
      }
      ElementGroup& group = sub.groups.back();
      places[element] = {partition.ofElement[element], int(sub.groups.size()) - 1, int(group.elementNumbers.size())};
      group.elementNumbers.push_back(mesh.elementNumbers[element]);
      sub.elements.push_back(element);
      for (int i = 0; i < perElement; ++i) sub.nodes.push_back(block.connectivity[e * perElement + i]);
    }
  }
  return places;
}

// sub.nodes holds the connectivity in mesh indices: turn it into sorted nodes and local connectivity.
void localise(const Mesh& mesh, Subdomain& sub) {
  std::vector<std::int64_t> connectivity = std::move(sub.nodes);
  sub.nodes = connectivity;
  std::sort(sub.nodes.begin(), sub.nodes.end());
  sub.nodes.erase(std::unique(sub.nodes.begin(), sub.nodes.end()), sub.nodes.end());
  sub.nodes.shrink_to_fit();
  for (auto node : sub.nodes) sub.coordinates.push_back(mesh.coordinates[node]);
  std::size_t at = 0;
  for (auto& group : sub.groups) {
    const std::size_t entries = group.elementNumbers.size() * nodesPerElement(group.topology);
    group.connectivity.reserve(entries);
    for (std::size_t i = 0; i < entries; ++i, ++at)
      group.connectivity.push_back(
          int(std::lower_bound(sub.nodes.begin(), sub.nodes.end(), connectivity[at]) - sub.nodes.begin()));
  }
}

}  // namespace

// In mesh order first, with nodes of the whole mesh; then every subdomain numbers its own.
std::vector<Subdomain> extractSubdomains(const Mesh& mesh, const Partition& partition,
                                         const std::vector<int>& materialOfBlock) {
  std::vector<Subdomain> subdomains(partition.count);
  for (int s = 0; s < partition.count; ++s) {
    subdomains[s].id = s;
    subdomains[s].body = partition.bodyOfSubdomain[s];
    subdomains[s].piece = partition.pieceOfSubdomain[s];
  }
  const auto places = dealElements(mesh, partition, materialOfBlock, subdomains);
  for (auto& sub : subdomains) localise(mesh, sub);
  for (std::size_t set = 0; set < mesh.sideSets.size(); ++set)
    for (const auto& side : mesh.sideSets[set].sides) {
      const Place& place = places[side.element];
      subdomains[place.subdomain].sides.push_back({int(set), place.group, place.element, side.side});
    }
  return subdomains;
}

std::vector<std::int64_t> nodesOf(const std::vector<Subdomain>& subdomains) {
  std::vector<std::int64_t> nodes;
  for (const auto& sub : subdomains) nodes.insert(nodes.end(), sub.nodes.begin(), sub.nodes.end());
  return nodes;
}

// Elements travel with the number of their subdomain; those that come make a small mesh, which is cut as a whole one would be, and
// its positions become mesh indices again.
std::vector<Subdomain> dealSubdomains(const Communicator& comm, const OwnElements& own, const Partition& partition,
                                      const std::vector<int>& rankOf, const std::vector<int>& materialOfBlock) {
  std::vector<int> target;
  for (int s : partition.ofElement) target.push_back(rankOf[std::size_t(s)]);
  SentElements sent = sendElements(comm, own.part, target, partition.ofElement);
  const auto [begin, end] = std::equal_range(rankOf.begin(), rankOf.end(), comm.getRank());
  const int first = int(begin - rankOf.begin());
  Partition mine;
  mine.count = int(end - begin);
  const auto mineOf = [&](const std::vector<int>& all) { return std::vector<int>(all.begin() + first, all.begin() + first + mine.count); };
  mine.bodyOfSubdomain = mineOf(partition.bodyOfSubdomain);
  mine.pieceOfSubdomain = mineOf(partition.pieceOfSubdomain);
  for (int tag : sent.tags) mine.ofElement.push_back(tag - first);
  auto subdomains = extractSubdomains(sent.part.mesh, mine, materialOfBlock);
  for (auto& sub : subdomains) {
    sub.id += first;
    for (auto& node : sub.nodes) node = sent.part.nodes[std::size_t(node)];
    for (auto& element : sub.elements) element = sent.part.elements[std::size_t(element)];
  }
  return subdomains;
}

// The rank in whose range a node lies hears from all how many subdomains of theirs have it, and tells them the sum.
std::vector<std::vector<int>> countCopies(const Communicator& comm, const EvenRanges& nodes, const std::vector<Subdomain>& subdomains) {
  std::map<std::int64_t, int> mine;
  for (const auto& sub : subdomains)
    for (auto node : sub.nodes) ++mine[node];
  std::vector<std::int64_t> wanted;
  std::vector<int> counts, sums(std::size_t(nodes.count(comm.getRank())), 0);
  for (const auto& [node, count] : mine) {
    wanted.push_back(node);
    counts.push_back(count);
  }
  const RemoteValues remote(comm, nodes, wanted);
  remote.give(counts, [&](std::int64_t place, int count) { sums[std::size_t(place)] += count; });
  const auto all = remote.fetch([&](std::int64_t place) { return sums[std::size_t(place)]; });
  std::vector<std::vector<int>> result;
  for (const auto& sub : subdomains) {
    result.emplace_back();
    for (auto node : sub.nodes)
      result.back().push_back(all[std::size_t(std::lower_bound(wanted.begin(), wanted.end(), node) - wanted.begin())]);
  }
  return result;
}

}  // namespace Haptos
