// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "Haptos_ContactSurface.hpp"

namespace Haptos {

/// \brief Two side sets between which contact is possible.  Must outlive what refers to it.
struct SurfaceCouple {
  const Mesh& mesh;
  std::string interface;  ///< the interface's name, for messages
  const ContactSurface& secondary;
  const ContactSurface& primary;
};

/// \brief Who faces whom, by positions in the two surfaces.
struct SurfaceMatch {
  std::vector<int> partner;    ///< [secondary nodes] primary node, or -1: no primary face lies opposite
  std::vector<double> gap;     ///< [secondary nodes] (x_primary - x_secondary) . n, 0 without partner
  std::size_t mismatched = 0;  ///< secondary faces whose partners are not the corners of one primary face
};

/// \brief Finds for every secondary node the primary node opposite it; each primary node serves at most once.
///
/// A primary node is opposite if the offset x_primary - x_secondary is along the normal n of the secondary
/// node, either way (gap or penetration) and at any distance, up to a tangential mismatch of
///
///   tolerance h + min(|gap| sin(turn), h/4),
///
/// h the shortest edge around the secondary node and turn the angle to the neighbours' normals: on a curved
/// surface n itself is known no better, on a flat one the second term is zero.  Between smooth curved
/// surfaces the opposite of the primary node's normal and the mean directions of approach count as well (a
/// sphere over a plane, meshed alike along the vertical).  Of several candidates, on faces that look against
/// n, the nearest is taken.
///
/// \throws NonMatchingError if a node of either surface lies opposite a face of the other one but not
/// opposite
///   a node, or if several nodes at one place compete for a partner: tells the largest mismatch and its place
/// \throws InputError if the outward normals of the two surfaces do not oppose each other
SurfaceMatch matchSurfaces(const SurfaceCouple& couple, double tolerance);

}  // namespace Haptos
