// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_KktMeasure.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

#include "Haptos_EllipseProjection.hpp"

namespace Haptos {
namespace {

using Triple = std::array<double, 3>;

// An error that is 0 needs no scale; without a scale any other is infinite.
double ratio(double a, double b) { return a == 0 ? 0 : a / b; }

// || lambda_T - P(lambda_T + step) || at the slip bound of lambda_N
double distanceToProjection(const PairLaw& pair, const Triple& lambda, double step1, double step2) {
  bool moved;
  const double g = pair.slipBound(lambda[0]);
  const auto P = projectOntoEllipse({lambda[1] + step1, lambda[2] + step2},
                                    {pair.coefficients[0] * g, pair.coefficients[1] * g}, moved);
  return std::hypot(lambda[1] - P[0], lambda[2] - P[1]);
}

bool isFinite(const Triple& x) { return std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]); }

// The contact errors of one pair: infinite where something is no number, which comparisons would take for 0.
KktErrors measurePair(const PairLaw& pair, const Triple& lambda, const Triple& s, double uRef, double lRef) {
  KktErrors errors;
  if (!isFinite(lambda) || !isFinite(s)) {
    errors.penetration = std::numeric_limits<double>::infinity();
    return errors;
  }
  if (!pair.normalPinned) {
    errors.penetration = ratio(std::max(0.0, s[0]), uRef);
    errors.compression = ratio(std::max(0.0, -lambda[0]), lRef);
    errors.complementarity = std::min(ratio(std::max(0.0, lambda[0]), lRef), ratio(std::max(0.0, -s[0]), uRef));
  }
  if (pair.frictional()) {
    // A component that the rows cannot move (pinned, or coefficient 0) has P = 0 whatever its slip.
    const double r = uRef > 0 ? lRef / uRef : 0;
    errors.cone = ratio(distanceToProjection(pair, lambda, 0, 0), lRef);
    errors.slipLaw = ratio(distanceToProjection(pair, lambda, r * s[1], r * s[2]), lRef);
  }
  return errors;
}

double largestOf(const KktErrors& e) {
  return std::max({e.penetration, e.compression, e.complementarity, e.cone, e.slipLaw});
}

// Along the axes of friction, whatever rows are: visit(law, lambda, s).
template <class Visit>
void forEachPair(const ContactLaw& law, const Vector& lambda, const Vector& s, Visit&& visit) {
  const auto data = lambda.getData(0), jumps = s.getData(0);
  for (const PairLaw& pair : law.pairs()) {
    Triple l = ContactLaw::gather(pair, data.getRawPtr()), jump = ContactLaw::gather(pair, jumps.getRawPtr());
    if (!pair.turn) {
      visit(pair, l, jump);
      continue;
    }
    const auto T = pair.turn->toAxes(l[1], l[2]), slip = pair.turn->slipToAxes(jump[1], jump[2]);
    visit(pair.alongAxes(), Triple{l[0], T[0], T[1]}, Triple{jump[0], slip[0], slip[1]});
  }
}

}  // namespace

double KktErrors::kkt() const { return std::max({equilibrium, fieldEquilibrium, continuity, largestOf(*this)}); }

std::string KktErrors::worst() const {
  const std::pair<double, const char*> all[] = {{equilibrium, "equilibrium"}, {fieldEquilibrium, "field_equilibrium"},
                                                {continuity, "continuity"},
                                                {penetration, "penetration"}, {compression, "compression"},
                                                {complementarity, "complementarity"}, {cone, "cone"}, {slipLaw, "slip_law"}};
  return std::max_element(std::begin(all), std::end(all), [](auto& a, auto& b) { return a.first < b.first; })->second;
}

double largestContactForce(const ContactLaw& law, const Vector& lambda) {
  double largest = 0;
  forEachPair(law, lambda, lambda, [&](const PairLaw&, const Triple& l, const Triple&) {
    largest = std::max(largest, std::hypot(l[0], l[1], l[2]));
  });
  return largest;
}

double contactForceScale(double largestContactForce, double load) { return std::max(largestContactForce, 1e-3 * load); }

double contactForceScale(const ContactLaw& law, const Vector& lambda, double load) {
  double result = 0;
  Teuchos::reduceAll(*lambda.getMap()->getComm(), Teuchos::REDUCE_MAX, largestContactForce(law, lambda), Teuchos::outArg(result));
  return contactForceScale(result, load);
}

KktErrors measureContact(const ContactLaw& law, const Vector& lambda, const Vector& s, const KktScales& scales) {
  return measureContact(law, lambda, s, scales.uRef, contactForceScale(law, lambda, scales.load));
}

// Largest over all pairs of all ranks, each measure by itself: one reduction.
KktErrors measureContact(const ContactLaw& law, const Vector& lambda, const Vector& s, double uRef, double lRef) {
  double mine[5] = {0, 0, 0, 0, 0}, all[5];
  forEachPair(law, lambda, s, [&](const PairLaw& pair, const Triple& l, const Triple& jump) {
    const KktErrors e = measurePair(pair, l, jump, uRef, lRef);
    const double values[5] = {e.penetration, e.compression, e.complementarity, e.cone, e.slipLaw};
    for (int k = 0; k < 5; ++k) mine[k] = std::max(mine[k], values[k]);
  });
  Teuchos::reduceAll(*lambda.getMap()->getComm(), Teuchos::REDUCE_MAX, 5, mine, all);
  KktErrors errors;
  errors.penetration = all[0];
  errors.compression = all[1];
  errors.complementarity = all[2];
  errors.cone = all[3];
  errors.slipLaw = all[4];
  return errors;
}

std::vector<double> errorsOfPairs(const ContactLaw& law, const Vector& lambda, const Vector& s, double uRef, double lRef) {
  std::vector<double> errors;
  forEachPair(law, lambda, s, [&](const PairLaw& pair, const Triple& l, const Triple& jump) {
    errors.push_back(largestOf(measurePair(pair, l, jump, uRef, lRef)));
  });
  return errors;
}

}  // namespace Haptos
