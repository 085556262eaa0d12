// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NewtonDirection.hpp"

#include <Eigen/Dense>
#include <Teuchos_CommHelpers.hpp>
#include <algorithm>

#include "Haptos_ByteBuffer.hpp"
#include "Haptos_Exchange.hpp"

namespace Haptos {

double globalMedian(const Communicator& comm, const std::vector<double>& values) {
  ByteWriter writer;
  writer.write(values);
  std::vector<double> all;
  for (const auto& message : gatherOnAll(comm, writer.take())) {
    const auto part = ByteReader(message).readVector<double>();
    all.insert(all.end(), part.begin(), part.end());
  }
  if (all.empty()) return 0;
  std::sort(all.begin(), all.end());
  const std::size_t n = all.size();
  return n % 2 == 1 ? all[n / 2] : 0.5 * (all[n / 2 - 1] + all[n / 2]);
}

namespace {

// A stiff body on a soft one moves where q is small beside its largest entries.  Where it floats, the iteration ran away at some
// contrasts above 1e5 with 1e-3; where it is held, 1e-3 cost up to three multiplications more there.
double toleranceOfCompliance(const GluingBalance& balance) { return balance.numFloating() > 0 ? 1e-6 : 1e-4; }

}  // namespace

NewtonDirection::NewtonDirection(const ContactOperators& dual, const Eigen::VectorXd& diagonalOfM, const DualVectors& vectors,
                                 const GluingBalance& balance)
    : dual_(dual), vectors_(vectors), balance_(balance), stiffness_(diagonalOfM), preconditioner_(dual, vectors, toleranceOfCompliance(balance)) {
  const Eigen::VectorXd contact = vectors.contact(stiffness_);
  std::vector<double> normal;
  for (Eigen::Index i = 0; i < vectors.numPairs(); ++i)
    if (contact[3 * i] > 0) normal.push_back(contact[3 * i]);
  const double onNormals = globalMedian(vectors.comm(), normal), mine = stiffness_.size() > 0 ? stiffness_.maxCoeff() : 0.0;
  double largest = 0;
  Teuchos::reduceAll(vectors.comm(), Teuchos::REDUCE_MAX, mine, Teuchos::outArg(largest));
  pairStiffness_ = Eigen::VectorXd::Constant(vectors.numPairs(), onNormals > 0 ? onNormals : largest);
  weights_ = stiffness_ / (largest > 0 ? largest : 1.0);
  const double pairs = vectors.sum(double(vectors.numPairs()));
  mayHaveModel_ = dual.makeDeflatedM && pairs > 0 && pairs <= double(CondensedNewton::kLargest);
}

bool NewtonDirection::useModel() {
  if (!mayHaveModel_) return hasModel();
  mayHaveModel_ = false;
  const auto deflated = dual_.makeDeflatedM();
  if (deflated.M.is_null()) return false;
  const auto contactM = deflated.contactM.is_null() ? contactBlockOf(deflated.M, dual_.pairs) : deflated.contactM;
  condensed_ = std::make_unique<CondensedNewton>(deflated.M, *contactM, vectors_);
  const Eigen::VectorXd felt = condensed_->normalStiffness();
  pairStiffness_ = (felt.array() > 0).select(felt, pairStiffness_);
  return true;
}

double NewtonDirection::tangentialStiffness(const PairLaw& pair) const {
  return 0.5 * (stiffness_[pair.tangential[0]] + stiffness_[pair.tangential[1]]);
}

// The projection may stand on a law a little older: what it leaves is balanced by the law of the day.  Collective.
bool NewtonDirection::coarseIsStale(const LawLinearization& law) const {
  constexpr double kChange = 0.1;  // of P', whose eigenvalues lie in [0, 1], root mean square over the pairs
  Eigen::Vector2d sums(0, double(law.dP.size()));
  for (std::size_t i = 0; i < law.dP.size() && coarse_; ++i) sums[0] += (law.dP[i] - preparedFor_[i]).squaredNorm();
  vectors_.sum(sums);
  return !coarse_ || sums[0] > kChange * kChange * sums[1];
}

void NewtonDirection::prepare(const std::vector<PairLaw>& pairs, const LawLinearization& law) {
  modes_.resize(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (law.tangential[i]) modes_[i] = TangentialModes::of(law.dP[i], law.r[Eigen::Index(i)], tangentialStiffness(pairs[i]));
  preconditioner_.prepare(pairs, law, modes_);
  if (!coarseIsStale(law)) return;
  preparedFor_ = law.dP;
  if (!coarse_) coarse_ = std::make_unique<ActiveCoarseProjection>(dual_, balance_, vectors_, weights_);
  coarse_->renew(law, modes_);
}

Eigen::VectorXd NewtonDirection::residual(const std::vector<PairLaw>& pairs, const LawLinearization& law, const Point& point) const {
  Eigen::VectorXd result = point.s;  // gluing and Dirichlet rows
  Eigen::VectorXd contact = Eigen::VectorXd::Zero(point.phi.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Index at = 3 * Eigen::Index(i);
    if (law.closed[i]) contact[at] = point.s[pairs[i].normal];
    if (!law.tangential[i]) continue;
    const TangentialModes& m = modes_[i];
    Eigen::Vector2d t = -(m.E.transpose() * point.phi.segment<2>(at + 1));  // stick: the slip itself
    const Eigen::Vector2d Pg = m.E.transpose() * law.dP[i].block<2, 1>(1, 0);
    for (int k = 0; k < 2; ++k) {
      if (law.closed[i] && m.isPartial(k)) t[k] -= Pg[k] * point.s[pairs[i].normal];  // the part of dN that is not dlambda_N
      t[k] *= std::sqrt(m.theta[k]) / std::max(m.sigma[k], 1e-14);
    }
    contact.segment<2>(at + 1) = m.E * t;
  }
  vectors_.setContact(result, contact);
  return result;
}

Eigen::VectorXd NewtonDirection::followLaw(const std::vector<PairLaw>& pairs, const LawLinearization& law, const ContactPoint& point,
                                           const Eigen::VectorXd& zc) const {
  const auto& [lambda, s, pointPhi] = point;
  Eigen::VectorXd out = -lambda;  // open pairs let go
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Index at = 3 * Eigen::Index(i);
    double dLambdaN = 0, dN = 0;
    if (law.closed[i]) {
      out[at] = dLambdaN = zc[at];
      dN = zc[at] - law.r[Eigen::Index(i)] * s[at];  // change of lambda_N + r s_N, with s_N going to 0
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
        if (m.isPartial(k)) t[k] += Pg[k] / (1 - m.sigma[k]) * dLambdaN;  // along the generator of the friction cone
      }
    }
    out.segment<2>(at + 1) = m.E * t;
  }
  return out;
}

// Slip drags tangential forces along with normal ones, which unbalances the subdomains again.  Their balance is
// restored by all active rows, as the law allows; by the gluing rows alone it costs half of the convergence.
Eigen::VectorXd NewtonDirection::balanceByLaw(const std::vector<PairLaw>& pairs, const LawLinearization& law, PrimalBalance& balance,
                                              Eigen::VectorXd contact) const {
  constexpr int kSweeps = 2;  // each leaves about a tenth, the coefficient of friction times the coupling
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(contact.size());
  for (int sweep = 0; sweep < kSweeps; ++sweep) contact += followLaw(pairs, law, {zero, zero, zero}, balance.carry(contact));
  return contact;
}

// Contact forces of the direction must not push floating bodies: what is left is spread by the law, then cleaned.
void NewtonDirection::holdFloatingBodies(const LawLinearization& law, Eigen::VectorXd& contact) const {
  const Eigen::MatrixXd& H = balance_.H();
  const Eigen::Index k = H.cols();
  if (k == 0) return;
  Eigen::MatrixXd PH(H.rows(), k), rH(H.rows(), k);
  for (std::size_t i = 0; i < law.dP.size(); ++i)
    PH.middleRows<3>(3 * Eigen::Index(i)) = law.r[Eigen::Index(i)] * law.dP[i] * H.middleRows<3>(3 * Eigen::Index(i));
  for (Eigen::Index i = 0; i < law.r.size(); ++i) rH.middleRows<3>(3 * i) = law.r[i] * H.middleRows<3>(3 * i);
  Eigen::MatrixXd sums(k, 3 * k + 1);
  sums << H.transpose() * PH, H.transpose() * H, H.transpose() * rH, H.transpose() * contact;
  vectors_.sum(sums);
  Eigen::MatrixXd K = sums.leftCols(k);
  const Eigen::MatrixXd HH = sums.middleCols(k, k);
  K += 1e-8 * K.trace() * Eigen::MatrixXd::Identity(k, k) + 1e-10 * sums.middleCols(2 * k, k);
  contact -= PH * K.partialPivLu().solve(sums.rightCols(1));
  Eigen::MatrixXd rest = H.transpose() * contact;
  vectors_.sum(rest);
  contact -= H * HH.completeOrthogonalDecomposition().solve(rest);
}

CondensedNewton::Step NewtonDirection::computeNonlinear(const std::vector<PairLaw>& pairs, const LawLinearization& law, const Point& point) const {
  CondensedNewton::Step step = condensed_->direction(pairs, law.r, point.lambda, point.s);
  balance_.balance(step.z);
  return step;
}

Eigen::VectorXd NewtonDirection::compute(const std::vector<PairLaw>& pairs, const LawLinearization& law, const Point& point) {
  if (condensed_) {
    Eigen::VectorXd z = condensed_->linearDirection(law, point.s, point.phi);
    balance_.balance(z);
    return z;
  }
  prepare(pairs, law);
  Eigen::VectorXd r = residual(pairs, law, point);
  coarse_->projectDual(r);
  Eigen::VectorXd z = preconditioner_.apply(r);
  PrimalBalance balance(*coarse_, z);
  const ContactPoint at{vectors_.contact(point.lambda), vectors_.contact(point.s), point.phi};
  Eigen::VectorXd contact = followLaw(pairs, law, at, balance.project(vectors_.contact(z)));
  contact = balanceByLaw(pairs, law, balance, std::move(contact));
  holdFloatingBodies(law, contact);
  balance.finish(contact, z);
  return z;
}

}  // namespace Haptos
