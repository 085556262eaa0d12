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

// A motion along the first tangents of pairs that slip (the first two, under friction) or are open (the last one): neither M nor B feels it, and b has a
// part that no solution gives, which is not along it, as friction follows normal forces.  The rest is solved as least squares are, the motion resting.
TEUCHOS_UNIT_TEST(ContactFactor, FreeMotionsRestAndWhatIsPossibleIsSolved) {
  Eigen::MatrixXd motion = Eigen::VectorXd::Zero(kRows);
  motion(1) = 1, motion(4) = -2, motion(7) = 0.5;
  motion.normalize();
  const Matrix P = Matrix::Identity() - motion * motion.transpose();
  for (const double unit : {1e-6, 1.0, 1e8}) {
    const Eigen::MatrixXd M = unit * P * reflection() * Eigen::VectorXd::LinSpaced(kRows, 1, 3).asDiagonal() * reflection().transpose() * P;
    Eigen::MatrixXd law = blocks(0) / unit;  // A / r where nothing else is said, r as stiff as M
    law.row(0) << 0, 0, 0, 1, 0, 0;
    law.row(1) << -0.3 / unit, 1 / unit, 0, 0.3, 0, 0;
    law.row(2) << 0, 0, 0, 0, 0, 1;
    law.row(3) << 0, 0, 0, 1, 0, 0;
    law.row(4) << 0.6 / unit, 1 / unit, 0, -0.6, 0, 0;
    Eigen::MatrixXd AMB(kRows, kRows);
    for (Eigen::Index row = 0; row < kRows; ++row) {
      const Eigen::Index at = row - row % 3;
      AMB.row(row) = law.row(row).head<3>() * M.middleRows<3>(at);
      AMB.row(row).segment<3>(at) += law.row(row).tail<3>();
    }
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(kRows, 1, -0.7);
    const ContactFactor factor(M, motion, law, ContactFactor::Shape::General);
    const Eigen::VectorXd x = factor.solve(b), left = b - AMB * x;
    out << "unit " << unit << ": |x| " << x.norm() << ", left " << left.norm() << "\n";
    TEST_ASSERT(factor.hasFree());
    TEST_ASSERT(factor.isSolution(x, b));
    TEST_COMPARE(std::abs(x.dot(motion.col(0))), <, 1e-12 * x.norm());
    TEST_COMPARE(left.norm(), >, 1e-2);
    for (const Eigen::Index known : {0, 2, 3}) TEST_COMPARE(std::abs(left[known]), <, 1e-12);
    for (const Eigen::Index row : {1, 4, 5, 6, 7, 8}) TEST_COMPARE(std::abs(AMB.col(row).dot(left)), <, 1e-12);
    TEST_ASSERT(!factor.isSolution(x + 1e-3 * reflection().col(1), b));
  }
}
