// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SurfaceSchur.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <array>

#include "TestSubdomain.hpp"

using namespace Haptos;
using namespace Haptos::Testing;

namespace {

/// S by dense algebra, with the Moore-Penrose inverse of K_ii.
Dense denseSchur(const Sparse& K, const std::vector<int>& boundary) {
  std::vector<int> order = boundary;
  for (int i = 0; i < K.rows(); ++i)
    if (std::find(boundary.begin(), boundary.end(), i) == boundary.end()) order.push_back(i);
  Dense sorted(K.rows(), K.rows());
  for (Eigen::Index i = 0; i < K.rows(); ++i)
    for (Eigen::Index j = 0; j < K.rows(); ++j) sorted(i, j) = K.coeff(order[i], order[j]);
  const Eigen::Index nb = Eigen::Index(boundary.size()), ni = K.rows() - nb;
  const SymmetricSpectrum spectrum(sorted.bottomRightCorner(ni, ni));
  Eigen::VectorXd inverse = spectrum.values;
  const double zero = 1e-11 * inverse.maxCoeff();
  for (double& v : inverse) v = v > zero ? 1.0 / v : 0.0;
  const Dense pinv = spectrum.vectors * inverse.asDiagonal() * spectrum.vectors.transpose();
  return sorted.topLeftCorner(nb, nb) - sorted.topRightCorner(nb, ni) * pinv * sorted.bottomLeftCorner(ni, nb);
}

/// Unknowns of the part's nodes that other parts have too; a node's in the order given.
std::vector<int> interfaceUnknowns(const TestMesh& mesh, const std::vector<std::vector<int>>& parts, int mine,
                                   const std::array<int, 3>& order = {2, 0, 1}) {
  std::map<int, std::set<int>> partsOf;
  for (int p = 0; p < int(parts.size()); ++p)
    for (const int e : parts[p])
      for (const int node : mesh.elements[e]) partsOf[node].insert(p);
  std::vector<int> unknowns;
  int local = 0;
  for (const auto& [node, owners] : partsOf) {
    if (owners.count(mine) == 0) continue;
    if (owners.size() > 1) unknowns.insert(unknowns.end(), {3 * local + order[0], 3 * local + order[1], 3 * local + order[2]});
    ++local;
  }
  return unknowns;
}

double difference(const Dense& a, const Dense& b) { return (a - b).norm() / b.norm(); }

}  // namespace

TEUCHOS_UNIT_TEST(SurfaceSchur, MatchesDenseAlgebraOnJaggedParts) {
  const auto mesh = boxMesh({6, 5, 5}, {1.2, 1, 1}, 0.15);
  const auto parts = cutByMetis(mesh, 4);
  for (const auto method : {LocalSolverMethod::Automatic, LocalSolverMethod::Klu2})
    for (int p = 0; p < 4; ++p) {
      const auto s = makeSubdomain(mesh, parts[p], 2e5, 0.3);
      const auto boundary = interfaceUnknowns(mesh, parts, p);
      TEST_ASSERT(boundary.size() > 60 && Eigen::Index(boundary.size()) < s.K.rows() - 60);
      const SurfaceSchur schur(s.K, s.kernel, boundary, method);
      TEST_EQUALITY(schur.interiorKernelSize(), 0);
      const Dense reference = denseSchur(s.K, boundary), S = schur.dense();
      TEST_COMPARE(difference(S, reference), <=, 1e-12);
      TEST_EQUALITY((S - S.transpose()).norm(), 0.0);

      const Dense X = Dense::Random(schur.size(), 70);
      Dense Y(schur.size(), 70);
      schur.apply(X, Y);
      TEST_COMPARE(difference(Y, reference * X), <=, 1e-12);
      Dense R(boundary.size(), 6);
      for (std::size_t i = 0; i < boundary.size(); ++i) R.row(i) = s.kernel.row(boundary[i]);
      TEST_COMPARE((S * R).norm(), <=, 1e-12 * S.norm());  // S inherits the rigid motions
    }
}

TEUCHOS_UNIT_TEST(SurfaceSchur, BlockIsThatOfTheWhole) {
  const auto mesh = boxMesh({6, 5, 5}, {1.2, 1, 1}, 0.15);
  const auto parts = cutByMetis(mesh, 4);
  const auto s = makeSubdomain(mesh, parts[1], 2e5, 0.3);
  const auto boundary = interfaceUnknowns(mesh, parts, 1);
  const SurfaceSchur schur(s.K, s.kernel, boundary);
  std::vector<int> c;
  for (int i = int(boundary.size()) - 1; i >= 0; i -= 2) c.push_back(i);  // any order, more than one block of columns
  const Dense S = schur.dense(), block = schur.block(c);
  for (std::size_t i = 0; i < c.size(); ++i)
    for (std::size_t j = 0; j < c.size(); ++j)
      TEST_ASSERT(std::abs(block(Eigen::Index(i), Eigen::Index(j)) - S(c[i], c[j])) <= 1e-13 * S.norm());
}

// Of a long part the columns of one end reach nothing of the other until the middle is eliminated; a column of K_ib may be empty.
TEUCHOS_UNIT_TEST(SurfaceSchur, BlocksOfALongPart) {
  const auto mesh = boxMesh({4, 4, 24}, {1, 1, 6}, 0.1);
  const auto s = makeSubdomain(mesh, allElements(mesh), 2e5, 0.3);
  std::vector<int> boundary, c;
  for (int node = 0; node < int(mesh.nodes.size()); ++node)
    if (mesh.nodes[std::size_t(node)][2] < 0.3 || mesh.nodes[std::size_t(node)][2] > 5.9)  // two layers at one end: the outer one has no neighbour inside
      for (int d = 0; d < 3; ++d) boundary.push_back(3 * node + d);
  for (int i = 0; i < int(boundary.size()); i += 3) c.push_back(i);
  const Dense reference = denseSchur(s.K, boundary);
  for (const auto precision : {FactorPrecision::Double, FactorPrecision::Single}) {
    const SurfaceSchur schur(s.K, s.kernel, boundary, LocalSolverMethod::Automatic, precision);
    const double tolerance = precision == FactorPrecision::Double ? 1e-12 : 1e-6;
    TEST_COMPARE(difference(schur.dense(), reference), <=, tolerance);
    const Dense block = schur.block(c);
    for (std::size_t i = 0; i < c.size(); ++i)
      for (std::size_t j = 0; j < c.size(); ++j)
        TEST_ASSERT(std::abs(block(Eigen::Index(i), Eigen::Index(j)) - reference(c[i], c[j])) <= tolerance * reference.norm());
  }
}

// In any units: the entries lie far outside the range of single precision.
TEUCHOS_UNIT_TEST(SurfaceSchur, SinglePrecisionInAnyUnits) {
  const auto mesh = boxMesh({6, 5, 5}, {1.2, 1, 1}, 0.15);
  const auto parts = cutByMetis(mesh, 4);
  auto boundary = interfaceUnknowns(mesh, parts, 0, {0, 1, 2});
  std::rotate(boundary.begin(), boundary.begin() + 30, boundary.end());  // nodes in any order
  for (double E : {2e-60, 2e5, 2e60}) {
    const auto s = makeSubdomain(mesh, parts[0], E, 0.3);
    const Dense reference = denseSchur(s.K, boundary), X = 1e-70 * Dense::Random(Eigen::Index(boundary.size()), 3);
    const SurfaceSchur schur(s.K, s.kernel, boundary, LocalSolverMethod::Automatic, FactorPrecision::Single);
    const SurfaceSchur lumped = SurfaceSchur::lumped(s.K, boundary, FactorPrecision::Single);
    Dense Y(X.rows(), X.cols());
    for (Eigen::Index columns : {1, 3}) {
      schur.apply(X.leftCols(columns), Y.leftCols(columns));
      const double error = difference(Y.leftCols(columns), reference * X.leftCols(columns));
      TEST_COMPARE(error, <=, 1e-5);
      if (hasCholmod()) TEST_COMPARE(error, >, 1e-10);
    }
    lumped.apply(X, Y);
    Dense Kbb(X.rows(), X.rows());
    for (Eigen::Index i = 0; i < X.rows(); ++i)
      for (Eigen::Index j = 0; j < X.rows(); ++j) Kbb(i, j) = s.K.coeff(boundary[std::size_t(i)], boundary[std::size_t(j)]);
    TEST_COMPARE(difference(Y, Kbb * X), <=, 1e-6);
  }
}

// block() and dense() see the same entries as apply().
TEUCHOS_UNIT_TEST(SurfaceSchur, SinglePrecisionBlocksAreThoseOfTheProduct) {
  const auto mesh = boxMesh({6, 5, 5}, {1.2, 1, 1}, 0.15);
  const auto parts = cutByMetis(mesh, 4);
  const auto boundary = interfaceUnknowns(mesh, parts, 1, {0, 1, 2});
  const auto s = makeSubdomain(mesh, parts[1], 2e5, 0.3);
  const SurfaceSchur schur(s.K, s.kernel, boundary, LocalSolverMethod::Automatic, FactorPrecision::Single);
  const Dense S = schur.dense(), identity = Dense::Identity(S.rows(), S.rows());
  Dense Y(S.rows(), S.rows());
  schur.apply(identity, Y);
  TEST_COMPARE((Y - S).cwiseAbs().maxCoeff(), <=, 2e-6 * S.cwiseAbs().maxCoeff());
  TEST_EQUALITY((S - S.transpose()).cwiseAbs().maxCoeff(), 0.0);
  TEST_COMPARE(difference(S, denseSchur(s.K, boundary)), <=, 1e-5);
}

TEUCHOS_UNIT_TEST(SurfaceSchur, PartsOfNodesStayInDoublePrecision) {
  const auto mesh = boxMesh({6, 5, 5}, {1.2, 1, 1}, 0.15);
  const auto parts = cutByMetis(mesh, 4);
  auto boundary = interfaceUnknowns(mesh, parts, 0, {0, 1, 2});
  boundary.erase(boundary.begin() + 4);
  const auto s = makeSubdomain(mesh, parts[0], 2e5, 0.3);
  const SurfaceSchur schur(s.K, s.kernel, boundary, LocalSolverMethod::Automatic, FactorPrecision::Single);
  TEST_COMPARE(difference(schur.dense(), denseSchur(s.K, boundary)), <=, 1e-5);
  const SurfaceSchur lumped = SurfaceSchur::lumped(s.K, boundary, FactorPrecision::Single);
  TEST_COMPARE(difference(lumped.dense(), SurfaceSchur::lumped(s.K, boundary, FactorPrecision::Double).dense()), ==, 0.0);
}

TEUCHOS_UNIT_TEST(SurfaceSchur, OneElementHasNoInterior) {
  const auto mesh = boxMesh({1, 1, 1}, {1, 2, 3}, 0.1);
  const auto s = makeSubdomain(mesh, {0}, 7.0, 0.3);
  std::vector<int> all(24);
  std::iota(all.rbegin(), all.rend(), 0);
  const SurfaceSchur schur(s.K, s.kernel, all);
  const Dense reversed = 0.5 * (Dense(s.K) + Dense(s.K).transpose()).reverse();
  TEST_COMPARE(difference(schur.dense(), reversed), <=, 1e-15);
  const Dense X = Dense::Random(24, 3);
  Dense Y(24, 3);
  schur.apply(X, Y);
  TEST_COMPARE(difference(Y, reversed * X), <=, 1e-14);
}

/// Boundaries that hold nothing, a point, a hinge, normal components only: K_ii has 6, 3, 1 and 3 free motions.
TEUCHOS_UNIT_TEST(SurfaceSchur, BoundaryNeedNotHoldTheInterior) {
  const auto mesh = boxMesh({3, 3, 3}, {1, 1, 1}, 0.0);
  const auto s = makeSubdomain(mesh, allElements(mesh), 1e5, 0.3);
  std::vector<int> hinge, normals;
  for (int i = 0; i < 4; ++i) hinge.insert(hinge.end(), {3 * i, 3 * i + 1, 3 * i + 2});
  for (int i = 0; i < 16; ++i) normals.push_back(3 * i + 2);
  const std::vector<std::pair<std::vector<int>, int>> cases{{{}, 6}, {{0, 1, 2}, 3}, {hinge, 1}, {normals, 3}};
  for (const auto& [boundary, freeMotions] : cases) {
    const SurfaceSchur schur(s.K, s.kernel, boundary);
    TEST_EQUALITY(schur.interiorKernelSize(), freeMotions);
    TEST_COMPARE((schur.dense() - denseSchur(s.K, boundary)).norm(), <=, 1e-12 * s.K.norm());
  }
}
