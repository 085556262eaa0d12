// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_StackedQr.hpp"

#include <Teuchos_CommHelpers.hpp>

#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {
namespace {

// R of A = Q R; signs of its rows are as they come, only R^T R counts
Eigen::MatrixXd triangleOf(Eigen::MatrixXd A) {
  const Eigen::Index n = A.cols(), rows = std::min(A.rows(), n);
  Eigen::MatrixXd R = Eigen::MatrixXd::Zero(n, n);
  if (rows == 0) return R;
  factorQrInPlace(A);
  R.topRows(rows) = A.topRows(rows).triangularView<Eigen::Upper>();
  return R;
}

// The triangle by columns, n (n + 1) / 2 numbers for a message.
Eigen::VectorXd packed(const Eigen::MatrixXd& R) {
  Eigen::VectorXd values(R.cols() * (R.cols() + 1) / 2);
  for (Eigen::Index j = 0, at = 0; j < R.cols(); at += ++j) values.segment(at, j + 1) = R.col(j).head(j + 1);
  return values;
}

Eigen::MatrixXd unpacked(const Eigen::VectorXd& values, Eigen::Index n) {
  Eigen::MatrixXd R = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index j = 0, at = 0; j < n; at += ++j) R.col(j).head(j + 1) = values.segment(at, j + 1);
  return R;
}

}  // namespace

Eigen::MatrixXd stackedQr(const Communicator& comm, const Eigen::MatrixXd& A) {
  const Eigen::Index n = A.cols();
  const int ranks = comm.getSize(), me = comm.getRank();
  Eigen::MatrixXd R = triangleOf(A);
  if (ranks == 1 || n == 0) return R;
  Eigen::VectorXd values(n * (n + 1) / 2);
  // A binary tree: [R_a; R_b] has the products of all rows below both, and its R is as large as theirs.  Rank 0 ends with all;
  // others get its digits, so that no branch differs.
  for (int step = 1; step < ranks; step *= 2) {
    if (me % (2 * step) != 0) {  // done after this
      values = packed(R);
      Teuchos::send(comm, int(values.size()), values.data(), me - step);
      break;
    }
    if (me + step >= ranks) continue;
    Teuchos::receive(comm, me + step, int(values.size()), values.data());
    Eigen::MatrixXd both(2 * n, n);
    both << R, unpacked(values, n);
    R = triangleOf(std::move(both));
  }
  if (me == 0) values = packed(R);
  Teuchos::broadcast(comm, 0, int(values.size()), values.data());
  return unpacked(values, n);
}

// Twice, as the first time loses the digits of what is small.
Eigen::MatrixXd orthonormalizer(const Communicator& comm, const Eigen::MatrixXd& Y, double nothing) {
  Eigen::MatrixXd T = Eigen::MatrixXd::Identity(Y.cols(), Y.cols());
  for (int pass = 0; pass < 2 && T.cols() > 0; ++pass) {
    const RightSvd svd(stackedQr(comm, Y * T));
    Eigen::Index rank = 0;
    while (rank < T.cols() && svd.values[rank] > nothing * svd.values[0]) ++rank;
    T = (T * svd.V.leftCols(rank) * svd.values.head(rank).cwiseInverse().asDiagonal()).eval();
  }
  return T;
}

}  // namespace Haptos
