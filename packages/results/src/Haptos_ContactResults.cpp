// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactResults.hpp"

#include <Teuchos_Comm.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>

#include "Haptos_Exchange.hpp"

namespace Haptos {
namespace {

PairResult describePair(const LocalPair& local, const PairLaw& law, const std::array<double, 3>& l,
                        const std::array<double, 3>& s, double openForce) {
  const ContactPair& geometry = local.geometry;
  PairResult result{};
  result.interface = local.interface;
  result.pair = local.pair;
  result.secondaryNode = geometry.secondaryNode;
  result.primaryNode = geometry.primaryNode;
  for (int d = 0; d < 3; ++d) {
    result.tangentialForce[d] = -(l[1] * geometry.frame.t1[d] + l[2] * geometry.frame.t2[d]);
    result.force[d] = result.tangentialForce[d] - l[0] * geometry.frame.normal[d];
    result.slip[d] = s[1] * geometry.frame.t1[d] + s[2] * geometry.frame.t2[d];
  }
  result.axis = geometry.frame.t1;
  result.normalForce = l[0];
  result.pressure = l[0] / geometry.area;
  result.gap = -s[0];
  result.status = contactStatus(law, l, openForce);
  return result;
}

}  // namespace

std::vector<PairResult> gatherContactResults(const MultiplierMap& multipliers, const ContactLaw& law, const Vector& lambda,
                                             const Vector& s, double forceScale) {
  const auto l = lambda.getData(0), jump = s.getData(0);
  std::vector<PairResult> mine;
  for (std::size_t i = 0; i < law.pairs().size(); ++i)
    mine.push_back(describePair(multipliers.pairs()[i], law.pairs()[i], ContactLaw::gather(law.pairs()[i], l.getRawPtr()),
                                ContactLaw::gather(law.pairs()[i], jump.getRawPtr()), 1e-9 * forceScale));
  ByteWriter writer;
  writer.write(mine);
  std::vector<PairResult> all;
  for (const auto& message : gatherOnRoot(*multipliers.map()->getComm(), writer.take())) {
    const auto part = ByteReader(message).readVector<PairResult>();
    all.insert(all.end(), part.begin(), part.end());
  }
  std::sort(all.begin(), all.end(), [](const PairResult& a, const PairResult& b) {
    return a.interface != b.interface ? a.interface < b.interface : a.pair < b.pair;
  });
  return all;
}

std::vector<InterfaceResult> summarizeInterfaces(const std::vector<PairResult>& pairs, std::size_t numInterfaces) {
  std::vector<InterfaceResult> result(numInterfaces);
  for (const auto& pair : pairs) {
    InterfaceResult& sum = result[pair.interface];
    sum.normalForce += pair.normalForce;
    for (int d = 0; d < 3; ++d) sum.tangentialForce[d] += pair.tangentialForce[d];
    sum.maxPressure = std::max(sum.maxPressure, pair.pressure);
    ++(pair.status == ContactStatus::Stick ? sum.stick : pair.status == ContactStatus::Slip ? sum.slip : sum.open);
  }
  return result;
}

}  // namespace Haptos
