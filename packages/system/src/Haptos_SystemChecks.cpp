// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SystemChecks.hpp"

#include <Teuchos_Comm.hpp>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "Haptos_Error.hpp"
#include "Haptos_LocalFrame.hpp"
#include "Haptos_ParameterSpec.hpp"
#include "Haptos_ParameterValue.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

const std::string kRange = "; it must be >= 0 and at most " + numberText(kLargestNumber) + ".";

bool isInRange(double value) { return value >= 0 && isUsable(value); }

}  // namespace

std::string describe(const PairInput& pair) { return "The contact pair of node " + std::to_string(pair.secondary); }

bool isUsable(double value) { return std::abs(value) <= kLargestNumber; }

// Weights that do not add up to one would make a force of a motion that moves both sides alike.
void checkPair(const PairInput& pair, int numInterfaces) {
  constexpr double kRoundOff = 1e-8;
  if (pair.interface < 0 || pair.interface >= numInterfaces)
    throw InputError(describe(pair) + " names interface " + std::to_string(pair.interface) + "; there are " + std::to_string(numInterfaces) +
                     ", numbered from 0.");
  if (!std::isfinite(pair.gap)) throw InputError(describe(pair) + " has a gap that is not finite.");
  if (!(pair.area > 0 && isUsable(pair.area)))
    throw InputError(describe(pair) + " has the area " + numberText(pair.area) + "; it must be > 0 and at most " + numberText(kLargestNumber) + ".");
  double sum = 0;
  for (const auto& [node, weight] : pair.primary) {
    sum += weight;
    if (node == pair.secondary && weight != 0) throw InputError(describe(pair) + " has that node on its primary side, too.");
  }
  if (!pair.primary.empty() && !(std::abs(sum - 1) <= kRoundOff))
    throw InputError(describe(pair) + " has primary weights that add up to " + std::to_string(sum) + "; it must be 1.");
  try {
    makeFrame(pair.normal, pair.axis);
  } catch (const InputError& e) {
    throw InputError(describe(pair) + ": " + e.what());
  }
}

void checkFriction(const std::string& interface, const FrictionSpec& friction) {
  const std::string who = "Interface '" + interface + "' has the ";
  for (double F : friction.coefficients)
    if (!isInRange(F)) throw InputError(who + "coefficient of friction " + numberText(F) + kRange);
  if (!isInRange(friction.slipBound)) throw InputError(who + "slip bound " + numberText(friction.slipBound) + kRange);
}

std::optional<PinnedOverlap> firstPinnedOverlap(const Communicator& comm, const MultiplierMap& multipliers, double size) {
  constexpr double kRoundOff = 1e-9;
  std::vector<PinnedOverlap> overlaps;
  const auto place = [](const PinnedOverlap& overlap) { return std::tie(overlap.interface, overlap.position); };
  const auto isBefore = [&](const PinnedOverlap& a, const PinnedOverlap& b) { return place(a) < place(b); };
  for (const auto& pair : multipliers.pairs())
    if (const auto row = std::size_t(pair.normal); multipliers.pinned()[row] && multipliers.c()[row] < -kRoundOff * size)
      overlaps.push_back({pair.interface, pair.pair, pair.geometry.secondaryNode, -multipliers.c()[row]});
  if (!overlaps.empty()) overlaps = {*std::min_element(overlaps.begin(), overlaps.end(), isBefore)};  // one a rank is sent
  overlaps = gatheredOnAll(comm, overlaps);
  if (overlaps.empty()) return {};
  return *std::min_element(overlaps.begin(), overlaps.end(), isBefore);
}

}  // namespace Haptos
