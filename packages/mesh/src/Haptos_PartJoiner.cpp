// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_PartJoiner.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "Haptos_Error.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_SetMembers.hpp"

namespace Haptos {
namespace {

using Index = std::int64_t;

/// The number of a node, or of an element with its block as group.
struct Key {
  Index number;
  int group;
};

struct SentNode {
  Index index, number;
  std::array<double, 3> x;
};

struct SentElement {
  Index index, number;
  std::vector<Index> nodes;

  auto parts() { return std::tie(index, number, nodes); }  // see ByteWriter
};

/// \brief Joins parts step by step; what is wrong is told on all ranks.
class Joiner {
 public:
  Joiner(const Communicator& comm, const std::string& path, std::vector<ExodusPart> parts)
      : comm_(comm), path_(path), parts_(std::move(parts)) {}

  // Nodes and elements get their places in the order of their numbers, as in a file that holds all of them; everything else follows.
  MeshShare join() {
    share_.rank = comm_.getRank();
    agreeOnHeaders();
    agreeOnTopologies();
    const auto nodes = numberNodes();
    joinNodes(nodes);
    joinNodalFields(nodes);
    const auto elements = numberElements();
    joinElements(nodes, elements);
    joinNodeSets(nodes);
    joinSideSets(elements);
    return std::move(share_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError("Mesh file '" + path_ + "': " + what);
  }

  void requireSame(const std::string& what, const std::string& found, const std::string& wanted) const {
    if (found != wanted)
      refuse("its files do not belong together: one has the " + what + " " + found + ", the first one " + wanted +
             "; decompose the mesh anew.");
  }

  /// Title, blocks and sets are those of the first part; the others must have the same blocks and sets.
  void agreeOnHeaders() {
    // Rank 0 always has a file, ranks beyond the number of files have none.
    share_.part = broadcasted(comm_, comm_.getRank() == 0 ? headerOf(parts_.front().mesh) : Mesh{});
    runOnAllRanks(comm_, [&] {
      for (const auto& part : parts_) {
        requireSame("element blocks", listBlocks(part.mesh), listBlocks(share_.part));
        requireSame("nodal fields", listNodalFields(part.mesh), listNodalFields(share_.part));
        requireSame("node sets", listNodeSets(part.mesh), listNodeSets(share_.part));
        requireSame("side sets", listSideSets(part.mesh), listSideSets(share_.part));
      }
    });
    share_.part.wideIntegers =
        anyOfAll(comm_, std::any_of(parts_.begin(), parts_.end(), [](const ExodusPart& part) { return part.mesh.wideIntegers; }));
  }

  /// Title, and id and name of every block and set.
  static Mesh headerOf(const Mesh& mesh) {
    Mesh header;
    header.title = mesh.title;
    for (const auto& field : mesh.nodalFields) header.nodalFields.push_back({field.name, {}});
    for (const auto& block : mesh.blocks) header.blocks.push_back({block.id, block.name, Topology{}, {}});
    for (const auto& set : mesh.nodeSets) header.nodeSets.push_back({set.id, set.name, {}});
    for (const auto& set : mesh.sideSets) header.sideSets.push_back({set.id, set.name, {}});
    return header;
  }

  /// A block without elements in one part has its topology from another.
  void agreeOnTopologies() {
    auto& blocks = share_.part.blocks;
    std::vector<int> mine(blocks.size(), -1);
    for (const auto& part : parts_)
      for (std::size_t b = 0; b < blocks.size(); ++b)
        if (part.mesh.blocks[b].numElements() > 0) mine[b] = std::max(mine[b], int(part.mesh.blocks[b].topology));
    const auto all = largestOfAll(comm_, mine);
    for (std::size_t b = 0; b < blocks.size(); ++b) blocks[b].topology = Topology(std::max(all[b], 0));
    runOnAllRanks(comm_, [&] {
      for (const auto& part : parts_)
        for (std::size_t b = 0; b < blocks.size(); ++b)
          if (part.mesh.blocks[b].numElements() > 0 && part.mesh.blocks[b].topology != blocks[b].topology)
            refuse("its files do not belong together: element block " + std::to_string(blocks[b].id) + " is of " +
                   topologyName(part.mesh.blocks[b].topology) + " in one and of " + topologyName(blocks[b].topology) + " in another.");
    });
  }

  /// \brief Position of every key in the ascending order of all ranks' different keys, by group and then by number.
  ///
  /// Keys meet at the rank in whose range their number lies; there they are sorted and counted.
  /// \param what "node" or "element"; elements must not come twice
  /// \param starts [groups + 1] of the groups in the order, on return
  std::vector<Index> positionsOf(const std::vector<Key>& keys, const std::string& what, std::vector<Index>& starts) const {
    Index mine = 1;
    runOnAllRanks(comm_, [&] {
      for (const Key& key : keys) {
        if (key.number < 1) refuse("its files hold a " + what + " with the number " + std::to_string(key.number) + "; they go from 1.");
        // Numbers need not be dense: maps of decomposed files may skip what was removed from the mesh.
        mine = std::max(mine, key.number);
      }
    });
    const EvenRanges ranges{largestOfAll(comm_, mine), comm_.getSize()};
    const auto rankOf = [&](const Key& key) { return ranges.owner(key.number - 1); };
    std::vector<std::size_t> countFrom;
    const auto met = sendItems(comm_, keys, rankOf, &countFrom);
    const auto positions = positionsAmong(met, what, starts);
    const auto answers = sendAnswers(comm_, positions, countFrom);
    std::vector<std::size_t> next(answers.size(), 0);
    std::vector<Index> result;
    for (const Key& key : keys) {
      const auto r = std::size_t(rankOf(key));
      result.push_back(answers[r][next[r]++]);
    }
    return result;
  }

  std::vector<Index> positionsAmong(const std::vector<Key>& met, const std::string& what, std::vector<Index>& starts) const {
    std::vector<std::size_t> order(met.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return std::tie(met[a].group, met[a].number) < std::tie(met[b].group, met[b].number);
    });
    const auto isNew = [&](std::size_t i) {
      return i == 0 || met[order[i]].group != met[order[i - 1]].group || met[order[i]].number != met[order[i - 1]].number;
    };
    std::vector<Index> counts(starts.size() - 1, 0);
    runOnAllRanks(comm_, [&] {
      for (std::size_t i = 0; i < order.size(); ++i) {
        if (isNew(i)) ++counts[std::size_t(met[order[i]].group)];
        else if (what == "element")
          refuse("element " + std::to_string(met[order[i]].number) + " is in two of its files.");
      }
    });
    // Ranks hold ascending ranges of numbers, so a position is what lower ranks have, plus the place here.
    const auto [below, all] = std::pair(sumOfLower(comm_, counts), sumOfAll(comm_, counts));
    starts[0] = 0;
    std::partial_sum(all.begin(), all.end(), starts.begin() + 1);
    std::vector<Index> positions(met.size());
    Index inGroup = -1;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const auto group = std::size_t(met[order[i]].group);
      if (i == 0 || group != std::size_t(met[order[i - 1]].group)) inGroup = -1;
      if (isNew(i)) ++inGroup;
      positions[order[i]] = starts[group] + below[group] + inGroup;
    }
    return positions;
  }

  /// What headers of files say of the whole mesh, where they say it.
  void requireTotal(Index found, Index ExodusPart::*stated, const std::string& what) const {
    runOnAllRanks(comm_, [&] {
      for (const auto& part : parts_)
        if (part.*stated >= 0 && part.*stated != found)
          refuse("its files hold " + std::to_string(found) + " " + what + ", but state " + std::to_string(part.*stated) +
                 "; decompose the mesh anew.");
    });
  }

  /// \return index of every node of every part, one part after the other.
  std::vector<Index> numberNodes() {
    std::vector<Key> keys;
    for (const auto& part : parts_)
      for (const Index number : part.mesh.nodeNumbers) keys.push_back({number, 0});
    std::vector<Index> starts(2, 0);
    auto nodes = positionsOf(keys, "node", starts);
    requireTotal(starts.back(), &ExodusPart::numNodes, "nodes");
    share_.nodes = {starts.back(), comm_.getSize()};
    return nodes;
  }

  /// Copies of a node must lie at one place to the last digit: the same number may be another node.
  void joinNodes(const std::vector<Index>& indices) {
    std::vector<SentNode> sent;
    auto index = indices.begin();
    for (auto& part : parts_) {
      const auto& numbers = part.originalNodes.empty() ? part.mesh.nodeNumbers : part.originalNodes;
      for (std::size_t i = 0; i < numbers.size(); ++i) sent.push_back({*index++, numbers[i], part.mesh.coordinates[i]});
      // Let go as soon as it is sent: no rank holds its files twice.
      part.mesh.coordinates = {};
    }
    const auto nodes = sendItems(comm_, sent, [&](const SentNode& n) { return share_.nodes.owner(n.index); });
    const auto count = std::size_t(share_.nodes.count(share_.rank));
    share_.part.coordinates.resize(count);
    share_.part.nodeNumbers.assign(count, 0);
    std::vector<char> isThere(count, 0);
    runOnAllRanks(comm_, [&] {
      for (const auto& node : nodes) {
        const auto at = std::size_t(node.index - share_.firstNode());
        if (isThere[at] && share_.part.coordinates[at] != node.x)
          refuse("node " + std::to_string(node.number) + " lies at different places in two of its files.");
        isThere[at] = 1;
        share_.part.coordinates[at] = node.x;
        share_.part.nodeNumbers[at] = node.number;
      }
    });
  }

  /// Copies of a node may differ: the first file that has it counts.
  void joinNodalFields(const std::vector<Index>& indices) {
    struct Sent {
      Index index;
      double value;
    };
    for (std::size_t f = 0; f < share_.part.nodalFields.size(); ++f) {
      std::vector<Sent> sent;
      auto index = indices.begin();
      for (const auto& part : parts_) {
        for (const double value : part.mesh.nodalFields[f].values) sent.push_back({*index++, value});
        if (part.mesh.nodalFields[f].values.empty()) index += std::ptrdiff_t(part.mesh.nodeNumbers.size());
      }
      auto came = sendItems(comm_, sent, [&](const Sent& s) { return share_.nodes.owner(s.index); });
      if (!anyOfAll(comm_, !came.empty())) continue;  // nobody asked for it
      auto& values = share_.part.nodalFields[f].values;
      values.resize(std::size_t(share_.nodes.count(share_.rank)));
      // Copies come in the order of files, and the last one written stays.
      std::reverse(came.begin(), came.end());
      for (const Sent& s : came) values[std::size_t(s.index - share_.firstNode())] = s.value;
    }
  }

  /// \return index of every element of every part, block by block as the mesh counts them.
  std::vector<Index> numberElements() {
    std::vector<Key> keys;
    for (const auto& part : parts_) {
      auto number = part.mesh.elementNumbers.begin();
      for (std::size_t b = 0; b < part.mesh.blocks.size(); ++b)
        for (std::size_t e = 0; e < part.mesh.blocks[b].numElements(); ++e) keys.push_back({*number++, int(b)});
    }
    share_.blockStarts.assign(share_.part.blocks.size() + 1, 0);
    auto elements = positionsOf(keys, "element", share_.blockStarts);
    requireTotal(share_.blockStarts.back(), &ExodusPart::numElements, "elements");
    share_.elements = {share_.blockStarts.back(), comm_.getSize()};
    return elements;
  }

  void joinElements(const std::vector<Index>& nodes, const std::vector<Index>& elements) {
    std::vector<SentElement> sent;
    auto index = elements.begin();
    std::size_t firstNode = 0;
    for (auto& part : parts_) {
      auto number = part.originalElements.empty() ? part.mesh.elementNumbers.begin() : part.originalElements.begin();
      for (auto& block : part.mesh.blocks) {
        const auto n = std::size_t(nodesPerElement(block.topology));
        for (std::size_t e = 0; e < block.numElements(); ++e) {
          sent.push_back({*index++, *number++, {}});
          for (std::size_t i = 0; i < n; ++i) sent.back().nodes.push_back(nodes[firstNode + std::size_t(block.connectivity[n * e + i])]);
        }
        // As above: the largest array of a part goes first.
        block.connectivity = {};
      }
      firstNode += part.mesh.nodeNumbers.size();
    }
    auto mine = sendItems(comm_, sent, [&](const SentElement& e) { return share_.elements.owner(e.index); });
    std::sort(mine.begin(), mine.end(), [](const SentElement& a, const SentElement& b) { return a.index < b.index; });
    for (const auto& element : mine) {
      auto& block = share_.part.blocks[std::size_t(locateElement(share_.blockStarts, element.index).block)];
      block.connectivity.insert(block.connectivity.end(), element.nodes.begin(), element.nodes.end());
      share_.part.elementNumbers.push_back(element.number);
    }
  }

  void joinNodeSets(const std::vector<Index>& nodes) {
    std::vector<SetMember> members;
    std::size_t firstNode = 0;
    for (const auto& part : parts_) {
      for (std::size_t s = 0; s < part.mesh.nodeSets.size(); ++s)
        for (const Index node : part.mesh.nodeSets[s].nodes) members.push_back({0, nodes[firstNode + std::size_t(node)], int(s), 0});
      firstNode += part.mesh.nodeNumbers.size();
    }
    const auto order = numberMembers(members, share_.nodes, share_.nodeSetSizes, share_.part.nodeSets.size());
    dealSetNodes(comm_, order, share_);
  }

  void joinSideSets(const std::vector<Index>& elements) {
    std::vector<SetMember> members;
    std::size_t firstElement = 0;
    for (const auto& part : parts_) {
      for (std::size_t s = 0; s < part.mesh.sideSets.size(); ++s)
        for (const auto& side : part.mesh.sideSets[s].sides)
          members.push_back({0, elements[firstElement + std::size_t(side.element)], int(s), side.side});
      firstElement += part.mesh.elementNumbers.size();
    }
    const auto order = numberMembers(members, share_.elements, share_.sideSetSizes, share_.part.sideSets.size());
    dealSides(comm_, order, share_);
  }

  /// Members by set, index and side, each once, at the ranks in whose ranges they lie, and their places in the sets.
  std::vector<SetMember> numberMembers(const std::vector<SetMember>& members, const EvenRanges& ranges, std::vector<Index>& sizes,
                                       std::size_t numSets) const {
    const auto key = [](const SetMember& m) { return std::tie(m.set, m.index, m.side); };
    auto mine = sendItems(comm_, members, [&](const SetMember& m) { return ranges.owner(m.index); });
    std::sort(mine.begin(), mine.end(), [&](const SetMember& a, const SetMember& b) { return key(a) < key(b); });
    mine.erase(std::unique(mine.begin(), mine.end(), [&](const SetMember& a, const SetMember& b) { return key(a) == key(b); }), mine.end());
    std::vector<Index> counts(numSets, 0);
    for (const auto& m : mine) ++counts[std::size_t(m.set)];
    auto [next, all] = std::pair(sumOfLower(comm_, counts), sumOfAll(comm_, counts));
    for (auto& m : mine) m.position = next[std::size_t(m.set)]++;
    sizes = all;
    return mine;
  }

  const Communicator& comm_;
  std::string path_;
  std::vector<ExodusPart> parts_;
  MeshShare share_;
};

}  // namespace

MeshShare joinParts(const Communicator& comm, const std::string& path, std::vector<ExodusPart> parts) {
  return Joiner(comm, path, std::move(parts)).join();
}

}  // namespace Haptos
