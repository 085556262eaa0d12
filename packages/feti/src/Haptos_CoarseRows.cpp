// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CoarseRows.hpp"

#include <Teuchos_Assert.hpp>

namespace Haptos {
namespace {

constexpr int kModes = 6;
using Six = Eigen::Matrix<double, kModes, 1>;

// run(first column, six values) or one(column, value) for all entries of a row
template <class Run, class One>
inline void forEachRun(const CoarseRows& C, Eigen::Index row, Run&& run, One&& one) {
  const int* column = C.innerIndexPtr();
  const double* value = C.valuePtr();
  const int end = C.outerIndexPtr()[row + 1];
  for (int i = C.outerIndexPtr()[row]; i < end;) {
    if (i + kModes <= end && column[i + kModes - 1] == column[i] + kModes - 1) {
      run(column[i], Eigen::Map<const Six>(value + i));
      i += kModes;
    } else {
      one(column[i], value[i]);
      ++i;
    }
  }
}

template <class Result, class Argument>
Result product(const CoarseRows& C, const Argument& A) {
  TEUCHOS_ASSERT(C.isCompressed() && A.rows() == C.cols());
  using Row = Eigen::Matrix<double, 1, Result::ColsAtCompileTime>;
  Result result(C.rows(), A.cols());
  for (Eigen::Index row = 0; row < C.rows(); ++row) {
    Row sum = Row::Zero();
    forEachRun(C, row, [&](int first, const auto& values) { sum.noalias() += values.transpose() * A.template middleRows<kModes>(first); },
               [&](int column, double value) { sum += value * A.row(column); });
    result.row(row) = sum;
  }
  return result;
}

}  // namespace

Eigen::VectorXd multiplyTransposed(const CoarseRows& C, const Eigen::Ref<const Eigen::VectorXd>& x) {
  TEUCHOS_ASSERT(C.isCompressed() && x.size() == C.rows());
  Eigen::VectorXd y = Eigen::VectorXd::Zero(C.cols());
  for (Eigen::Index row = 0; row < C.rows(); ++row) {
    const double xi = x[row];
    if (xi == 0) continue;
    forEachRun(C, row, [&](int first, const auto& values) { y.segment<kModes>(first) += xi * values; },
               [&](int column, double value) { y[column] += xi * value; });
  }
  return y;
}

Eigen::VectorXd multiply(const CoarseRows& C, const Eigen::Ref<const Eigen::VectorXd>& a) { return product<Eigen::VectorXd>(C, a); }
TwoColumns multiplyTwo(const CoarseRows& C, const TwoColumns& A) { return product<TwoColumns>(C, A); }

}  // namespace Haptos
