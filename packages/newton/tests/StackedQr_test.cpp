// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_StackedQr.hpp"

#include <Eigen/Core>
#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>

namespace {

using namespace Haptos;

// Rows of rank r: none on rank 1, few on rank 2, many elsewhere.
Eigen::MatrixXd rowsOf(int rank, Eigen::Index n) {
  const Eigen::Index rows = rank == 1 ? 0 : rank == 2 ? 3 : 40 + rank;
  Eigen::MatrixXd A(rows, n);
  for (Eigen::Index i = 0; i < rows; ++i)
    for (Eigen::Index j = 0; j < n; ++j) A(i, j) = std::sin(1.0 + 7 * rank + 3.1 * double(i) + 1.7 * double(j * j)) / double(1 + j);
  return A;
}

}  // namespace

TEUCHOS_UNIT_TEST(StackedQr, IsTheTriangleOfAllRows) {
  const auto comm = Tpetra::getDefaultComm();
  for (const Eigen::Index n : {1, 2, 9, 17}) {
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(n, n);
    for (int r = 0; r < comm->getSize(); ++r) G += rowsOf(r, n).transpose() * rowsOf(r, n);
    const Eigen::MatrixXd R = stackedQr(*comm, rowsOf(comm->getRank(), n));
    TEST_EQUALITY(R.rows(), n);
    TEST_ASSERT((R.transpose() * R - G).norm() <= 1e-13 * G.norm());
    TEST_ASSERT(Eigen::MatrixXd(R.triangularView<Eigen::StrictlyLower>()).norm() == 0.0);
    Eigen::MatrixXd ofRoot = R;
    Teuchos::broadcast(*comm, 0, int(ofRoot.size()), ofRoot.data());
    TEST_ASSERT(R == ofRoot);
  }
}

// The least residual of a small system is that of all rows: far below what A^T A could resolve.
TEUCHOS_UNIT_TEST(StackedQr, KeepsSmallResiduals) {
  const auto comm = Tpetra::getDefaultComm();
  constexpr Eigen::Index n = 5;
  Eigen::MatrixXd A = rowsOf(comm->getRank(), n + 1);
  const Eigen::VectorXd y = Eigen::VectorXd::LinSpaced(n, 1, 2);
  A.col(n) = A.leftCols(n) * y;
  if (comm->getRank() == 0) A(0, n) += 1e-11;
  const Eigen::MatrixXd R = stackedQr(*comm, A);
  const double residual = std::abs(R(n, n));
  out << "residual " << residual << "\n";
  TEST_ASSERT(residual > 1e-13 && residual <= 1.001e-11);
}
