// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_RowDealer.hpp"

#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "Haptos_Error.hpp"
#include "Haptos_Format.hpp"
#include "Haptos_NodeDirectory.hpp"
#include "Haptos_OrderedScan.hpp"
#include "Haptos_PairDraft.hpp"
#include "Haptos_Reductions.hpp"

namespace Haptos {
namespace {

using Labels = NodeDirectory::Labels;
using Draft = PairDraft;
constexpr int kNone = std::numeric_limits<int>::max();

class RowDealer {
 public:
  RowDealer(const Communicator& comm, const RowSources& sources)
      : comm_(comm), interfaces_(sources.interfaces), directory_(comm, sources), shares_(std::size_t(comm.getSize())) {
    learnRanks(sources);
    takePairs(sources);
    requireNodes();
    findOwners();
    for (Draft& draft : drafts_) makeRows(directory_, interfaces_[std::size_t(draft.placed.interface)], draft);
    requireTiedValues();
    findHolders();
  }

  RowShare deal() {
    dealNodes();
    numberPairs();
    for (const Draft& draft : drafts_) dealPair(draft);
    dealCoupledCopies();
    return receive();
  }

 private:
  void learnRanks(const RowSources& sources);
  void takePairs(const RowSources& sources);
  void requireNodes() const;
  void findOwners();
  void requireTiedValues() const;
  void findHolders();
  void dealNodes();
  void dealNode(const NodeRecord& record, std::size_t index, GlobalOrdinal gluing, const std::array<GlobalOrdinal, 3>& dirichlet);
  void numberPairs();
  void numberTied(GlobalOrdinal first);
  void dealPair(const Draft& draft);
  void dealCoupledCopies();
  RowShare receive();

  std::vector<int> membersOf(const Draft& draft) const;
  std::vector<GlobalOrdinal> placesOf(bool (*counts)(const InterfaceRows&), GlobalOrdinal& total) const;
  int rankOfSubdomain(int subdomain) const {
    return (std::upper_bound(firstOfRank_.begin(), firstOfRank_.end(), std::make_pair(subdomain, kNone)) - 1)->second;
  }
  // Every other lowest subdomain, by its parity, lets its highest partner own the rows.
  bool isHighest(std::size_t record) const { return groups_[record][0] % 2 == 1; }
  int ownerOf(std::size_t record) const {
    const Labels& group = groups_[record];
    // A node without copies has no rows; any rank will do.
    return group[0] == kNone ? comm_.getRank() : rankOfSubdomain(isHighest(record) ? -group[1] : group[0]);
  }

  const Communicator& comm_;
  const std::vector<InterfaceRows>& interfaces_;
  NodeDirectory directory_;
  std::vector<RowShare> shares_;                    // [ranks]
  std::vector<std::pair<int, int>> firstOfRank_;    // first subdomain, rank; ascending
  std::vector<GlobalOrdinal> pairsOfInterface_;
  std::vector<Draft> drafts_;
  std::vector<Labels> groups_;   // [records] lowest subdomain, - highest, 0: of the node and those it is paired with alone
  std::vector<Labels> holders_;  // [records] lowest rank that rows meet at, - highest, - whether contact rows do
  GlobalOrdinal numEquality_ = 0, numRows_ = 0, numContact_ = 0;
};

// Ranks have ranges of subdomains: the first of each tells who has which.
void RowDealer::learnRanks(const RowSources& sources) {
  const std::vector<int> mine{sources.subdomains.empty() ? -1 : sources.subdomains.front().id};
  for (int first : gatheredOnAll(comm_, mine)) firstOfRank_.emplace_back(first, int(firstOfRank_.size()));
  // Ranks without subdomains own no rows.
  firstOfRank_.erase(std::remove_if(firstOfRank_.begin(), firstOfRank_.end(), [](const auto& f) { return f.first < 0; }), firstOfRank_.end());
  std::sort(firstOfRank_.begin(), firstOfRank_.end());
}

// Pairs come to the rank that keeps their secondary node, and the other nodes become known there.
void RowDealer::takePairs(const RowSources& sources) {
  pairsOfInterface_.assign(interfaces_.size(), 0);
  for (const auto& placed : sources.pairs) ++pairsOfInterface_[std::size_t(placed.interface)];
  pairsOfInterface_ = sumOfAll(comm_, pairsOfInterface_);
  std::vector<std::int64_t> nodes;
  for (auto& placed : sendItems(comm_, sources.pairs, [&](const PlacedPair& p) { return directory_.rankOf(p.pair.secondaryNode); })) {
    TEUCHOS_ASSERT(placed.position >= 0 && placed.position < pairsOfInterface_[std::size_t(placed.interface)]);
    for (const auto* side : {&placed.pair.secondary, &placed.pair.primary})
      for (const auto& item : *side) nodes.push_back(item.node);
    drafts_.emplace_back();
    drafts_.back().placed = std::move(placed);
  }
  directory_.fetch(nodes);
  // Rows of a rank follow the order of interfaces and pairs, not that in which they came.
  std::sort(drafts_.begin(), drafts_.end(), [](const Draft& a, const Draft& b) {
    return std::make_pair(a.placed.interface, a.placed.position) < std::make_pair(b.placed.interface, b.placed.position);
  });
  for (Draft& draft : drafts_) findNodes(directory_, draft);
}

// A node that a pair names and no subdomain has would leave the pair hanging: said by its place in the mesh.
void RowDealer::requireNodes() const {
  std::string message;
  for (const Draft& draft : drafts_) {
    std::vector<int> used = membersOf(draft);
    used.push_back(directory_.find(draft.placed.pair.secondaryNode));
    for (int node : used)
      if (message.empty() && directory_.records()[std::size_t(node)].numCopies == 0)
        message = "Contact '" + interfaces_[std::size_t(draft.placed.interface)].name + "': the pair of node " +
                  std::to_string(draft.placed.pair.secondaryNode + 1) + " names node " +
                  std::to_string(directory_.records()[std::size_t(node)].node + 1) + " of the mesh, which no subdomain has; pair nodes of elements";
  }
  throwOnAllRanks(comm_, message);
}

// Gluing and Dirichlet rows belong to the lowest subdomain at a node, and every other one of those leaves its nodes to the
// highest, as rows are work for both neighbours' ranks.  Nodes that are paired one by one count as one.
void RowDealer::findOwners() {
  groups_.assign(directory_.records().size(), {kNone, kNone, 0});
  for (std::size_t i = 0; i < directory_.records().size(); ++i) {
    const NodeRecord& record = directory_.records()[i];
    if (record.numCopies == 0) continue;
    groups_[i] = {directory_.copies(record)->subdomain, -(directory_.copies(record) + record.numCopies - 1)->subdomain, 0};
  }
  std::vector<std::vector<int>> joined;
  for (const Draft& draft : drafts_)
    if (draft.placed.pair.secondary.size() == 1 && draft.placed.pair.primary.size() == 1) joined.push_back(membersOf(draft));
  // The minimum spreads along chains of pairs: where a node is in several, all of them have one owner.
  directory_.spreadMinimum(joined, groups_);
}

std::vector<int> RowDealer::membersOf(const Draft& draft) const {
  std::vector<int> members;
  for (const auto& [node, weight] : draft.nodes) members.push_back(node);
  return members;
}

// A tied row that is left empty must hold by itself; the first one that does not is told.
void RowDealer::requireTiedValues() const {
  CaughtError error;
  std::pair<int, int> where{kNone, kNone};
  for (const Draft& draft : drafts_)
    for (std::size_t d = 0; d < 3 && error.kind == 0 && draft.share.isTied; ++d) {
      double largest = 0;
      for (const auto& [index, weight] : draft.nodes)
        largest = std::max(largest, std::abs(directory_.records()[std::size_t(index)].prescribed[d]));
      if (!draft.share.pinned[d] || std::abs(draft.share.c[d]) <= PairDraft::kRoundOff * largest) continue;
      where = {draft.share.interface, draft.share.position};
      error = {2, "The model has no solution: the displacements prescribed on both sides of contact '" +
                      interfaces_[std::size_t(where.first)].name + "' part a tied pair by " +
                      formatted("%g", std::abs(draft.share.c[d])) + " along " + "xyz"[d] + "."};
    }
  const int first = leastOfAll(comm_, where.first), position = leastOfAll(comm_, where.first == first ? where.second : kNone);
  // Only the rank that has the first one speaks.
  if (where != std::make_pair(first, position)) error = {};
  throwOnAllRanks(comm_, error);
}

// Rows meet where they act on the same node: who solves with them is the lowest of the ranks that own them.
void RowDealer::findHolders() {
  holders_.assign(directory_.records().size(), {kNone, kNone, 0});
  std::vector<std::vector<int>> meeting;
  // least and largest rank at a node: where they differ, rows of several ranks meet
  const auto see = [&](int index, int rank, int contact) {
    Labels& label = holders_[std::size_t(index)];
    label = {std::min(label[0], rank), std::min(label[1], -rank), std::min(label[2], contact)};
  };
  for (const Draft& draft : drafts_) {
    std::vector<int> members = membersOf(draft);
    members.erase(std::remove_if(members.begin(), members.end(),
                                 [&](int i) { return directory_.records()[std::size_t(i)].isHeld(); }),
                  members.end());
    const int owner = ownerOf(std::size_t(directory_.find(draft.placed.pair.secondaryNode)));
    for (int i : members) {
      see(i, owner, draft.share.isTied ? 0 : -1);
      if (directory_.records()[std::size_t(i)].numCopies > 1) see(i, ownerOf(std::size_t(i)), 0);
    }
    meeting.push_back(std::move(members));
  }
  directory_.spreadMinimum(meeting, holders_);
}

int holderOf(const Labels& label) { return label[0] == kNone || label[0] == -label[1] ? -1 : label[0]; }

// Gluing rows of all nodes, then Dirichlet rows of all, both in the order of node indices: the directory's ranges ascend with
// the ranks, so a sum over the lower ranks is where each begins.
void RowDealer::dealNodes() {
  GlobalOrdinal gluing = 0, dirichlet = 0;
  const auto visit = [&](auto&& each) {
    for (std::size_t i = 0; i < directory_.numOwn(); ++i) each(i, directory_.records()[i]);
  };
  visit([&](std::size_t, const NodeRecord& record) {
    gluing += 3 * std::max(0, record.numCopies - 1);
    for (char is : record.isPrescribed) dirichlet += is;
  });
  const GlobalOrdinal numGluing = sumOfAll(comm_, gluing);
  numEquality_ = numGluing + sumOfAll(comm_, dirichlet);
  // mu copies have mu - 1 differences in each component.
  gluing = sumOfLower(comm_, gluing);
  dirichlet = numGluing + sumOfLower(comm_, dirichlet);
  visit([&](std::size_t i, const NodeRecord& record) {
    std::array<GlobalOrdinal, 3> rows{-1, -1, -1};
    for (std::size_t d = 0; d < 3; ++d)
      if (record.isPrescribed[d]) rows[d] = dirichlet++;
    const bool isShared = record.numCopies > 1;
    if (isShared || rows != std::array<GlobalOrdinal, 3>{-1, -1, -1}) dealNode(record, i, isShared ? gluing : -1, rows);
    if (isShared) gluing += 3 * (record.numCopies - 1);
  });
}

// Copies count from the owner's: rows among them are nobody else's.
void RowDealer::dealNode(const NodeRecord& record, std::size_t index, GlobalOrdinal gluing, const std::array<GlobalOrdinal, 3>& dirichlet) {
  const int mu = record.numCopies;
  RowShare::Node node{record.node, gluing, dirichlet, record.prescribed, holderOf(holders_[index]), {}};
  for (int i = 0; i < mu; ++i) {
    const NodeCopy& copy = directory_.copies(record)[isHighest(index) ? mu - 1 - i : i];
    node.stiffness.push_back(copy.stiffness);
    shares_[std::size_t(rankOfSubdomain(copy.subdomain))].copies.push_back({copy.subdomain, copy.localNode, mu, i, gluing, dirichlet});
  }
  shares_[std::size_t(ownerOf(index))].nodes.push_back(std::move(node));
}

// By interface: the number of its first pair among those of interfaces that count.
std::vector<GlobalOrdinal> RowDealer::placesOf(bool (*counts)(const InterfaceRows&), GlobalOrdinal& total) const {
  std::vector<GlobalOrdinal> first;
  total = 0;
  for (std::size_t k = 0; k < interfaces_.size(); ++k) {
    first.push_back(total);
    if (counts(interfaces_[k])) total += pairsOfInterface_[k];
  }
  return first;
}

// Tied rows, then N of all pairs, T1 of those with friction, T2 of those.
void RowDealer::numberPairs() {
  numberTied(numEquality_);
  GlobalOrdinal tied = 0, numFrictional = 0;
  for (const Draft& draft : drafts_)
    for (std::size_t d = 0; d < 3; ++d) tied += draft.share.isTied && !draft.share.pinned[d];
  numEquality_ += sumOfAll(comm_, tied);
  const auto contact = placesOf([](const InterfaceRows& k) { return !k.tied; }, numContact_);
  const auto frictional = placesOf([](const InterfaceRows& k) { return !k.tied && k.frictional; }, numFrictional);
  for (Draft& draft : drafts_) {
    RowShare::Pair& pair = draft.share;
    if (pair.isTied) continue;
    // By place, as no contact row is left out: an empty one keeps its number, and its multiplier is pinned.
    pair.rows[0] = numEquality_ + contact[std::size_t(pair.interface)] + pair.position;
    for (int t = 0; t < 2 && interfaces_[std::size_t(pair.interface)].frictional; ++t)
      pair.rows[std::size_t(t) + 1] = numEquality_ + numContact_ + t * numFrictional + frictional[std::size_t(pair.interface)] + pair.position;
  }
  numRows_ = numEquality_ + numContact_ + 2 * numFrictional;
}

// Tied pairs have as many rows as are not empty.
void RowDealer::numberTied(GlobalOrdinal first) {
  GlobalOrdinal total = 0;
  const auto places = placesOf([](const InterfaceRows& k) { return k.tied; }, total);
  std::vector<PlacedCount> counts;
  for (const Draft& draft : drafts_)
    if (draft.share.isTied)
      counts.push_back({places[std::size_t(draft.share.interface)] + draft.share.position,
                        std::count(draft.share.pinned.begin(), draft.share.pinned.end(), char(0))});
  const auto before = scanInOrder(comm_, counts, total);
  auto next = before.begin();
  for (Draft& draft : drafts_) {
    if (!draft.share.isTied) continue;
    GlobalOrdinal row = first + *next++;
    for (std::size_t d = 0; d < 3; ++d)
      if (!draft.share.pinned[d]) draft.share.rows[d] = row++;
  }
}

// Rows act on the mean of a node's copies.
void RowDealer::dealPair(const Draft& draft) {
  RowShare::Pair share = draft.share;
  share.geometry = draft.placed.pair;
  const int owner = ownerOf(std::size_t(directory_.find(share.geometry.secondaryNode)));
  Labels label{owner, -owner, share.isTied ? 0 : -1};
  for (const auto& [index, weight] : draft.nodes) {
    const NodeRecord& record = directory_.records()[std::size_t(index)];
    // All free nodes of a pair have the same label, by `spreadMinimum`.
    if (!record.isHeld()) label = holders_[std::size_t(index)];
    PairNode node{record.node, weight, 0.0, record.numCopies, record.numCopies > 1 ? ownerOf(std::size_t(index)) : -1, record.isPrescribed};
    for (int i = 0; i < record.numCopies; ++i) {
      const NodeCopy& copy = directory_.copies(record)[i];
      node.stiffness += copy.stiffness;
      auto& entries = shares_[std::size_t(rankOfSubdomain(copy.subdomain))].entries;
      for (std::size_t a = 0; a < 3; ++a)
        for (int d = 0; d < 3 && share.rows[a] >= 0 && weight != 0; ++d) {
          const double value = weight * draft.axes[a][std::size_t(d)];
          // Not along prescribed components: what they contribute is in c.
          if (draft.acts(a, std::size_t(d), record))
            entries.push_back({share.rows[a], copy.subdomain, 3 * copy.localNode + d, value / record.numCopies});
        }
    }
    share.nodes.push_back(node);
  }
  share.holder = holderOf(label);
  share.meetsContact = label[2] < 0;
  shares_[std::size_t(owner)].pairs.push_back(std::move(share));
}

// Ranks with copies of a node that rows of pairs act on must know how stiff all copies are together.
void RowDealer::dealCoupledCopies() {
  for (std::size_t i = 0; i < directory_.numOwn(); ++i) {
    const NodeRecord& record = directory_.records()[i];
    if (holders_[i][0] == kNone) continue;
    double sum = 0;
    for (int k = 0; k < record.numCopies; ++k) sum += directory_.copies(record)[k].stiffness;
    for (int k = 0; k < record.numCopies; ++k) {
      const NodeCopy& copy = directory_.copies(record)[k];
      shares_[std::size_t(rankOfSubdomain(copy.subdomain))].coupled.push_back({copy.subdomain, copy.localNode, sum / record.numCopies});
    }
  }
}

// What every rank is to know of rows: those that it owns, and its subdomains' entries in all rows.
RowShare RowDealer::receive() {
  RowShare share;
  share.numRows = numRows_;
  share.numEquality = numEquality_;
  share.numPairs = numContact_;
  const auto append = [](auto& all, auto& part) { std::move(part.begin(), part.end(), std::back_inserter(all)); };
  for (auto& from : exchangeEach(comm_, std::move(shares_))) {
    append(share.nodes, from.nodes);
    append(share.pairs, from.pairs);
    append(share.copies, from.copies);
    append(share.entries, from.entries);
    append(share.coupled, from.coupled);
  }
  std::sort(share.pairs.begin(), share.pairs.end(), [](const RowShare::Pair& a, const RowShare::Pair& b) {
    return std::make_pair(a.interface, a.position) < std::make_pair(b.interface, b.position);
  });
  return share;
}

}  // namespace

RowShare dealRows(const Communicator& comm, const RowSources& sources) { return RowDealer(comm, sources).deal(); }

}  // namespace Haptos
