// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactFactor.hpp"

#include <Teuchos_UnitTestHarness.hpp>

namespace {

using namespace Haptos;

constexpr Eigen::Index kRows = 9;
using Matrix = Eigen::Matrix<double, kRows, kRows>;

// Orthonormal, of no zeros.
Matrix reflection() {
  const Eigen::Matrix<double, kRows, 1> v = Eigen::Matrix<double, kRows, 1>::LinSpaced(0.5, 2).normalized();
  return Matrix::Identity() - 2 * v * v.transpose();
}

// All eigenvalues 1e8, but for the last one.
Eigen::MatrixXd stiff(double soft) {
  Eigen::VectorXd values = Eigen::VectorXd::Constant(kRows, 1e8);
  values[kRows - 1] = soft;
  return reflection() * values.asDiagonal() * reflection().transpose();
}

// A = 1 and B = beta
Eigen::MatrixXd blocks(double beta) {
  Eigen::MatrixXd blocks = Eigen::MatrixXd::Zero(kRows, 6);
  for (Eigen::Index row = 0; row < kRows; ++row) blocks(row, row % 3) = 1, blocks(row, 3 + row % 3) = beta;
  return blocks;
}

struct Kind {
  ContactFactor::Shape shape;
  const char* name;
};
constexpr Kind kKinds[] = {{ContactFactor::Shape::Symmetric, "Cholesky"}, {ContactFactor::Shape::General, "LU"}};

}  // namespace

// What is soft gives way by 1e4: what is left of stiff products is 1e-3 of b, and nothing solves it better.
TEUCHOS_UNIT_TEST(ContactFactor, RoundOffOfFarSolutionsIsNoFailure) {
  const Eigen::MatrixXd M = stiff(1e-5), kernel(kRows, 0);
  const Eigen::VectorXd b = 1e-1 * reflection().col(kRows - 1), off = reflection().col(0);
  for (const Kind& kind : kKinds) {
    const ContactFactor factor(M, kernel, blocks(1e-7), kind.shape);
    const Eigen::VectorXd x = factor.solve(b), left = b - M * x - 1e-7 * x;
    out << kind.name << ": |x| " << x.norm() << ", left " << left.norm() / b.norm() << " of b\n";
    TEST_COMPARE(x.norm(), >, 5e3);
    TEST_COMPARE(left.norm(), >, 1e-6 * b.norm());
    TEST_ASSERT(factor.isSolution(x, b));
    TEST_ASSERT(!factor.isSolution(x + 1e-9 * off, b));  // forces of .1 that are wrong
  }
}

// What nothing holds is pushed: however far it went, that is no solution.
TEUCHOS_UNIT_TEST(ContactFactor, NoSolutionOfASingularMatrixIsOne) {
  const Eigen::MatrixXd M = stiff(0), kernel(kRows, 0);
  const Eigen::VectorXd b = reflection().col(kRows - 1) + reflection().col(1);
  for (const Kind& kind : kKinds) {
    const ContactFactor factor(M, kernel, blocks(0), kind.shape);
    const Eigen::VectorXd x = factor.solve(b);
    TEST_ASSERT(!factor.isSolution(x, b));
    TEST_ASSERT(!factor.isSolution(Eigen::VectorXd::Zero(kRows), b));
  }
}
