// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_FixingNodes.hpp"

#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_SparseBlocks.hpp"

namespace Haptos {

namespace {

/// Nodes of every connected piece of K's graph, pieces in the order of their lowest node.
std::vector<std::vector<int>> connectedPieces(const Eigen::SparseMatrix<double>& K) {
  const int nodes = int(K.rows()) / 3;
  int left = nodes;  // not seen yet: where none is, the columns that were not looked at say nothing new
  std::vector<char> seen(nodes, false);
  std::vector<std::vector<int>> pieces;
  for (int seed = 0; seed < nodes; ++seed) {
    if (seen[seed]) continue;
    std::vector<int> piece{seed};
    seen[seed] = true;
    --left;
    for (std::size_t next = 0; next < piece.size() && left > 0; ++next)
      for (int c = 0; c < 3; ++c)
        for (Eigen::SparseMatrix<double>::InnerIterator it(K, 3 * piece[next] + c); it; ++it) {
          const int neighbour = int(it.row()) / 3;
          if (seen[neighbour]) continue;
          seen[neighbour] = true;
          --left;
          piece.push_back(neighbour);
        }
    std::sort(piece.begin(), piece.end());
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

/// Coordinates of a piece [nodes x 3] about its centroid, scaled to unit inertia along its principal axes.
Eigen::MatrixXd scaledCoordinates(const std::vector<int>& piece, const std::vector<std::array<double, 3>>& coordinates) {
  Eigen::MatrixXd y(piece.size(), 3);
  for (std::size_t i = 0; i < piece.size(); ++i)
    y.row(i) = Eigen::Map<const Eigen::RowVector3d>(coordinates[piece[i]].data());
  y.rowwise() -= y.colwise().mean().eval();
  const SymmetricEigen3 inertia(y.transpose() * y / double(piece.size()));
  const double flat = 1e-12 * inertia.values[2];  // no extent along this axis
  y = y * inertia.vectors;
  for (int c = 0; c < 3; ++c) {
    const double lambda = inertia.values[c];
    y.col(c) *= lambda > flat ? 1.0 / std::sqrt(lambda) : 0.0;
  }
  return y;
}

/// Index of the largest entry; among entries equal up to round-off the first.
int firstLargest(const Eigen::VectorXd& values) {
  const double nearly = values.maxCoeff() * (1.0 - 1e-9);
  return int(std::find_if(values.begin(), values.end(), [=](double v) { return v >= nearly; }) - values.begin());
}

/// Each node the farthest from all before it; no more than the piece has nodes, or distinct places.
void sampleFarthest(const std::vector<int>& piece, const std::vector<std::array<double, 3>>& coordinates, int wanted,
                    std::vector<int>& chosen) {
  const auto y = scaledCoordinates(piece, coordinates);
  Eigen::VectorXd distance = y.rowwise().squaredNorm();  // the first: farthest from the centroid
  for (int k = 0; k < std::min<int>(wanted, int(piece.size())); ++k) {
    const int i = firstLargest(distance);
    if (k > 0 && distance[i] == 0.0) break;
    const Eigen::VectorXd toNew = (y.rowwise() - y.row(i)).rowwise().squaredNorm();
    distance = k == 0 ? toNew : distance.cwiseMin(toNew).eval();
    chosen.push_back(piece[i]);
  }
}

std::vector<int> unknownsOf(const std::vector<int>& nodes) {
  std::vector<int> unknowns;
  for (const int node : nodes) unknowns.insert(unknowns.end(), {3 * node, 3 * node + 1, 3 * node + 2});
  return unknowns;
}

/// Adds nodes until every unit combination of kernel columns is visible on the chosen ones: the smallest singular
/// value of R_f is then a fair part of what it would be, sqrt(chosen / all), if R were spread evenly.
void holdWholeKernel(const Eigen::MatrixXd& kernel, std::vector<int>& chosen) {
  constexpr double fairPart = 0.2;
  const double all = double(kernel.rows()) / 3.0;
  const auto most = std::min<std::size_t>(chosen.size() + 2 * kernel.cols(), std::size_t(all));
  while (chosen.size() < most) {
    const RightSvd svd(rowsOf(kernel, unknownsOf(chosen)));
    const bool full = svd.values.size() == kernel.cols();
    const double weakest = full ? svd.values[kernel.cols() - 1] : 0.0;
    if (weakest >= fairPart * std::sqrt(double(chosen.size()) / all)) break;
    // the motion that is seen least is held where it is largest
    const Eigen::VectorXd motion = kernel * svd.V.col(kernel.cols() - 1);
    Eigen::VectorXd size(kernel.rows() / 3);
    for (Eigen::Index i = 0; i < size.size(); ++i) size[i] = motion.segment<3>(3 * i).norm();
    for (const int node : chosen) size[node] = 0.0;
    chosen.push_back(firstLargest(size));
  }
}

}  // namespace

std::vector<int> chooseFixingNodes(const Eigen::SparseMatrix<double>& K, const Eigen::MatrixXd& kernel,
                                   const std::vector<std::array<double, 3>>& coordinates, int perPiece) {
  TEUCHOS_ASSERT(K.rows() == K.cols() && K.rows() == kernel.rows());
  TEUCHOS_ASSERT(K.rows() == 3 * Eigen::Index(coordinates.size()));
  std::vector<int> chosen;
  if (kernel.cols() == 0) return chosen;
  for (const auto& piece : connectedPieces(K)) sampleFarthest(piece, coordinates, perPiece, chosen);
  holdWholeKernel(kernel, chosen);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

// Every round holds the kernel by unknowns that no round before took: R_f is better conditioned by all of them than by one set.
std::vector<int> chooseFixingUnknowns(const Eigen::MatrixXd& kernel, int rounds) {
  std::vector<int> chosen;
  std::vector<int> rest(kernel.rows());
  std::iota(rest.begin(), rest.end(), 0);
  for (int round = 0; round < rounds && kernel.cols() > 0 && !rest.empty(); ++round) {
    std::vector<int> picked;
    for (int column : PivotedQr(rowsOf(kernel, rest).transpose()).columns) picked.push_back(rest[column]);
    chosen.insert(chosen.end(), picked.begin(), picked.end());
    std::sort(picked.begin(), picked.end());
    std::vector<int> left;
    std::set_difference(rest.begin(), rest.end(), picked.begin(), picked.end(), std::back_inserter(left));
    rest = std::move(left);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

Eigen::SparseMatrix<double> regularizeByFixing(const Eigen::SparseMatrix<double>& K, const Eigen::MatrixXd& kernel,
                                               const std::vector<int>& unknowns) {
  if (kernel.cols() == 0) return K;
  // Householder QR is stable row by row if large rows come first.
  const Eigen::VectorXd diagonal = K.diagonal();
  std::vector<int> order = unknowns;
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return diagonal[i] > diagonal[j]; });
  Eigen::VectorXd rootW(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) rootW[i] = std::sqrt(diagonal[order[i]]);

  const PivotedQr qr(rootW.asDiagonal() * rowsOf(kernel, order));
  TEUCHOS_TEST_FOR_EXCEPTION(Eigen::Index(qr.columns.size()) < kernel.cols(), std::runtime_error,
                             "regularizeByFixing: the kernel of a subdomain has " << kernel.cols()
                                 << " columns, but only " << qr.columns.size() << " are independent on its "
                                 << unknowns.size() << " fixing unknowns");
  // with W^1/2 R_f = Q T:  N (R_f^T N)^-1 N^T = W^1/2 Q Q^T W^1/2, without the squared condition number
  const Eigen::MatrixXd& Q = qr.Q;

  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = 0; j < order.size(); ++j) {
      const double coupling = Q.row(i).dot(Q.row(j));
      if (std::abs(coupling) > 1e-14 * Q.row(i).norm() * Q.row(j).norm())
        entries.emplace_back(order[i], order[j], rootW[i] * coupling * rootW[j]);
    }
  Eigen::SparseMatrix<double> fixing(K.rows(), K.cols());
  fixing.setFromTriplets(entries.begin(), entries.end());
  return withFewAdded(K, fixing);
}

}  // namespace Haptos
