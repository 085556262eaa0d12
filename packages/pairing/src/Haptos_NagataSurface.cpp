// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NagataSurface.hpp"

#include <algorithm>
#include <cmath>

#include "Haptos_FaceShapes.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

// (n0 + n1) (q0 + q1) / (2 (1 + a)) + (n0 - n1) (q0 - q1) / (2 (1 - a)), q0 = n0 . d, q1 = - n1 . d, a = n0 . n1: the second part only shifts points
// along the edge unless it has an inflection, and is dropped where normals are too near to tell, or would fold the edge.
Vec3::Array bulge(const Vec3::Array& d, const Vec3::Array& n0, const Vec3::Array& n1) {
  constexpr double kParallel = 1e-8, kLongest = 0.5;
  const double q0 = Vec3::dot(n0, d), q1 = -Vec3::dot(n1, d), a = Vec3::dot(n0, n1);
  const auto even = Vec3::scale((q0 + q1) / (2 * (1 + a)), Vec3::add(n0, n1));
  if (1 - a < kParallel) return even;
  const auto odd = Vec3::scale((q0 - q1) / (2 * (1 - a)), Vec3::subtract(n0, n1));
  return Vec3::norm(odd) > kLongest * Vec3::norm(d) ? even : Vec3::add(even, odd);
}

class Patches {
 public:
  explicit Patches(const ContactSurface& surface) : s_(surface), facesAt_(surface.numNodes()), facetOf_(surface.faces.size(), -1) {
    for (int f = 0; f < int(s_.numFacets()); ++f) facetOf_[std::size_t(s_.faceOfFacet[std::size_t(f)])] = f;
    for (int f = 0; f < int(s_.faces.size()); ++f)
      for (int i = 0; i < s_.faces[std::size_t(f)].size; ++i) facesAt_[std::size_t(s_.faces[std::size_t(f)].nodes[std::size_t(i)])].push_back(f);
  }

  ContactSurface run() {
    ContactSurface result;
    result.name = s_.name;
    result.nodes = s_.nodes;
    result.coordinates = s_.coordinates;
    for (int f = 0; f < int(s_.faces.size()); ++f) {
      result.faces.push_back(s_.faces[std::size_t(f)]);
      if (isLinear(result.faces.back().size)) addMiddles(f, result);
      addFacets(result);
    }
    return result;
  }

 private:
  const Vec3::Array& normalOf(int face) const { return s_.facetNormals[std::size_t(facetOf_[std::size_t(face)])]; }

  // The angle that a face fills at a corner.
  double angleAt(int face, int node) const {
    const SurfaceFace& own = s_.faces[std::size_t(face)];
    const int corners = numCorners(own.size);
    const int i = int(std::find(own.nodes.begin(), own.nodes.begin() + own.size, node) - own.nodes.begin());
    if (i >= corners) return 0;
    const auto edgeTo = [&](int k) {
      return Vec3::subtract(s_.coordinates[std::size_t(own.nodes[std::size_t(k % corners)])], s_.coordinates[std::size_t(node)]);
    };
    const auto a = edgeTo(i + 1), b = edgeTo(i + corners - 1);
    return std::atan2(Vec3::norm(Vec3::cross(a, b)), Vec3::dot(a, b));
  }

  Vec3::Array cornerNormal(int face, int node) const {
    Vec3::Array sum{};
    for (const int other : facesAt_[std::size_t(node)])
      if (Vec3::dot(normalOf(face), normalOf(other)) > creaseCosine) sum = Vec3::add(sum, Vec3::scale(angleAt(other, node), normalOf(other)));
    return Vec3::normalized(sum);
  }

  void addMiddles(int face, ContactSurface& result) const {
    SurfaceFace& patch = result.faces.back();
    const int corners = patch.size;
    for (int i = 0; i < corners; ++i) {
      const int from = patch.nodes[std::size_t(i)], to = patch.nodes[std::size_t((i + 1) % corners)];
      const auto &x0 = s_.coordinates[std::size_t(from)], &x1 = s_.coordinates[std::size_t(to)];
      const auto c = bulge(Vec3::subtract(x1, x0), cornerNormal(face, from), cornerNormal(face, to));
      patch.nodes[std::size_t(corners + i)] = int(result.coordinates.size());
      result.coordinates.push_back(Vec3::subtract(Vec3::scale(0.5, Vec3::add(x0, x1)), Vec3::scale(0.25, c)));
      result.nodes.push_back(-1);
    }
    patch.size = 2 * corners;
  }

  static void addFacets(ContactSurface& result) {
    const SurfaceFace& patch = result.faces.back();
    for (auto facet : facetsOfShape(patch.size)) {
      for (int& node : facet)
        if (node >= 0) node = patch.nodes[std::size_t(node)];
      const auto at = [&](std::size_t i) { return result.coordinates[std::size_t(facet[i])]; };
      const auto a = facet[3] < 0 ? Vec3::subtract(at(1), at(0)) : Vec3::subtract(at(2), at(0));
      const auto b = facet[3] < 0 ? Vec3::subtract(at(2), at(0)) : Vec3::subtract(at(3), at(1));
      result.facets.push_back(facet);
      result.faceOfFacet.push_back(int(result.faces.size()) - 1);
      result.facetNormals.push_back(Vec3::normalized(Vec3::cross(a, b)));
    }
  }

  const ContactSurface& s_;
  std::vector<std::vector<int>> facesAt_;  // [nodes]
  std::vector<int> facetOf_;               // [faces] one of its facets
};

}  // namespace

ContactSurface nagataSurface(const ContactSurface& surface) { return Patches(surface).run(); }

}  // namespace Haptos
