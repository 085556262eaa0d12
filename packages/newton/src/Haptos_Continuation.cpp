// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Continuation.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_Comm.hpp>
#include <algorithm>

namespace Haptos {

std::vector<PairLaw> scaledCoefficients(std::vector<PairLaw> pairs, double factor) {
  for (auto& pair : pairs)
    for (double& F : pair.coefficients) F *= factor;
  return pairs;
}

// The ellipse grows along its short axis only, so that what sticks at a rounder level may slip later, not the other way round.
std::vector<PairLaw> roundedEllipses(std::vector<PairLaw> pairs, double least) {
  for (auto& pair : pairs) {
    const double largest = std::max(pair.coefficients[0], pair.coefficients[1]);
    for (double& F : pair.coefficients)
      if (F > 0) F = std::max(F, least * largest);
  }
  return pairs;
}

// The same on all ranks, as it decides how many levels there are; a coefficient 0 needs none.
double largestAxisRatio(const std::vector<PairLaw>& pairs, const Communicator& comm) {
  double mine = 1, all = 1;
  for (const auto& pair : pairs) {
    const auto [low, high] = std::minmax(pair.coefficients[0], pair.coefficients[1]);
    if (low > 0) mine = std::max(mine, high / low);
  }
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, mine, Teuchos::outArg(all));
  return all;
}

// F_small >= b F_large with b = 1 / start, 1 / (start factor), ... as long as it changes anything: b > 1 / ratio.
std::vector<std::vector<PairLaw>> axisRatioLevels(const std::vector<PairLaw>& pairs, double ratio, double start, double factor) {
  std::vector<std::vector<PairLaw>> levels;
  for (double b = 1 / start; b * ratio > 1; b /= factor) levels.push_back(roundedEllipses(pairs, b));
  return levels;
}

// Larger coefficients come last: nearest to the true ones.
FrictionLevels ContinuationPolicy::first(bool mindsAxisRatio) const {
  FrictionLevels levels{{}, options_.levelTolerance, options_.levelPatience};
  if (isElongated() && mindsAxisRatio) levels.laws = axisRatioLevels(pairs_, ratio_, options_.firstAxisRatio, options_.axisRatioStep);
  levels.laws.push_back(easier());
  return levels;
}

// By axis ratios where those are what is hard, in small steps from nearly round.
FrictionLevels ContinuationPolicy::detour(int restart) const {
  FrictionLevels levels{{}, options_.detourTolerance, options_.detourPatience};
  if (isElongated()) {
    levels.laws = axisRatioLevels(pairs_, ratio_, options_.detourAxisRatio, options_.detourAxisRatioStep);
    return levels;
  }
  const auto& factors = options_.detourFactors;
  for (double factor : factors[std::min(std::size_t(restart), factors.size() - 1)]) levels.laws.push_back(scaledCoefficients(pairs_, factor));
  return levels;
}

}  // namespace Haptos
