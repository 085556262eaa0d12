// SPDX-License-Identifier: BSD-3-Clause
#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <vector>

#include "Haptos_DenseDecompositions.hpp"

// Teuchos has none in a range.
extern "C" void dsyevr_(const char* job, const char* range, const char* uplo, const int* n, double* A, const int* lda, const double* lower,
                        const double* upper, const int* first, const int* last, const double* tolerance, int* found, double* values, double* vectors,
                        const int* ldz, int* support, double* work, const int* lwork, int* iwork, const int* liwork, int* info);

namespace Haptos {

// A tridiagonal matrix as for all of them, by bisection what is asked for: with a tenth of the vectors half of the time, at 1200 rows.
EigenBelow::EigenBelow(Eigen::MatrixXd A, double most) {
  constexpr double kLeast = -1;
  const int n = int(A.rows()), one = 1, lwork = 40 * std::max(1, n), liwork = 10 * std::max(1, n);
  const double tolerance = 0;  // what LAPACK takes for itself
  Eigen::VectorXd all(n);
  Eigen::MatrixXd Z(n, n);
  std::vector<double> work(static_cast<std::size_t>(lwork));
  std::vector<int> iwork(static_cast<std::size_t>(liwork)), support(2 * static_cast<std::size_t>(std::max(1, n)));
  int found = 0, info = 0;
  if (n > 0)
    dsyevr_("V", "V", "L", &n, A.data(), &n, &kLeast, &most, &one, &n, &tolerance, &found, all.data(), Z.data(), &n, support.data(), work.data(),
            &lwork, iwork.data(), &liwork, &info);
  TEUCHOS_TEST_FOR_EXCEPTION(info != 0, std::runtime_error, "the eigenvalues below " << most << " of a symmetric matrix of size " << n << " were not found");
  values = all.head(found);
  vectors = Z.leftCols(found);
}

}  // namespace Haptos
