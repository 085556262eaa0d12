// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_ContactLaw.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief Coefficients of friction times a factor.
std::vector<PairLaw> scaledCoefficients(std::vector<PairLaw> pairs, double factor);

/// \brief The small coefficient raised to at least `least` times the large one; zeros stay.
std::vector<PairLaw> roundedEllipses(std::vector<PairLaw> pairs, double least);

/// \brief Largest ratio of the two coefficients of a pair, over all ranks; 1 where one of them is 0.  Collective.
double largestAxisRatio(const std::vector<PairLaw>& pairs, const Communicator& comm);

/// \brief Rounded ellipses whose axis ratio is at most start, start x factor, ...; all below `ratio`.
std::vector<std::vector<PairLaw>> axisRatioLevels(const std::vector<PairLaw>& pairs, double ratio, double start, double factor);

}  // namespace Haptos
