// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactResults.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>

#include "Haptos_Rendezvous.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

// From which t1 and t2 were turned.
std::array<std::array<double, 3>, 2> axesOfFriction(const ContactPair& geometry) {
  std::array<std::array<double, 3>, 2> axes{geometry.frame.t1, geometry.frame.t2};
  if (const auto& turn = geometry.turn)
    for (std::size_t d = 0; d < 3; ++d) {
      axes[0][d] = turn->c * geometry.frame.t1[d] - turn->s * geometry.frame.t2[d];
      axes[1][d] = turn->s * geometry.frame.t1[d] + turn->c * geometry.frame.t2[d];
    }
  return axes;
}

PairResult startResult(const ContactPair& geometry, int interface, int pair) {
  PairResult result{};
  result.interface = interface;
  result.pair = pair;
  result.secondaryNode = geometry.secondaryNode;
  result.area = geometry.area;
  result.size = geometry.size;
  result.axis = axesOfFriction(geometry)[0];
  result.normal = geometry.frame.normal;
  result.secondary = geometry.secondary;
  result.primary = geometry.primary;
  return result;
}

// Multipliers act against the jump: the force on the secondary node is -(lambda_N n + T1 t1 + T2 t2) along the axes of friction.
PairResult describePair(const LocalPair& local, const PairLaw& law, const std::array<double, 3>& l,
                        const std::array<double, 3>& s, const StateScales& scales) {
  const ContactPair& geometry = local.geometry;
  PairResult result = startResult(geometry, local.interface, local.pair);
  const auto axes = axesOfFriction(geometry);
  const auto T = geometry.turn ? geometry.turn->toAxes(l[1], l[2]) : std::array<double, 2>{l[1], l[2]};
  for (std::size_t d = 0; d < 3; ++d) {
    result.tangentialForce[d] = -(T[0] * axes[0][d] + T[1] * axes[1][d]);
    result.force[d] = result.tangentialForce[d] - l[0] * geometry.frame.normal[d];
  }
  result.normalForce = l[0];
  result.pressure = l[0] / geometry.area;
  result.gap = -s[0];
  if (law.frictional()) result.coefficients = law.alongAxes().coefficients;
  result.status = contactStatus(law, l, scales);
  return result;
}

// The pairs of all ranks, on rank 0 in the order of interfaces and pairs.  Collective.
std::vector<PairResult> allOnRoot(const Communicator& comm, const std::vector<PairResult>& mine) {
  auto all = gatheredOnRoot(comm, mine);
  std::sort(all.begin(), all.end(), [](const PairResult& a, const PairResult& b) {
    return a.interface != b.interface ? a.interface < b.interface : a.pair < b.pair;
  });
  return all;
}

// A tied pair has a force in global axes, which is split along the normal as that of contact is.
void describeTied(const ContactPair& geometry, const std::array<double, 3>& force, PairResult& result) {
  result.force = force;
  result.normalForce = -Vec3::dot(force, result.normal);
  for (int d = 0; d < 3; ++d) result.tangentialForce[d] = force[d] + result.normalForce * result.normal[d];
  result.pressure = result.normalForce / geometry.area;
  result.gap = geometry.gap;
  result.status = ContactStatus::Stick;
}

}  // namespace

// The rows of a tied pair act along x, y, z: the force on its secondary side is minus its multipliers.
std::vector<PairResult> gatherTiedResults(const MultiplierMap& multipliers, const Vector& lambda) {
  const auto l = lambda.getData(0);
  std::vector<PairResult> mine;
  for (const TiedPair& pair : multipliers.tiedPairs()) {
    std::array<double, 3> force{0, 0, 0};
    for (std::size_t d = 0; d < 3; ++d)
      if (pair.rows[d] >= 0) force[d] = -l[pair.rows[d]];
    mine.push_back(startResult(pair.geometry, pair.interface, pair.pair));
    describeTied(pair.geometry, force, mine.back());
  }
  return allOnRoot(*multipliers.map()->getComm(), mine);
}

// Of displacements, not of rows: frictionless pairs slip and have no tangential rows.
void setSlip(const NodalGather& gather, const std::vector<double>& displacement, const std::vector<char>& isExchanged, std::vector<PairResult>& pairs) {
  std::vector<std::int64_t> nodes;
  for (const PairResult& pair : pairs)
    for (const auto* side : {&pair.secondary, &pair.primary})
      for (const NodeWeight& share : *side) nodes.push_back(share.node);
  const auto values = gather.fetch(displacement, nodes);
  const double* u = values.data();  // of the next node
  const auto sumOf = [&](const std::vector<NodeWeight>& side) {
    std::array<double, 3> sum{0, 0, 0};
    for (const NodeWeight& share : side)
      for (int d = 0; d < 3; ++d) sum[d] += share.weight * *u++;
    return sum;
  };
  for (PairResult& pair : pairs) {
    const auto secondary = sumOf(pair.secondary), primary = sumOf(pair.primary);
    const auto jump = isExchanged[std::size_t(pair.interface)] ? Vec3::subtract(primary, secondary) : Vec3::subtract(secondary, primary);
    const double opening = Vec3::dot(jump, pair.normal);
    for (int d = 0; d < 3; ++d) pair.slip[d] = jump[d] - opening * pair.normal[d];
  }
}

std::vector<LargeSliding> findLargeSliding(const std::vector<PairResult>& pairs, std::size_t numInterfaces) {
  constexpr double kPartOfElement = 0.5;
  std::vector<LargeSliding> result(numInterfaces);
  for (const PairResult& pair : pairs) {
    const double length = Vec3::norm(pair.slip);
    if (pair.primary.empty() || pair.status == ContactStatus::Open || !(pair.size > 0 && length > kPartOfElement * pair.size)) continue;
    LargeSliding& sliding = result[std::size_t(pair.interface)];
    ++sliding.pairs;
    if (length > sliding.farthest) sliding.node = pair.secondaryNode;
    sliding.farthest = std::max(sliding.farthest, length);
  }
  return result;
}

// s = B u - c, so that -s_N = d - n [u] is what is left of the gap.
std::vector<PairResult> gatherContactResults(const MultiplierMap& multipliers, const ContactLaw& law, const Vector& lambda,
                                             const Vector& s, const StateScales& scales) {
  const auto l = lambda.getData(0), jump = s.getData(0);
  std::vector<PairResult> mine;
  for (std::size_t i = 0; i < law.pairs().size(); ++i)
    mine.push_back(describePair(multipliers.pairs()[i], law.pairs()[i], ContactLaw::gather(law.pairs()[i], l.getRawPtr()),
                                ContactLaw::gather(law.pairs()[i], jump.getRawPtr()), scales));
  return allOnRoot(*multipliers.map()->getComm(), mine);
}

// Sums of vectors, as curved surfaces have: the normal force alone is a sum of sizes.
std::vector<InterfaceResult> summarizeInterfaces(const std::vector<PairResult>& pairs, const std::vector<char>& isExchanged) {
  std::vector<InterfaceResult> result(isExchanged.size());
  for (const auto& pair : pairs) {
    InterfaceResult& sum = result[pair.interface];
    sum.normalForce += pair.normalForce;
    for (int d = 0; d < 3; ++d) sum.tangentialForce[d] += isExchanged[std::size_t(pair.interface)] ? -pair.tangentialForce[d] : pair.tangentialForce[d];
    sum.maxPressure = std::max(sum.maxPressure, pair.pressure);
    ++(pair.status == ContactStatus::Stick ? sum.stick : pair.status == ContactStatus::Slip ? sum.slip : sum.open);
  }
  return result;
}

}  // namespace Haptos
