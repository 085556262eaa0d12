// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Subdomain.hpp"

#include <algorithm>

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

std::vector<Subdomain> extractSubdomains(const Mesh& mesh, const Partition& partition,
                                         const std::vector<int>& materialOfBlock) {
  std::vector<Subdomain> subdomains(partition.count);
  for (int s = 0; s < partition.count; ++s) {
    subdomains[s].id = s;
    subdomains[s].body = partition.bodyOfSubdomain[s];
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

void pack(ByteWriter& writer, const Subdomain& sub) {
  writer.write(sub.id);
  writer.write(sub.body);
  writer.write(sub.nodes);
  writer.write(sub.coordinates);
  writer.write(sub.groups.size());
  for (const auto& group : sub.groups) {
    writer.write(group.topology);
    writer.write(group.connectivity);
    writer.write(group.material);
    writer.write(group.elementNumbers);
    writer.write(group.blockName);
  }
  writer.write(sub.blockOfGroup);
  writer.write(sub.elements);
  writer.write(sub.sides);
}

Subdomain unpackSubdomain(ByteReader& reader) {
  Subdomain sub;
  sub.id = reader.read<int>();
  sub.body = reader.read<int>();
  sub.nodes = reader.readVector<std::int64_t>();
  sub.coordinates = reader.readVector<std::array<double, 3>>();
  sub.groups.resize(reader.read<std::size_t>());
  for (auto& group : sub.groups) {
    group.topology = reader.read<Topology>();
    group.connectivity = reader.readVector<int>();
    group.material = reader.read<int>();
    group.elementNumbers = reader.readVector<std::int64_t>();
    group.blockName = reader.readString();
  }
  sub.blockOfGroup = reader.readVector<int>();
  sub.elements = reader.readVector<std::int64_t>();
  sub.sides = reader.readVector<SubdomainSide>();
  return sub;
}

}  // namespace Haptos
