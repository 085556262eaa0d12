// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <utility>
#include <vector>

#include "Haptos_ContactSurface.hpp"
#include "Haptos_FaceShapes.hpp"

namespace Haptos {

class FacetTree;

/// \brief Integrals over what of a secondary face lies opposite primary faces; N its shape functions, [n] its nodes.
///
/// x_p - x_s at each point is along the normal of the plane in which the faces were cut.
struct FaceIntegrals {
  double area = 0;      ///< of the covered part
  Eigen::VectorXd d;    ///< [n] int N
  Eigen::MatrixXd M;    ///< [n x n] int N N^T
  Eigen::MatrixXd gap;  ///< [n x 3] int N (x_p - x_s)^T
  std::vector<std::pair<int, Eigen::MatrixXd>> across;  ///< primary face, [n x nodes of it] int N N_p^T

  explicit FaceIntegrals(int size);
  void add(const FaceValues& values, double dA);  ///< a point, to area, d and M
};

struct SurfaceOverlap {
  std::vector<FaceIntegrals> faces;  ///< [secondary faces] area 0, and nothing else, where nothing is opposite
  std::vector<double> areas;         ///< [secondary faces] of the whole faces
  std::vector<char> isCovered;       ///< [secondary nodes] whether a primary face lies opposite the node itself
};

/// \brief Cuts the faces of both surfaces on planes and integrates over the pieces.  Serial, O(n log n).
///
/// Each linear facet of the secondary surface has its plane, through its middle and along it; the facets of the primary surface
/// that look against it are projected there and clipped, and the pieces integrated as fans of triangles about their centroids:
/// with 7 points between plane triangles and parallelograms, else with 36, or 64 (`ProjectedFace::isSkew`).  A point goes back to both faces along the normal of the plane.
/// Primary facets count at whatever distance, the nearest of several layers only (Puso and Laursen 2004).
/// \throws InputError where a face is too distorted to be inverted
/// \param tree of the primary facets
SurfaceOverlap integrateOverlap(const ContactSurface& secondary, const ContactSurface& primary, const FacetTree& tree);
SurfaceOverlap integrateOverlap(const ContactSurface& secondary, const ContactSurface& primary);

/// \brief The same with a point a piece: what is covered and how much of it, in a fraction of the time.
SurfaceOverlap roughOverlap(const ContactSurface& secondary, const ContactSurface& primary);

/// \brief All of a surface, opposite a rigid obstacle: nothing across, no gap.  Serial.
SurfaceOverlap wholeSurface(const ContactSurface& surface);

}  // namespace Haptos
