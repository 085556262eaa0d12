// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DependentGroups.hpp"

#include <Eigen/SparseCore>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <cmath>
#include <map>

#include "Haptos_CouplingCoefficients.hpp"
#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_DependentUnknowns.hpp"
#include "Haptos_DisjointSets.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_HeldCouplings.hpp"
#include "Haptos_SparseLdl.hpp"

namespace Haptos {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr double kRoundOff = 1e-9;  // of coefficients that are about 1
constexpr double kNearly = 1e-3;    // of a row: what forces with less of an effect do is the law's alone too

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
    if (at.size() == 1 && hasToItself(items[std::size_t(at.front())].nodes, node.node)) leave(at.front());
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
      rows.isContact.push_back(item.isContact);
    }
  rows.C.resize(Eigen::Index(rows.global.size()), Eigen::Index(columns.size()));
  rows.C.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

Sparse withoutUnknowns(const Sparse& A, const std::vector<int>& dropped) {
  Eigen::VectorXd kept = Eigen::VectorXd::Ones(A.rows());
  for (const int j : dropped) kept[j] = 0;
  return Sparse(kept.asDiagonal() * A * kept.asDiagonal()).pruned();
}

// Columns that span all z with C^T z = 0, or nearly so: e_j - A^- A e_j for each row j that others determine in A = C C^T.
Sparse kernelOf(const Sparse& C) {
  const Sparse A = C * Sparse(C.transpose());
  const std::vector<int> dropped = dependentUnknowns(A, kNearly * kNearly);
  const SparseLdl factor(withoutUnknowns(A, dropped));
  std::vector<Eigen::Triplet<double>> entries;
  int count = 0;
  for (const int j : dropped) {
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

// Its projector does not depend on which rows were dropped.
DependentGroup groupOf(const Rows& rows, const Sparse& Z, const std::vector<int>& columns) {
  std::map<int, int> places;
  for (const int j : columns)
    for (Sparse::InnerIterator it(Z, j); it; ++it) places.emplace(int(it.row()), 0);
  DependentGroup group;
  for (auto& [row, place] : places) {
    place = int(group.rows.size());
    group.rows.push_back(rows.global[std::size_t(row)]);
    group.isContact.push_back(rows.isContact[std::size_t(row)]);
  }
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(Eigen::Index(places.size()), Eigen::Index(columns.size()));
  for (std::size_t j = 0; j < columns.size(); ++j)
    for (Sparse::InnerIterator it(Z, columns[j]); it; ++it) all(places.at(int(it.row())), Eigen::Index(j)) = it.value();
  const Eigen::MatrixXd basis = orthonormalBasis(all);
  group.Q = basis * basis.transpose();
  group.dimension = int(columns.size());
  return group;
}

}  // namespace

double DependentGroup::mean(const std::vector<double>& ofRows) const {
  double sum = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) sum += Q(Eigen::Index(i), Eigen::Index(i)) * ofRows[i];
  return sum / dimension;
}

std::vector<DependentGroup> findDependentGroups(const MultiplierMap& multipliers) {
  const std::vector<HeldCoupling> items = heldCouplings(multipliers, Vector(multipliers.map()));
  std::vector<DependentGroup> groups;
  runOnAllRanks(*multipliers.map()->getComm(), [&] {
    for (const auto& part : parted(withoutIndependent(items))) {
      const Rows rows = rowsOfCouplings(part);
      const Sparse Z = kernelOf(rows.C);
      for (const auto& columns : groupsOf(Z)) groups.push_back(groupOf(rows, Z, columns));
    }
  });
  return groups;
}

Eigen::SparseMatrix<double> meanOnDependentRows(const std::vector<DependentGroup>& dependent, const std::vector<GlobalOrdinal>& rows,
                                                const Eigen::VectorXd& diagonal) {
  std::vector<Eigen::Triplet<double>> entries;
  std::map<GlobalOrdinal, int> places;
  for (std::size_t i = 0; i < rows.size() && !dependent.empty(); ++i) places.emplace(rows[i], int(i));
  for (const DependentGroup& group : dependent) {
    if (places.count(group.rows.front()) == 0) continue;
    std::vector<int> at;
    std::vector<double> ofRows;
    for (const GlobalOrdinal row : group.rows) at.push_back(places.at(row)), ofRows.push_back(diagonal[at.back()]);
    const double s = group.mean(ofRows);
    for (std::size_t i = 0; i < at.size(); ++i)
      for (std::size_t j = 0; j < at.size(); ++j)
        if (const double q = group.Q(Eigen::Index(i), Eigen::Index(j)); q != 0) entries.emplace_back(at[i], at[j], s * q);
  }
  Eigen::SparseMatrix<double> sum(Eigen::Index(rows.size()), Eigen::Index(rows.size()));
  sum.setFromTriplets(entries.begin(), entries.end());
  return sum;
}

}  // namespace Haptos
