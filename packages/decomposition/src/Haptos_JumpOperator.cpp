// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_JumpOperator.hpp"

#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <algorithm>
#include <numeric>

#include "Haptos_TpetraCompat.hpp"

namespace Haptos {
namespace {

template <class Transfer>
void count(JumpOperator::Traffic& traffic, std::size_t vectors, Transfer&& transfer) {
  const CommunicationCounts before = communicationSoFar();
  transfer();
  traffic.vectors += long(vectors);
  traffic.sent += communicationSoFar() - before;
}

}  // namespace

JumpOperator::JumpOperator(RCP<const MultiplierMap> multipliers, int firstSubdomain, const std::vector<int>& dofsOfSubdomain)
    : multipliers_(std::move(multipliers)), firstSubdomain_(firstSubdomain), primalOffsets_{0} {
  for (int dofs : dofsOfSubdomain) primalOffsets_.push_back(primalOffsets_.back() + dofs);
  const auto invalid = Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid();
  primalMap_ = Teuchos::rcp(new Map(invalid, primalOffsets_.back(), 0, multipliers_->map()->getComm()));

  const std::size_t rows = localNumElements(*multipliers_->overlapMap());
  const auto& entries = multipliers_->overlapEntries();
  rowOffsets_.assign(rows + 1, 0);
  for (const auto& entry : entries) ++rowOffsets_[entry.row + 1];
  std::partial_sum(rowOffsets_.begin(), rowOffsets_.end(), rowOffsets_.begin());
  columns_.resize(entries.size());
  values_.resize(entries.size());
  std::vector<std::size_t> next(rowOffsets_.begin(), rowOffsets_.end() - 1);
  for (const auto& entry : entries) {
    const std::size_t at = next[entry.row]++;
    columns_[at] = int(primalOffsets_[entry.subdomain - firstSubdomain]) + entry.dof;
    values_[at] = entry.value;
  }
}

std::vector<int> JumpOperator::touchedDofs(int localSubdomain) const {
  const auto& entries = multipliers_->overlapEntries();  // sorted by subdomain
  const int subdomain = firstSubdomain_ + localSubdomain;
  const auto bySubdomain = [](const MultiplierMap::OverlapEntry& entry, int s) { return entry.subdomain < s; };
  auto it = std::lower_bound(entries.begin(), entries.end(), subdomain, bySubdomain);
  std::vector<int> dofs;
  for (; it != entries.end() && it->subdomain == subdomain; ++it) dofs.push_back(it->dof);
  return dofs;
}

void JumpOperator::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode, double alpha, double beta) const {
  const std::size_t rows = rowOffsets_.size() - 1, columns = x.getNumVectors();
  MultiVector overlap(multipliers_->overlapMap(), columns);
  if (mode == Teuchos::NO_TRANS) {
    for (std::size_t v = 0; v < columns; ++v) {
      const auto u = x.getData(v);
      const auto s = overlap.getDataNonConst(v);
      for (std::size_t row = 0; row < rows; ++row) {
        double sum = 0;
        for (auto k = rowOffsets_[row]; k < rowOffsets_[row + 1]; ++k) sum += values_[k] * u[columns_[k]];
        s[row] = alpha * sum;
      }
    }
    // Tpetra 13.2 adds only what comes from other ranks; what is here already would be replaced.
    MultiVector sum(y.getMap(), columns);
    count(forward_, columns, [&] { sum.doExport(overlap, multipliers_->importer(), Tpetra::ADD); });
    y.update(1.0, sum, beta);
    return;
  }
  count(transposed_, columns, [&] { overlap.doImport(x, multipliers_->importer(), Tpetra::INSERT); });
  if (beta == 0.0) y.putScalar(0.0);
  else y.scale(beta);
  for (std::size_t v = 0; v < columns; ++v) {
    const auto l = overlap.getData(v);
    const auto f = y.getDataNonConst(v);
    for (std::size_t row = 0; row < rows; ++row)
      for (auto k = rowOffsets_[row]; k < rowOffsets_[row + 1]; ++k) f[columns_[k]] += alpha * values_[k] * l[row];
  }
}

}  // namespace Haptos
