// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NodeDirectory.hpp"

#include <Teuchos_Assert.hpp>
#include <algorithm>

#include "Haptos_DisjointSets.hpp"
#include "Haptos_Reductions.hpp"

namespace Haptos {
namespace {

// Of everything that names nodes: a pair may name one that no subdomain has, which is told later.
std::int64_t largestNode(const RowSources& sources) {
  std::int64_t largest = -1;
  for (const auto& sub : sources.subdomains)
    for (auto node : sub.nodes) largest = std::max(largest, node);
  for (const auto& p : sources.prescribed) largest = std::max(largest, p.node);
  for (const auto& placed : sources.pairs) {
    largest = std::max(largest, placed.pair.secondaryNode);
    for (const auto* side : {&placed.pair.secondary, &placed.pair.primary})
      for (const auto& item : *side) largest = std::max(largest, item.node);
  }
  return largest;
}

// A node of another rank on its way here.
struct SentRecord {
  NodeRecord record;
  std::vector<NodeCopy> copies;

  auto parts() { return std::tie(record, copies); }
};

void lower(NodeDirectory::Labels& label, const NodeDirectory::Labels& other) {
  for (std::size_t k = 0; k < label.size(); ++k) label[k] = std::min(label[k], other[k]);
}

}  // namespace

// Ranges are even in node numbers, not in work, so that who keeps a node is known to all by a division.
NodeDirectory::NodeDirectory(const Communicator& comm, const RowSources& sources)
    : comm_(comm), ranges_{largestOfAll(comm, largestNode(sources)) + 1, comm.getSize()}, first_(ranges_.begin(comm.getRank())), records_(numOwn()) {
  for (std::size_t i = 0; i < records_.size(); ++i) records_[i].node = first_ + std::int64_t(i);
  std::vector<SentCopy> copies;
  for (const auto& sub : sources.subdomains)
    for (std::size_t i = 0; i < sub.nodes.size(); ++i) copies.push_back({sub.nodes[i], {sub.id, int(i), sub.stiffness[i]}});
  takeCopies(sendItems(comm, copies, [&](const SentCopy& copy) { return rankOf(copy.node); }));
  for (const auto& p : sendItems(comm, sources.prescribed, [&](const PrescribedDisplacement& p) { return rankOf(p.node); })) {
    NodeRecord& record = records_[std::size_t(p.node - first_)];
    record.isPrescribed[std::size_t(p.component)] = 1;
    record.prescribed[std::size_t(p.component)] = p.value;
  }
}

// A counting sort: how many copies every node has, where they begin, then each into its place.
void NodeDirectory::takeCopies(const std::vector<SentCopy>& received) {
  for (const auto& sent : received) ++records_[std::size_t(sent.node - first_)].numCopies;
  std::size_t size = 0;
  for (auto& record : records_) {
    record.firstCopy = size;
    size += std::size_t(record.numCopies);
  }
  copies_.resize(size);
  std::vector<int> taken(records_.size(), 0);
  for (const auto& sent : received) {
    const std::size_t i = std::size_t(sent.node - first_);
    copies_[records_[i].firstCopy + std::size_t(taken[i]++)] = sent.copy;
  }
  for (const auto& record : records_)
    std::sort(copies_.data() + record.firstCopy, copies_.data() + record.firstCopy + record.numCopies,
              [](const NodeCopy& a, const NodeCopy& b) { return a.subdomain < b.subdomain; });
}

// Every node is asked for once, in ascending order: records come by rank, whose ranges ascend, and can be searched by bisection.
void NodeDirectory::fetch(const std::vector<std::int64_t>& nodes) {
  TEUCHOS_ASSERT(!remote_);
  std::vector<std::int64_t> wanted;
  for (auto node : nodes)
    if (rankOf(node) != comm_.getRank()) wanted.push_back(node);
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  remote_.emplace(comm_, ranges_, wanted);
  const auto sent = remote_->fetch([&](std::int64_t place) {
    const NodeRecord& record = records_[std::size_t(place)];
    return SentRecord{record, {copies(record), copies(record) + record.numCopies}};
  });
  for (const auto& [record, copies] : sent) {
    records_.push_back(record);
    records_.back().firstCopy = copies_.size();
    copies_.insert(copies_.end(), copies.begin(), copies.end());
  }
}

// Own nodes by their place in the range, others by bisection.
int NodeDirectory::find(std::int64_t node) const {
  if (rankOf(node) == comm_.getRank()) return int(node - first_);
  const auto at = std::lower_bound(records_.begin() + std::ptrdiff_t(numOwn()), records_.end(), node,
                                   [](const NodeRecord& record, std::int64_t n) { return record.node < n; });
  TEUCHOS_ASSERT(at != records_.end() && at->node == node);
  return int(at - records_.begin());
}

// One round: of a node on several ranks the owner hears all labels, and all of them the least.
void NodeDirectory::exchangeLabels(std::vector<Labels>& labels) const {
  Labels* others = labels.data() + numOwn();
  remote_->give(std::vector<Labels>(others, labels.data() + labels.size()),
                [&](std::int64_t place, const Labels& label) { lower(labels[std::size_t(place)], label); });
  for (const Labels& label : remote_->fetch([&](std::int64_t place) { return labels[std::size_t(place)]; })) *others++ = label;
}

// First over the sets that groups of this rank make, then over the ranks, until nobody has anything new.
void NodeDirectory::spreadMinimum(const std::vector<std::vector<int>>& groups, std::vector<Labels>& labels) const {
  DisjointSets sets(records_.size());
  for (const auto& group : groups)
    for (int record : group) sets.join(record, group.front());
  for (bool changed = true; changed;) {  // as often as a chain goes from rank to rank
    const auto before = labels;
    // all members to the lowest one, and back from it
    for (std::size_t i = 0; i < labels.size(); ++i) lower(labels[std::size_t(sets.lowest(int(i)))], labels[i]);
    for (std::size_t i = 0; i < labels.size(); ++i) labels[i] = labels[std::size_t(sets.lowest(int(i)))];
    exchangeLabels(labels);
    changed = anyOfAll(comm_, labels != before);
  }
}

}  // namespace Haptos
