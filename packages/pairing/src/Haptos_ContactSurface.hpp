// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "Haptos_Mesh.hpp"

namespace Haptos {

/// \brief A face by the positions of its nodes, corners first; their number tells its shape.
struct SurfaceFace {
  int size = 0;
  std::array<int, 9> nodes{};
};

/// \brief The faces of one side set as a surface of its own: nodes, normals, areas, sizes.
///
/// The normal of a node is the mean of the outward corner normals of the faces around it, weighted by the
/// angle of the corner (Thuermer and Wuethrich 1998): it depends neither on the numbering nor on how a face
/// is cut into triangles.  The tributary area of a node is the integral of its shape function over the
/// surface (2 x 2 Gauss points on quadrilaterals, exact on plane ones), so the areas sum to that of the
/// surface. Node indices inside are positions in `nodes` (0-based).
struct ContactSurface {
  std::string name;                                ///< the side set's name, or its number
  std::vector<std::int64_t> nodes;                 ///< [numNodes] mesh indices, ascending
  std::vector<std::array<double, 3>> coordinates;  ///< [numNodes]
  std::vector<std::array<double, 3>> normals;      ///< [numNodes] unit, outward
  std::vector<double> areas;                       ///< [numNodes] tributary area
  std::vector<double> sizes;                       ///< [numNodes] shortest edge of the faces around the node
  /// [numNodes] sine of the largest angle between the normal here and at a node of the same face (0 if flat)
  std::vector<double> turns;
  std::vector<SurfaceFace> faces;          ///< [numFaces] outward
  std::vector<std::array<int, 4>> facets;  ///< [numFacets] node positions, outward; -1 last: triangle
  std::vector<int> faceOfFacet;            ///< [numFacets] linear faces are one facet
  std::vector<std::array<double, 3>> facetNormals;  ///< [numFacets] unit, outward

  std::size_t numNodes() const { return nodes.size(); }
  std::size_t numFacets() const { return facets.size(); }
  int facetSize(int facet) const { return facets[std::size_t(facet)][3] < 0 ? 3 : 4; }
};

/// \brief Surface of a side set, given by name or number.
/// \throws InputError if there is no such side set (lists those there are), if it is empty or lists a side twice, if a face has no
///   area, or if the faces around a node look in opposite directions, so that it has no outward normal
ContactSurface makeContactSurface(const Mesh& mesh, const std::string& sideSet);

/// \brief Those of its faces that look along a direction, as a surface of their own; without nodes if none does.
/// \param whole the surface of the side set
ContactSurface facesTowards(const Mesh& mesh, const std::string& sideSet, const ContactSurface& whole, const std::array<double, 3>& direction);

/// \brief [numNodes] tributary areas on some of the facets.  \param counts [numFacets]
std::vector<double> areasOnFacets(const ContactSurface& surface, const std::vector<char>& counts);

constexpr double creaseCosine = 0.766;  ///< 40 degrees between faces: more is a crease

/// \brief Whether creases cut it into several patches.
bool isCreased(const ContactSurface& surface);

/// \brief The same surface cut along its creases, so that each patch has nodes and normals of its own there; one patch if there are none.
std::vector<ContactSurface> smoothPatches(const Mesh& mesh, const std::string& sideSet);

/// \brief Linear facets of a face of so many nodes, by the places of its nodes; -1 last: triangle.
std::vector<std::array<int, 4>> facetsOfShape(int numNodes);

}  // namespace Haptos
