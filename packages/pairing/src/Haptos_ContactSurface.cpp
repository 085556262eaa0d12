// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactSurface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <tuple>

#include "Haptos_DisjointSets.hpp"
#include "Haptos_FaceShapes.hpp"
#include "Haptos_InputCheck.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

using Corners = std::array<Vec3::Array, 4>;

// As the file counts elements, for messages.
std::int64_t elementNumber(const Mesh& mesh, std::int64_t element) {
  return mesh.elementNumbers.empty() ? element + 1 : mesh.elementNumbers[std::size_t(element)];
}

// In the order of elements; one that is listed twice would count its area twice.
std::vector<ElementSide> sortedSides(const Mesh& mesh, const SideSet& set, const std::string& name) {
  auto key = [](const ElementSide& s) { return std::tie(s.element, s.side); };
  auto sides = set.sides;
  std::sort(sides.begin(), sides.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  const auto twice = std::adjacent_find(sides.begin(), sides.end(), [&](const auto& a, const auto& b) { return key(a) == key(b); });
  HAPTOS_REFUSE_IF(twice != sides.end(), "Side set '" << name << "': side " << twice->side + 1 << " of element " << elementNumber(mesh, twice->element)
                                                     << " is listed twice; a face of a contact surface is given once.");
  return sides;
}

// Faces as mesh nodes; a quadrilateral with two equal corners (a collapsed brick) is a triangle.
std::vector<std::vector<std::int64_t>> collectFaces(const Mesh& mesh, const std::string& name,
                                                    const std::vector<ElementSide>& sides) {
  const auto offsets = blockOffsets(mesh);
  std::vector<std::vector<std::int64_t>> faces;
  faces.reserve(sides.size());
  for (const ElementSide& side : sides) {
    auto face = nodesOfSide(mesh, offsets, side);
    if (face.size() <= 4) {
      face.erase(std::unique(face.begin(), face.end()), face.end());
      if (face.size() > 1 && face.front() == face.back()) face.pop_back();
    }
    HAPTOS_REFUSE_IF(face.size() < 3,
                     "Side set '" << name << "': side " << side.side + 1 << " of element "
                                  << elementNumber(mesh, side.element)
                                  << " is collapsed to a line; leave it out of the side set.");
    faces.push_back(std::move(face));
  }
  return faces;
}

// Nodes ascend, so that they are found by bisection and two surfaces are compared in one pass.
void setTopology(const Mesh& mesh, const std::vector<std::vector<std::int64_t>>& faces,
                 ContactSurface& surface) {
  for (const auto& face : faces) surface.nodes.insert(surface.nodes.end(), face.begin(), face.end());
  std::sort(surface.nodes.begin(), surface.nodes.end());
  surface.nodes.erase(std::unique(surface.nodes.begin(), surface.nodes.end()), surface.nodes.end());
  surface.coordinates.reserve(surface.numNodes());
  for (const auto node : surface.nodes) surface.coordinates.push_back(mesh.coordinates[std::size_t(node)]);

  surface.facets.reserve(faces.size());
  for (const auto& face : faces) {
    SurfaceFace& target = surface.faces.emplace_back();
    target.size = int(face.size());
    for (std::size_t i = 0; i < face.size(); ++i)
      target.nodes[i] =
          int(std::lower_bound(surface.nodes.begin(), surface.nodes.end(), face[i]) - surface.nodes.begin());
    for (auto facet : facetsOfShape(target.size)) {
      for (int& node : facet)
        if (node >= 0) node = target.nodes[std::size_t(node)];
      surface.facets.push_back(facet);
      surface.faceOfFacet.push_back(int(surface.faces.size()) - 1);
    }
  }
}

// Places of a facet's corners; the fourth of a triangle is of no use.
Corners cornersOf(const ContactSurface& surface, int facet) {
  Corners x{};
  for (int i = 0; i < surface.facetSize(facet); ++i)
    x[std::size_t(i)] = surface.coordinates[std::size_t(surface.facets[std::size_t(facet)][std::size_t(i)])];
  return x;
}

// Twice the area vector: of a triangle by two edges, of a quadrilateral by its diagonals.
Vec3::Array areaVector(const Corners& x, int size) {
  return size == 3 ? Vec3::cross(Vec3::subtract(x[1], x[0]), Vec3::subtract(x[2], x[0]))
                   : Vec3::cross(Vec3::subtract(x[2], x[0]), Vec3::subtract(x[3], x[1]));
}

// Outward, as sides list their nodes anticlockwise from outside; a face without area has no normal and is refused.
void setFacetNormals(const Mesh& mesh, const std::vector<ElementSide>& sides, ContactSurface& surface) {
  const auto sideOf = [&](int facet) { return sides[std::size_t(surface.faceOfFacet[std::size_t(facet)])]; };
  surface.facetNormals.reserve(surface.numFacets());
  for (int f = 0; f < int(surface.numFacets()); ++f) {
    const Corners x = cornersOf(surface, f);
    const Vec3::Array vector = areaVector(x, surface.facetSize(f));
    const double length =
        std::max(Vec3::norm(Vec3::subtract(x[1], x[0])), Vec3::norm(Vec3::subtract(x[2], x[1])));
    HAPTOS_REFUSE_IF(!(Vec3::norm(vector) > 1e-12 * length * length),
                     "Side set '" << surface.name << "': side " << sideOf(f).side + 1
                                  << " of element "
                                  << elementNumber(mesh, sideOf(f).element)
                                  << " has no area; the element is degenerate.");
    surface.facetNormals.push_back(Vec3::normalized(vector));
  }
}

// Adds the normals of a face at its nodes, by the angle that it fills there: between the edges at a corner, half a turn in the middle
// of an edge, a whole one inside; the facet's own where a corner of a quadrilateral is not convex.
void addNormals(const SurfaceFace& face, const Vec3::Array& facetNormal, ContactSurface& surface) {
  constexpr double kHalfTurn = 3.141592653589793;
  const int corners = numCorners(face.size);
  for (int i = 0; i < face.size; ++i) {
    const Point2 at = nodeOfFace(face.size, i);
    const FaceValues v = faceValues(face.size, at);
    const auto towards = [&](int corner) {
      const Point2 to = nodeOfFace(face.size, corner);
      Vec3::Array t{};
      for (std::size_t k = 0; k < std::size_t(face.size); ++k)
        t = Vec3::add(t, Vec3::scale((to[0] - at[0]) * v.dXi[k] + (to[1] - at[1]) * v.dEta[k],
                                     surface.coordinates[std::size_t(face.nodes[k])]));
      return t;
    };
    const int next = (i + 1) % corners, previous = (i < corners ? i + corners - 1 : i + 2) % corners;
    const auto a = towards(next), b = towards(previous), product = Vec3::cross(a, b);
    const bool isUsable = Vec3::norm(product) > 1e-12 * Vec3::norm(a) * Vec3::norm(b) && Vec3::dot(product, facetNormal) > 0.0;
    const double angle = i < corners ? std::atan2(Vec3::norm(product), Vec3::dot(a, b)) : i < 2 * corners ? kHalfTurn : 2 * kHalfTurn;
    auto& normal = surface.normals[std::size_t(face.nodes[std::size_t(i)])];
    normal = Vec3::add(normal, Vec3::scale(angle, isUsable ? Vec3::normalized(product) : facetNormal));
  }
}

// Integrals of the four bilinear shape functions, 2 x 2 Gauss points.
std::array<double, 4> quadrilateralAreas(const Corners& x) {
  static constexpr std::array<std::array<double, 2>, 4> reference = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  const double g = 1.0 / std::sqrt(3.0);
  std::array<double, 4> areas{};
  for (const auto& point : reference) {
    const double xi = g * point[0], eta = g * point[1];
    Vec3::Array dXi{}, dEta{};
    for (std::size_t i = 0; i < 4; ++i) {
      dXi = Vec3::add(dXi, Vec3::scale(0.25 * reference[i][0] * (1 + eta * reference[i][1]), x[i]));
      dEta = Vec3::add(dEta, Vec3::scale(0.25 * reference[i][1] * (1 + xi * reference[i][0]), x[i]));
    }
    const double jacobian = Vec3::norm(Vec3::cross(dXi, dEta));
    for (std::size_t i = 0; i < 4; ++i)
      areas[i] += 0.25 * (1 + xi * reference[i][0]) * (1 + eta * reference[i][1]) * jacobian;
  }
  return areas;
}

// Integrals of the shape functions: what each corner has of the facet's area.
std::array<double, 4> facetAreas(const Corners& x, int size) {
  if (size == 4) return quadrilateralAreas(x);
  const double third = Vec3::norm(areaVector(x, 3)) / 6.0;
  return {third, third, third, 0.0};
}

// Adds every face to its nodes: angle-weighted normal (not yet of length 1); area and shortest edge of its facets.
void accumulateNodalData(ContactSurface& surface) {
  surface.normals.assign(surface.numNodes(), Vec3::Array{});
  surface.areas.assign(surface.numNodes(), 0.0);
  surface.sizes.assign(surface.numNodes(), std::numeric_limits<double>::max());
  for (int f = 0; f < int(surface.numFacets()); ++f) {
    const int size = surface.facetSize(f);
    const Corners x = cornersOf(surface, f);
    const auto areas = facetAreas(x, size);
    double shortest = std::numeric_limits<double>::max();
    for (int i = 0; i < size; ++i)
      shortest =
          std::min(shortest, Vec3::norm(Vec3::subtract(x[std::size_t((i + 1) % size)], x[std::size_t(i)])));
    for (int i = 0; i < size; ++i) {
      const auto node = std::size_t(surface.facets[std::size_t(f)][std::size_t(i)]);
      surface.areas[node] += areas[std::size_t(i)];
      surface.sizes[node] = std::min(surface.sizes[node], shortest);
    }
    const int face = surface.faceOfFacet[std::size_t(f)];
    if (f + 1 == int(surface.numFacets()) || surface.faceOfFacet[std::size_t(f + 1)] != face)
      addNormals(surface.faces[std::size_t(face)], surface.facetNormals[std::size_t(f)], surface);
  }
}

// A nodal normal must make sense for all faces around the node: one that vanishes, or that some face looks away from, does not.
void normalizeNormals(const Mesh& mesh, ContactSurface& surface) {
  const auto refuse = [&](std::size_t node) {
    HAPTOS_REFUSE_IF(true,
                     "Side set '" << surface.name << "': the faces around " << describeNode(mesh, surface.nodes[node])
                                  << " look in opposite directions, so that it has no outward normal; "
                                     "put the two sides of a thin part into two side sets.");
  };
  for (std::size_t i = 0; i < surface.numNodes(); ++i) {
    if (!(Vec3::norm(surface.normals[i]) > 1e-6)) refuse(i);
    surface.normals[i] = Vec3::normalized(surface.normals[i]);
  }
  constexpr double smallestCosine = 0.0175;  // a face steeper than 89 degrees against the mean is folded back
  for (std::size_t f = 0; f < surface.numFacets(); ++f)
    for (const int node : surface.facets[f])
      if (node >= 0 &&
          Vec3::dot(surface.normals[std::size_t(node)], surface.facetNormals[f]) < smallestCosine)
        refuse(std::size_t(node));
}

// How far the normal turns from a node to its neighbours, as a sine: the size of curvature times the element size.
void setTurns(ContactSurface& surface) {
  surface.turns.assign(surface.numNodes(), 0.0);
  for (const auto& facet : surface.facets)
    for (const int a : facet)
      for (const int b : facet) {
        if (a < 0 || b < 0 || a == b) continue;
        const double sine =
            Vec3::norm(Vec3::cross(surface.normals[std::size_t(a)], surface.normals[std::size_t(b)]));
        surface.turns[std::size_t(a)] = std::max(surface.turns[std::size_t(a)], sine);
      }
}

std::string nameOf(const SideSet& set) { return set.name.empty() ? std::to_string(set.id) : set.name; }

const SideSet& sideSetOf(const Mesh& mesh, const std::string& sideSet) {
  const int position = findSideSet(mesh, sideSet);
  HAPTOS_REFUSE_IF(position < 0,
                   "There is no side set '" << sideSet << "'; the mesh has: " << listSideSets(mesh) << ".");
  const SideSet& set = mesh.sideSets[std::size_t(position)];
  HAPTOS_REFUSE_IF(set.sides.empty(),
                   "Side set '" << sideSet << "' is empty; a contact surface needs at least one face.");
  return set;
}

// Faces, then what their nodes have of them: normals weighted by angles, which do not depend on how a face is cut, areas, sizes.
ContactSurface surfaceOfSides(const Mesh& mesh, const std::string& name, const std::vector<ElementSide>& sides) {
  ContactSurface surface;
  surface.name = name;
  setTopology(mesh, collectFaces(mesh, name, sides), surface);
  setFacetNormals(mesh, sides, surface);
  accumulateNodalData(surface);
  normalizeNormals(mesh, surface);
  setTurns(surface);
  return surface;
}

// [faces] mean over their facets
std::vector<Vec3::Array> faceNormals(const ContactSurface& surface) {
  std::vector<Vec3::Array> normals(surface.faces.size(), Vec3::Array{});
  for (std::size_t f = 0; f < surface.numFacets(); ++f) {
    auto& normal = normals[std::size_t(surface.faceOfFacet[f])];
    normal = Vec3::add(normal, surface.facetNormals[f]);
  }
  for (auto& normal : normals) normal = Vec3::normalized(normal);
  return normals;
}

// [faces] number of the patch; faces with a common edge belong together unless the surface turns there by more than 40 degrees
std::vector<int> patchesOfFaces(const ContactSurface& surface, int& count) {
  std::map<std::pair<int, int>, std::vector<int>> facesAt;  // edges
  for (int f = 0; f < int(surface.faces.size()); ++f) {
    const SurfaceFace& face = surface.faces[std::size_t(f)];
    for (int i = 0; i < numCorners(face.size); ++i)
      facesAt[std::minmax(face.nodes[std::size_t(i)], face.nodes[std::size_t((i + 1) % numCorners(face.size))])].push_back(f);
  }
  const auto normals = faceNormals(surface);
  DisjointSets smooth(surface.faces.size());
  std::vector<std::pair<int, int>> creases;
  for (const auto& [edge, faces] : facesAt)
    for (std::size_t i = 1; i < faces.size(); ++i) {
      const bool isSmooth = Vec3::dot(normals[std::size_t(faces[0])], normals[std::size_t(faces[i])]) > creaseCosine;
      if (isSmooth) smooth.join(faces[0], faces[i]);
      else creases.emplace_back(faces[0], faces[i]);
    }
  const bool isCut = std::any_of(creases.begin(), creases.end(), [&](const auto& c) { return smooth.lowest(c.first) != smooth.lowest(c.second); });
  if (isCut) return smooth.numbered(count);
  count = 1;
  return std::vector<int>(surface.faces.size(), 0);
}

}  // namespace

std::vector<std::array<int, 4>> facetsOfShape(int numNodes) {
  switch (numNodes) {
    case 6: return {{0, 3, 5, -1}, {3, 1, 4, -1}, {5, 4, 2, -1}, {3, 4, 5, -1}};
    case 8: return {{0, 4, 7, -1}, {4, 1, 5, -1}, {5, 2, 6, -1}, {7, 6, 3, -1}, {4, 5, 6, 7}};
    case 9: return {{0, 4, 8, 7}, {4, 1, 5, 8}, {8, 5, 2, 6}, {7, 8, 6, 3}};
    default: return {{0, 1, 2, numNodes == 4 ? 3 : -1}};
  }
}

// Faces, then what their nodes have of them: normals weighted by angles, which do not depend on how a face is cut, areas, sizes.
ContactSurface makeContactSurface(const Mesh& mesh, const std::string& sideSet) {
  const SideSet& set = sideSetOf(mesh, sideSet);
  return surfaceOfSides(mesh, nameOf(set), sortedSides(mesh, set, nameOf(set)));
}

ContactSurface facesTowards(const Mesh& mesh, const std::string& sideSet, const ContactSurface& whole, const std::array<double, 3>& direction) {
  constexpr double kSideways = 1e-6;
  const auto sides = sortedSides(mesh, sideSetOf(mesh, sideSet), whole.name);
  const auto normals = faceNormals(whole);
  const auto towards = Vec3::normalized(direction);
  std::vector<ElementSide> kept;
  for (std::size_t f = 0; f < sides.size(); ++f)
    if (Vec3::dot(normals[f], towards) > kSideways) kept.push_back(sides[f]);
  if (kept.size() == sides.size()) return whole;
  if (!kept.empty()) return surfaceOfSides(mesh, whole.name, kept);
  ContactSurface none;
  none.name = whole.name;
  return none;
}

std::vector<double> areasOnFacets(const ContactSurface& surface, const std::vector<char>& counts) {
  std::vector<double> areas(surface.numNodes(), 0.0);
  for (std::size_t f = 0; f < surface.numFacets(); ++f) {
    if (!counts[f]) continue;
    const auto ofCorners = facetAreas(cornersOf(surface, int(f)), surface.facetSize(int(f)));
    for (int i = 0; i < surface.facetSize(int(f)); ++i) areas[std::size_t(surface.facets[f][std::size_t(i)])] += ofCorners[std::size_t(i)];
  }
  return areas;
}

bool isCreased(const ContactSurface& surface) {
  int count = 0;
  patchesOfFaces(surface, count);
  return count > 1;
}

// A crease that ends within the surface cuts nothing; without one the surface stays whole, in however many parts it lies.
std::vector<ContactSurface> smoothPatches(const Mesh& mesh, const std::string& sideSet) {
  const SideSet& set = sideSetOf(mesh, sideSet);
  const auto sides = sortedSides(mesh, set, nameOf(set));
  int count = 0;
  const auto patchOf = patchesOfFaces(surfaceOfSides(mesh, nameOf(set), sides), count);
  std::vector<std::vector<ElementSide>> parts(static_cast<std::size_t>(count));
  for (std::size_t f = 0; f < sides.size(); ++f) parts[std::size_t(patchOf[f])].push_back(sides[f]);
  std::vector<ContactSurface> patches;
  for (const auto& part : parts) patches.push_back(surfaceOfSides(mesh, nameOf(set), part));
  return patches;
}

}  // namespace Haptos
