// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NodeDirectory.hpp"

#include <Teuchos_Assert.hpp>
#include <Teuchos_CommHelpers.hpp>
#include <algorithm>
#include <numeric>

#include "Haptos_ByteBuffer.hpp"
#include "Haptos_Exchange.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

template <class Item>
std::vector<Bytes> packed(const std::vector<std::vector<Item>>& lists) {
  std::vector<Bytes> messages;
  for (const auto& list : lists) {
    ByteWriter writer;
    writer.write(list);
    messages.push_back(writer.take());
  }
  return messages;
}

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

int findRoot(std::vector<int>& parent, int i) {
  while (parent[std::size_t(i)] != i) i = parent[std::size_t(i)] = parent[std::size_t(parent[std::size_t(i)])];
  return i;
}

void lower(NodeDirectory::Labels& label, const NodeDirectory::Labels& other) {
  for (std::size_t k = 0; k < label.size(); ++k) label[k] = std::min(label[k], other[k]);
}

}  // namespace

NodeDirectory::NodeDirectory(const Communicator& comm, const RowSources& sources) : comm_(comm) {
  const std::int64_t mine = largestNode(sources);
  std::int64_t largest = -1;
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, mine, Teuchos::outArg(largest));
  perRank_ = largest / comm.getSize() + 1;
  first_ = perRank_ * comm.getRank();
  numOwn_ = std::size_t(std::clamp<std::int64_t>(largest + 1 - first_, 0, perRank_));
  records_.resize(numOwn_);
  for (std::size_t i = 0; i < numOwn_; ++i) records_[i].node = first_ + std::int64_t(i);

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

void NodeDirectory::takeCopies(const std::vector<SentCopy>& received) {
  for (const auto& sent : received) ++records_[std::size_t(sent.node - first_)].numCopies;
  std::size_t size = 0;
  for (auto& record : records_) {
    record.firstCopy = size;
    size += std::size_t(record.numCopies);
  }
  copies_.resize(size);
  std::vector<int> taken(numOwn_, 0);
  for (const auto& sent : received) {
    const std::size_t i = std::size_t(sent.node - first_);
    copies_[records_[i].firstCopy + std::size_t(taken[i]++)] = sent.copy;
  }
  for (const auto& record : records_)
    std::sort(copies_.data() + record.firstCopy, copies_.data() + record.firstCopy + record.numCopies,
              [](const NodeCopy& a, const NodeCopy& b) { return a.subdomain < b.subdomain; });
}

void NodeDirectory::fetch(const std::vector<std::int64_t>& nodes) {
  TEUCHOS_ASSERT(asked_.empty());
  std::vector<std::vector<std::int64_t>> wanted(std::size_t(comm_.getSize()));
  for (auto node : nodes)
    if (rankOf(node) != comm_.getRank()) wanted[std::size_t(rankOf(node))].push_back(node);
  for (auto& list : wanted) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  std::vector<Bytes> answers;
  for (const auto& question : exchangeAll(comm_, packed(wanted))) {
    ByteWriter writer;
    answered_.emplace_back();
    for (auto node : ByteReader(question).readVector<std::int64_t>()) {
      answered_.back().push_back(int(node - first_));
      const NodeRecord& record = records_[std::size_t(node - first_)];
      writer.write(record);
      writer.write(std::vector<NodeCopy>(copies(record), copies(record) + record.numCopies));
    }
    answers.push_back(writer.take());
  }
  for (const auto& answer : exchangeAll(comm_, answers)) {  // by rank: nodes ascend
    asked_.emplace_back();
    for (ByteReader reader(answer); !reader.atEnd();) {
      asked_.back().push_back(int(records_.size()));
      records_.push_back(reader.read<NodeRecord>());
      records_.back().firstCopy = copies_.size();
      const auto list = reader.readVector<NodeCopy>();
      copies_.insert(copies_.end(), list.begin(), list.end());
    }
  }
}

int NodeDirectory::find(std::int64_t node) const {
  if (rankOf(node) == comm_.getRank()) return int(node - first_);
  const auto at = std::lower_bound(records_.begin() + std::ptrdiff_t(numOwn_), records_.end(), node,
                                   [](const NodeRecord& record, std::int64_t n) { return record.node < n; });
  TEUCHOS_ASSERT(at != records_.end() && at->node == node);
  return int(at - records_.begin());
}

// Of a node on several ranks the owner hears all labels, and all of them the least.
void NodeDirectory::exchangeLabels(std::vector<Labels>& labels) const {
  const auto exchange = [&](const std::vector<std::vector<int>>& from, const std::vector<std::vector<int>>& to) {
    std::vector<std::vector<Labels>> outgoing;
    for (const auto& list : from) {
      outgoing.emplace_back();
      for (int record : list) outgoing.back().push_back(labels[std::size_t(record)]);
    }
    const auto incoming = exchangeAll(comm_, packed(outgoing));
    for (std::size_t rank = 0; rank < to.size(); ++rank) {
      const auto list = ByteReader(incoming[rank]).readVector<Labels>();
      for (std::size_t i = 0; i < list.size(); ++i) lower(labels[std::size_t(to[rank][i])], list[i]);
    }
  };
  exchange(asked_, answered_);
  exchange(answered_, asked_);
}

void NodeDirectory::spreadMinimum(const std::vector<std::vector<int>>& groups, std::vector<Labels>& labels) const {
  std::vector<int> parent(records_.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (const auto& group : groups)
    for (int record : group) parent[std::size_t(findRoot(parent, record))] = findRoot(parent, group.front());
  for (int changed = 1; changed != 0;) {  // as often as a chain goes from rank to rank
    const auto before = labels;
    for (std::size_t i = 0; i < labels.size(); ++i) lower(labels[std::size_t(findRoot(parent, int(i)))], labels[i]);
    for (std::size_t i = 0; i < labels.size(); ++i) labels[i] = labels[std::size_t(findRoot(parent, int(i)))];
    exchangeLabels(labels);
    const int mine = labels != before;
    Teuchos::reduceAll(comm_, Teuchos::REDUCE_MAX, mine, Teuchos::outArg(changed));
  }
}

}  // namespace Haptos
