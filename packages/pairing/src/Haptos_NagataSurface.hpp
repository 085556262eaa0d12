// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_ContactSurface.hpp"

namespace Haptos {

/// \brief The surface with quadratic patches in the place of its linear faces, which meet the nodal normals at right angles (Nagata 2005).
///
/// The edge from x0 to x1 with the normals n0, n1 becomes x0 + (d - c) s + c s^2, d = x1 - x0, with n0 . (d - c) = 0 = n1 . (d + c) and c of least length;
/// a patch is the face of 6 or 8 nodes whose middles lie on its edges, at (x0 + x1) / 2 - c / 4.  On regular meshes of a circle it lies off by h^4 / (128 R^3).
/// The normal at a corner is that of the faces around it that turn by less than 40 degrees: what lies beyond a crease does not count.
/// \return coordinates, faces, facets and their normals; new nodes are none of the mesh (-1)
ContactSurface nagataSurface(const ContactSurface& surface);

}  // namespace Haptos
