// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <limits>
#include <optional>
#include <string>

#include "Haptos_ContactSystem.hpp"
#include "Haptos_MultiplierMap.hpp"

namespace Haptos {

/// Unknowns are 3 x id + component.
constexpr GlobalOrdinal kLargestId = (std::numeric_limits<GlobalOrdinal>::max() - 2) / 3;

/// A number that can be computed with: its products do not overflow.
bool isUsable(double value);

/// For messages.
std::string describe(const PairInput& pair);

/// \throws InputError that names the pair
void checkPair(const PairInput& pair, int numInterfaces);

/// \throws InputError that names the interface
void checkFriction(const std::string& interface, const FrictionSpec& friction);

/// \brief A pair whose nodes are held, nearer to each other than its gap.
struct PinnedOverlap {
  int interface, position;
  std::int64_t node;  ///< of the secondary side
  double depth;       ///< [length]
};

/// \brief The first one by interface and position, the same on all ranks; none if what is prescribed leaves all gaps.  Collective.
/// \param size of the model [length]: an overlap of its round-off is none
std::optional<PinnedOverlap> firstPinnedOverlap(const Communicator& comm, const MultiplierMap& multipliers, double size);

}  // namespace Haptos
