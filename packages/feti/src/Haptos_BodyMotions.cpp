// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_BodyMotions.hpp"

#include <Teuchos_Assert.hpp>
#include <Tpetra_Map.hpp>
#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_DisjointSets.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Format.hpp"
#include "Haptos_LocalSystems.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_RigidBodyModes.hpp"

namespace Haptos {
namespace {

// Coefficients of the motions without energy, by columns: U [6 x 6] what the motions have outside the kernels, squared, N the
// motions themselves.
Eigen::MatrixXd motionsWithoutEnergy(const Eigen::Matrix<double, 6, 6>& U, const Eigen::Matrix<double, 6, 6>& N) {
  constexpr double kInside = 1e-10;
  if (U.cwiseAbs().maxCoeff() <= kInside * N.trace()) return Eigen::MatrixXd::Identity(6, 6);
  const SymmetricEigen eigen(U);
  Eigen::Index k = 0;
  while (k < 6 && eigen.values[k] <= kInside * N.trace()) ++k;
  return eigen.vectors.leftCols(k);
}

}  // namespace

// Centre and size of every body, and its first subdomain.
void BodyMotions::findBodies(const Communicator& comm, const LocalSystems& systems, const std::vector<int>& bodies) {
  const int count = numBodies();
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(4, count);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (const auto& x : systems.source().coordinates(int(i))) sums.col(bodies[i]) += Eigen::Vector4d(x[0], x[1], x[2], 1.0);
  sums = sumOfAll(comm, sums);
  for (int b = 0; b < count; ++b) centre_.push_back(sums.col(b).head<3>() / sums(3, b));
  Eigen::VectorXd size2 = Eigen::VectorXd::Zero(count);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (const auto& x : systems.source().coordinates(int(i)))
      size2[bodies[i]] = std::max(size2[bodies[i]], (Eigen::Vector3d(x[0], x[1], x[2]) - centre_[std::size_t(bodies[i])]).squaredNorm());
  for (double squared : largestOfAll(comm, size2)) size_.push_back(std::sqrt(squared));
}

// The six at a place.
Eigen::Matrix<double, 3, 6> BodyMotions::motionAt(int body, const std::array<double, 3>& x) const {
  Eigen::Matrix<double, 3, 6> motion = rigidMotion(Eigen::Vector3d(x[0], x[1], x[2]), centre_[std::size_t(body)]);
  motion.rightCols<3>() /= size_[std::size_t(body)];
  return motion;
}

// What the ranks know of the bodies' motions together.
struct BodyMotions::Sums {
  Eigen::MatrixXd rows;     // [6 x l] R^T times the six motions of the subdomain's body, transposed
  Eigen::MatrixXd squares;  // [6 x 12 bodies] U and N of motionsWithoutEnergy, body after body
  Eigen::VectorXi bodyOf;   // [l]

  void add(const Eigen::MatrixXd& block, const Eigen::Matrix<double, 6, 6>& N, int column, int body) {
    rows.middleCols(column, block.rows()) = block.transpose();
    squares.middleCols<6>(12 * body) += N - block.transpose() * block;
    squares.middleCols<6>(12 * body + 6) += N;
    bodyOf.segment(column, block.rows()).setConstant(body);
  }
};

// R^T N for the six motions N of the body: their coordinates in the kernel, and what of them lies outside it, N^T N - (R^T N)^T (R^T N).
BodyMotions::Sums BodyMotions::sumUp(const NaturalCoarseSpace& G, const LocalSystems& systems, const std::vector<int>& bodies) const {
  const int l = G.dimension();
  Sums sums{Eigen::MatrixXd::Zero(6, l), Eigen::MatrixXd::Zero(6, 12 * numBodies()), Eigen::VectorXi::Zero(l)};
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto& R = systems[int(i)].R();
    const auto& coordinates = systems.source().coordinates(int(i));
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(R.cols(), 6);
    Eigen::Matrix<double, 6, 6> N = Eigen::Matrix<double, 6, 6>::Zero();
    for (std::size_t node = 0; node < coordinates.size(); ++node) {
      const auto motion = motionAt(bodies[i], coordinates[node]);
      block.noalias() += R.middleRows(3 * Eigen::Index(node), 3).transpose() * motion;
      N.noalias() += motion.transpose() * motion;
    }
    sums.add(block, N, G.columnOf(int(i)), bodies[i]);
  }
  const Communicator& comm = *G.getRangeMap()->getComm();
  return {sumOfAll(comm, sums.rows), sumOfAll(comm, sums.squares), sumOfAll(comm, sums.bodyOf)};
}

// The coarse unknowns of every body's first subdomain.
void BodyMotions::findFirst(const NaturalCoarseSpace& G, const std::vector<int>& bodies) {
  const Communicator& comm = *G.getRangeMap()->getComm();
  std::vector<int> begin(names_.size(), G.dimension()), end(names_.size(), 0);
  for (std::size_t i = 0; i < bodies.size(); ++i) begin[bodies[i]] = std::min(begin[bodies[i]], G.columnOf(int(i)));
  const auto first = leastOfAll(comm, begin);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (G.columnOf(int(i)) == first[bodies[i]]) end[bodies[i]] = G.columnOf(int(i) + 1);
  const auto last = largestOfAll(comm, end);
  for (std::size_t b = 0; b < first.size(); ++b) first_.push_back({first[b], last[b]});
}

BodyMotions::BodyMotions(const NaturalCoarseSpace& G, const LocalSystems& systems, const std::vector<int>& bodies,
                         std::vector<std::string> names)
    : names_(std::move(names)) {
  findBodies(*G.getRangeMap()->getComm(), systems, bodies);
  findFirst(G, bodies);
  const Sums sums = sumUp(G, systems, bodies);
  for (int b = 0; b < numBodies(); ++b) {
    const Eigen::MatrixXd basis = motionsWithoutEnergy(sums.squares.middleCols<6>(12 * b), sums.squares.middleCols<6>(12 * b + 6));
    for (Eigen::Index m = 0; m < basis.cols(); ++m) columns_.push_back({b, basis.col(m)});
  }
  std::vector<std::size_t> firstOf(std::size_t(numBodies()) + 1, columns_.size());  // columns come body by body
  for (std::size_t j = columns_.size(); j-- > 0;) firstOf[std::size_t(columns_[j].body)] = j;
  std::vector<Eigen::Triplet<double>> triplets;
  for (int i = 0; i < G.dimension(); ++i)
    for (std::size_t j = firstOf[std::size_t(sums.bodyOf[i])]; j < columns_.size() && columns_[j].body == sums.bodyOf[i]; ++j)
      triplets.emplace_back(i, int(j), columns_[j].motion.dot(sums.rows.col(i)));
  Z_.resize(G.dimension(), Eigen::Index(columns_.size()));
  Z_.setFromTriplets(triplets.begin(), triplets.end());
}

// One body is named: the one that moves most, the first of equals.
std::string BodyMotions::describe(const Eigen::VectorXd& y, double negligible, MotionSense sense) const {
  std::vector<Motion> motions(names_.size(), Motion::Zero());
  for (std::size_t j = 0; j < columns_.size(); ++j) motions[std::size_t(columns_[j].body)] += y[Eigen::Index(j)] * columns_[j].motion;
  for (Motion& m : motions)
    if (m.tail<3>().norm() < negligible * m.head<3>().norm()) m.tail<3>().setZero();
  std::size_t body = 0;
  for (std::size_t b = 1; b < motions.size(); ++b)
    if (motions[b].norm() > (1 + 1e-9) * motions[body].norm()) body = b;
  const Motion& m = motions[body];
  return "body '" + names_[body] + "': " + describeRigidMotion({m.head<3>(), m.tail<3>() / size_[body], centre_[body], size_[body]}, sense);
}

std::string BodyMotions::describeDriven(const Eigen::VectorXd& y) const { return describe(y, 0.05, MotionSense::AsGiven); }

Eigen::SparseVector<double> BodyMotions::hold(int motion) const {
  Eigen::SparseVector<double> w(Z_.rows());
  const auto [begin, end] = first_[std::size_t(columns_[std::size_t(motion)].body)];
  for (Eigen::SparseMatrix<double>::InnerIterator it(Z_, motion); it; ++it)
    if (it.row() >= begin && it.row() < end) w.insert(it.row()) = it.value();
  return w / w.norm();
}

namespace {

// Entries of a symmetric matrix over motions, [2]: of all rows that count, and of those that touch one body alone.
using JumpProducts = std::map<std::pair<int, int>, std::array<double, 2>>;

// (G^T Z)^T (G^T Z) of the rows that count, one by one: G^T Z as a whole may take more memory than G^T.  In blocks of motions that rows touch together,
// as there are many rows and few of these.
JumpProducts productsOfJumps(const CoarseRows& GT, const Eigen::SparseMatrix<double>& Z, const std::vector<char>& holds, const std::vector<int>& bodyOf) {
  const CoarseRows motions = Z;
  std::map<std::vector<int>, Eigen::MatrixXd> blocks;
  Eigen::VectorXd jump = Eigen::VectorXd::Zero(Z.cols());
  std::vector<Eigen::Index> touchedBy(std::size_t(Z.cols()), -1);
  std::vector<int> touched;
  for (Eigen::Index row = 0; row < GT.rows(); ++row) {
    if (!holds[std::size_t(row)]) continue;
    touched.clear();
    for (CoarseRows::InnerIterator it(GT, row); it; ++it)
      for (CoarseRows::InnerIterator motion(motions, it.col()); motion; ++motion) {
        if (touchedBy[std::size_t(motion.col())] != row) touched.push_back(int(motion.col()));
        touchedBy[std::size_t(motion.col())] = row;
        jump[motion.col()] += it.value() * motion.value();
      }
    std::sort(touched.begin(), touched.end());
    const Eigen::Index n = Eigen::Index(touched.size());
    const Eigen::VectorXd j = jump(touched);
    blocks.try_emplace(touched, Eigen::MatrixXd::Zero(n, n)).first->second.noalias() += j * j.transpose();
    for (int motion : touched) jump[motion] = 0;
  }
  JumpProducts products;
  for (const auto& [list, block] : blocks) {
    const bool isAlone = std::all_of(list.begin(), list.end(), [&](int m) { return bodyOf[std::size_t(m)] == bodyOf[std::size_t(list.front())]; });
    for (std::size_t k = 0; k < list.size(); ++k)
      for (std::size_t l = k; l < list.size(); ++l) {
        auto& entry = products[{list[k], list[l]}];
        entry[0] += block(Eigen::Index(k), Eigen::Index(l));
        if (isAlone) entry[1] += block(Eigen::Index(k), Eigen::Index(l));
      }
  }
  return products;
}

// The same on all ranks.  A body touches few others, whatever their number: only these entries are sent.
JumpProducts sumOfProducts(const Communicator& comm, const JumpProducts& mine) {
  struct Place {
    int a, b;
  };
  std::vector<Place> places;
  for (const auto& [place, value] : mine) places.push_back({place.first, place.second});
  JumpProducts all;
  for (const Place& place : gatheredOnAll(comm, places)) all[{place.a, place.b}] = {0, 0};
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(2, Eigen::Index(all.size()));
  Eigen::Index at = 0;
  for (const auto& [place, zero] : all) {
    if (const auto found = mine.find(place); found != mine.end()) values.col(at) << found->second[0], found->second[1];
    ++at;
  }
  values = sumOfAll(comm, values);
  at = 0;
  for (auto& [place, value] : all) {
    value = {values(0, at), values(1, at)};
    ++at;
  }
  return all;
}

// [motions] lists; two are in one where an entry joins them.  Those of `isOut` are in none.
std::vector<std::vector<int>> groupsOfMotions(const JumpProducts& A, int count, const std::vector<char>& isOut) {
  DisjointSets sets{std::size_t(count)};
  for (const auto& [place, value] : A)
    if (!isOut[std::size_t(place.first)] && !isOut[std::size_t(place.second)]) sets.join(place.first, place.second);
  std::map<int, std::vector<int>> groups;
  for (int m = 0; m < count; ++m)
    if (!isOut[std::size_t(m)]) groups[sets.lowest(m)].push_back(m);
  std::vector<std::vector<int>> result;
  for (auto& [lowest, group] : groups) result.push_back(std::move(group));
  return result;
}

Eigen::MatrixXd denseOf(const JumpProducts& A, const std::vector<int>& motions, std::size_t which) {
  const Eigen::Index n = Eigen::Index(motions.size());
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (auto it = A.lower_bound({motions[std::size_t(i)], 0}); it != A.end() && it->first.first == motions[std::size_t(i)]; ++it) {
      const auto found = std::lower_bound(motions.begin(), motions.end(), it->first.second);
      if (found == motions.end() || *found != it->first.second) continue;
      const Eigen::Index j = found - motions.begin();
      dense(i, j) = dense(j, i) = it->second[which];
    }
  return dense;
}

// [motions] those of bodies that rows of their own hold well: no motion of theirs is left, whatever others do.
std::vector<char> motionsHeldAlone(const JumpProducts& A, const std::vector<int>& bodyOf) {
  constexpr double kWell = 1e-6;
  std::vector<char> isHeld(bodyOf.size(), 0);
  std::map<int, std::vector<int>> motionsOf;
  for (std::size_t m = 0; m < bodyOf.size(); ++m) motionsOf[bodyOf[m]].push_back(int(m));
  for (const auto& [body, motions] : motionsOf) {
    const SymmetricEigen eigen(denseOf(A, motions, 1));
    if (eigen.values[0] > kWell * std::max(1.0, eigen.values.tail<1>()[0]))
      for (int m : motions) isHeld[std::size_t(m)] = 1;
  }
  return isHeld;
}

// Gauss-Jordan with complete pivoting of Y's columns; the rows of the pivots.
std::vector<int> reduce(Eigen::MatrixXd& Y) {
  std::vector<int> pivots;
  for (Eigen::Index i = 0; i < Y.cols(); ++i) {
    double best = 0;
    Eigen::Index row = 0, column = i;
    for (Eigen::Index c = i; c < Y.cols(); ++c)
      for (Eigen::Index r = 0; r < Y.rows(); ++r)
        if (std::abs(Y(r, c)) > best) best = std::abs(Y(r, c)), row = r, column = c;
    Y.col(i).swap(Y.col(column));
    Y.col(i) /= Y(row, i);
    for (Eigen::Index c = 0; c < Y.cols(); ++c)
      if (c != i) Y.col(c) -= Y(row, c) * Y.col(i);
    pivots.push_back(int(row));
  }
  return pivots;
}

// [columns of Z] what tells bodies apart: all motions of one are on its subdomains
std::vector<int> bodiesOfMotions(const Eigen::SparseMatrix<double>& Z) {
  std::vector<int> bodyOf;
  for (Eigen::Index m = 0; m < Z.cols(); ++m) {
    const Eigen::SparseMatrix<double>::InnerIterator first(Z, m);
    bodyOf.push_back(first ? int(first.row()) : -1);
  }
  return bodyOf;
}

}  // namespace

// Bodies that are held by themselves leave first, then motions that rows join are looked at group by group: of many bolts in plates that are held
// each is one.
UnheldMotions findUnheldMotions(const Communicator& comm, const CoarseRows& GT, const Eigen::SparseMatrix<double>& Z,
                                const std::vector<char>& holds) {
  TEUCHOS_ASSERT(holds.size() == std::size_t(GT.rows()));
  if (Z.cols() == 0) return {};
  constexpr double kUnheld = 1e-10;  // of the largest eigenvalue; a single held node gives about 1, round-off 1e-30
  const std::vector<int> bodyOf = bodiesOfMotions(Z);
  const JumpProducts A = sumOfProducts(comm, productsOfJumps(GT, Z, holds, bodyOf));
  const auto groups = groupsOfMotions(A, int(Z.cols()), motionsHeldAlone(A, bodyOf));
  std::vector<SymmetricEigen> eigen;
  double largest = 1;  // 1: where nothing is held at all
  for (const auto& group : groups) {
    eigen.emplace_back(denseOf(A, group, 0));
    largest = std::max(largest, eigen.back().values.tail<1>()[0]);
  }
  UnheldMotions result;
  result.basis.resize(Z.cols(), 0);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto isUnheld = eigen[g].values.array() <= kUnheld * largest;
    Eigen::MatrixXd Y = eigen[g].vectors.leftCols(isUnheld.count());
    if (Y.cols() == 0) continue;
    for (int row : reduce(Y)) result.pivots.push_back(groups[g][std::size_t(row)]);
    const Eigen::Index first = result.basis.cols();
    result.basis.conservativeResize(Eigen::NoChange, first + Y.cols());
    result.basis.rightCols(Y.cols()).setZero();
    for (std::size_t i = 0; i < groups[g].size(); ++i) result.basis.row(groups[g][i]).tail(Y.cols()) = Y.row(Eigen::Index(i));
  }
  return result;
}

CoarseProblem::Holds holdsFor(const UnheldMotions& unheld, const BodyMotions& bodies) {
  CoarseProblem::Holds holds;
  for (int pivot : unheld.pivots) holds.push_back(bodies.hold(pivot));
  return holds;
}

// With Y a basis of the unheld motions, Y^T Z^T e is the work of the loads on them.
Eigen::VectorXd drivenMotion(const UnheldMotions& unheld, const BodyMotions& bodies, const Eigen::VectorXd& e) {
  const Eigen::MatrixXd& Y = unheld.basis;
  return Y * solveByLdlt(Y.transpose() * Y, Y.transpose() * (bodies.Z().transpose() * e));
}

// That work must vanish, or no equilibrium exists; where it does not the motion is named that the loads drive.
void requireBalance(const UnheldMotions& unheld, const BodyMotions& bodies, const Eigen::VectorXd& e, double loadScale) {
  constexpr double kBalanced = 1e-9;
  if (unheld.basis.cols() == 0) return;
  const Eigen::VectorXd driven = drivenMotion(unheld, bodies, e);
  if (driven.norm() > kBalanced * loadScale)
    throw InsufficientModel("The model has no solution: " + bodies.describe(driven) +
                            " is held by nothing, and the loads drive it (resultant " + formatted("%g", driven.norm()) +
                            "). Fix the body by a Displacement condition or give it a contact that can carry the load.");
}

}  // namespace Haptos
