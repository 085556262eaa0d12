// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DependentRows.hpp"

#include <Eigen/SparseCore>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <map>

#include "Haptos_CouplingCoefficients.hpp"
#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_DisjointSets.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_HeldCouplings.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_SparseLdl.hpp"

namespace Haptos {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr double kRoundOff = 1e-9;  // of coefficients that are about 1
constexpr double kStiffness = 1000;  // of a row: what the law asks of a force has to be seen, and hides the jumps of no other (decisions/057)

// Rows with a node of their own, free in all components, depend on no others: without them others may have one.
std::vector<HeldCoupling> withoutIndependent(std::vector<HeldCoupling> items) {
  std::map<std::int64_t, std::vector<int>> itemsAt;
  for (std::size_t i = 0; i < items.size(); ++i)
    for (const PairNode& node : items[i].nodes)
      if (node.weight != 0) itemsAt[node.node].push_back(int(i));
  std::vector<char> isLeft(items.size(), 1);
  std::vector<int> waiting;
  const auto leave = [&](int i) {
    if (isLeft[std::size_t(i)]) isLeft[std::size_t(i)] = 0, waiting.push_back(i);
  };
  const auto leaveOwner = [&](const PairNode& node) {
    auto& at = itemsAt[node.node];
    at.erase(std::remove_if(at.begin(), at.end(), [&](int i) { return !isLeft[std::size_t(i)]; }), at.end());
    if (at.size() == 1 && isWhollyFree(node)) leave(at.front());
  };
  for (const HeldCoupling& item : items)
    for (const PairNode& node : item.nodes) leaveOwner(node);
  while (!waiting.empty()) {
    const HeldCoupling& left = items[std::size_t(waiting.back())];
    waiting.pop_back();
    for (const PairNode& node : left.nodes) leaveOwner(node);
  }
  std::vector<HeldCoupling> rest;
  for (std::size_t i = 0; i < items.size(); ++i)
    if (isLeft[i]) rest.push_back(std::move(items[i]));
  return rest;
}

// Those that meet at nodes, each with all that it meets.
std::vector<std::vector<HeldCoupling>> parted(std::vector<HeldCoupling> items) {
  DisjointSets sets(items.size());
  std::map<std::int64_t, int> first;
  for (std::size_t i = 0; i < items.size(); ++i)
    for (const PairNode& node : items[i].nodes)
      if (const auto [at, isNew] = first.emplace(node.node, int(i)); !isNew) sets.join(at->second, int(i));
  int count = 0;
  const std::vector<int> numbers = sets.numbered(count);
  std::vector<std::vector<HeldCoupling>> parts{std::size_t(count)};
  for (std::size_t i = 0; i < items.size(); ++i) parts[std::size_t(numbers[i])].push_back(std::move(items[i]));
  return parts;
}

struct Rows {
  std::vector<GlobalOrdinal> global;
  std::vector<double> diagonal;
  std::vector<char> isContact;
  Sparse C;  // [rows x components of nodes]
};

Rows rowsOfCouplings(const std::vector<HeldCoupling>& items) {
  Rows rows;
  std::map<std::pair<std::int64_t, int>, int> columns;
  std::vector<Eigen::Triplet<double>> entries;
  for (const HeldCoupling& item : items)
    for (std::size_t a = 0; a < 3; ++a) {
      if (item.rows[a] < 0) continue;
      forEachCoefficient(item.axes[a], item.nodes, [&](const PairNode& node, int d, double value) {
        if (std::abs(value) >= kRoundOff)
          entries.emplace_back(int(rows.global.size()), columns.emplace(std::pair(node.node, d), int(columns.size())).first->second, value);
      });
      rows.global.push_back(item.rows[a]);
      rows.diagonal.push_back(item.values[a]);
      rows.isContact.push_back(item.isContact);
    }
  rows.C.resize(Eigen::Index(rows.global.size()), Eigen::Index(columns.size()));
  rows.C.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

// Columns that span all z with C^T z = 0: e_j - A^- A e_j for each row j that a factor of A = C C^T drops.
Sparse kernelOf(const Sparse& C) {
  const Sparse A = C * Sparse(C.transpose());
  const SparseLdl factor(A);
  std::vector<Eigen::Triplet<double>> entries;
  int count = 0;
  for (const int j : factor.dropped()) {
    Eigen::VectorXd z = -factor.solve(Eigen::VectorXd(A.col(j)));
    z[j] += 1;
    for (Eigen::Index i = 0; i < z.size(); ++i)
      if (std::abs(z[i]) > kRoundOff) entries.emplace_back(int(i), count, z[i]);
    ++count;
  }
  Sparse Z(A.rows(), count);
  Z.setFromTriplets(entries.begin(), entries.end());
  return Z;
}

// Columns that have rows in common, group by group.
std::vector<std::vector<int>> groupsOf(const Sparse& Z) {
  DisjointSets sets{std::size_t(Z.cols())};
  std::vector<int> columnAt(std::size_t(Z.rows()), -1);
  for (int j = 0; j < Z.cols(); ++j)
    for (Sparse::InnerIterator it(Z, j); it; ++it) {
      int& other = columnAt[std::size_t(it.row())];
      if (other >= 0) sets.join(other, j);
      other = j;
    }
  int count = 0;
  const std::vector<int> numbers = sets.numbered(count);
  std::vector<std::vector<int>> groups{std::size_t(count)};
  for (int j = 0; j < Z.cols(); ++j) groups[std::size_t(numbers[std::size_t(j)])].push_back(j);
  return groups;
}

// visit(i, j, k Q_ij) of one group: its projector does not depend on which rows were dropped.
template <class Visit>
void forEachEntry(const Rows& rows, const Sparse& Z, const std::vector<int>& group, Visit&& visit) {
  std::map<int, int> places;
  for (const int j : group)
    for (Sparse::InnerIterator it(Z, j); it; ++it) places.emplace(int(it.row()), 0);
  std::vector<int> all;
  for (auto& [row, place] : places) place = int(all.size()), all.push_back(row);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(Eigen::Index(all.size()), Eigen::Index(group.size()));
  for (std::size_t j = 0; j < group.size(); ++j)
    for (Sparse::InnerIterator it(Z, group[j]); it; ++it) columns(places.at(int(it.row())), Eigen::Index(j)) = it.value();
  const Eigen::MatrixXd basis = orthonormalBasis(columns), Q = basis * basis.transpose();
  double k = 0;
  for (std::size_t i = 0; i < all.size(); ++i) k += Q(Eigen::Index(i), Eigen::Index(i)) * rows.diagonal[std::size_t(all[i])];
  k *= kStiffness / double(group.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < all.size(); ++j)
      if (const double q = Q(Eigen::Index(i), Eigen::Index(j)); std::abs(q) > kRoundOff) visit(std::size_t(all[i]), std::size_t(all[j]), k * q);
}

// E[i, j] of this rank, of rows that may be others'.
struct Entry {
  GlobalOrdinal row, column;
  double value;
  bool isContactRow, isContactColumn;
};

std::vector<Entry> entriesOfE(const std::vector<HeldCoupling>& items) {
  std::vector<Entry> entries;
  for (const auto& part : parted(withoutIndependent(items))) {
    const Rows rows = rowsOfCouplings(part);
    const Sparse Z = kernelOf(rows.C);
    for (const auto& group : groupsOf(Z))
      forEachEntry(rows, Z, group, [&](std::size_t i, std::size_t j, double value) {
        entries.push_back({rows.global[i], rows.global[j], value, rows.isContact[i] != 0, rows.isContact[j] != 0});
      });
  }
  return entries;
}

// Room in a row for all of E, or for a part.  Collective.
std::size_t mostPerRow(const Communicator& comm, const std::vector<Entry>& entries) {
  std::map<GlobalOrdinal, int> counts;
  int most = 0;
  for (const Entry& entry : entries) most = std::max(most, ++counts[entry.row]);
  return std::size_t(largestOfAll(comm, most));
}

template <class IsIn>
RCP<const CrsMatrix> matrixOf(const std::vector<Entry>& entries, std::size_t perRow, const RCP<const Map>& rows, const RCP<const Map>& columns,
                              IsIn&& isIn) {
  auto E = Teuchos::rcp(new CrsMatrix(rows, perRow));
  for (const Entry& entry : entries)
    if (isIn(entry)) E->insertGlobalValues(entry.row, Teuchos::tuple(entry.column), Teuchos::tuple(entry.value));
  E->fillComplete(columns, rows);
  return E;
}

}  // namespace

DependentRows findDependentRows(const MultiplierMap& multipliers, const Vector& diagonal) {
  const auto& comm = *multipliers.map()->getComm();
  const std::vector<HeldCoupling> items = heldCouplings(multipliers, diagonal);
  std::vector<Entry> entries;
  runOnAllRanks(comm, [&] { entries = entriesOfE(items); });
  const std::size_t perRow = mostPerRow(comm, entries);
  if (perRow == 0) return {};
  const auto &all = multipliers.map(), &contact = multipliers.contactMap();
  return {matrixOf(entries, perRow, all, all, [](const Entry&) { return true; }),
          matrixOf(entries, perRow, contact, all, [](const Entry& entry) { return entry.isContactRow; }),
          matrixOf(entries, perRow, contact, contact, [](const Entry& entry) { return entry.isContactRow && entry.isContactColumn; })};
}

}  // namespace Haptos
