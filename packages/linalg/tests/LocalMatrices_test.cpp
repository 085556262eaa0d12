// SPDX-License-Identifier: BSD-3-Clause
// What a subdomain's matrices are kept in, against the dense matrices that they stand for.
#include <Eigen/Core>
#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "DenseAlgebra.hpp"
#include "Haptos_DenseSymmetric.hpp"
#include "Haptos_NodeBlockMatrix.hpp"
#include "Haptos_SparseBlocks.hpp"
#include "Haptos_SupernodalFactor.hpp"

namespace {

using namespace Haptos;
using Eigen::MatrixXd;
using Storage = DenseSymmetric::Storage;
using Precision = DenseSymmetric::Precision;

constexpr double kSingle = 1e-6, kDouble = 1e-13;

// Any numbers that are no multiples of each other.
MatrixXd numbers(Eigen::Index rows, Eigen::Index columns, double seed) {
  return MatrixXd::NullaryExpr(rows, columns, [&](Eigen::Index i, Eigen::Index j) { return std::sin(seed + 1.7 * double(i) + 0.3 * double(i * j) + 2.9 * double(j)); });
}

MatrixXd definite(Eigen::Index n, double seed) {
  const MatrixXd B = numbers(n, n, seed);
  return B * B.transpose() + double(n) * MatrixXd::Identity(n, n);
}

// The upper triangle must not be read.
MatrixXd lowerOf(const MatrixXd& A) {
  MatrixXd lower = A;
  lower.triangularView<Eigen::StrictlyUpper>().setConstant(1e30);
  return lower;
}

double relativeError(const MatrixXd& x, const MatrixXd& expected) { return (x - expected).norm() / expected.norm(); }

TEUCHOS_UNIT_TEST(DenseSymmetric, MultipliesAsTheMatrixInEveryStorage) {
  for (const Eigen::Index n : {1, 3, 17, 64})
    for (const Storage storage : {Storage::Packed, Storage::Full})
      for (const Precision precision : {Precision::Double, Precision::Single})
        for (const Eigen::Index columns : {1, 5, 20})
          for (const double unit : {1.0, 1e-60, 1e60}) {
            const MatrixXd A = unit * definite(n, 0.4), X = numbers(n, columns, 2.0);
            MatrixXd Y(n, columns);
            DenseSymmetric(lowerOf(A), storage, precision).apply(X, Y);
            TEST_COMPARE(relativeError(Y, A * X), <, precision == Precision::Single ? kSingle : kDouble);
          }
}

TEUCHOS_UNIT_TEST(DenseSymmetric, BlockIsThatOfTheMatrix) {
  const MatrixXd A = definite(9, 1.1);
  const std::vector<int> c{7, 0, 4};
  MatrixXd expected(3, 3);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) expected(i, j) = A(c[std::size_t(i)], c[std::size_t(j)]);
  for (const Storage storage : {Storage::Packed, Storage::Full}) {
    const MatrixXd block = DenseSymmetric(lowerOf(A), storage, Precision::Double).block(c);
    TEST_COMPARE(relativeError(block, expected), <, kDouble);
  }
}

TEUCHOS_UNIT_TEST(DenseCholesky, SolvesInBothStorages) {
  const MatrixXd A = definite(23, 0.2), B = numbers(23, 4, 0.9);
  MatrixXd L = lowerOf(A);
  TEST_ASSERT(Lapack::choleskyInPlace(L));
  for (const Storage storage : {Storage::Packed, Storage::Full}) {
    MatrixXd X = B;
    DenseCholesky(L, storage).solve(X);
    TEST_COMPARE(relativeError(A * X, B), <, kDouble);
  }
}

TEUCHOS_UNIT_TEST(SingleCholesky, TellsWhatIsBeyondIt) {
  for (const double unit : {1.0, 1e-60, 1e60}) {
    const MatrixXd A = unit * definite(23, 0.2), B = unit * numbers(23, 2, 0.9);
    SingleCholesky factor;
    TEST_ASSERT(factor.factor(lowerOf(A)));
    MatrixXd X = B;
    factor.solve(X);
    TEST_COMPARE(relativeError(X, Testing::ldltSolve(A, B)), <, 1e-4);
  }
  for (const double shift : {1e-6, 1e-11}) {  // a factor of no digits, and none
    MatrixXd hard = MatrixXd::Constant(12, 12, 1.0);
    hard.diagonal().array() += shift;
    TEST_ASSERT(!SingleCholesky().factor(hard));
  }
  MatrixXd indefinite = definite(6, 0.3);
  indefinite(3, 3) = -1;
  TEST_ASSERT(!SingleCholesky().factor(indefinite));
}

// A chain of nodes, and its ends: K [3 nodes], symmetric.
Eigen::SparseMatrix<double> chain(int nodes) {
  MatrixXd K = MatrixXd::Zero(3 * nodes, 3 * nodes);
  const auto couple = [&](int a, int b) {
    const Eigen::Matrix3d block = numbers(3, 3, 5.0 * a + b);
    K.block<3, 3>(3 * a, 3 * b) += block;
    K.block<3, 3>(3 * b, 3 * a) += block.transpose();
  };
  for (int a = 0; a < nodes; ++a) couple(a, a);
  for (int a = 0; a + 1 < nodes; ++a) couple(a, a + 1);
  couple(0, nodes - 1);
  return K.sparseView();
}

// The same without some entries between nodes.
Eigen::SparseMatrix<double> thinned(Eigen::SparseMatrix<double> K) {
  K.prune([](Eigen::Index i, Eigen::Index j, double) { return i / 3 == j / 3 || (i + j) % 4 != 0; });
  return K;
}

Eigen::VectorXf padded(const Eigen::VectorXd& x) {
  Eigen::VectorXf result = Eigen::VectorXf::Zero(x.size() / 3 * NodeBlockMatrix::kPadded);
  for (Eigen::Index i = 0; i < x.size() / 3; ++i) result.segment<3>(NodeBlockMatrix::kPadded * i) = x.segment<3>(3 * i).cast<float>();
  return result;
}

Eigen::VectorXd unpadded(const Eigen::VectorXf& x) {
  Eigen::VectorXd result(x.size() / NodeBlockMatrix::kPadded * 3);
  for (Eigen::Index i = 0; i < result.size() / 3; ++i) result.segment<3>(3 * i) = x.segment<3>(NodeBlockMatrix::kPadded * i).cast<double>();
  return result;
}

// K of the nodes listed
MatrixXd part(const Eigen::SparseMatrix<double>& K, const std::vector<int>& rows, const std::vector<int>& columns) {
  MatrixXd result(3 * rows.size(), 3 * columns.size());
  const MatrixXd dense = K;
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < columns.size(); ++j)
      result.block<3, 3>(3 * Eigen::Index(i), 3 * Eigen::Index(j)) = dense.block<3, 3>(3 * rows[i], 3 * columns[j]);
  return result;
}

void testParts(const Eigen::SparseMatrix<double>& K, bool& success, Teuchos::FancyOStream& out) {
  const std::vector<int> surface{8, 1, 4, 5, 0}, inside{2, 3, 6, 7};  // not in the order of K
  std::vector<int> onSurface(9, -1), within(9, -1);
  for (std::size_t i = 0; i < surface.size(); ++i) onSurface[std::size_t(surface[i])] = int(i);
  for (std::size_t i = 0; i < inside.size(); ++i) within[std::size_t(inside[i])] = int(i);
  constexpr double kUnit = 0.25;
  const NodeBlockMatrix Kbb(K, onSurface, surface, int(surface.size()), kUnit, true), Kib(K, within, surface, int(inside.size()), kUnit, false);
  const MatrixXd bb = part(K, surface, surface) / kUnit, ib = part(K, inside, surface) / kUnit;

  const Eigen::VectorXd xb = numbers(15, 1, 0.3), xi = numbers(12, 1, 0.8), yb = numbers(15, 1, 4.0), yi = numbers(12, 1, 5.0);
  const Eigen::VectorXf pb = padded(xb), pi = padded(xi);
  Eigen::VectorXf y = padded(yb);
  Kbb.add(pb.data(), y.data());
  TEST_COMPARE(relativeError(unpadded(y), yb + bb * xb), <, kSingle);
  y = padded(yi);
  Kib.add(pb.data(), y.data());
  TEST_COMPARE(relativeError(unpadded(y), yi + ib * xb), <, kSingle);
  y = padded(yb);
  Kib.subtractTransposed(pi.data(), y.data());
  TEST_COMPARE(relativeError(unpadded(y), yb - ib.transpose() * xi), <, kSingle);
  const std::vector<int> some{14, 0, 4, 5, 3};  // no node whole but the second
  const auto picked = [&](const MatrixXd& A) {
    MatrixXd result(A.rows(), some.size());
    for (std::size_t j = 0; j < some.size(); ++j) result.col(Eigen::Index(j)) = A.col(some[j]);
    return result;
  };
  TEST_COMPARE(relativeError(MatrixXd(Kbb.columns(some)), kUnit * picked(bb)), <, kSingle);
  TEST_COMPARE(relativeError(MatrixXd(Kib.columns(some)), kUnit * picked(ib)), <, kSingle);
}

TEUCHOS_UNIT_TEST(NodeBlockMatrix, MultipliesAsTheParts) {
  TEST_COMPARE(thinned(chain(9)).nonZeros(), <, chain(9).nonZeros());
  for (const auto& K : {chain(9), thinned(chain(9))}) testParts(K, success, out);
}

TEUCHOS_UNIT_TEST(SparseBlocks, AFewEntriesAreAdded) {
  const auto K = thinned(chain(6));
  Eigen::SparseMatrix<double> few(18, 18);
  for (const auto& [i, j] : {std::pair{0, 0}, {17, 0}, {3, 4}, {1, 9}, {5, 9}, {17, 9}, {2, 17}, {17, 17}}) few.insert(i, j) = 1 + i + 0.1 * j;
  few.makeCompressed();
  const Eigen::SparseMatrix<double> sum = withFewAdded(K, few), expected = K + few;
  TEST_EQUALITY(sum.nonZeros(), expected.nonZeros());
  TEST_COMPARE(sum.nonZeros(), >, K.nonZeros());  // places that K lacks
  TEST_ASSERT(std::equal(sum.innerIndexPtr(), sum.innerIndexPtr() + sum.nonZeros(), expected.innerIndexPtr()));
  TEST_EQUALITY(MatrixXd(sum), MatrixXd(expected));
  TEST_EQUALITY(MatrixXd(withFewAdded(K, Eigen::SparseMatrix<double>(18, 18))), MatrixXd(K));
}

// A sparse L in supernodes that end where listed; their rows below lie apart.
struct Supernodes {
  std::vector<int> super{0}, pi{0}, px{0}, s, perm;
  std::vector<double> x;
  MatrixXd L;

  Supernodes(int n, double unit, std::initializer_list<int> ends) : L(MatrixXd::Zero(n, n)) {
    const MatrixXd all = std::sqrt(unit) * (numbers(n, n, 0.7) + n * MatrixXd::Identity(n, n));
    for (int i = 0; i < n; ++i) perm.push_back((5 * i + 3) % n);
    for (int end : ends) {
      const int first = super.back();
      const auto isThere = [&](int i) { return i < end || (i + first) % 3 != 0; };
      for (int i = first; i < n; ++i)
        if (isThere(i)) s.push_back(i);
      for (int j = first; j < end; ++j)
        for (int i = first; i < n; ++i) {
          if (!isThere(i)) continue;
          if (i >= j) L(i, j) = all(i, j);
          x.push_back(i < j ? 1e30 : L(i, j));
        }
      super.push_back(end);
      pi.push_back(int(s.size()));
      px.push_back(int(x.size()));
    }
  }
  SupernodeView view() const {
    return {int(perm.size()), int(super.size()) - 1, super.data(), pi.data(), px.data(), s.data(), perm.data(), x.data()};
  }
};

template <class Scalar>
double errorOfSolve(Eigen::Index columns, double unit) {
  constexpr int n = 28;
  const Supernodes nodes(n, unit, {1, 4, 5, 12, 19, 28});  // of 1, 3, 1, 7, 7 and 9 columns
  const MatrixXd permuted = nodes.L * nodes.L.transpose();
  MatrixXd A(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) A(nodes.perm[std::size_t(i)], nodes.perm[std::size_t(j)]) = permuted(i, j);
  const SupernodalFactor<Scalar> factor(nodes.view());
  const MatrixXd B = numbers(n, columns, 1.5);
  MatrixXd X(n, columns);
  factor.solve(B, X);
  return relativeError(A * X, B);
}

TEUCHOS_UNIT_TEST(SupernodalFactor, SolvesOneAndManyRightHandSides) {
  for (const Eigen::Index columns : {1, 2, 9})
    for (const double unit : {1.0, 1e-60, 1e60}) {
      TEST_COMPARE(errorOfSolve<double>(columns, unit), <, kDouble);
      TEST_COMPARE(errorOfSolve<float>(columns, unit), <, 10 * kSingle);
    }
}

}  // namespace
