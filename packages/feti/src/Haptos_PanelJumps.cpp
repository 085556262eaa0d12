// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_PanelJumps.hpp"

#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <algorithm>
#include <numeric>

#include "Haptos_DualPreconditioner.hpp"
#include "Haptos_LocalSystems.hpp"
#include "Haptos_RowGram.hpp"
#include "Haptos_SurfaceOperators.hpp"
#include "Haptos_TpetraCompat.hpp"

namespace Haptos {
namespace {

constexpr int kColumns = RowPanel::kColumns;

void add(double factor, const double* from, double* to) {
  for (int v = 0; v < kColumns; ++v) to[v] += factor * from[v];
}

// Rows that others have, too, and their values in x
template <class Visit>
void forEachShared(const RemoteRows& remoteRows, MultiVector& x, Visit&& visit) {
  const auto rows = remoteRows.importer().getExportLIDs();
  for (std::size_t v = 0; v < std::size_t(kColumns); ++v) {
    const auto data = x.getDataNonConst(v);
    for (const int row : rows) visit(std::size_t(row), v, data[row]);
  }
}

}  // namespace

PanelJumps::PanelJumps(const DualPreconditioner& M)
    : M_(M), first_{0}, y_(localNumElements(*M.jump().multipliers().overlapMap())) {
  const MultiplierMap& multipliers = M.jump().multipliers();
  std::vector<std::vector<int>> places;  // [local subdomains][dofs] among the boundary unknowns
  for (int i = 0; i < M.systems().size(); ++i) {
    const auto& boundary = M.surface().boundary(M.systems()[i].congruenceClass);
    auto& place = places.emplace_back(std::size_t(M.systems()[i].R().rows()), -1);
    for (std::size_t k = 0; k < boundary.size(); ++k) place[std::size_t(boundary[k])] = int(first_.back() + k);
    first_.push_back(first_.back() + boundary.size());
  }
  const auto placeOf = [&](const MultiplierMap::OverlapEntry& entry) {
    return std::size_t(places[std::size_t(entry.subdomain - M.jump().firstSubdomain())][std::size_t(entry.dof)]);
  };
  const auto& entries = multipliers.overlapEntries();
  weights_.assign(size(), 0.0);
  firstOfUnknown_.assign(size() + 1, 0);
  firstOfRow_.assign(y_.rows() + 1, 0);
  for (const auto& entry : entries) {
    weights_[placeOf(entry)] = 1.0 / entry.weight;
    ++firstOfUnknown_[placeOf(entry) + 1];
    ++firstOfRow_[std::size_t(entry.row) + 1];
  }
  std::partial_sum(firstOfUnknown_.begin(), firstOfUnknown_.end(), firstOfUnknown_.begin());
  std::partial_sum(firstOfRow_.begin(), firstOfRow_.end(), firstOfRow_.begin());
  ofUnknowns_.resize(entries.size());
  ofRows_.resize(entries.size());
  std::vector<std::size_t> ofUnknown(firstOfUnknown_.begin(), firstOfUnknown_.end() - 1), ofRow(firstOfRow_.begin(), firstOfRow_.end() - 1);
  for (const auto& entry : entries) {
    ofUnknowns_[ofUnknown[placeOf(entry)]++] = {entry.row, entry.value};
    ofRows_[ofRow[std::size_t(entry.row)]++] = {int(placeOf(entry)), entry.value};
  }
  if (multipliers.map()->getComm()->getSize() == 1) return;
  own_ = Teuchos::rcp(new MultiVector(multipliers.map(), kColumns, false));
  remote_ = Teuchos::rcp(new MultiVector(multipliers.remote().map(), kColumns, false));
}

std::vector<SubdomainColumns::Piece> PanelJumps::piecesOf(const RowPanel& t, int width) const {
  std::vector<int> filled = t.filled();
  std::sort(filled.begin(), filled.end());
  std::vector<SubdomainColumns::Piece> pieces;
  for (auto end = filled.begin(); end != filled.end();) {
    const auto begin = end;
    const std::size_t i = std::size_t(std::upper_bound(first_.begin(), first_.end(), std::size_t(*begin)) - first_.begin()) - 1;
    while (end != filled.end() && std::size_t(*end) < first_[i + 1]) ++end;
    SubdomainColumns::Piece piece{i, {}, {}, {}};
    for (auto row = begin; row != end; ++row) piece.rows.push_back(Eigen::Index(std::size_t(*row) - first_[i]));
    for (Eigen::Index v = 0; v < width; ++v)
      if (std::any_of(begin, end, [&](int row) { return t[std::size_t(row)][v] != 0; })) piece.columns.push_back(v);
    if (piece.columns.empty()) continue;
    piece.values.resize(Eigen::Index(piece.rows.size()), Eigen::Index(piece.columns.size()));
    for (Eigen::Index k = 0; k < piece.values.rows(); ++k)
      for (Eigen::Index v = 0; v < piece.values.cols(); ++v) piece.values(k, v) = t[std::size_t(begin[k])][piece.columns[std::size_t(v)]];
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

// y_ := B t, or B W t, of this rank's unknowns
void PanelJumps::takeJumps(const RowPanel& t, Weighted weighted) {
  y_.clear();
  for (const int unknown : t.filled()) {
    const double weight = weighted == Weighted::Yes ? weights_[std::size_t(unknown)] : 1.0;
    for (auto k = firstOfUnknown_[std::size_t(unknown)]; k < firstOfUnknown_[std::size_t(unknown) + 1]; ++k)
      add(weight * ofUnknowns_[k].value, t[std::size_t(unknown)], y_.fill(std::size_t(ofUnknowns_[k].at)));
  }
}

// t += factor W B^T y_
void PanelJumps::addSpread(double factor, RowPanel& t) const {
  for (const int row : y_.filled())
    for (auto k = firstOfRow_[std::size_t(row)]; k < firstOfRow_[std::size_t(row) + 1]; ++k) {
      const std::size_t unknown = std::size_t(ofRows_[k].at);
      add(factor * weights_[unknown] * ofRows_[k].value, y_[std::size_t(row)], t.fill(unknown));
    }
}

// What this rank has for rows of others is added there.
void PanelJumps::toOwners() {
  if (own_.is_null()) return;
  const RemoteRows& remoteRows = M_.jump().multipliers().remote();
  const std::size_t owned = remoteRows.numOwned();
  for (std::size_t v = 0; v < std::size_t(kColumns); ++v) {
    const auto data = remote_->getDataNonConst(v);
    for (std::size_t row = owned; row < y_.rows(); ++row) data[Teuchos_Ordinal(row - owned)] = y_[row][v];
  }
  forEachShared(remoteRows, *own_, [](std::size_t, std::size_t, double& value) { value = 0; });
  remoteRows.addToOwners(*remote_, *own_);
  // a row that several ranks have comes as often: it is taken once
  forEachShared(remoteRows, *own_, [&](std::size_t row, std::size_t v, double& value) {
    if (value != 0) y_.fill(row)[v] += value;
    value = 0;
  });
}

void PanelJumps::fromOwners() {
  if (own_.is_null()) return;
  const RemoteRows& remoteRows = M_.jump().multipliers().remote();
  const std::size_t owned = remoteRows.numOwned();
  forEachShared(remoteRows, *own_, [&](std::size_t row, std::size_t v, double& value) { value = y_[row][v]; });
  remoteRows.fetch(*own_, *remote_);
  for (std::size_t v = 0; v < std::size_t(kColumns); ++v) {
    const auto data = remote_->getData(v);
    for (std::size_t row = owned; row < y_.rows(); ++row) y_.data()[row * kColumns + v] = data[Teuchos_Ordinal(row - owned)];
  }
  for (std::size_t row = owned; row < y_.rows(); ++row) y_.fillIfAny(row);
}

// y_ := (B W B^T)^-1 y_
void PanelJumps::solveGram() {
  toOwners();
  M_.gram().apply(y_);
}

void PanelJumps::average(RowPanel& t) {
  takeJumps(t, Weighted::No);
  solveGram();
  fromOwners();
  addSpread(-1, t);
}

void PanelJumps::spread(const std::vector<std::array<int, 2>>& units, RowPanel& t) {
  y_.clear();
  for (const auto& [row, column] : units) y_.fill(std::size_t(row))[column] = 1;
  M_.gram().apply(y_);
  fromOwners();
  addSpread(1, t);
}

void PanelJumps::collect(const RowPanel& t, const std::vector<int>& rows, Eigen::Ref<Eigen::MatrixXd> y) {
  takeJumps(t, Weighted::Yes);
  solveGram();
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (Eigen::Index v = 0; v < y.cols(); ++v) y(Eigen::Index(i), v) = y_[std::size_t(rows[i])][v];
}

}  // namespace Haptos
