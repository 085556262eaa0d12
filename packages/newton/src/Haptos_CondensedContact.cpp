// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CondensedContact.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <cmath>

#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {
namespace {

// By LU, which is good for all but singular matrices; kernel vectors (motions that nothing holds) get the least norm.
Eigen::VectorXd solveDense(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  constexpr double kUseless = 1e-6;  // residual of a solution that is none
  const Eigen::VectorXd x = solveByLu(A, b);
  if (x.allFinite() && (A * x - b).norm() <= kUseless * b.norm()) return x;
  return solveLeastSquares(A, b);
}

}  // namespace

// Column j of M_cc is M applied to unit force j; every rank has its own rows of it, then all have all.
CondensedContact::CondensedContact(RCP<const Operator> M, const Operator& contactM, const DualVectors& vectors,
                                   SubspaceNewtonOptions::Condensed options)
    : M_(std::move(M)), vectors_(vectors), options_(options) {
  const Eigen::Index mine = 3 * vectors.numPairs();
  Eigen::Index end = 0;
  Teuchos::scan(vectors.comm(), Teuchos::REDUCE_SUM, mine, Teuchos::outArg(end));
  Teuchos::reduceAll(vectors.comm(), Teuchos::REDUCE_SUM, mine, Teuchos::outArg(size_));
  first_ = end - mine;
  Eigen::MatrixXd rows(mine, size_);
  for (Eigen::Index j = 0; j < size_; ++j) {
    Eigen::VectorXd unit = Eigen::VectorXd::Zero(mine);
    if (j >= first_ && j < end) unit[j - first_] = 1;
    rows.col(j) = vectors.applyOnContact(contactM, unit);
  }
  Mcc_ = onAllRanks(rows);
  // as M is, but for round-off and the single precision of its parts
  Mcc_ = (0.5 * (Mcc_ + Mcc_.transpose())).eval();
}

// Every rank's rows, in the order of the ranks, by one sum of numbers that are 0 elsewhere.
Eigen::MatrixXd CondensedContact::onAllRanks(const Eigen::MatrixXd& mine) const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(size_, mine.cols());
  all.middleRows(first_, mine.rows()) = mine;
  vectors_.sum(all);
  return all;
}

// (M s_E)_c of this rank
Eigen::VectorXd CondensedContact::forcesOfGluing(const Eigen::VectorXd& s) const {
  Eigen::VectorXd jumps = s;
  vectors_.setContact(jumps, Eigen::VectorXd::Zero(3 * vectors_.numPairs()));
  return vectors_.contact(vectors_.apply(*M_, jumps));
}

// M (s_E, sigma)
Eigen::VectorXd CondensedContact::response(Eigen::VectorXd s, const Eigen::VectorXd& sigma) const {
  vectors_.setContact(s, sigma.segment(first_, 3 * vectors_.numPairs()));
  return vectors_.apply(*M_, s);
}

// All pairs of all ranks: phi at sigma, and Newton's matrix.
struct CondensedContact::Model {
  const Eigen::MatrixXd& Mcc;
  const SubspaceNewtonOptions::Condensed& options;
  std::vector<PairLaw> pairs;
  Eigen::VectorXd r, lambda, s;  // lambda: with m

  LawLinearization at(const Eigen::VectorXd& sigma) const { return linearizeLaw(pairs, lambda + Mcc * sigma, s - sigma, r); }

  // (A Mcc - B) d = rhs, A = (I - P') / r, B = -P': d phi / d sigma of phi(lambda + Mcc sigma, s - sigma)
  static Eigen::VectorXd step(const Eigen::MatrixXd& Mcc, const LawLinearization& law, Eigen::VectorXd rhs) {
    Eigen::MatrixXd J = Mcc;
    for (Eigen::Index i = 0; i < law.r.size(); ++i) {
      const Eigen::Matrix3d& P = law.dP[std::size_t(i)];
      J.middleRows<3>(3 * i) = ((Eigen::Matrix3d::Identity() - P) / law.r[i] * Mcc.middleRows<3>(3 * i)).eval();
      J.block<3, 3>(3 * i, 3 * i) += P;
    }
    for (Eigen::Index row = 0; row < rhs.size(); ++row) {
      if (Mcc(row, row) > 0) continue;  // else a row that is pinned or not there
      J.row(row).setZero();
      J(row, row) = 1;
      rhs[row] = 0;
    }
    return solveDense(J, rhs);
  }

  // Damped Newton from sigma; where nothing descends, the full step lets the active set move.  Returns the best residual.
  double solve(Eigen::VectorXd& sigma) const {
    LawLinearization law = at(sigma);
    double norm = law.phi.norm(), best = norm;
    const double target = options.reduction * norm;
    Eigen::VectorXd x = sigma;
    for (int k = 0; k < options.newtonSteps && norm > target; ++k) {
      const Eigen::VectorXd d = step(Mcc, law, -law.phi);
      if (!d.allFinite()) break;
      double kept = 1, least = norm;  // the least residual of all trials, where none descends enough
      for (double t = 1; t > options.leastStep; t /= 2) {
        const double trial = at(x + t * d).phi.norm();
        if (trial < least) least = trial, kept = t;
        if (trial < (1 - options.armijo * t) * norm) break;
      }
      x += kept * d;
      law = at(x);
      norm = law.phi.norm();
      if (norm < best) best = norm, sigma = x;
    }
    return best;
  }

  // Near a limit load the state may be a bad place to start from; the tied bodies, sigma = s, are as good as any other.
  void solveFromHereOrTied(Eigen::VectorXd& sigma) const {
    const double before = at(sigma).phi.norm(), after = solve(sigma);
    if (after <= options.solved * before) return;
    Eigen::VectorXd other = s;
    if (solve(other) < after) sigma = other;
  }
};

// What the pairs of all ranks bring goes to all of them in one sum; the dense system is then the same everywhere, and so is sigma.
Eigen::VectorXd CondensedContact::solveLinearized(const LawLinearization& law, const Eigen::VectorXd& s, const Eigen::VectorXd& phi) const {
  const Eigen::Index pairs = vectors_.numPairs();
  Eigen::MatrixXd part(3 * pairs, 6);  // phi, (M s_E)_c, P', r
  part << phi, forcesOfGluing(s), Eigen::MatrixXd::Zero(3 * pairs, 4);
  for (Eigen::Index i = 0; i < pairs; ++i) {
    part.block<3, 3>(3 * i, 2) = law.dP[std::size_t(i)];
    part.block<3, 1>(3 * i, 5).setConstant(law.r[i]);
  }
  const Eigen::MatrixXd all = onAllRanks(part);
  LawLinearization global;
  global.r.resize(size_ / 3);
  Eigen::VectorXd rhs(size_);
  for (Eigen::Index i = 0; i < size_ / 3; ++i) {
    const Eigen::Matrix3d P = all.block<3, 3>(3 * i, 2);
    global.r[i] = all(3 * i, 5);
    global.dP.push_back(P);
    // - phi - A m
    rhs.segment<3>(3 * i) = -all.block<3, 1>(3 * i, 0) - (Eigen::Matrix3d::Identity() - P) / global.r[i] * all.block<3, 1>(3 * i, 1);
  }
  return response(s, Model::step(Mcc_, global, rhs));
}

// The pairs' laws travel as numbers, since every rank projects all pairs; sigma = 0, nothing moves, is where Newton starts.
CondensedContact::Step CondensedContact::solveLaw(const std::vector<PairLaw>& pairs, const Eigen::VectorXd& r,
                                                 const Eigen::VectorXd& lambda, const Eigen::VectorXd& s) const {
  const Eigen::Index n = vectors_.numPairs();
  Eigen::MatrixXd part(3 * n, 5);  // lambda + m, s, r, law, coefficients
  part.col(0) = vectors_.contact(lambda) + forcesOfGluing(s);
  part.col(1) = vectors_.contact(s);
  for (Eigen::Index i = 0; i < n; ++i) {
    const PairLaw& pair = pairs[std::size_t(i)];
    part.block<3, 1>(3 * i, 2).setConstant(r[i]);
    part.block<3, 1>(3 * i, 3) << double(pair.law), pair.normalPinned, pair.frictional();
    part.block<3, 1>(3 * i, 4) << pair.coefficients[0], pair.coefficients[1], pair.slipForce;
  }
  const Eigen::MatrixXd all = onAllRanks(part);
  Model model{Mcc_, options_, {}, Eigen::VectorXd(size_ / 3), all.col(0), all.col(1)};
  for (Eigen::Index at = 0; at < size_; at += 3) {
    const int t = all(at + 2, 3) != 0 ? int(at) : -2;  // tangential rows at + 1, at + 2, or -1 without friction
    model.r[at / 3] = all(at, 2);
    model.pairs.push_back({int(at), {t + 1, t + 1 + (t >= 0)}, {all(at, 4), all(at + 1, 4)}, all(at + 2, 4),
                           FrictionLaw(int(all(at, 3))), all(at + 1, 3) != 0});
  }
  Eigen::VectorXd sigma = Eigen::VectorXd::Zero(size_);
  model.solveFromHereOrTied(sigma);
  return {response(s, sigma), sigma.segment(first_, 3 * n)};
}

// 1 / (M_cc^+)_ii: with M_cc^-1 in the place of F, (M_cc^-1)_ii is what pair i opens under a unit force, no force at the others.
// With S = diag(M_cc)^-1/2, M_cc^+ is taken as S (S M_cc S)^+ S, whose rank does not depend on the stiffness of a pair.
Eigen::VectorXd CondensedContact::normalStiffness() const {
  constexpr double kFree = 1e-10;  // of the largest eigenvalue: rigid motions and pinned rows
  Eigen::VectorXd scale = Mcc_.diagonal();
  for (double& value : scale) value = value > 0 ? 1 / std::sqrt(value) : 0.0;
  const SymmetricEigen eigen(scale.asDiagonal() * Mcc_ * scale.asDiagonal());
  Eigen::VectorXd stiffness(vectors_.numPairs());
  for (Eigen::Index i = 0; i < stiffness.size(); ++i) {
    double compliance = 0;
    for (Eigen::Index k = 0; k < size_; ++k)
      if (eigen.values[k] > kFree * eigen.values[size_ - 1])
        compliance += std::pow(scale[first_ + 3 * i] * eigen.vectors(first_ + 3 * i, k), 2) / eigen.values[k];
    stiffness[i] = compliance > 0 ? 1 / compliance : 0.0;
  }
  return stiffness;
}

}  // namespace Haptos
