// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_AssemblyOnRoot.hpp"

#include <Tpetra_Map.hpp>
#include <map>

#include "Haptos_DisjointSets.hpp"
#include "Haptos_LocalSystems.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

struct RowOfB {
  GlobalOrdinal row;
  RowKind kind;
  std::int64_t place;  // among the rows of contact pairs, or of tied ones, of all ranks, three a pair
};

struct EntryOfB {
  GlobalOrdinal row;
  int subdomain, dof;
  double value;
};

// Of the upper triangle.
struct EntryOfK {
  int subdomain, i, j;
  double value;
};

std::vector<RowOfB> rowsOf(const MultiplierMap& multipliers) {
  const Communicator& comm = *multipliers.map()->getComm();
  std::vector<RowOfB> rows;
  for (std::size_t i = 0; i < multipliers.kinds().size(); ++i)
    rows.push_back({multipliers.map()->getGlobalElement(LocalOrdinal(i)), multipliers.kinds()[i], -1});
  const auto place = [&rows](int row, std::int64_t at) {
    if (row >= 0) rows[std::size_t(row)].place = at;
  };
  std::int64_t at = 3 * sumOfLower(comm, std::int64_t(multipliers.pairs().size()));
  for (const LocalPair& pair : multipliers.pairs())
    for (const int row : {pair.normal, pair.tangential[0], pair.tangential[1]}) place(row, at++);
  at = 3 * sumOfLower(comm, std::int64_t(multipliers.tiedPairs().size()));
  for (const TiedPair& pair : multipliers.tiedPairs())
    for (const int row : pair.rows) place(row, at++);
  return rows;
}

std::vector<EntryOfB> entriesOf(const MultiplierMap& multipliers) {
  std::vector<EntryOfB> entries;
  for (const auto& entry : multipliers.overlapEntries())
    entries.push_back({multipliers.overlapMap()->getGlobalElement(entry.row), entry.subdomain, entry.dof, entry.value});
  return entries;
}

std::vector<EntryOfK> entriesOf(const LocalSystems& systems, int firstSubdomain) {
  std::vector<EntryOfK> entries;
  for (int s = 0; s < systems.size(); ++s) {
    const auto& K = systems.stiffness(systems[s].congruenceClass);
    for (int j = 0; j < K.outerSize(); ++j)
      for (Eigen::SparseMatrix<double>::InnerIterator entry(K, j); entry && entry.row() <= j; ++entry)
        entries.push_back({firstSubdomain + s, int(entry.row()), j, entry.value()});
  }
  return entries;
}

std::vector<std::int64_t> sizesOf(const LocalSystems& systems) {
  std::vector<std::int64_t> sizes;
  for (int s = 0; s < systems.size(); ++s) sizes.push_back(systems.stiffness(systems[s].congruenceClass).rows());
  return sizes;
}

// Of all ranks, whose subdomains follow one another.
class Joiner {
 public:
  Joiner(const std::vector<RowOfB>& rows, std::vector<EntryOfB> entries, const std::vector<std::int64_t>& sizes)
      : entries_(std::move(entries)) {
    for (const auto size : sizes) offsets_.push_back(offsets_.back() + std::size_t(size));
    for (const RowOfB& row : rows) rowOf_[row.row] = row;
    number();
  }

  void addStiffness(const std::vector<EntryOfK>& entries) {
    for (const EntryOfK& entry : entries) {
      const int i = numberOf(entry.subdomain, entry.i), j = numberOf(entry.subdomain, entry.j);
      if (i < 0 || j < 0) continue;
      parts_.K.emplace_back(i, j, entry.value);
      if (entry.i != entry.j) parts_.K.emplace_back(j, i, entry.value);
    }
  }

  void addPairs(std::int64_t contactPairs, std::int64_t tiedPairs) {
    parts_.contactPairs = contactPairs, parts_.tiedPairs = tiedPairs;
    for (const EntryOfB& entry : entries_) {
      const RowOfB& row = rowOf_.at(entry.row);
      const int number = numberOf(entry.subdomain, entry.dof);
      if (row.place >= 0 && number >= 0) parts_.C.emplace_back(int(row.place + (row.kind == RowKind::Tied ? 3 * contactPairs : 0)), number, entry.value);
    }
  }

  AssembledStiffness::Parts take() { return std::move(parts_); }

 private:
  std::size_t placeOf(int subdomain, int dof) const { return offsets_[std::size_t(subdomain)] + std::size_t(dof); }
  int numberOf(int subdomain, int dof) const { return parts_.numberOf[placeOf(subdomain, dof)]; }

  // Copies that a gluing row holds together are one displacement; by lowest copies, so that those of a node stay together.
  void number() {
    DisjointSets copies(offsets_.back());
    std::map<GlobalOrdinal, int> firstOf;
    for (const EntryOfB& entry : entries_)
      if (rowOf_.at(entry.row).kind == RowKind::Gluing) {
        const int place = int(placeOf(entry.subdomain, entry.dof));
        copies.join(firstOf.try_emplace(entry.row, place).first->second, place);
      }
    int count = 0;
    parts_.numberOf = copies.numbered(count);
    parts_.size = count;
    std::vector<char> isPrescribed(std::size_t(count), 0);
    for (const EntryOfB& entry : entries_)
      if (rowOf_.at(entry.row).kind == RowKind::Dirichlet) isPrescribed[std::size_t(numberOf(entry.subdomain, entry.dof))] = 1;
    for (int i = 0; i < count; ++i)
      if (isPrescribed[std::size_t(i)]) parts_.K.emplace_back(i, i, 1.0);
    for (int& number : parts_.numberOf)
      if (isPrescribed[std::size_t(number)]) number = -1;
  }

  std::vector<EntryOfB> entries_;
  std::map<GlobalOrdinal, RowOfB> rowOf_;
  std::vector<std::size_t> offsets_{0};
  AssembledStiffness::Parts parts_;
};

}  // namespace

AssembledStiffness::Parts assembleOnRoot(const JumpOperator& jump, const LocalSystems& systems) {
  const MultiplierMap& multipliers = jump.multipliers();
  const Communicator& comm = *multipliers.map()->getComm();
  const auto contactPairs = sumOfAll(comm, std::int64_t(multipliers.pairs().size())), tiedPairs = sumOfAll(comm, std::int64_t(multipliers.tiedPairs().size()));
  const auto rows = gatheredOnRoot(comm, rowsOf(multipliers));
  auto entries = gatheredOnRoot(comm, entriesOf(multipliers));
  const auto sizes = gatheredOnRoot(comm, sizesOf(systems));
  const auto stiffness = gatheredOnRoot(comm, entriesOf(systems, jump.firstSubdomain()));
  if (comm.getRank() != 0) return {};
  Joiner joiner(rows, std::move(entries), sizes);
  joiner.addStiffness(stiffness);
  joiner.addPairs(contactPairs, tiedPairs);
  return joiner.take();
}

}  // namespace Haptos
