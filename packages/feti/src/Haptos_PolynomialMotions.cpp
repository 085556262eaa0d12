// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_PolynomialMotions.hpp"

#include <cmath>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_SparseBlocks.hpp"

namespace Haptos {
namespace {

constexpr int kDegree = 3;

// [nodes x monomials] in coordinates that go from -1 to 1 along each axis; an extent 0 has none.
Eigen::MatrixXd monomials(const Coordinates& coordinates) {
  const Eigen::Map<const Eigen::Matrix3Xd> x(coordinates.data()->data(), 3, Eigen::Index(coordinates.size()));
  const Eigen::Vector3d least = x.rowwise().minCoeff(), most = x.rowwise().maxCoeff(), middle = 0.5 * (least + most);
  Eigen::Vector3d scale = 0.5 * (most - least);
  for (double& value : scale) value = value > 0 ? 1 / value : 0.0;
  const Eigen::Array3Xd y = (scale.asDiagonal() * (x.colwise() - middle)).array();
  std::vector<Eigen::VectorXd> columns;
  for (int i = 0; i <= kDegree; ++i)
    for (int j = 0; i + j <= kDegree; ++j)
      for (int k = 0; i + j + k <= kDegree; ++k) columns.push_back((y.row(0).pow(i) * y.row(1).pow(j) * y.row(2).pow(k)).matrix().transpose());
  Eigen::MatrixXd values(x.cols(), Eigen::Index(columns.size()));
  for (std::size_t j = 0; j < columns.size(); ++j) values.col(Eigen::Index(j)) = columns[j];
  return values;
}

// Each monomial as each component.
Eigen::MatrixXd fields(const Coordinates& coordinates) {
  const Eigen::MatrixXd values = monomials(coordinates);
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(3 * values.rows(), 3 * values.cols());
  for (Eigen::Index m = 0; m < values.cols(); ++m)
    for (Eigen::Index d = 0; d < 3; ++d)
      for (Eigen::Index node = 0; node < values.rows(); ++node) P(3 * node + d, 3 * m + d) = values(node, m);
  return P;
}

}  // namespace

// In the scale of D = diag K on the boundary rigid motions are Q, and X = (1 - Q Q^T) D^1/2 P_b; their energies are those of P, as K R = 0.
// X has combinations that are next to nothing (rigid ones, and z^3 on three layers of nodes): they are left out.
Eigen::MatrixXd polynomialMotions(const PolynomialSubject& subject, double softest) {
  constexpr double kNothing = 1e-8;  // of the largest square
  const auto& boundary = subject.boundary;
  const Eigen::MatrixXd P = fields(subject.x);
  const Eigen::VectorXd diagonal = subject.K.diagonal(), root = diagonal(boundary).cwiseSqrt();
  const Eigen::MatrixXd Q = orthonormalBasis(root.asDiagonal() * subject.R(boundary, Eigen::all));
  Eigen::MatrixXd X = root.asDiagonal() * P(boundary, Eigen::all);
  X -= Q * (Q.transpose() * X).eval();
  const SymmetricEigen lengths(X.transpose() * X);
  const Eigen::Index good = (lengths.values.array() > kNothing * lengths.values.maxCoeff()).count();
  const Eigen::MatrixXd T = lengths.vectors.rightCols(good) * lengths.values.tail(good).cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::MatrixXd energies = P.transpose() * timesColumns(subject.K, P);
  const SymmetricEigen eigen(T.transpose() * energies * T);
  const Eigen::Index soft = (eigen.values.array() < softest).count();
  return root.cwiseInverse().asDiagonal() * (X * (T * eigen.vectors.leftCols(soft)));
}

}  // namespace Haptos
