// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <tuple>
#include <vector>

#include "Haptos_ContactLaw.hpp"
#include "Haptos_MultiplierMap.hpp"
#include "Haptos_NodalGather.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief One contact pair after the solve, in global axes; plain data, to be sent.
struct PairState {
  int interface;
  int pair;                    ///< position in the interface's pairs
  std::int64_t secondaryNode;  ///< mesh node
  std::array<double, 3> force; ///< on the secondary side: -(lambda_N n + lambda_T1 t1 + lambda_T2 t2)
  std::array<double, 3> tangentialForce;  ///< its tangential part
  double normalForce;          ///< lambda_N >= 0
  double area;                 ///< tributary area
  double size;                 ///< of the elements, see ContactPair
  double pressure;             ///< lambda_N / area
  double gap;                  ///< d - N u: the opening that is left
  std::array<double, 3> slip;  ///< tangential part of u_secondary - u_primary
  std::array<double, 3> axis;    ///< t1
  std::array<double, 3> normal;  ///< n, out of the secondary surface
  std::array<double, 2> coefficients;  ///< F1, F2 along t1, t2; 0 where there is no friction or a support holds the component
  ContactStatus status;          ///< Stick for tied pairs
};

/// \brief The same with the nodes that share it: weight x force acts on a secondary one, - weight x force on a primary one.
struct PairResult : PairState {
  std::vector<NodeWeight> secondary, primary;

  auto parts() { return std::tie(static_cast<PairState&>(*this), secondary, primary); }  ///< see ByteWriter
};

/// \brief The contact pairs of all ranks, on rank 0 in the order of interfaces and pairs; empty elsewhere.  Collective.
///
/// Slip is left to `setSlip`.
/// \param s B u - c on the dual map, \param scales tell open, slipping and sticking pairs
std::vector<PairResult> gatherContactResults(const MultiplierMap& multipliers, const ContactLaw& law, const Vector& lambda,
                                             const Vector& s, const StateScales& scales);

/// \brief The tied pairs of all ranks in the same way; a normal force < 0 pulls.  Slip is left to `setSlip`.  Collective.
///
/// A component that is prescribed on both sides has no row, and no force here.
std::vector<PairResult> gatherTiedResults(const MultiplierMap& multipliers, const Vector& lambda);

/// \brief Tangential part of u_secondary - u_primary for all pairs, also those without tangential rows.
/// \param displacement [3 x nodes of this rank's range], mean of the copies
/// \param pairs on any rank.  Collective.
void setSlip(const NodalGather& gather, const std::vector<double>& displacement, const std::vector<char>& isExchanged, std::vector<PairResult>& pairs);

/// \brief Closed pairs of one interface that slide by more than half of their element, where rows no longer belong to what lies opposite.
struct LargeSliding {
  long pairs = 0;
  double farthest = 0;
  std::int64_t node = -1;  ///< of the farthest
};
std::vector<LargeSliding> findLargeSliding(const std::vector<PairResult>& pairs, std::size_t numInterfaces);  ///< a rigid plane is flat: none there

/// \brief Sums over one interface.
struct InterfaceResult {
  double normalForce = 0;
  std::array<double, 3> tangentialForce{0, 0, 0};  ///< on what the user calls the secondary surface
  long stick = 0, slip = 0, open = 0;
  double maxPressure = 0;
};
/// \param isExchanged [interfaces], see `ContactInterface`
std::vector<InterfaceResult> summarizeInterfaces(const std::vector<PairResult>& pairs, const std::vector<char>& isExchanged);

}  // namespace Haptos
