// SPDX-License-Identifier: BSD-3-Clause
// Conditions and loads of a model: sets are looked up, displacements evaluated at the nodes.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "Haptos_Error.hpp"
#include "Haptos_ModelBuilder.hpp"
#include "Haptos_ParameterValue.hpp"

namespace Haptos {
namespace {

std::set<std::int64_t> nodesOfSet(const Mesh& mesh, const std::vector<std::int64_t>& offsets, const std::string& name,
                                  const std::string& path) {
  const int nodeSet = findNodeSet(mesh, name), sideSet = findSideSet(mesh, name);
  if (nodeSet < 0 && sideSet < 0)
    throw InputError(path + "->Sets: the mesh has no node set or side set '" + name + "'; its node sets are: " +
                     listNodeSets(mesh) + "; its side sets are: " + listSideSets(mesh));
  std::set<std::int64_t> nodes;
  if (nodeSet >= 0) nodes.insert(mesh.nodeSets[nodeSet].nodes.begin(), mesh.nodeSets[nodeSet].nodes.end());
  if (sideSet >= 0)
    for (const auto& side : mesh.sideSets[sideSet].sides)
      for (auto node : nodesOfSide(mesh, offsets, side)) nodes.insert(node);
  if (nodes.empty()) throw InputError(path + "->Sets: the set '" + name + "' has no nodes");
  return nodes;
}

int sideSetFor(const Mesh& mesh, const std::string& name, const std::string& type, const std::string& path) {
  const int set = findSideSet(mesh, name);
  if (set >= 0) return set;
  const std::string hint = findNodeSet(mesh, name) >= 0 ? "'" + name + "' is a node set, but a " + type + " needs a side set"
                                                        : "the mesh has no side set '" + name + "'";
  throw InputError(path + "->Sets: " + hint + "; its side sets are: " + listSideSets(mesh));
}

struct Given {
  double value;
  std::string path;
};

}  // namespace

std::vector<PrescribedDisplacement> collectDisplacements(const std::vector<ConditionOptions>& conditions, const Mesh& mesh) {
  const auto offsets = blockOffsets(mesh);
  std::vector<char> used(mesh.numNodes(), 0);
  for (const auto& block : mesh.blocks)
    for (auto node : block.connectivity) used[node] = 1;
  std::map<std::pair<std::int64_t, int>, Given> given;
  for (const auto& condition : conditions) {
    if (condition.type != ConditionType::Displacement) continue;
    const std::string& path = condition.path;
    for (const auto& name : condition.sets)
      for (auto node : nodesOfSet(mesh, offsets, name, path)) {
        if (!used[node]) continue;  // a node without elements has nothing to hold
        const auto& x = mesh.coordinates[node];
        const auto u = condition.value(x[0], x[1], x[2]);
        for (char letter : condition.components) {
          const int component = letter - 'x';
          const auto [entry, isNew] = given.emplace(std::make_pair(node, component), Given{u[component], path});
          const double before = entry->second.value;
          if (!isNew && std::abs(before - u[component]) > 1e-12 * std::max(std::abs(before), std::abs(u[component])))
            throw InputError(path + "->Value: prescribes " + letter + "-displacement " + numberText(u[component]) + " at " +
                             describeNode(mesh, node) + ", where " + entry->second.path + " prescribes " + numberText(before) +
                             "; give one value only");
        }
      }
  }
  std::vector<PrescribedDisplacement> result;
  for (const auto& [key, entry] : given) result.push_back({key.first, key.second, entry.value});
  return result;
}

std::vector<Load> collectLoads(const std::vector<ConditionOptions>& conditions, const Mesh& mesh) {
  std::vector<Load> loads;
  for (const auto& condition : conditions) {
    if (condition.type == ConditionType::Displacement) continue;
    const std::string& path = condition.path;
    Load load;
    load.name = path;
    load.kind = condition.type;
    load.pressure = condition.pressure;
    load.value = condition.value;
    for (const auto& name : condition.blocks) {
      load.blocks.push_back(findBlock(mesh, name));
      if (load.blocks.back() < 0)
        throw InputError(path + "->Element Blocks: the mesh has no element block '" + name + "'; its blocks are: " + listBlocks(mesh));
    }
    for (const auto& name : condition.sets) load.sideSets.push_back(sideSetFor(mesh, name, nameOf(condition.type), path));
    loads.push_back(std::move(load));
  }
  return loads;
}

void requireLoadedSides(const std::vector<Load>& loads, const Mesh& mesh) {
  for (const Load& load : loads) {
    for (int i : load.sideSets) {
      const SideSet& set = mesh.sideSets[std::size_t(i)];
      if (set.sides.empty()) throw InputError(load.name + "->Sets: the side set " + std::to_string(set.id) + " '" + set.name + "' has no sides");
    }
    for (int i : load.blocks) {
      const ElementBlock& block = mesh.blocks[std::size_t(i)];
      if (block.numElements() == 0)
        throw InputError(load.name + "->Element Blocks: the block " + std::to_string(block.id) + " '" + block.name + "' has no elements");
    }
  }
}

}  // namespace Haptos
