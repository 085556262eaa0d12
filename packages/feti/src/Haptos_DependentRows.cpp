// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DependentRows.hpp"

#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <cmath>
#include <map>

#include "Haptos_DependentGroups.hpp"
#include "Haptos_Reductions.hpp"

namespace Haptos {
namespace {

constexpr double kNothing = 1e-9;   // of Q
constexpr double kStiffness = 1e6;  // of a row: what the law asks of a force has to be seen, down to jumps that are errors (decisions/057)

// E[i, j] of this rank, of rows that may be others'.
struct Entry {
  GlobalOrdinal row, column;
  double value;
  bool isContactRow, isContactColumn;
};

// Of the rows of these groups, one after the other, which may be other ranks'.  Collective.
std::vector<double> valuesOn(const std::vector<DependentGroup>& groups, const Vector& values) {
  std::vector<GlobalOrdinal> rows;
  for (const DependentGroup& group : groups) rows.insert(rows.end(), group.rows.begin(), group.rows.end());
  const auto none = Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid();
  const auto map = Teuchos::rcp(new Map(none, rows, 0, values.getMap()->getComm()));
  Vector found(map);
  found.doImport(values, Tpetra::Import<>(values.getMap(), map), Tpetra::INSERT);
  const auto data = found.getData(0);
  return {data.begin(), data.end()};
}

std::vector<Entry> entriesOfE(const std::vector<DependentGroup>& groups, const std::vector<double>& diagonal) {
  std::vector<Entry> entries;
  auto next = diagonal.begin();
  for (const DependentGroup& group : groups) {
    const auto first = next;
    next += std::ptrdiff_t(group.rows.size());
    const double k = kStiffness * group.mean({first, next});
    for (std::size_t i = 0; i < group.rows.size(); ++i)
      for (std::size_t j = 0; j < group.rows.size(); ++j)
        if (const double q = group.Q(Eigen::Index(i), Eigen::Index(j)); std::abs(q) > kNothing)
          entries.push_back({group.rows[i], group.rows[j], k * q, group.isContact[i] != 0, group.isContact[j] != 0});
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

DependentRows makeDependentRows(const MultiplierMap& multipliers, const std::vector<DependentGroup>& groups, const Vector& diagonal) {
  const auto& comm = *multipliers.map()->getComm();
  if (!anyOfAll(comm, !groups.empty())) return {};
  const std::vector<Entry> entries = entriesOfE(groups, valuesOn(groups, diagonal));
  const std::size_t perRow = mostPerRow(comm, entries);
  const auto &all = multipliers.map(), &contact = multipliers.contactMap();
  return {matrixOf(entries, perRow, all, all, [](const Entry&) { return true; }),
          matrixOf(entries, perRow, contact, all, [](const Entry& entry) { return entry.isContactRow; }),
          matrixOf(entries, perRow, contact, contact, [](const Entry& entry) { return entry.isContactRow && entry.isContactColumn; })};
}

}  // namespace Haptos
