// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CondensedDirection.hpp"

#include <Tpetra_Operator.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {
namespace {

RCP<const Operator> contactRowsOf(const ContactOperators::Deflated& deflated, const ContactOperators& dual) {
  return deflated.contactM.is_null() ? contactBlockOf(deflated.M, dual.pairs) : deflated.contactM;
}

// Rows of the contact values in their order, three a pair.
std::vector<int> rowsOfValues(const std::vector<PairLaw>& pairs) {
  std::vector<int> rows;
  for (const PairLaw& pair : pairs) rows.insert(rows.end(), {pair.normal, pair.tangential[0], pair.tangential[1]});
  return rows;
}

std::function<Eigen::MatrixXd()> denseOf(const ContactOperators::Deflated& deflated, const std::vector<PairLaw>& pairs) {
  if (!deflated.between) return {};
  return [between = deflated.between, rows = rowsOfValues(pairs)] { return between(rows); };
}

std::function<std::vector<Eigen::MatrixXd>(const std::vector<PairGroup>&)> matricesOfGroups(const ContactOperators::Deflated& deflated,
                                                                                           const std::vector<PairLaw>& pairs) {
  if (!deflated.ofGroups) return {};
  return [ofGroups = deflated.ofGroups, all = rowsOfValues(pairs)](const std::vector<PairGroup>& groups) {
    std::vector<std::vector<int>> rows(groups.size());
    for (std::size_t g = 0; g < rows.size(); ++g)
      for (const int pair : groups[g].pairs) rows[g].insert(rows[g].end(), all.begin() + 3 * pair, all.begin() + 3 * pair + 3);
    return ofGroups(rows);
  };
}

// Where M between contact rows is no cheaper than M, subdomains are slender.
bool isDense(const ContactOperators::Deflated& deflated) { return deflated.contactM.is_null() && !deflated.exact.isThere(); }

SubspaceNewtonOptions::Condensed forSubdomains(SubspaceNewtonOptions::Condensed options, bool slender) {
  if (slender) options.reduction = options.pathFrom = options.reductionSlender;
  return options;
}

}  // namespace

CondensedDirection::CondensedDirection(const ContactOperators::Deflated& deflated, const ContactOperators& dual,
                                       const GluingBalance& balance, const Eigen::VectorXd& diagonal, const Eigen::VectorXd& without,
                                       const SubspaceNewtonOptions::Condensed& options)
    : balance_(balance),
      matrix_({contactRowsOf(deflated, dual), diagonal, denseOf(deflated, dual.pairs), balance.contactMotions(), deflated.smoothJumps,
               deflated.entriesRead, deflated.groups, matricesOfGroups(deflated, dual.pairs), deflated.exact}, balance.vectors(),
              isDense(deflated) ? ContactMatrix::Kind::Dense : ContactMatrix::Kind::Products, options),
      contact_(deflated.M, matrix_, forSubdomains(options, deflated.contactM.is_null())),
      pairStiffness_(options.penalty * without),
      options_(options) {
  if (!isDense(deflated)) return;
  // A pinned pair feels nothing; its r is free, but must be a number.
  const Eigen::VectorXd felt = matrix_.normalStiffness();
  pairStiffness_ = (felt.array() > 0).select(felt, without);
}

// The motions that contact alone holds, J on contact rows, H those entries of it that forces may answer:
// v_c := v_c - H (H^T H)^+ J^T v_c.  A body that came a long way leaves round-off of its way: 1e-3 of the load was seen.
void CondensedDirection::holdFloatingBodies(Eigen::VectorXd& v) const {
  const Eigen::MatrixXd& H = balance_.H();
  const Eigen::Index k = H.cols();
  if (k == 0) return;
  const DualVectors& vectors = balance_.vectors();
  Eigen::VectorXd contact = vectors.contact(v);
  Eigen::MatrixXd sums(k, k + 1);
  sums.leftCols(k) = H.transpose() * H;
  for (Eigen::Index j = 0; j < k; ++j) sums(j, k) = vectors.contact(balance_.jumps().col(j)).dot(contact);
  vectors.sum(sums);
  contact -= H * solveLeastSquares(sums.leftCols(k), sums.rightCols(1));
  vectors.setContact(v, contact);
}

// A coefficient 0 leaves no force: it goes in a full step, not to what the model was solved to.
void CondensedDirection::dropWhatSlidesFreely(const std::vector<PairLaw>& pairs, const Eigen::VectorXd& lambda, Eigen::VectorXd& v) const {
  const Eigen::VectorXd forces = balance_.vectors().contact(lambda), free = forces - carriedRows(forces, pairs);
  balance_.vectors().setContact(v, carriedRows(balance_.vectors().contact(v), pairs) - free);
}

// v^T F v / v^T M^-1 v is a Rayleigh quotient of M F.  Full steps go too far along v where it is more than 2, and come no nearer from one to the next.
void CondensedDirection::learn(double vFv) {
  const double quotient = energy_ > 0 ? vFv / energy_ : 0.0;
  if (std::isfinite(quotient) && quotient > options_.tooFar) matrix_.scale(std::max(options_.asFar / quotient, options_.leastScaling));
}

// sigma solves the law at s_c - sigma, so v is a step as it stands.
Direction CondensedDirection::compute(const std::vector<PairLaw>& pairs, const LawLinearization& law, const DirectionPoint& point) {
  constexpr double kLeadsOn = 0.5;  // of phi: where the law is not even half solved, the state is beyond help
  CondensedContact::Step step = contact_.solveLaw(pairs, law.r, point.lambda, point.s);
  const DualVectors& vectors = balance_.vectors();
  energy_ = vectors.sum(vectors.gluing(step.z).dot(vectors.gluing(point.s)) + vectors.contact(step.z).dot(step.sigma));
  Direction direction{std::move(step.z), true, -step.sigma, step.left <= kLeadsOn};
  dropWhatSlidesFreely(pairs, point.lambda, direction.v);
  holdFloatingBodies(direction.v);
  balance_.balance(direction.v);
  return direction;
}

}  // namespace Haptos
