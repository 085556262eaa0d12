// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_BalancedDirection.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

// Median of this rank's and all other ranks' values.  Collective.
double globalMedian(const Communicator& comm, const std::vector<double>& values) {
  std::vector<double> all = gatheredOnAll(comm, values);
  if (all.empty()) return 0;
  std::sort(all.begin(), all.end());
  const std::size_t n = all.size();
  return n % 2 == 1 ? all[n / 2] : 0.5 * (all[n / 2 - 1] + all[n / 2]);
}

}  // namespace

BalancedDirection::BalancedDirection(const ContactOperators& dual, const Eigen::VectorXd& diagonalOfM, const DualVectors& vectors,
                                     const GluingBalance& balance, const SubspaceNewtonOptions::Balanced& options)
    : dual_(dual),
      vectors_(vectors),
      balance_(balance),
      options_(options),
      stiffness_(diagonalOfM),
      preconditioner_(dual, vectors, options.slipTolerance, options.slipSteps) {
  const Eigen::VectorXd contact = vectors.contact(stiffness_);
  std::vector<double> normal;
  for (Eigen::Index i = 0; i < vectors.numPairs(); ++i)
    if (contact[3 * i] > 0) normal.push_back(contact[3 * i]);
  const double onNormals = globalMedian(vectors.comm(), normal), mine = stiffness_.size() > 0 ? stiffness_.maxCoeff() : 0.0;
  double largest = 0;
  Teuchos::reduceAll(vectors.comm(), Teuchos::REDUCE_MAX, mine, Teuchos::outArg(largest));
  pairStiffness_ = Eigen::VectorXd::Constant(vectors.numPairs(), onNormals > 0 ? onNormals : largest);
  weights_ = stiffness_ / (largest > 0 ? largest : 1.0);  // D, so that the coarse matrix is about 1 in any units
}

// k of `TangentialModes`, one for both modes whatever their axes: the mean of the two rows' diag(M)
double BalancedDirection::tangentialStiffness(const PairLaw& pair) const {
  return 0.5 * (stiffness_[pair.tangential[0]] + stiffness_[pair.tangential[1]]);
}

// The projection may stand on a law a little older: what it leaves is balanced by the law of the day.  Collective.
bool BalancedDirection::coarseIsStale(const LawLinearization& law) const {
  Eigen::Vector2d sums(0, double(law.dP.size()));  // || P' - P'_then ||^2 and pairs, of all ranks
  for (std::size_t i = 0; i < law.dP.size() && coarse_; ++i) sums[0] += (law.dP[i] - preparedFor_[i]).squaredNorm();
  vectors_.sum(sums);
  return !coarse_ || sums[0] > options_.coarseChange * options_.coarseChange * sums[1];
}

// What belongs to the law and not to the point: modes of slip, their springs, the coarse matrix unless it is good enough.
void BalancedDirection::prepare(const std::vector<PairLaw>& pairs, const LawLinearization& law) {
  modes_.resize(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (law.tangential[i]) modes_[i] = TangentialModes::of(law.dP[i], law.r[Eigen::Index(i)], tangentialStiffness(pairs[i]));
  preconditioner_.prepare(pairs, law, modes_);
  if (!coarseIsStale(law)) return;
  preparedFor_ = law.dP;
  if (!coarse_) coarse_ = std::make_unique<ActiveCoarseProjection>(dual_, balance_, vectors_, weights_);
  coarse_->renew(law, modes_);
}

// The linearised law of a pair, with dx = dlambda + r ds, on the eigenvectors E of P'_TT (eigenvalues sigma), P_g = E^T P'_TN:
//
//   closed normal row    - ds_N = - phi_N = s_N
//   tangential mode k    (1 - sigma_k) / r dlambda_k - sigma_k ds_k = - phi_k + P_g,k dN / r,    dN = dlambda_N + r ds_N
//
// Over sigma_k: C_k dlambda_k - ds_k = (- phi_k + P_g,k dN / r) / sigma_k.  With ds = - F dlambda the left side is (F + C) dlambda,
// what is on the right is the residual.  ds_N = - s_N is known, so that P_g,k dN / r = P_g,k (dlambda_N / r - s_N); the part with
// dlambda_N is put in by `followLaw`.  Rows are in the variables of the coarse projections, sqrt(theta) times these.
Eigen::VectorXd BalancedDirection::residual(const std::vector<PairLaw>& pairs, const LawLinearization& law, const DirectionPoint& point) const {
  Eigen::VectorXd result = point.s;  // gluing and Dirichlet rows
  Eigen::VectorXd contact = Eigen::VectorXd::Zero(point.phi.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Index at = 3 * Eigen::Index(i);
    if (law.closed[i]) contact[at] = point.s[pairs[i].normal];
    if (!law.tangential[i]) continue;
    const TangentialModes& m = modes_[i];
    Eigen::Vector2d t = -(m.E.transpose() * point.phi.segment<2>(at + 1));  // at stick phi = -s, so t is the slip itself
    const Eigen::Vector2d Pg = m.E.transpose() * law.dP[i].block<2, 1>(1, 0);
    for (int k = 0; k < 2; ++k) {
      if (law.closed[i] && m.isPartial(k)) t[k] -= Pg[k] * point.s[pairs[i].normal];
      t[k] *= std::sqrt(m.theta[k]) / std::max(m.sigma[k], 1e-14);
    }
    contact.segment<2>(at + 1) = m.E * t;
  }
  vectors_.setContact(result, contact);
  return result;
}

// Contact forces as the linearised law wants them, where the preconditioned residual zc leaves nothing to choose:
//
//   open            dlambda = - lambda
//   sigma_k = 0     dlambda_k = P_g,k dN - r phi_k                                        the law fixes the force
//   else            dlambda_k = sqrt(theta_k) zc_k + P_g,k / (1 - sigma_k) dlambda_N      P_g,k dlambda_N / r over sigma_k C_k
//
// The last term goes along the generator of the friction cone.  It is linear in zc but for what the point brings in.
Eigen::VectorXd BalancedDirection::followLaw(const std::vector<PairLaw>& pairs, const LawLinearization& law, const ContactPoint& point,
                                           const Eigen::VectorXd& zc) const {
  const auto& [lambda, s, pointPhi] = point;
  Eigen::VectorXd out = -lambda;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Index at = 3 * Eigen::Index(i);
    double dLambdaN = 0, dN = 0;
    if (law.closed[i]) {
      out[at] = dLambdaN = zc[at];
      dN = zc[at] - law.r[Eigen::Index(i)] * s[at];  // dlambda_N + r ds_N, ds_N = - s_N
    }
    if (!law.tangential[i]) continue;
    const TangentialModes& m = modes_[i];
    const Eigen::Vector2d Pg = m.E.transpose() * law.dP[i].block<2, 1>(1, 0);
    const Eigen::Vector2d phi = m.E.transpose() * pointPhi.segment<2>(at + 1);
    Eigen::Vector2d t = m.E.transpose() * zc.segment<2>(at + 1);
    for (int k = 0; k < 2; ++k) {
      if (m.isHeld(k)) {
        t[k] = Pg[k] * dN - law.r[Eigen::Index(i)] * phi[k];
      } else {
        t[k] *= std::sqrt(m.theta[k]);
        if (m.isPartial(k)) t[k] += Pg[k] / (1 - m.sigma[k]) * dLambdaN;
      }
    }
    out.segment<2>(at + 1) = m.E * t;
  }
  return out;
}

// Slip drags tangential forces along with normal ones, which unbalances the subdomains again.  Their balance is
// restored by all active rows, as the law allows; by the gluing rows alone it costs half of the convergence.
//
// A sweep: K a = G z with K = G_A D G_A^T, contact := contact + law(- D Y G_c^T a), Y = E sqrt(theta) E^T, law the linear part of
// `followLaw`.  K holds what Y does, but not what follows along generators: that is what a sweep leaves to the next one.
Eigen::VectorXd BalancedDirection::balanceByLaw(const std::vector<PairLaw>& pairs, const LawLinearization& law, PrimalBalance& balance,
                                              Eigen::VectorXd contact) const {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(contact.size());
  for (int sweep = 0; sweep < options_.sweeps; ++sweep) contact += followLaw(pairs, law, {zero, zero, zero}, balance.spreadImbalance(contact));
  return contact;
}

// Contact forces c of the direction must not push floating bodies, H^T c = 0: what is left is spread by the law,
//
//   c := c - r P' H (H^T r P' H)^-1 H^T c,       then, as K is shifted,      c := c - H (H^T H)^+ H^T c.
void BalancedDirection::holdFloatingBodies(const LawLinearization& law, Eigen::VectorXd& contact) const {
  const Eigen::MatrixXd& H = balance_.H();
  const Eigen::Index k = H.cols();
  if (k == 0) return;
  Eigen::MatrixXd PH(H.rows(), k), rH(H.rows(), k);
  for (std::size_t i = 0; i < law.dP.size(); ++i)
    PH.middleRows<3>(3 * Eigen::Index(i)) = law.r[Eigen::Index(i)] * law.dP[i] * H.middleRows<3>(3 * Eigen::Index(i));
  for (Eigen::Index i = 0; i < law.r.size(); ++i) rH.middleRows<3>(3 * i) = law.r[i] * H.middleRows<3>(3 * i);
  Eigen::MatrixXd sums(k, 3 * k + 1);  // one reduction for all four products
  sums << H.transpose() * PH, H.transpose() * H, H.transpose() * rH, H.transpose() * contact;
  vectors_.sum(sums);
  Eigen::MatrixXd K = sums.leftCols(k);
  const Eigen::MatrixXd HH = sums.middleCols(k, k);
  K += options_.floatingShift * K.trace() * Eigen::MatrixXd::Identity(k, k) + options_.floatingHold * sums.middleCols(2 * k, k);
  contact -= PH * solveByLu(K, sums.rightCols(1));
  Eigen::MatrixXd rest = H.transpose() * contact;
  vectors_.sum(rest);
  contact -= H * solveLeastSquares(HH, rest);
}

// v = z with contact values as the law wants them and G v = 0: in turn the residual without its rigid part, the preconditioner with
// slip, the law, the balance that the law disturbs, the motions that contact alone holds, the gluing rows.
Direction BalancedDirection::compute(const std::vector<PairLaw>& pairs, const LawLinearization& law, const DirectionPoint& point) {
  prepare(pairs, law);
  Eigen::VectorXd r = residual(pairs, law, point);
  coarse_->projectDual(r);                       // r := r - G_A^T a,   G_A D r = 0
  Eigen::VectorXd z = preconditioner_.apply(r);  // z := (M^-1 + C)^-1 r
  PrimalBalance balance(*coarse_, z);            // z := z - D G_A^T a, G_A z = 0, on contact rows; on gluing rows by `finish`
  const ContactPoint at{vectors_.contact(point.lambda), vectors_.contact(point.s), point.phi};
  Eigen::VectorXd contact = followLaw(pairs, law, at, balance.project(vectors_.contact(z)));
  contact = balanceByLaw(pairs, law, balance, std::move(contact));
  holdFloatingBodies(law, contact);
  balance.finish(contact, z);
  Direction direction;
  direction.v = std::move(z);
  return direction;
}

}  // namespace Haptos
