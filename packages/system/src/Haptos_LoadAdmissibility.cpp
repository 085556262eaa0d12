// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_LoadAdmissibility.hpp"

#include <Tpetra_Map.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_DisjointSets.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_FrictionCone.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

// Coulomb's cone with all three components in it, which the law of a pair is not: forces are asked for, not motions.
bool isCone(const PairLaw& pair) { return pair.law == FrictionLaw::Coulomb && pair.frictional() && !pair.normalPinned; }

// Motions that contact may hold together, [motions x free] of them, and the laws of the pairs of this rank that feel them.
struct FreeGroup {
  std::vector<int> motions;  // columns of Z, ascending
  Eigen::MatrixXd N;         // orthonormal
  std::vector<PairLaw> pairs;
};

// Work of the contact forces of every pair on the free motions: 3 rows a pair.  Those of a cone belong to (lambda_N, F^-1 lambda_T), in
// which it is circular: on flat ones (coefficients 3000 times apart) Newton's method got nowhere, here it takes a few steps.
SparseRows pairRows(const FreeGroup& group, const SparseRows& GZ, const Eigen::MatrixXd& N) {
  std::vector<Eigen::Triplet<double>> triplets;
  const auto add = [&](int target, int row, double scale) {
    if (row < 0 || scale == 0) return;
    Eigen::VectorXd r = Eigen::VectorXd::Zero(N.cols());
    for (SparseRows::InnerIterator it(GZ, row); it; ++it) {
      const auto found = std::lower_bound(group.motions.begin(), group.motions.end(), int(it.col()));
      if (found != group.motions.end() && *found == int(it.col())) r += it.value() * N.row(found - group.motions.begin()).transpose();
    }
    for (Eigen::Index j = 0; j < r.size(); ++j)
      if (r[j] != 0.0) triplets.emplace_back(target, int(j), scale * r[j]);
  };
  for (std::size_t i = 0; i < group.pairs.size(); ++i) {
    const PairLaw& pair = group.pairs[i];
    add(3 * int(i), pair.normal, 1);
    for (std::size_t t = 0; t < 2; ++t) add(3 * int(i) + 1 + int(t), pair.tangential[t], isCone(pair) ? pair.coefficients[t] : 1);
  }
  SparseRows H(3 * Eigen::Index(group.pairs.size()), N.cols());
  H.setFromTriplets(triplets.begin(), triplets.end());
  return H;
}

// Two motions that a pair of any rank feels are in one group, and two of one free motion: bolts that touch nothing but plates which are held are each
// a problem of their own, of six unknowns.
class GroupFinder {
 public:
  GroupFinder(const ContactLaw& law, const SparseRows& GZ, const Eigen::MatrixXd& basis)
      : law_(law), GZ_(GZ), basis_(basis), sets_(std::size_t(basis.rows())), isFree_(std::size_t(basis.rows()), 0) {}

  /// The same on all ranks but for the pairs.
  std::vector<FreeGroup> find(const Communicator& comm) {
    joinMotions();
    joinPairs(comm);
    std::map<int, FreeGroup> groups;  // by lowest motions
    for (std::size_t m = 0; m < isFree_.size(); ++m)
      if (isFree_[m]) groups[sets_.lowest(int(m))].motions.push_back(int(m));
    std::map<int, std::vector<Eigen::Index>> columns;
    for (Eigen::Index j = 0; j < basis_.cols(); ++j) columns[sets_.lowest(firstOf(j))].push_back(j);
    for (auto& [lowest, group] : groups) group.N = orthonormalBasis(basis_(group.motions, columns[lowest]));
    for (const PairLaw& pair : law_.pairs())
      if (const auto felt = motionsOf(pair); !felt.empty()) groups[sets_.lowest(felt.front())].pairs.push_back(pair);
    std::vector<FreeGroup> result;
    for (auto& [lowest, group] : groups) result.push_back(std::move(group));
    return result;
  }

 private:
  int firstOf(Eigen::Index column) const {
    int m = 0;
    while (basis_(m, column) == 0) ++m;
    return m;
  }

  void joinMotions() {
    for (Eigen::Index j = 0; j < basis_.cols(); ++j)
      for (int first = firstOf(j), m = first; m < int(basis_.rows()); ++m) {
        if (basis_(m, j) == 0) continue;
        isFree_[std::size_t(m)] = 1;
        sets_.join(first, m);
      }
  }

  // There are many pairs, and few bodies that meet: what a rank knows is sent once.
  void joinPairs(const Communicator& comm) {
    struct Edge {
      int a, b;
    };
    std::set<std::pair<int, int>> mine;
    for (const PairLaw& pair : law_.pairs()) {
      const auto felt = motionsOf(pair);
      for (const int m : felt) mine.emplace(felt.front(), m);
    }
    std::vector<Edge> edges;
    for (const auto& [a, b] : mine) edges.push_back({a, b});
    for (const Edge& edge : gatheredOnAll(comm, edges)) sets_.join(edge.a, edge.b);
  }

  // Free ones.
  std::vector<int> motionsOf(const PairLaw& pair) const {
    std::vector<int> felt;
    for (const int row : {pair.normal, pair.tangential[0], pair.tangential[1]}) {
      if (row < 0) continue;
      for (SparseRows::InnerIterator it(GZ_, row); it; ++it)
        if (isFree_[std::size_t(it.col())]) felt.push_back(int(it.col()));
    }
    return felt;
  }

  const ContactLaw& law_;
  const SparseRows& GZ_;
  const Eigen::MatrixXd& basis_;
  DisjointSets sets_;
  std::vector<char> isFree_;
};

ConeProjection projectPair(const PairLaw& pair, const std::array<double, 3>& x) {
  if (isCone(pair)) return projectOntoFrictionCone(x, {1, 1});
  const PairProjection p = pair.project(x);
  return {p.point, p.dPdx};
}

// Phi(a) = H^T P(H a) + eps a - b, the gradient of a strongly convex function; J its derivative.
struct DualState {
  Eigen::VectorXd a, phi;
  Eigen::MatrixXd J;
};

class RigidBalance {
 public:
  // \param units of the entries of b
  RigidBalance(const Communicator& comm, const std::vector<PairLaw>& pairs, SparseRows H, Eigen::VectorXd b, Eigen::VectorXd units)
      : comm_(comm), pairs_(pairs), H_(std::move(H)), b_(std::move(b)), units_(std::move(units)) {
    const double trace = sumOfAll(comm, H_.coeffs().square().sum());  // a rank may have no pairs
    eps_ = 1e-9 * std::max(trace, 1e-300) / double(std::max<Eigen::Index>(1, H_.cols()));
  }

  // P(H a) pair by pair; H^T P and H^T P' H in one reduction.
  DualState evaluate(const Eigen::VectorXd& a) const {
    const Eigen::VectorXd x = H_ * a;
    Eigen::VectorXd p(x.size());
    std::vector<Eigen::Triplet<double>> triplets;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const int at = 3 * int(i);
      const auto P = projectPair(pairs_[i], {x[at], x[at + 1], x[at + 2]});
      for (int r = 0; r < 3; ++r) {
        p[at + r] = P.point[r];
        for (int c = 0; c < 3; ++c)
          if (P.dPdx[r][c] != 0.0) triplets.emplace_back(at + r, at + c, P.dPdx[r][c]);
      }
    }
    SparseRows D(x.size(), x.size());
    D.setFromTriplets(triplets.begin(), triplets.end());
    Eigen::MatrixXd mine(a.size(), a.size() + 1);
    mine.leftCols(a.size()) = Eigen::MatrixXd(H_.transpose() * (D * H_));
    mine.rightCols(1) = H_.transpose() * p;
    const Eigen::MatrixXd sum = sumOfAll(comm_, mine);
    return {a, sum.rightCols(1) + eps_ * a - b_,
            Eigen::MatrixXd(sum.leftCols(a.size())) + eps_ * Eigen::MatrixXd::Identity(a.size(), a.size())};
  }

  // Semismooth Newton's method with a line search on |Phi|.
  DualState solve() const {
    DualState state = evaluate(Eigen::VectorXd::Zero(b_.size()));
    double damping = 0;
    for (int i = 0; i < 200 && sizeOf(state.phi) > 1e-9 * sizeOf(b_); ++i) {
      Eigen::MatrixXd J = state.J;
      J.diagonal().array() += damping;
      const Eigen::VectorXd step = -solveByLdlt(J, state.phi);
      double t = 1;
      DualState next = evaluate(state.a + step);
      while (t > 1e-6 && sizeOf(next.phi) > (1 - 1e-4 * t) * sizeOf(state.phi)) next = evaluate(state.a + (t *= 0.5) * step);
      const bool descends = sizeOf(next.phi) < sizeOf(state.phi);
      damping = descends ? damping / 10 : std::max(10 * damping, 1e3 * eps_);
      if (descends) state = next;
    }
    return state;
  }

  double imbalance(const DualState& state) const { return sizeOf(eps_ * state.a - state.phi) / sizeOf(b_); }  ///< of the loads

 private:
  const Communicator& comm_;
  const std::vector<PairLaw>& pairs_;
  double sizeOf(const Eigen::VectorXd& phi) const { return units_.cwiseProduct(phi).norm(); }

  SparseRows H_;
  Eigen::VectorXd b_, units_;
  double eps_;
};

// T with (H T)^T (H T) = 1 and the units of T^T b, 1 / |column|.  Motions along which coefficients are small are scaled as others are: a
// ratio of 1e4 had left them as little of H^T P' H as the regularisation adds.  Those that contact does not feel at all stay.
struct EvenMotions {
  Eigen::MatrixXd T;
  Eigen::VectorXd units;
};

EvenMotions evenMotions(const Communicator& comm, const SparseRows& H) {
  constexpr double kFelt = 1e-14;  // of the largest: round-off
  const Eigen::MatrixXd mine = Eigen::MatrixXd(H.transpose() * H);
  const SymmetricEigen eigen(sumOfAll(comm, mine));
  const double largest = eigen.values.cwiseAbs().maxCoeff();
  Eigen::VectorXd units(eigen.values.size());
  for (Eigen::Index k = 0; k < units.size(); ++k) units[k] = std::sqrt(eigen.values[k] > kFelt * largest ? eigen.values[k] : std::max(largest, 1e-300));
  return {eigen.vectors * units.cwiseInverse().asDiagonal(), units};
}

// Exists lambda in the cones with H^T lambda = b?  The regularised dual function is minimised; what imbalance is left where it is
// least tells, and its a the motion that nothing stops: [motions of the group], or nothing.
Eigen::VectorXd motionThatNothingStops(const Communicator& comm, const FreeGroup& group, const SparseRows& GZ, const Eigen::VectorXd& b) {
  constexpr double kBalanced = 1e-5;  // of the loads; the regularisation leaves about 1e-9
  const SparseRows H = pairRows(group, GZ, group.N);
  const EvenMotions even = evenMotions(comm, H);
  const RigidBalance balance(comm, group.pairs, pairRows(group, GZ, group.N * even.T), even.T.transpose() * b, even.units);
  if (balance.imbalance(balance.solve()) <= kBalanced) return {};
  // The motion that is named is the one of least distance in lengths.
  const DualState state = RigidBalance(comm, group.pairs, H, b, Eigen::VectorXd::Ones(b.size())).solve();
  const double sense = b.dot(state.a) < 0 ? -1 : 1;  // the loads' work is positive
  return sense * (group.N * state.a);
}

}  // namespace

// Group by group, as forces of one do nothing for another; of several that cannot be held the first is named.
void requireAdmissibleLoads(const ContactLaw& law, const UnheldMotions& floating, const NaturalCoarseSpace& G,
                            const Eigen::VectorXd& e, const BodyMotions& bodies, double loadScale) {
  constexpr double kUnloaded = 1e-9;
  if (floating.basis.cols() == 0) return;
  const Eigen::VectorXd work = bodies.Z().transpose() * e;
  const SparseRows GZ = G.rows() * bodies.Z();
  const Communicator& comm = *G.getRangeMap()->getComm();
  for (const FreeGroup& group : GroupFinder(law, GZ, floating.basis).find(comm)) {
    const Eigen::VectorXd b = group.N.transpose() * work(group.motions);
    if (b.norm() <= kUnloaded * loadScale) continue;
    const Eigen::VectorXd driven = motionThatNothingStops(comm, group, GZ, b);
    if (driven.size() == 0) continue;
    Eigen::VectorXd way = Eigen::VectorXd::Zero(work.size());
    way(group.motions) = driven;
    throw InsufficientModel("The model has no solution: contact and friction cannot carry the loads on " + bodies.describeDriven(way) +
                            ". Reduce the load in that direction, raise the friction, or fix the body there.");
  }
}

}  // namespace Haptos
