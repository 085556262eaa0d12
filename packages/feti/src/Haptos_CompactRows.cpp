// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CompactRows.hpp"

#include <Teuchos_Assert.hpp>
#include <Tpetra_Map.hpp>

#include "Haptos_SparseBlocks.hpp"
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
                         const std::function<double(const MultiplierMap::OverlapEntry&)>& scale) {
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
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& entry : multipliers.overlapEntries()) {
    if (!isKept[std::size_t(entry.row)]) continue;
    const Eigen::Index position = place(entry.subdomain, entry.dof);
    if (position >= 0) entries.emplace_back(number[std::size_t(entry.row)], int(position), entry.value * scale(entry));
  }
  collects_.resize(Eigen::Index(rows_.size() + localNumElements(*remote_->map())), size);
  collects_.setFromTriplets(entries.begin(), entries.end());
  spreads_ = collects_.transpose();
}

// T = B^T X of the kept rows, X this rank's own ones.
Eigen::MatrixXd CompactRows::spread(const Eigen::MatrixXd& X) const {
  Eigen::MatrixXd all(collects_.rows(), X.cols());
  all.topRows(X.rows()) = X;
  for (Eigen::Index v = 0; v < X.cols(); ++v) all.col(v).tail(all.rows() - X.rows()) = remote_->fetch(X.col(v));
  return timesColumns(spreads_, all);
}

Eigen::SparseMatrix<double> CompactRows::spreads(const Eigen::VectorXd& columns, Eigen::Index count) const {
  Eigen::VectorXd all(collects_.rows());
  all << columns, remote_->fetch(columns);
  std::vector<Eigen::Triplet<double>> triplets;
  for (Eigen::Index row = 0; row < collects_.rows(); ++row)
    for (Matrix::InnerIterator it(collects_, row); it && all[row] >= 0; ++it) triplets.emplace_back(int(it.col()), int(all[row]), it.value());
  Eigen::SparseMatrix<double> result(size(), count);
  result.setFromTriplets(triplets.begin(), triplets.end());
  return result;
}

// B T on this rank's own kept rows.
Eigen::MatrixXd CompactRows::collect(const Eigen::MatrixXd& T) const {
  const Eigen::MatrixXd all = timesColumns(collects_, T);
  Eigen::MatrixXd Y = all.topRows(Eigen::Index(rows_.size()));
  for (Eigen::Index v = 0; v < T.cols(); ++v) {
    Eigen::VectorXd y = Y.col(v);
    remote_->addToOwners(all.col(v).tail(all.rows() - Y.rows()), y);
    Y.col(v) = y;
  }
  return Y;
}

}  // namespace Haptos
