// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_BodyMotions.hpp"

#include <Teuchos_Assert.hpp>
#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Map.hpp>
#include <limits>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Format.hpp"
#include "Haptos_RigidBodyModes.hpp"

namespace Haptos {
namespace {

constexpr int kModes = 6;

template <class Packed>
void sumOverRanks(const Communicator& comm, Packed& values) {
  const Packed mine = values;
  Teuchos::reduceAll(comm, Teuchos::REDUCE_SUM, int(mine.size()), mine.data(), values.data());
}

}  // namespace

BodyMotions::BodyMotions(const Communicator& comm, const std::vector<Subdomain>& subdomains, const LocalSystems& systems,
                         int numSubdomains, std::vector<std::string> names)
    : names_(std::move(names)) {
  const int bodies = numBodies();
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(4, bodies);
  for (const auto& sub : subdomains)
    for (const auto& x : sub.coordinates) sums.col(sub.body) += Eigen::Vector4d(x[0], x[1], x[2], 1.0);
  sumOverRanks(comm, sums);
  Eigen::VectorXd size2 = Eigen::VectorXd::Zero(bodies), largest2(bodies);
  std::vector<int> first(bodies, numSubdomains);
  for (int b = 0; b < bodies; ++b) centre_.push_back(sums.col(b).head<3>() / sums(3, b));
  for (const auto& sub : subdomains) {
    first[sub.body] = std::min(first[sub.body], sub.id);
    for (const auto& x : sub.coordinates)
      size2[sub.body] = std::max(size2[sub.body], (Eigen::Vector3d(x[0], x[1], x[2]) - centre_[sub.body]).squaredNorm());
  }
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, bodies, size2.data(), largest2.data());
  firstSubdomain_.resize(bodies);
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MIN, bodies, first.data(), firstSubdomain_.data());
  for (int b = 0; b < bodies; ++b) size_.push_back(std::sqrt(largest2[b]));

  // Block s of Z: R_s^T times the six motions of its body.
  Eigen::MatrixXd blocks = Eigen::MatrixXd::Zero(kModes * kModes, numSubdomains);
  std::vector<int> bodyOf(numSubdomains, 0), bodyOfAll(numSubdomains);
  for (std::size_t i = 0; i < subdomains.size(); ++i) {
    const Subdomain& sub = subdomains[i];
    bodyOf[sub.id] = sub.body;
    Eigen::Map<Eigen::MatrixXd> block(blocks.col(sub.id).data(), kModes, kModes);
    for (int node = 0; node < sub.numNodes(); ++node) {
      const auto& x = sub.coordinates[node];
      Eigen::Matrix<double, 3, 6> motion = rigidMotion(Eigen::Vector3d(x[0], x[1], x[2]), centre_[sub.body]);
      motion.rightCols<3>() /= size_[sub.body];
      block.noalias() += systems[int(i)].R().middleRows(3 * node, 3).transpose() * motion;
    }
  }
  sumOverRanks(comm, blocks);
  Teuchos::reduceAll(comm, Teuchos::REDUCE_SUM, numSubdomains, bodyOf.data(), bodyOfAll.data());
  std::vector<Eigen::Triplet<double>> triplets;
  for (int s = 0; s < numSubdomains; ++s)
    for (int i = 0; i < kModes; ++i)
      for (int j = 0; j < kModes; ++j)
        triplets.emplace_back(kModes * s + i, kModes * bodyOfAll[s] + j, blocks(i + kModes * j, s));
  Z_.resize(kModes * numSubdomains, kModes * bodies);
  Z_.setFromTriplets(triplets.begin(), triplets.end());
}

std::string BodyMotions::describe(const Eigen::VectorXd& y) const {
  int body = 0;
  for (int b = 1; b < numBodies(); ++b)
    if (y.segment<kModes>(kModes * b).norm() > (1 + 1e-9) * y.segment<kModes>(kModes * body).norm()) body = b;
  const auto part = y.segment<kModes>(kModes * body);
  return "body '" + names_[body] + "': " +
         describeRigidMotion({part.head<3>(), part.tail<3>() / size_[body], centre_[body], size_[body]});
}

Eigen::SparseVector<double> BodyMotions::hold(int body, int motion) const {
  Eigen::SparseVector<double> w(Z_.rows());
  const int first = kModes * firstSubdomain_[body];
  for (Eigen::SparseMatrix<double>::InnerIterator it(Z_, kModes * body + motion); it; ++it)
    if (it.row() >= first && it.row() < first + kModes) w.insert(it.row()) = it.value();
  return w / w.norm();
}

namespace {

// (G^T Z)^T (G^T Z) of the rows that count, one by one: G^T Z as a whole may take more memory than G^T.
Eigen::MatrixXd gramOfJumps(const CoarseRows& GT, const Eigen::SparseMatrix<double>& Z, const std::vector<char>& holds) {
  const CoarseRows motions = Z;
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(Z.cols(), Z.cols());
  Eigen::VectorXd jump = Eigen::VectorXd::Zero(Z.cols());
  std::vector<int> touched;  // motions of the bodies at this row
  std::vector<Eigen::Index> touchedBy(std::size_t(Z.cols()), -1);
  for (Eigen::Index row = 0; row < GT.rows(); ++row) {
    if (!holds[std::size_t(row)]) continue;
    touched.clear();
    for (CoarseRows::InnerIterator it(GT, row); it; ++it)
      for (CoarseRows::InnerIterator motion(motions, it.col()); motion; ++motion) {
        if (touchedBy[std::size_t(motion.col())] != row) touched.push_back(int(motion.col()));
        touchedBy[std::size_t(motion.col())] = row;
        jump[motion.col()] += it.value() * motion.value();
      }
    for (int a : touched)
      for (int b : touched) gram(a, b) += jump[a] * jump[b];
    for (int a : touched) jump[a] = 0;
  }
  return gram;
}

}  // namespace

UnheldMotions findUnheldMotions(const Communicator& comm, const CoarseRows& GT, const Eigen::SparseMatrix<double>& Z,
                                const std::vector<char>& holds) {
  TEUCHOS_ASSERT(holds.size() == std::size_t(GT.rows()));
  if (Z.cols() == 0) return {};
  constexpr double kUnheld = 1e-10;  // of the largest eigenvalue; a single held node gives about 1, round-off 1e-30
  Eigen::MatrixXd A = gramOfJumps(GT, Z, holds);
  sumOverRanks(comm, A);
  const SymmetricEigen eigen(A);
  const double largest = std::max(1.0, eigen.values.tail<1>()[0]);  // 1: where nothing is held at all
  Eigen::Index k = 0;
  while (k < A.rows() && eigen.values[k] <= kUnheld * largest) ++k;
  UnheldMotions result;
  result.basis = eigen.vectors.leftCols(k);
  for (Eigen::Index i = 0; i < k; ++i) {  // Gauss-Jordan with complete pivoting
    double best = 0;
    Eigen::Index row = 0, column = i;
    for (Eigen::Index c = i; c < k; ++c)
      for (Eigen::Index r = 0; r < A.rows(); ++r)
        if (std::abs(result.basis(r, c)) > best) best = std::abs(result.basis(r, c)), row = r, column = c;
    result.basis.col(i).swap(result.basis.col(column));
    result.basis.col(i) /= result.basis(row, i);
    for (Eigen::Index c = 0; c < k; ++c)
      if (c != i) result.basis.col(c) -= result.basis(row, c) * result.basis.col(i);
    result.pivots.push_back(int(row));
  }
  return result;
}

CoarseProblem::Holds holdsFor(const UnheldMotions& unheld, const BodyMotions& bodies) {
  CoarseProblem::Holds holds;
  for (int pivot : unheld.pivots) holds.push_back(bodies.hold(pivot / kModes, pivot % kModes));
  return holds;
}

CoarseProblem::Holds holdUnheldMotions(const UnheldMotions& unheld, const BodyMotions& bodies, const Eigen::VectorXd& e,
                                       double loadScale) {
  constexpr double kBalanced = 1e-9;
  const Eigen::VectorXd resultant = bodies.Z().transpose() * e;
  Eigen::VectorXd work = unheld.basis.transpose() * resultant;
  // Loads that do work on a free motion: name the motion that they drive.
  const Eigen::VectorXd driven = unheld.basis * solveByLdlt(unheld.basis.transpose() * unheld.basis, work);
  if (work.size() > 0 && driven.norm() > kBalanced * loadScale)
    throw InsufficientModel("The model has no solution: " + bodies.describe(driven) +
                            " is held by nothing, and the loads drive it (resultant " + formatted("%g", driven.norm()) +
                            "). Fix the body by a Displacement condition or give it a contact that can carry the load.");
  return holdsFor(unheld, bodies);
}

}  // namespace Haptos
