// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

namespace Haptos {

struct ContactSurface;

/// \brief An infinite straight line; `direction` has length 1.
struct Line {
  std::array<double, 3> origin;
  std::array<double, 3> direction;
};

/// \brief Whether the line passes through face `facet`, grown by `margin` (a length) at its edges.
///
/// Seen along the line the face is taken as a convex polygon; it must not be parallel to the line.
bool passesThrough(const ContactSurface& surface, int facet, const Line& line, double margin);

/// \brief Signed distance along the line from its origin to the plane of face `facet`.
double distanceToFacet(const ContactSurface& surface, int facet, const Line& line);

}  // namespace Haptos
