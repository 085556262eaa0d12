// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_JumpOperator.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <algorithm>
#include <numeric>

#include "Haptos_TpetraCompat.hpp"

namespace Haptos {
namespace {

// What B and B^T send is counted apart: scaling.md has formulas for it.
template <class Transfer>
void count(JumpOperator::Traffic& traffic, std::size_t vectors, Transfer&& transfer) {
  const CommunicationCounts before = communicationSoFar();
  transfer();
  traffic.vectors += long(vectors);
  traffic.sent += communicationSoFar() - before;
}

}  // namespace

// Rows compressed, own ones first: entries lie in the order in which B is multiplied.
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

// Unknowns of a subdomain in the order of its entries; one that several rows touch comes as often.
std::vector<int> JumpOperator::touchedDofs(int localSubdomain) const {
  const auto& entries = multipliers_->overlapEntries();  // sorted by subdomain
  const int subdomain = firstSubdomain_ + localSubdomain;
  const auto bySubdomain = [](const MultiplierMap::OverlapEntry& entry, int s) { return entry.subdomain < s; };
  auto it = std::lower_bound(entries.begin(), entries.end(), subdomain, bySubdomain);
  std::vector<int> dofs;
  for (; it != entries.end() && it->subdomain == subdomain; ++it) dofs.push_back(it->dof);
  return dofs;
}

// Rows of this rank go straight to y; those of others are sent to their owners.
void JumpOperator::multiply(const MultiVector& x, MultiVector& y, double alpha, double beta) const {
  const RemoteRows& remoteRows = multipliers_->remote();
  const std::size_t rows = rowOffsets_.size() - 1, owned = remoteRows.numOwned(), columns = x.getNumVectors();
  MultiVector remote(remoteRows.map(), columns, false);
  for (std::size_t v = 0; v < columns; ++v) {
    const auto u = x.getData(v);
    const auto mine = y.getDataNonConst(v), others = remote.getDataNonConst(v);
    const auto jumpAt = [&](std::size_t row) {
      double sum = 0;
      for (auto k = rowOffsets_[row]; k < rowOffsets_[row + 1]; ++k) sum += values_[k] * u[columns_[k]];
      return alpha * sum;
    };
    for (std::size_t row = 0; row < owned; ++row) mine[row] = beta == 0.0 ? jumpAt(row) : beta * mine[row] + jumpAt(row);
    for (std::size_t row = owned; row < rows; ++row) others[row - owned] = jumpAt(row);
  }
  count(forward_, columns, [&] { remoteRows.addToOwners(remote, y); });
}

// Values of other ranks' rows are fetched first; then every row adds its multiples to what it touches here.
void JumpOperator::multiplyTransposed(const MultiVector& x, MultiVector& y, double alpha, double beta) const {
  const RemoteRows& remoteRows = multipliers_->remote();
  const std::size_t rows = rowOffsets_.size() - 1, owned = remoteRows.numOwned(), columns = x.getNumVectors();
  MultiVector remote(remoteRows.map(), columns, false);
  count(transposed_, columns, [&] { remoteRows.fetch(x, remote); });
  if (beta == 0.0) y.putScalar(0.0);
  else y.scale(beta);
  for (std::size_t v = 0; v < columns; ++v) {
    const auto mine = x.getData(v), others = remote.getData(v);
    const auto f = y.getDataNonConst(v);
    const auto spread = [&](std::size_t row, double value) {
      for (auto k = rowOffsets_[row]; k < rowOffsets_[row + 1]; ++k) f[columns_[k]] += alpha * values_[k] * value;
    };
    for (std::size_t row = 0; row < owned; ++row) spread(row, mine[row]);
    for (std::size_t row = owned; row < rows; ++row) spread(row, others[row - owned]);
  }
}

// y := alpha B x + beta y, or with B^T
void JumpOperator::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode, double alpha, double beta) const {
  if (mode == Teuchos::NO_TRANS) multiply(x, y, alpha, beta);
  else multiplyTransposed(x, y, alpha, beta);
}

}  // namespace Haptos
