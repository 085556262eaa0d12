// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_KktMeasure.hpp"
#include "Haptos_MultiplierMap.hpp"

namespace Haptos {

/// \brief What rows pairs have by their interface's law.
InterfaceRows interfaceRows(const std::string& name, const FrictionSpec& friction);

/// \brief The laws of the pairs whose rows this rank owns, in the order of MultiplierMap::pairs().
/// \param friction [interfaces]
ContactLaw makeContactLaw(const MultiplierMap& multipliers, const std::vector<FrictionSpec>& friction);

/// \brief The pair with the largest contact error.
struct WorstPair {
  double error = 0;
  std::int64_t node = -1;  ///< mesh index of its secondary side
  int interface = -1;      ///< position in the list of interfaces
};

/// \brief Over the pairs of all ranks.  Collective.
WorstPair findWorstPair(const ContactLaw& law, const MultiplierMap& multipliers, const Vector& lambda, const Vector& s,
                        const KktScales& scales);

}  // namespace Haptos
