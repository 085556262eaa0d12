// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CoarseRows.hpp"

#include <Teuchos_Assert.hpp>

namespace Haptos {
namespace {

using Six = Eigen::Matrix<double, kCoarseModes, 1>;

// run(first column, six values) or one(column, value) for all entries of a row
template <class Run, class One>
inline void forEachRun(const CoarseRows& C, Eigen::Index row, Run&& run, One&& one) {
  const int* column = C.innerIndexPtr();
  const double* value = C.valuePtr();
  const int end = C.outerIndexPtr()[row + 1];
  for (int i = C.outerIndexPtr()[row]; i < end;) {
    if (i + kCoarseModes <= end && column[i + kCoarseModes - 1] == column[i] + kCoarseModes - 1) {
      run(column[i], Eigen::Map<const Six>(value + i));
      i += kCoarseModes;
    } else {
      one(column[i], value[i]);
      ++i;
    }
  }
}

}  // namespace

// y += x_i c_i, row by row: C is read once in its order
Eigen::VectorXd multiplyTransposed(const CoarseRows& C, const Eigen::Ref<const Eigen::VectorXd>& x) {
  TEUCHOS_ASSERT(C.isCompressed() && x.size() == C.rows());
  Eigen::VectorXd y = Eigen::VectorXd::Zero(C.cols());
  for (Eigen::Index row = 0; row < C.rows(); ++row) {
    const double xi = x[row];
    if (xi == 0) continue;
    forEachRun(C, row, [&](int first, const auto& values) { y.segment<kCoarseModes>(first) += xi * values; },
               [&](int column, double value) { y[column] += xi * value; });
  }
  return y;
}

// y_i = c_i . a, six columns as one product of small vectors
Eigen::VectorXd multiply(const CoarseRows& C, const Eigen::Ref<const Eigen::VectorXd>& a) {
  TEUCHOS_ASSERT(C.isCompressed() && a.size() == C.cols());
  Eigen::VectorXd y(C.rows());
  for (Eigen::Index row = 0; row < C.rows(); ++row) {
    double sum = 0;
    forEachRun(C, row, [&](int first, const auto& values) { sum += values.dot(a.segment<kCoarseModes>(first)); },
               [&](int column, double value) { sum += value * a[column]; });
    y[row] = sum;
  }
  return y;
}

}  // namespace Haptos
