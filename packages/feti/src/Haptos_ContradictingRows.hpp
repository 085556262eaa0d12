// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "Haptos_MultiplierMap.hpp"

namespace Haptos {

/// \brief Contacts that no displacements obey together: a node between obstacles that leave it no room.
struct Contradiction {
  std::int64_t node;  ///< mesh index, of the largest `depth`
  double depth;       ///< by which one is missed where all are missed least [length]
};

/// \brief The one of the largest depth, the same on all ranks; none where all contacts leave room, but for `roundOff` [length].
///
/// Rows with a component of a node of their own leave room.  The others, n_i . u <= c_i, are missed least by u of least sum (n_i . u - c_i)_+^2.
/// Then z = (n . u - c)_+ has N^T z = 0 and c . z < 0: forces that do nothing to displacements and make the dual cost fall without end.
/// \param c [owned rows], of normal rows what is left between the sides [length].  Collective.
std::optional<Contradiction> findContradiction(const MultiplierMap& multipliers, const Vector& c, double roundOff);

}  // namespace Haptos
