// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "Haptos_Communication.hpp"

namespace Haptos {

/// \brief A place on one of the contact interfaces.
struct SurfacePlace {
  int interface;
  Eigen::Vector3d x;
};

struct SurfaceCentre {
  SurfacePlace place;
  double spacing;  ///< no place of its interface is farther from the nearest centre, but for the side of a cell
};

/// \brief Centres all over the interfaces, about as far from each other as they can be, the same on all ranks and any number of them.
///
/// \param places of this rank.  \return `count` of them, or fewer where places are.  Collective.
std::vector<SurfaceCentre> chooseCentres(const Communicator& comm, const std::vector<SurfacePlace>& places, std::size_t count);

}  // namespace Haptos
