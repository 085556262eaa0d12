// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SparseBlocks.hpp"

#include <Teuchos_Assert.hpp>
#include <algorithm>

namespace Haptos {

std::vector<int> complement(Eigen::Index n, const std::vector<int>& listed) {
  std::vector<bool> isListed(n, false);
  for (const int i : listed) {
    TEUCHOS_ASSERT(i >= 0 && i < n && !isListed[i]);
    isListed[i] = true;
  }
  std::vector<int> rest;
  for (Eigen::Index i = 0; i < n; ++i)
    if (!isListed[i]) rest.push_back(int(i));
  return rest;
}

// Entries are counted first, so that nothing grows.
Eigen::SparseMatrix<double> blockOf(const Eigen::SparseMatrix<double>& K, const std::vector<int>& rows, const std::vector<int>& columns) {
  std::vector<int> newRow(std::size_t(K.rows()), -1);
  for (std::size_t i = 0; i < rows.size(); ++i) newRow[rows[i]] = int(i);
  Eigen::Index entries = 0;
  for (const int column : columns)
    for (Eigen::SparseMatrix<double>::InnerIterator it(K, column); it; ++it) entries += newRow[it.row()] >= 0;
  Eigen::SparseMatrix<double> part(Eigen::Index(rows.size()), Eigen::Index(columns.size()));
  part.resizeNonZeros(entries);
  Eigen::Index at = 0;
  for (std::size_t j = 0; j < columns.size(); ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(K, columns[j]); it; ++it) {
      if (newRow[it.row()] < 0) continue;
      part.innerIndexPtr()[at] = newRow[it.row()];
      part.valuePtr()[at++] = it.value();
    }
    part.outerIndexPtr()[j + 1] = int(at);
  }
  if (std::is_sorted(rows.begin(), rows.end())) return part;
  const Eigen::SparseMatrix<double> byRows = part.transpose();  // sorts
  return byRows.transpose();
}

Eigen::MatrixXd rowsOf(const Eigen::Ref<const Eigen::MatrixXd>& A, const std::vector<int>& rows) {
  Eigen::MatrixXd part(Eigen::Index(rows.size()), A.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) part.row(Eigen::Index(i)) = A.row(rows[i]);
  return part;
}

}  // namespace Haptos
