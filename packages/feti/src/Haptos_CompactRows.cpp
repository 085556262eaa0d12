// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CompactRows.hpp"

#include <Teuchos_Assert.hpp>
#include <Tpetra_Map.hpp>

#include "Haptos_TpetraCompat.hpp"

namespace Haptos {
namespace {

// The first `count` rows of a map as far as they are kept.
RCP<const Map> keptMap(const Map& map, const std::vector<char>& isKept, std::size_t count) {
  std::vector<int> kept;
  for (std::size_t row = 0; row < count; ++row)
    if (isKept[row]) kept.push_back(int(row));
  return mapOfRows(map, kept);
}

}  // namespace

// Rows are numbered anew, own ones first, and entries keep what `place` knows; the rest of B is not there.
CompactRows::CompactRows(const MultiplierMap& multipliers, const std::vector<char>& isKept, Eigen::Index size,
                         const std::function<Eigen::Index(int, int)>& place,
                         const std::function<double(const MultiplierMap::OverlapEntry&)>& scale)
    : size_(size) {
  const Map& overlap = *multipliers.overlapMap();
  const std::size_t owned = multipliers.remote().numOwned();
  TEUCHOS_ASSERT(isKept.size() == localNumElements(overlap));
  remote_ = std::make_unique<RemoteRows>(keptMap(overlap, isKept, owned), keptMap(overlap, isKept, isKept.size()));
  std::vector<int> number(isKept.size(), -1);
  for (std::size_t row = 0, next = 0; row < isKept.size(); ++row) {
    if (!isKept[row]) continue;
    number[row] = int(next++);
    if (row < owned) rows_.push_back(int(row));
  }
  for (const auto& entry : multipliers.overlapEntries()) {
    if (!isKept[std::size_t(entry.row)]) continue;
    const Eigen::Index position = place(entry.subdomain, entry.dof);
    if (position >= 0) entries_.push_back({number[std::size_t(entry.row)], int(position), entry.value * scale(entry)});
  }
}

// t = B^T x of the kept rows, x this rank's own ones.
Eigen::VectorXd CompactRows::spread(const Eigen::VectorXd& x) const {
  const Eigen::VectorXd remote = remote_->fetch(x);
  Eigen::VectorXd t = Eigen::VectorXd::Zero(size_);
  for (const Entry& e : entries_) t[e.position] += e.value * (e.row < x.size() ? x[e.row] : remote[e.row - x.size()]);
  return t;
}

// B t on this rank's own kept rows.
Eigen::VectorXd CompactRows::collect(const Eigen::VectorXd& t) const {
  const Eigen::Index owned = Eigen::Index(rows_.size());
  Eigen::VectorXd y = Eigen::VectorXd::Zero(owned), remote = Eigen::VectorXd::Zero(Eigen::Index(localNumElements(*remote_->map())));
  for (const Entry& e : entries_) (e.row < owned ? y[e.row] : remote[e.row - owned]) += e.value * t[e.position];
  remote_->addToOwners(remote, y);
  return y;
}

}  // namespace Haptos
