// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_MultiplierMap.hpp"

#include <Teuchos_Comm.hpp>
#include <Tpetra_Map.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_RowDealer.hpp"

namespace Haptos {
namespace {

struct OwnRow {
  GlobalOrdinal row;
  RowKind kind;
  char pinned;
  double c;
  std::int64_t node;
};

// Three gluing rows for every copy but the first; a Dirichlet row acts on all copies by 1 / sqrt(mu), hence its c.
void addRowsOfNode(const RowShare::Node& node, std::vector<OwnRow>& rows) {
  const int mu = int(node.stiffness.size());
  for (int k = 0; k < 3 * (mu - 1); ++k) rows.push_back({node.gluing + k, RowKind::Gluing, 0, 0.0, node.node});
  for (std::size_t d = 0; d < 3; ++d)
    if (node.dirichlet[d] >= 0)
      rows.push_back({node.dirichlet[d], RowKind::Dirichlet, char(mu == 0), std::sqrt(double(mu)) * node.prescribed[d], node.node});
}

// Rows that a pair has, in the order N, T1, T2, or x, y, z of a tied one.
void addRowsOfPair(const RowShare::Pair& pair, std::vector<OwnRow>& rows) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (pair.rows[a] < 0) continue;
    const RowKind kind = pair.isTied ? RowKind::Tied : a == 0 ? RowKind::Normal : RowKind::Tangential;
    rows.push_back({pair.rows[a], kind, pair.pinned[a], pair.c[a], pair.geometry.secondaryNode});
  }
}

// visit(row, component, value) for what gluing and Dirichlet rows have at one copy of a node
template <class Visit>
void forEachEntry(const RowShare::Copy& copy, Visit&& visit) {
  for (int j = std::max(1, copy.position); j < copy.copies; ++j) {
    const double norm = std::sqrt(double(j) * (j + 1));
    for (int d = 0; d < 3; ++d) visit(copy.gluing + 3 * (j - 1) + d, d, (copy.position < j ? 1.0 : -double(j)) / norm);
  }
  for (int d = 0; d < 3; ++d)
    if (copy.dirichlet[std::size_t(d)] >= 0) visit(copy.dirichlet[std::size_t(d)], d, 1.0 / std::sqrt(double(copy.copies)));
}

}  // namespace

// Shares come with global rows; what is kept is local, in the order of rows.
MultiplierMap::MultiplierMap(const RCP<const Communicator>& comm, const RowSources& sources) {
  const RowShare share = dealRows(*comm, sources);
  numEquality_ = share.numEquality;
  numPairs_ = share.numPairs;
  takeOwnRows(comm, share);
  takeNodes(share);
  takePairs(share);
  takeEntries(sources, share);
  coupledCopies_ = share.coupled;
}

// Own rows ascend; behind them, in the overlap map, come those of other ranks that this rank's subdomains touch.
void MultiplierMap::takeOwnRows(const RCP<const Communicator>& comm, const RowShare& share) {
  std::vector<OwnRow> rows;
  for (const auto& node : share.nodes) addRowsOfNode(node, rows);
  for (const auto& pair : share.pairs) addRowsOfPair(pair, rows);
  std::sort(rows.begin(), rows.end(), [](const OwnRow& a, const OwnRow& b) { return a.row < b.row; });
  std::vector<GlobalOrdinal> own;
  for (const OwnRow& row : rows) {
    if (!isEquality(row.kind)) contactRows_.push_back(int(own.size()));
    own.push_back(row.row);
    kinds_.push_back(row.kind);
    pinned_.push_back(row.pinned);
    c_.push_back(row.c);
    nodes_.push_back(row.node);
  }
  map_ = mapOf(own, comm);
  contactMap_ = mapOfRows(*map_, contactRows_);

  std::vector<GlobalOrdinal> touched;
  for (const auto& copy : share.copies) forEachEntry(copy, [&](GlobalOrdinal row, int, double) { touched.push_back(row); });
  for (const auto& entry : share.entries) touched.push_back(entry.row);
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  const std::size_t numOwn = own.size();
  for (GlobalOrdinal row : touched)
    if (!std::binary_search(own.begin(), own.begin() + std::ptrdiff_t(numOwn), row)) own.push_back(row);
  overlapMap_ = mapOf(own, comm);
  remote_ = std::make_unique<RemoteRows>(map_, overlapMap_);
}

// Global rows become local ones.
void MultiplierMap::takeNodes(const RowShare& share) {
  const auto local = [&](GlobalOrdinal row) { return row < 0 ? -1 : map_->getLocalElement(row); };
  for (const auto& node : share.nodes) {
    const auto& rows = node.dirichlet;
    nodeRows_.push_back({node.node, local(node.gluing), {local(rows[0]), local(rows[1]), local(rows[2])}, node.holder, copyStiffness_.size(),
                         int(node.stiffness.size())});
    copyStiffness_.insert(copyStiffness_.end(), node.stiffness.begin(), node.stiffness.end());
  }
}

// Contact pairs, then tied ones, each by interface and position: the order of laws and of results.
void MultiplierMap::takePairs(const RowShare& share) {
  const auto local = [&](GlobalOrdinal row) { return row < 0 ? -1 : map_->getLocalElement(row); };
  for (bool tied : {false, true})
    for (const auto& pair : share.pairs) {
      if (pair.isTied != tied) continue;
      const std::array<int, 3> rows{local(pair.rows[0]), local(pair.rows[1]), local(pair.rows[2])};
      const LocalFrame& frame = pair.geometry.frame;
      Coupling coupling{rows, {frame.normal, frame.t1, frame.t2}, pair.nodes, pair.holder, pair.meetsContact};
      if (tied) coupling.axes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
      for (std::size_t a = 0; a < 3; ++a)
        if (pair.geometry.isPinned[a]) coupling.axes[a] = {0, 0, 0};  // the row is empty, as in B
      couplings_.push_back(std::move(coupling));
      if (tied) tiedPairs_.push_back({pair.interface, pair.position, rows, pair.geometry});
      else pairs_.push_back({pair.interface, pair.position, rows[0], {rows[1], rows[2]}, pair.geometry});
    }
}

// A subdomain's entries lie together, by rows: that is how B is cut into local parts.
void MultiplierMap::takeEntries(const RowSources& sources, const RowShare& share) {
  const int first = sources.subdomains.empty() ? 0 : sources.subdomains.front().id;
  const auto add = [&](GlobalOrdinal row, int subdomain, int dof, double value) {
    const double weight = sources.subdomains[std::size_t(subdomain - first)].stiffness[std::size_t(dof / 3)];
    overlapEntries_.push_back({overlapMap_->getLocalElement(row), subdomain, dof, value, weight});
  };
  for (const auto& copy : share.copies)
    forEachEntry(copy, [&](GlobalOrdinal row, int d, double value) { add(row, copy.subdomain, 3 * copy.localNode + d, value); });
  for (const auto& entry : share.entries) add(entry.row, entry.subdomain, entry.dof, entry.value);
  std::stable_sort(overlapEntries_.begin(), overlapEntries_.end(), [](const OverlapEntry& a, const OverlapEntry& b) {
    return a.subdomain != b.subdomain ? a.subdomain < b.subdomain : a.row < b.row;
  });
}

}  // namespace Haptos
