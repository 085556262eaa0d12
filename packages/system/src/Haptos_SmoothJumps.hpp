// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <vector>

#include "Haptos_Types_fwd.hpp"

namespace Haptos {

class FetiSystem;
class MultiplierMap;

/// \brief [owned pairs] where their multiplier nodes are, whichever rank knows it.  Collective.
std::vector<Eigen::Vector3d> placesOfPairs(const FetiSystem& system);

/// \brief Jumps that vary slowly over the contact surfaces: what thin or soft bodies resist least, whatever they are made of.
///
/// Centres lie all over the pairs of each interface, one for 32 of them, 64 at most; every one moves by the six rigid motions about it, faded out by weights
/// that add up to 1 (partition of unity: Babuska and Melenk, Int. J. Numer. Meth. Engng. 40 (1997) 727).
/// \param places [owned pairs]
/// \return [3 x owned pairs x 6 x centres] by (N, T1, T2) of each pair, 0 where a row is pinned or not there.  Centres do not depend on the
/// ranks.  Collective.
Eigen::MatrixXd smoothJumps(const MultiplierMap& multipliers, const std::vector<Eigen::Vector3d>& places);

}  // namespace Haptos
