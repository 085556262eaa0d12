// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_PairLaws.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_Reductions.hpp"

namespace Haptos {

namespace {

// Of rows: along the axes of friction, along the one direction that a pair may slip in, or of all directions where rows are stretched.
std::array<double, 2> coefficientsOf(const ContactPair& pair, const FrictionSpec& spec) {
  const std::array<double, 2> F = pair.coefficients.value_or(spec.coefficients);
  const auto& turn = pair.turn;
  if (!turn) return F;
  if (turn->isOnly) return {std::hypot(F[0] * turn->c, F[1] * turn->s), 0.0};
  const double largest = std::max(F[0] / turn->stretch[0], F[1] / turn->stretch[1]);  // both are the same but for round-off
  return {largest, largest};
}

}  // namespace

InterfaceRows interfaceRows(const std::string& name, const FrictionSpec& friction) {
  return {name, friction.tied, friction.law != FrictionLaw::Frictionless, friction.coefficients};
}

// A tangential row that is missing or pinned has coefficient 0: the law then pins its force.
ContactLaw makeContactLaw(const MultiplierMap& multipliers, const std::vector<FrictionSpec>& friction) {
  std::vector<PairLaw> laws;
  for (const auto& pair : multipliers.pairs()) {
    const FrictionSpec& spec = friction[pair.interface];
    PairLaw law{pair.normal, {pair.tangential[0], pair.tangential[1]}, coefficientsOf(pair.geometry, spec),
                spec.slipBound * pair.geometry.area, spec.law, multipliers.pinned()[pair.normal] != 0};
    for (int t = 0; t < 2; ++t)
      if (law.tangential[t] < 0 || multipliers.pinned()[law.tangential[t]]) law.coefficients[t] = 0;
    if (pair.geometry.turn && pair.geometry.turn->isStretched()) law.turn = pair.geometry.turn;
    laws.push_back(law);
  }
  return ContactLaw(std::move(laws));
}

// Ranks agree in three steps: the largest error, the highest node among those that have it, that node's interface.
WorstPair findWorstPair(const ContactLaw& law, const MultiplierMap& multipliers, const Vector& lambda, const Vector& s,
                        const KktScales& scales) {
  const auto errors = errorsOfPairs(law, lambda, s, scales.uRef, contactForceScale(law, lambda, scales.load));
  WorstPair mine;
  for (std::size_t i = 0; i < errors.size(); ++i)
    if (errors[i] > mine.error)
      mine = {errors[i], multipliers.pairs()[i].geometry.secondaryNode, multipliers.pairs()[i].interface};
  const auto& comm = *lambda.getMap()->getComm();
  const double error = largestOfAll(comm, mine.error);
  const auto node = largestOfAll(comm, mine.error == error ? mine.node : -1);
  const bool isMine = mine.error == error && mine.node == node;
  return {error, node, largestOfAll(comm, isMine ? mine.interface : -1)};
}

}  // namespace Haptos
