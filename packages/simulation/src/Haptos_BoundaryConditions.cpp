// SPDX-License-Identifier: BSD-3-Clause
// Conditions and loads of a model: sets are looked up, displacements evaluated at the nodes.
#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "Haptos_Error.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_ModelBuilder.hpp"
#include "Haptos_ParameterValue.hpp"
#include "Haptos_Partition.hpp"
#include "Haptos_Reductions.hpp"

namespace Haptos {
namespace {

using Index = std::int64_t;

/// A value that a condition gives a node; sent to the rank in whose range the node lies.
struct Given {
  Index node;
  int component, turn, letter;  // turn: of the set among all that are named; letter: place in Components
  double value;
};

bool operator<(const Given& a, const Given& b) {
  return std::tie(a.node, a.component, a.turn) < std::tie(b.node, b.component, b.turn);
}

struct NamedSet {
  int condition, nodeSet, sideSet;
};

struct Displacements {
  std::vector<const ConditionOptions*> conditions;
  std::vector<NamedSet> sets;  // by turn

  std::size_t conditionOf(const Given& given) const { return std::size_t(sets[std::size_t(given.turn)].condition); }
};

NamedSet findNamedSet(const MeshShare& mesh, const std::string& name, const std::string& path) {
  const int nodeSet = findNodeSet(mesh.part, name), sideSet = findSideSet(mesh.part, name);
  if (nodeSet < 0 && sideSet < 0)
    throw InputError(path + "->Sets: the mesh has no node set or side set '" + name + "'; its node sets are: " +
                     listNodeSets(mesh.part) + "; its side sets are: " + listSideSets(mesh.part));
  // Sizes over all ranks: a set may be empty in this share and not in the mesh.
  const Index members = (nodeSet < 0 ? 0 : mesh.nodeSetSizes[std::size_t(nodeSet)]) + (sideSet < 0 ? 0 : mesh.sideSetSizes[std::size_t(sideSet)]);
  if (members == 0) throw InputError(path + "->Sets: the set '" + name + "' has no nodes");
  return {0, nodeSet, sideSet};
}

Displacements findDisplacements(const std::vector<ConditionOptions>& conditions, const MeshShare& mesh) {
  Displacements result;
  for (const auto& condition : conditions) {
    if (condition.type != ConditionType::Displacement) continue;
    for (const auto& name : condition.sets) {
      result.sets.push_back(findNamedSet(mesh, name, condition.path));
      result.sets.back().condition = int(result.conditions.size());
    }
    result.conditions.push_back(&condition);
  }
  return result;
}

// Values at this rank's nodes of the node sets, and at the nodes of its elements' sides.
std::vector<std::vector<Given>> evaluate(const Displacements& displacements, const MeshShare& mesh, const OwnElements& own) {
  std::vector<std::vector<Given>> toOwner(std::size_t(mesh.nodes.ranks));
  const auto offsets = blockOffsets(own.part.mesh);
  for (int turn = 0; turn < int(displacements.sets.size()); ++turn) {
    const NamedSet& set = displacements.sets[std::size_t(turn)];
    const ConditionOptions& condition = *displacements.conditions[std::size_t(set.condition)];
    const auto give = [&](Index node, const std::array<double, 3>& x) {
      const auto u = condition.value(x[0], x[1], x[2]);
      for (int i = 0; i < int(condition.components.size()); ++i) {
        const int component = condition.components[std::size_t(i)] - 'x';
        toOwner[std::size_t(mesh.nodes.owner(node))].push_back({node, component, turn, i, u[std::size_t(component)]});
      }
    };
    if (set.nodeSet >= 0)
      for (Index node : mesh.part.nodeSets[std::size_t(set.nodeSet)].nodes)
        if (const auto place = std::size_t(node - mesh.firstNode()); own.isUsed[place])  // one without elements has nothing to hold
          give(node, mesh.part.coordinates[place]);
    if (set.sideSet < 0) continue;
    // Each node once, though several sides of the set have it.
    std::set<Index> nodes;
    for (const auto& side : own.part.mesh.sideSets[std::size_t(set.sideSet)].sides)
      for (auto node : nodesOfSide(own.part.mesh, offsets, side)) nodes.insert(node);
    for (auto node : nodes) give(own.part.nodes[std::size_t(node)], own.part.mesh.coordinates[std::size_t(node)]);
  }
  return toOwner;
}

// [conditions] the largest magnitude that each prescribes, over all nodes of all ranks.  Collective.
std::vector<double> largestValues(const Communicator& comm, const Displacements& displacements, const std::vector<std::vector<Given>>& evaluated) {
  std::vector<double> largest(displacements.conditions.size(), 0.0);
  for (const auto& list : evaluated)
    for (const Given& given : list) {
      double& most = largest[displacements.conditionOf(given)];
      most = std::max(most, std::abs(given.value));
    }
  return largestOfAll(comm, largest);
}

/// Two values at one place.
struct Conflict {
  Given first, other;
  bool operator<(const Conflict& b) const {  // in the order in which conditions are read
    return std::tie(other.turn, other.node, other.letter) < std::tie(b.other.turn, b.other.node, b.other.letter);
  }
};

// The first value of every node and component; others must be the same, but for the round-off of `largest`, [conditions].
std::vector<PrescribedDisplacement> firstValues(std::vector<Given> given, const Displacements& displacements, const std::vector<double>& largest,
                                                std::vector<Conflict>& conflicts) {
  std::sort(given.begin(), given.end());
  std::vector<PrescribedDisplacement> result;
  for (std::size_t i = 0, first = 0; i < given.size(); ++i) {
    if (given[i].node != given[first].node || given[i].component != given[first].component) first = i;
    if (i == first) result.push_back({given[i].node, given[i].component, given[i].value});
    // Expressions of two conditions may differ by round-off where they mean the same: of what they are elsewhere, as it may be 0 here.
    const double scale = std::max(largest[displacements.conditionOf(given[first])], largest[displacements.conditionOf(given[i])]);
    if (std::abs(given[first].value - given[i].value) > 1e-12 * scale) conflicts.push_back({given[first], given[i]});
  }
  if (!conflicts.empty()) conflicts = {*std::min_element(conflicts.begin(), conflicts.end())};
  return result;
}

int sideSetFor(const Mesh& mesh, const std::string& name, const std::string& type, const std::string& path) {
  const int set = findSideSet(mesh, name);
  if (set >= 0) return set;
  const std::string hint = findNodeSet(mesh, name) >= 0 ? "'" + name + "' is a node set, but a " + type + " needs a side set"
                                                        : "the mesh has no side set '" + name + "'";
  throw InputError(path + "->Sets: " + hint + "; its side sets are: " + listSideSets(mesh));
}

}  // namespace

std::vector<PrescribedDisplacement> collectDisplacements(const Communicator& comm, const std::vector<ConditionOptions>& conditions,
                                                         const MeshShare& mesh, const OwnElements& own) {
  Displacements displacements;
  std::vector<std::vector<Given>> toOwner;
  runOnAllRanks(comm, [&] {
    displacements = findDisplacements(conditions, mesh);
    toOwner = evaluate(displacements, mesh, own);
  });
  const std::vector<double> largest = largestValues(comm, displacements, toOwner);
  std::vector<Conflict> conflicts;
  auto result = firstValues(joined(exchangeValues(comm, toOwner)), displacements, largest, conflicts);
  // Each rank tells its first one, and all ranks refuse with the same, whoever found it.
  conflicts = gatheredOnAll(comm, conflicts);
  if (conflicts.empty()) return result;
  const auto [first, other] = *std::min_element(conflicts.begin(), conflicts.end());
  const auto pathOf = [&](const Given& given) { return displacements.conditions[displacements.conditionOf(given)]->path; };
  throw InputError(pathOf(other) + "->Value: prescribes " + char('x' + other.component) + "-displacement " + numberText(other.value) + " at " +
                   describeNode(comm, mesh, other.node) + ", where " + pathOf(first) + " prescribes " + numberText(first.value) +
                   "; give one value only");
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

void requireLoadedSides(const std::vector<Load>& loads, const MeshShare& mesh) {
  for (const Load& load : loads) {
    for (int i : load.sideSets) {
      const SideSet& set = mesh.part.sideSets[std::size_t(i)];
      if (mesh.sideSetSizes[std::size_t(i)] == 0) throw InputError(load.name + "->Sets: the side set " + std::to_string(set.id) + " '" + set.name + "' has no sides");
    }
    for (int i : load.blocks) {
      const ElementBlock& block = mesh.part.blocks[std::size_t(i)];
      if (mesh.blockStarts[std::size_t(i)] == mesh.blockStarts[std::size_t(i) + 1])
        throw InputError(load.name + "->Element Blocks: the block " + std::to_string(block.id) + " '" + block.name + "' has no elements");
    }
  }
}

}  // namespace Haptos
