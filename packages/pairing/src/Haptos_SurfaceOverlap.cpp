// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SurfaceOverlap.hpp"

#include <algorithm>
#include <cmath>

#include "Haptos_ConvexPolygon.hpp"
#include "Haptos_FacetTree.hpp"
#include "Haptos_InputCheck.hpp"
#include "Haptos_ProjectedFace.hpp"
#include "Haptos_TriangleRule.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

constexpr double kOverlapping = 0.02;  // of the facet's area: more that is covered twice comes from layers

struct Segment {
  int facet;  // of the primary surface
  Polygon polygon;
  double distance;  // of the facets, along the plane's normal
};

// By the inverse of the face's own map along the plane's normal: the point that the clipped polygon stands for.
FaceValues valuesAt(const ProjectedFace& face, const Point2& x) {
  const auto point = face.pointAt(x);
  HAPTOS_REFUSE_IF(!point, "Side set '" << face.surface.name << "': a face near (" << face.at(0)[0] << ", " << face.at(0)[1] << ", "
                                        << face.at(0)[2] << ") is too distorted for mortar contact; mesh the surface anew there.");
  return faceValues(face.face.size, *point);
}

// Triangles from a corner, or smaller ones from the middle.
std::vector<Polygon> fanOf(const Polygon& polygon, bool fromMiddle) {
  std::vector<Polygon> fan;
  const Point2 apex = fromMiddle ? centroidOf(polygon) : polygon[0];
  const std::size_t first = fromMiddle ? 0 : 1, last = polygon.size() - first;
  for (std::size_t i = first; i < last; ++i) fan.push_back({apex, polygon[i], polygon[(i + 1) % polygon.size()]});
  return fan;
}

class Overlap {
 public:
  enum class Rule { Exact, Middle };
  Overlap(const ContactSurface& secondary, const ContactSurface& primary, const FacetTree& tree, Rule rule = Rule::Exact)
      : s_(secondary), p_(primary), tree_(tree), rule_(rule) {}

  SurfaceOverlap run() {
    result_ = wholeSurface(s_);
    result_.isCovered.assign(s_.numNodes(), 0);
    for (std::size_t f = 0; f < s_.faces.size(); ++f) result_.faces[f] = FaceIntegrals(s_.faces[f].size);
    for (int f = 0; f < int(s_.numFacets()); ++f) cutFacet(f);
    return std::move(result_);
  }

 private:
  static Polygon projected(const ContactSurface& surface, int facet, const ProjectionPlane& plane) {
    Polygon polygon;
    for (int i = 0; i < surface.facetSize(facet); ++i)
      polygon.push_back(plane.project(surface.coordinates[std::size_t(surface.facets[std::size_t(facet)][std::size_t(i)])]));
    return polygon;
  }

  void cutFacet(int facet);
  std::vector<Segment> findSegments(int facet, const ProjectionPlane& plane, const Polygon& own, double size);
  void dropFartherLayers(std::vector<Segment>& segments, double area, double size) const;
  double distanceTo(int facet, const ProjectionPlane& plane, const Point2& at) const;
  void markCovered(int facet, const Polygon& own, const Polygon& other, double size);
  void integrate(int facet, const Segment& segment, const ProjectionPlane& plane, double size);
  void addPoint(const ProjectedFace& own, const ProjectedFace& other, const ProjectionPlane& plane, const Point2& x, double weight, FaceIntegrals& sums,
                Eigen::MatrixXd& across) const;

  const ContactSurface &s_, &p_;
  const FacetTree& tree_;
  Rule rule_;
  std::vector<int> found_;
  SurfaceOverlap result_;
};

void Overlap::cutFacet(int facet) {
  Vec3::Array middle{};
  const int corners = s_.facetSize(facet);
  const auto corner = [&](int i) -> const Vec3::Array& {
    return s_.coordinates[std::size_t(s_.facets[std::size_t(facet)][std::size_t(i)])];
  };
  for (int i = 0; i < corners; ++i) middle = Vec3::add(middle, Vec3::scale(1.0 / corners, corner(i)));
  double size = 0;
  for (int i = 0; i < corners; ++i) size = std::max(size, 2 * Vec3::norm(Vec3::subtract(corner(i), middle)));
  // Of the face itself, not a mean of nodal normals: these tilt at free edges of curved surfaces, and uniform pressure is lost there.
  const ProjectionPlane plane(middle, s_.facetNormals[std::size_t(facet)]);
  const Polygon own = projected(s_, facet, plane);
  for (const Segment& segment : findSegments(facet, plane, own, size)) {
    markCovered(facet, own, projected(p_, segment.facet, plane), size);
    integrate(facet, segment, plane, size);
  }
}

std::vector<Segment> Overlap::findSegments(int facet, const ProjectionPlane& plane, const Polygon& own, double size) {
  tree_.facetsNearLine(plane.origin, plane.normal, found_, 0.5 * size);
  // The tree's order depends on how it was built; sums must not.
  std::sort(found_.begin(), found_.end());
  std::vector<Segment> segments;
  const double whole = areaOf(own);
  for (const int other : found_) {
    if (Vec3::dot(plane.normal, p_.facetNormals[std::size_t(other)]) >= opposing) continue;
    Polygon window = projected(p_, other, plane);
    // Seen from the secondary side the primary facet runs clockwise.
    std::reverse(window.begin(), window.end());
    Polygon piece = clipped(own, window, roundOff * size);
    if (piece.empty() || areaOf(piece) <= roundOff * whole) continue;
    const double distance = distanceTo(other, plane, centroidOf(piece));
    segments.push_back({other, std::move(piece), distance});
  }
  dropFartherLayers(segments, whole, size);
  return segments;
}

// A surface that is met several times along the normal: what lies nearer hides the rest.
void Overlap::dropFartherLayers(std::vector<Segment>& segments, double area, double size) const {
  double covered = 0;
  for (const Segment& segment : segments) covered += areaOf(segment.polygon);
  // Mostly one layer: then nothing is compared with anything.
  if (covered <= (1 + kOverlapping) * area) return;
  const auto order = [](const Segment& a, const Segment& b) {
    return std::make_pair(std::abs(a.distance), a.facet) < std::make_pair(std::abs(b.distance), b.facet);
  };
  std::sort(segments.begin(), segments.end(), order);
  std::vector<Segment> kept;
  for (Segment& segment : segments) {
    const bool isHidden = std::any_of(kept.begin(), kept.end(), [&](const Segment& nearer) {
      const Polygon common = clipped(segment.polygon, nearer.polygon, roundOff * size);
      return areaOf(common) > kOverlapping * std::min(areaOf(segment.polygon), areaOf(nearer.polygon));
    });
    if (!isHidden) kept.push_back(std::move(segment));
  }
  segments = std::move(kept);
}

// From the plane to a primary facet, along the plane's normal.
double Overlap::distanceTo(int facet, const ProjectionPlane& plane, const Point2& at) const {
  const auto x = Vec3::add(plane.origin, Vec3::add(Vec3::scale(at[0], plane.e1), Vec3::scale(at[1], plane.e2)));
  const auto& normal = p_.facetNormals[std::size_t(facet)];
  const auto& corner = p_.coordinates[std::size_t(p_.facets[std::size_t(facet)][0])];
  return Vec3::dot(Vec3::subtract(corner, x), normal) / Vec3::dot(plane.normal, normal);
}

// A node has a multiplier where it lies opposite a facet, whatever the integrals around it: its gap is measured there.
void Overlap::markCovered(int facet, const Polygon& own, const Polygon& other, double size) {
  const Polygon window(other.rbegin(), other.rend());
  for (std::size_t i = 0; i < own.size(); ++i)
    if (distanceFrom(window, own[i]) <= besideFace * size) result_.isCovered[std::size_t(s_.facets[std::size_t(facet)][i])] = 1;
}

void Overlap::integrate(int facet, const Segment& segment, const ProjectionPlane& plane, double size) {
  const int face = s_.faceOfFacet[std::size_t(facet)], otherFace = p_.faceOfFacet[std::size_t(segment.facet)];
  const ProjectedFace own(s_, face, plane), other(p_, otherFace, plane);
  FaceIntegrals& sums = result_.faces[std::size_t(face)];
  auto known = std::find_if(sums.across.begin(), sums.across.end(), [&](const auto& item) { return item.first == otherFace; });
  if (known == sums.across.end())
    known = sums.across.insert(sums.across.end(), {otherFace, Eigen::MatrixXd::Zero(own.face.size, other.face.size)});
  if (rule_ == Rule::Middle) return addPoint(own, other, plane, centroidOf(segment.polygon), areaOf(segment.polygon), sums, known->second);
  const bool areTriangles = isTriangle(own.face.size) && isTriangle(other.face.size);
  // Products of degree 4, or edges that are bent: cutting along chords leaves out far more than seven points do.  The inverse of a bilinear map is
  // no polynomial: see real distorted quadrilaterals in decisions/031.
  const bool isEasy = areTriangles || (own.isAffine(size) && other.isAffine(size));
  const auto& rule = isEasy ? sevenPoints() : own.isSkew() || other.isSkew() ? sixtyFourPoints() : thirtySixPoints();
  for (const Polygon& triangle : fanOf(segment.polygon, !isEasy)) {
    const double area = areaOf(triangle);
    if (!(area > 0)) continue;
    for (const TrianglePoint& point : rule) {
      Point2 x{0, 0};
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t c = 0; c < 2; ++c) x[c] += point.shares[k] * triangle[k][c];
      addPoint(own, other, plane, x, point.weight * area, sums, known->second);
    }
  }
}

// dA of the face itself is |a| / |a . n| of the plane's, a = x,xi x x,eta.
void Overlap::addPoint(const ProjectedFace& own, const ProjectedFace& other, const ProjectionPlane& plane, const Point2& x, double weight,
                       FaceIntegrals& sums, Eigen::MatrixXd& across) const {
  const FaceValues v = valuesAt(own, x), w = valuesAt(other, x);
  const auto normal = Vec3::cross(own.sum(v.dXi), own.sum(v.dEta));
  const double dA = weight * Vec3::norm(normal) / std::abs(Vec3::dot(normal, plane.normal));
  const Eigen::Map<const Eigen::VectorXd> N(v.N.data(), own.face.size), Np(w.N.data(), other.face.size);
  const auto gap = Vec3::subtract(other.sum(w.N), own.sum(v.N));
  sums.add(v, dA);
  // int N (x_p - x_s): weighted with the dual functions later, where rows take gaps from integrals.
  sums.gap += dA * N * Eigen::Map<const Eigen::RowVector3d>(gap.data());
  across += dA * N * Np.transpose();
}

}  // namespace

FaceIntegrals::FaceIntegrals(int size)
    : d(Eigen::VectorXd::Zero(size)), M(Eigen::MatrixXd::Zero(size, size)), gap(Eigen::MatrixXd::Zero(size, 3)) {}

void FaceIntegrals::add(const FaceValues& values, double dA) {
  const Eigen::Map<const Eigen::VectorXd> N(values.N.data(), d.size());
  area += dA;
  d += dA * N;
  M += dA * N * N.transpose();
}

// Squares as two triangles.
SurfaceOverlap wholeSurface(const ContactSurface& surface) {
  SurfaceOverlap result;
  result.isCovered.assign(surface.numNodes(), 1);
  for (const SurfaceFace& face : surface.faces) {
    FaceIntegrals& sums = result.faces.emplace_back(face.size);
    for (int half = 0; half < numCorners(face.size) - 2; ++half)
      for (const TrianglePoint& point : thirtySixPoints()) {
        const int corners[3] = {0, half + 1, half + 2};
        Point2 at{0, 0};
        for (int k = 0; k < 3; ++k)
          for (std::size_t c = 0; c < 2; ++c) at[c] += point.shares[std::size_t(k)] * nodeOfFace(face.size, corners[k])[c];
        const FaceValues v = faceValues(face.size, at);
        Vec3::Array a{}, b{};
        for (std::size_t k = 0; k < std::size_t(face.size); ++k) {
          a = Vec3::add(a, Vec3::scale(v.dXi[k], surface.coordinates[std::size_t(face.nodes[k])]));
          b = Vec3::add(b, Vec3::scale(v.dEta[k], surface.coordinates[std::size_t(face.nodes[k])]));
        }
        const double reference = isTriangle(face.size) ? 0.5 : 2;
        sums.add(v, reference * point.weight * Vec3::norm(Vec3::cross(a, b)));
      }
    result.areas.push_back(sums.area);
  }
  return result;
}

SurfaceOverlap integrateOverlap(const ContactSurface& secondary, const ContactSurface& primary, const FacetTree& tree) {
  return Overlap(secondary, primary, tree).run();
}

SurfaceOverlap roughOverlap(const ContactSurface& secondary, const ContactSurface& primary) {
  return Overlap(secondary, primary, FacetTree(primary), Overlap::Rule::Middle).run();
}

SurfaceOverlap integrateOverlap(const ContactSurface& secondary, const ContactSurface& primary) {
  return integrateOverlap(secondary, primary, FacetTree(primary));
}

}  // namespace Haptos
