// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_BalanceProjections.hpp"

#include "Haptos_DenseDecompositions.hpp"


namespace Haptos {
namespace {

// 1 on gluing rows and 0 on contact rows
Eigen::VectorXd markGluingRows(const DualVectors& vectors) {
  Eigen::VectorXd isGluing = Eigen::VectorXd::Zero(vectors.numRows());
  vectors.setGluing(isGluing, Eigen::VectorXd::Ones(Eigen::Index(vectors.gluingRows().size())));
  return isGluing;
}

std::vector<double> listOf(const Eigen::VectorXd& x) { return {x.data(), x.data() + x.size()}; }

// Orthonormal combinations of motions whose jumps H [3 pairs x k] some force answers; others may stay what they are.
Eigen::MatrixXd feltMotions(const Eigen::MatrixXd& H, const DualVectors& vectors) {
  constexpr double kUnfelt = 1e-10;  // of the largest eigenvalue; a single node gives about 1, round-off 1e-30
  Eigen::MatrixXd gram = H.transpose() * H;
  vectors.sum(gram);
  // gram = V diag(mu) V^T: combinations V with mu > 0 are felt
  const SymmetricEigen eigen(gram);
  Eigen::Index unfelt = 0;
  while (unfelt < gram.cols() && eigen.values[unfelt] <= kUnfelt * std::max(1.0, eigen.values.tail<1>()[0])) ++unfelt;
  return eigen.vectors.rightCols(gram.cols() - unfelt);
}

// 1 on contact values [3 pairs] of rows that may carry a force
Eigen::VectorXd carriedValues(const std::vector<PairLaw>& pairs) { return carriedRows(Eigen::VectorXd::Ones(3 * Eigen::Index(pairs.size())), pairs); }

}  // namespace

Eigen::MatrixXd carriedRows(Eigen::MatrixXd values, const std::vector<PairLaw>& pairs) {
  for (std::size_t i = 0; i < pairs.size(); ++i)
    for (int t = 0; t < 2; ++t)
      if (!pairs[i].frictional() || pairs[i].coefficients[t] == 0) values.row(3 * Eigen::Index(i) + 1 + t).setZero();
  return values;
}

// EE = G_E G_E^T, singular in the motions that contact alone holds: there with holds.  Where G G^T was made with contact rows as
// its changing part, it is G G^T without that part and shares the elimination.
GluingBalance::GluingBalance(const ContactOperators& dual, const DualVectors& vectors)
    : dual_(dual), vectors_(vectors), isGluing_(markGluingRows(vectors)), carried_(carriedValues(dual.pairs)), coarseSize_(dual.GT->cols()) {
  if (dual.contactChangesGGT) EE_ = std::make_unique<CoarseProblem>(*dual.GGT, dual.holds);
  else EE_ = std::make_unique<CoarseProblem>(dual.GGT->placement(), *dual.GT, listOf(isGluing_), dual.holds);
  const Eigen::Index k = dual.motions.cols();
  Zk_.resize(coarseSize_, k);  // orthonormal: what is projected off a below is Zk Zk^T a
  if (k > 0) Zk_ = orthonormalBasis(dual.motions);
  jumps_ = *dual.GT * Zk_;
  H_ = carriedRows(contactRowsOf(jumps_), dual.pairs);
  if (k == 0) return;
  const Eigen::MatrixXd felt = feltMotions(H_, vectors);
  jumps_ *= felt;
  H_ *= felt;
  feltMotions_ = Zk_ * felt;
}

bool GluingBalance::isOf(const std::vector<PairLaw>& pairs) const { return vectors_.sum((carriedValues(pairs) - carried_).squaredNorm()) == 0; }

Eigen::MatrixXd GluingBalance::contactRowsOf(const Eigen::MatrixXd& values) const {
  Eigen::MatrixXd contact(3 * vectors_.numPairs(), values.cols());
  for (Eigen::Index j = 0; j < contact.cols(); ++j) contact.col(j) = vectors_.contact(values.col(j));
  return contact;
}

Eigen::MatrixXd GluingBalance::contactMotions() const { return contactRowsOf(*dual_.GT * Zk_); }

Eigen::VectorXd GluingBalance::applyG(const Eigen::VectorXd& v) const {
  Eigen::VectorXd g = multiplyTransposed(*dual_.GT, v);
  vectors_.sum(g);
  return g;
}

// v_E := v_E - G_E^T a,   G_E G_E^T a = G v - target
void GluingBalance::balance(Eigen::VectorXd& v, const Eigen::VectorXd& target) const {
  const Eigen::VectorXd mine = multiplyTransposed(*dual_.GT, v);
  const Eigen::VectorXd a = EE_->solveSum(mine, target);
  v -= isGluing_.cwiseProduct(multiply(*dual_.GT, a));
}

Eigen::VectorXd GluingBalance::sumGluing(const Eigen::VectorXd& v) const {
  return multiplyTransposed(*dual_.GT, isGluing_.cwiseProduct(v));
}

// s := s - G^T (1 - Zk Zk^T) a,   G_E G_E^T a = G_E s_E: the rigid motions that gluing rows see, of contact rows, too; those of
// floating bodies stay, as they are unknowns
void GluingBalance::removeRigidPart(Eigen::VectorXd& s) const {
  Eigen::VectorXd a = EE_->solveSum(sumGluing(s));
  a -= Zk_ * (Zk_.transpose() * a);
  s -= multiply(*dual_.GT, a);
}

// J a, min || J a - s ||
Eigen::VectorXd GluingBalance::nearestMotion(const Eigen::VectorXd& s) const {
  const Eigen::Index k = jumps_.cols();
  if (k == 0) return Eigen::VectorXd::Zero(s.size());
  Eigen::MatrixXd sums(k, k + 1);
  sums << jumps_.transpose() * jumps_, jumps_.transpose() * s;
  vectors_.sum(sums);
  return jumps_ * solveByLdlt(sums.leftCols(k), sums.rightCols(1));
}

namespace {

// Rows of G^T in the order of contact values.
CoarseRows contactRowsOf(const CoarseRows& rows, const std::vector<PairLaw>& pairs) {
  std::vector<Eigen::Triplet<double>> triplets;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    for (int d = 0; d < 3; ++d) {
      const int row = d == 0 ? pairs[i].normal : pairs[i].tangential[d - 1];
      if (row < 0) continue;
      for (CoarseRows::InnerIterator it(rows, row); it; ++it) triplets.emplace_back(int(3 * i) + d, int(it.col()), it.value());
    }
  CoarseRows result(3 * Eigen::Index(pairs.size()), rows.cols());
  result.setFromTriplets(triplets.begin(), triplets.end());
  return result;
}

CoarseProblem::Holds weakened(CoarseProblem::Holds holds) {
  constexpr double kWeakHold = 1e-9;  // floating motions are held by active contact rows; this only keeps K regular
  for (auto& hold : holds) hold *= std::sqrt(kWeakHold);
  return holds;
}

}  // namespace

// coarse_ = K = G_A D G_A^T: the part of the gluing rows is fixed, that of contact rows changes; `renew` sends and factors that alone.
ActiveCoarseProjection::ActiveCoarseProjection(const ContactOperators& dual, const GluingBalance& gluing, const DualVectors& vectors,
                                               const Eigen::VectorXd& weights)
    : gluing_(gluing),
      vectors_(vectors),
      weights_(weights),
      q_(listOf(gluing.isGluing().cwiseProduct(weights))),
      contactWeights_(listOf(vectors.contact(weights))),
      contactRows_(contactRowsOf(*dual.GT, dual.pairs)),
      active_(contactRows_),
      coarse_(dual.GGT->placement()->onNextRanks(), {*dual.GT, q_}, {contactRows_, contactWeights_}, weakened(gluing.holds()),
              CoarseProblem::Factor::WithRoughRenewal) {}

// Contact rows of G_A: Y G_c^T with Y = 1 on closed normal rows, E sqrt(theta) E^T on tangential ones, 0 elsewhere.  For a force
// sqrt(theta) z this is what its z does to the balance, and K = G_A D G_A^T has theta D on a slip mode: what it can carry.
void ActiveCoarseProjection::renew(const LawLinearization& law, const std::vector<TangentialModes>& modes) {
  std::vector<Eigen::Triplet<double>> triplets;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const int at = 3 * int(i);
    if (law.closed[i]) triplets.emplace_back(at, at, 1.0);
    if (!law.tangential[i]) continue;
    const Eigen::Matrix2d Y = modes[i].E * modes[i].theta.cwiseSqrt().asDiagonal() * modes[i].E.transpose();
    for (int a = 0; a < 2; ++a)
      for (int b = 0; b < 2; ++b)
        if (Y(a, b) != 0.0) triplets.emplace_back(at + 1 + a, at + 1 + b, Y(a, b));
  }
  CoarseRows Y(contactRows_.rows(), contactRows_.rows());
  Y.setFromTriplets(triplets.begin(), triplets.end());
  active_ = Y * contactRows_;
  coarse_.renew({active_, contactWeights_});
  if (!gluingAlone_) gluingAlone_ = std::make_unique<CoarseProblem>(coarse_, gluing_.holds());
}

// r := r - G_A^T a,   K a = G_A D r
void ActiveCoarseProjection::projectDual(Eigen::VectorXd& residual) const {
  const Eigen::Map<const Eigen::VectorXd> contactWeights(contactWeights_.data(), Eigen::Index(contactWeights_.size()));
  const Eigen::VectorXd contact = vectors_.contact(residual);
  Eigen::VectorXd mine = gluing_.sumGluing(weights_.cwiseProduct(residual));
  mine += multiplyTransposed(active_, contactWeights.cwiseProduct(contact));
  const Eigen::VectorXd a = coarse_.solveSum(mine);
  residual -= multiply(gluing_.GT(), a);
  vectors_.setContact(residual, contact - multiply(active_, a));
}

PrimalBalance::PrimalBalance(const ActiveCoarseProjection& active, const Eigen::VectorXd& z)
    : active_(active), series_(active.coarse_, active.gluing_.sumGluing(z)) {}

// K a = G_E z_E + contactSum, where G_E z_E is what it was at the start less G_E D G_E^T of all a so far (`CoarseProblem::Series`);
// the contact values are to change by - D Y G_c^T a.
Eigen::VectorXd PrimalBalance::takeOff(const Eigen::VectorXd& contactSum) {
  const auto& weights = active_.contactWeights_;
  const Eigen::VectorXd a = series_.next(contactSum);
  return -Eigen::Map<const Eigen::VectorXd>(weights.data(), Eigen::Index(weights.size())).cwiseProduct(multiply(active_.active_, a));
}

// Values before the law are those of G_A (sqrt(theta) is still missing), those after it forces, which G_c itself sums up.
Eigen::VectorXd PrimalBalance::project(const Eigen::VectorXd& contact) {
  return contact + takeOff(multiplyTransposed(active_.active_, contact));
}

Eigen::VectorXd PrimalBalance::spreadImbalance(const Eigen::VectorXd& contact) { return takeOff(multiplyTransposed(active_.contactRows_, contact)); }

// z_E := z_E - D G_E^T a,   G_E D G_E^T a = G_E z_E + G_c contact, with z_E of the start: one change for all that came between
void PrimalBalance::finish(const Eigen::VectorXd& contact, Eigen::VectorXd& z) {
  const Eigen::VectorXd a = series_.last(*active_.gluingAlone_, multiplyTransposed(active_.contactRows_, contact));
  z -= active_.weights_.cwiseProduct(multiply(active_.gluing_.GT(), a));
  active_.vectors_.setContact(z, contact);
}

}  // namespace Haptos
