// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "Haptos_Communication.hpp"

namespace Haptos {

/// \brief Cuts sets of points into blocks of about equal numbers: recursive coordinate bisection.  Collective.
///
/// Every cut is across the longest axis of a set's box and between two values of that coordinate, so that a layer of points
/// stays together; it lies as near as such a place does to the share that the blocks on either side want.  The place is found by
/// counting points digit by digit, in whole numbers: the result depends on points and sets only, not on how ranks hold them.
/// \param points [this rank's points]
/// \param setOf [this rank's points] set of a point; -1: none
/// \param blocks [sets] how many blocks are wanted, at least 1; the same on all ranks
/// \param blockOf [this rank's points] is set: block of a point, numbered set after set; -1: none
/// \return [blocks] set; fewer than wanted where points fall together
std::vector<int> cutIntoBlocks(const Communicator& comm, const std::vector<std::array<double, 3>>& points, const std::vector<int>& setOf,
                               const std::vector<int>& blocks, std::vector<int>& blockOf);

}  // namespace Haptos
