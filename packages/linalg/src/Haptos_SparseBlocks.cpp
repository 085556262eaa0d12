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

namespace {

// Entries of a column in the making.
struct Entries {
  int* rows;
  double* values;
  int size = 0;

  void take(const Eigen::SparseMatrix<double>& K, int first, int last) {
    std::copy(K.innerIndexPtr() + first, K.innerIndexPtr() + last, rows + size);
    std::copy(K.valuePtr() + first, K.valuePtr() + last, values + size);
    size += last - first;
  }
};

}  // namespace

// Runs of columns to which nothing is added are one copy each; the others are merged.
Eigen::SparseMatrix<double> withFewAdded(const Eigen::SparseMatrix<double>& K, const Eigen::SparseMatrix<double>& few) {
  TEUCHOS_ASSERT(K.rows() == few.rows() && K.cols() == few.cols() && K.isCompressed() && few.isCompressed());
  Eigen::SparseMatrix<double> sum(K.rows(), K.cols());
  sum.resizeNonZeros(K.nonZeros() + few.nonZeros());
  Entries to{sum.innerIndexPtr(), sum.valuePtr()};
  const int *ofK = K.outerIndexPtr(), *ofFew = few.outerIndexPtr();
  int copied = 0;  // entries of K that are in the sum
  for (int j = 0; j < int(K.cols()); ++j) {
    for (int k = ofFew[j]; k < ofFew[j + 1]; ++k) {
      const int row = few.innerIndexPtr()[k];
      const int at = int(std::lower_bound(K.innerIndexPtr() + std::max(copied, ofK[j]), K.innerIndexPtr() + ofK[j + 1], row) - K.innerIndexPtr());
      to.take(K, copied, at);
      copied = at;
      to.take(few, k, k + 1);
      if (at == ofK[j + 1] || K.innerIndexPtr()[at] != row) continue;
      to.values[to.size - 1] += K.valuePtr()[at];
      ++copied;
    }
    // Where this column ends in the sum: what is not copied yet comes between.
    sum.outerIndexPtr()[j + 1] = to.size + ofK[j + 1] - copied;
  }
  to.take(K, copied, ofK[K.cols()]);
  sum.resizeNonZeros(to.size);
  return sum;
}

Eigen::MatrixXd rowsOf(const Eigen::Ref<const Eigen::MatrixXd>& A, const std::vector<int>& rows) {
  Eigen::MatrixXd part(Eigen::Index(rows.size()), A.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) part.row(Eigen::Index(i)) = A.row(rows[i]);
  return part;
}

}  // namespace Haptos
