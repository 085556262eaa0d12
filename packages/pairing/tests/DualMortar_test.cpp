// SPDX-License-Identifier: BSD-3-Clause
// Rows of dual mortar between stacked boxes that are meshed apart: sums, balance, matching meshes, dense quadrature.
#include "Haptos_DualMortar.hpp"

#include <Eigen/Dense>
#include <Teuchos_UnitTestHarness.hpp>
#include <map>

#include "ContactScenes.hpp"
#include "Haptos_FaceShapes.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Scenes;

struct Mortar {
  ContactSurface secondary, primary;
  SurfaceOverlap overlap;
  std::vector<MortarRow> rows;

  explicit Mortar(const Mesh& mesh, const std::string& upper = "upper_contact", const std::string& lower = "lower_contact")
      : secondary(makeContactSurface(mesh, upper)), primary(makeContactSurface(mesh, lower)), overlap(integrateOverlap(secondary, primary)) {
    rows = dualMortarRows(secondary, primary, overlap, chooseMultipliers(secondary, overlap, std::vector<Bar>(secondary.numNodes(), Bar::None)));
  }
};

// Moves inner nodes of [0,2] x [0,1] sideways.
std::function<Point(const Point&)> distort(double by, double phase) {
  return [=](const Point& x) {
    const double bubble = by * x[0] * (2 - x[0]) * x[1] * (1 - x[1]) * 4;
    return Point{x[0] + bubble * std::sin(9 * x[1] + phase), x[1] + bubble * std::cos(7 * x[0] + phase), x[2]};
  };
}

// Different divisions and distortions on either side.
Stack apart(Topology lower, Topology upper) {
  Stack stack;
  stack.lowerDivisions = {5, 3, 1};
  stack.upperDivisions = {7, 4, 1};
  stack.lowerTopology = lower;
  stack.upperTopology = upper;
  stack.lowerMap = distort(0.1, 0.3);
  stack.upperMap = distort(0.08, 1.1);
  return stack;
}

Point moment(const ContactSurface& surface, const std::vector<std::pair<int, double>>& weights) {
  Point sum{};
  for (const auto& [node, weight] : weights) sum = Vec3::add(sum, Vec3::scale(weight, surface.coordinates[std::size_t(node)]));
  return sum;
}

double sumOf(const std::vector<std::pair<int, double>>& weights) {
  double sum = 0;
  for (const auto& item : weights) sum += item.second;
  return sum;
}

// Forces balance by the sums, moments by the first moments, as the surfaces touch.
TEUCHOS_UNIT_TEST(DualMortar, rows_between_plane_surfaces_meshed_apart) {
  for (const Topology lower : {Topology::Hex8, Topology::Tet4})
    for (const Topology upper : {Topology::Hex8, Topology::Tet4}) {
      const auto rotation = randomRotation(3);
      const Mortar mortar(turned(makeStack(apart(lower, upper)), rotation));
      TEST_EQUALITY(mortar.rows.size(), mortar.secondary.numNodes());
      double area = 0;
      for (const MortarRow& row : mortar.rows) {
        area += row.w;
        TEST_COMPARE(std::abs(sumOf(row.secondary) - 1), <=, 1e-12);
        TEST_COMPARE(std::abs(sumOf(row.primary) - 1), <=, 1e-12);
        TEST_COMPARE(distance(moment(mortar.secondary, row.secondary), moment(mortar.primary, row.primary)), <=, 1e-9);
        TEST_COMPARE(std::abs(row.w - mortar.secondary.areas[std::size_t(row.node)]), <=, 1e-9);
        for (const auto& [node, weight] : row.secondary) TEST_COMPARE(std::abs(weight - (node == row.node)), <=, 1e-11);
        TEST_COMPARE(Vec3::norm(row.gap), <=, 1e-12);
      }
      TEST_FLOATING_EQUALITY(area, 2.0, 1e-9);
    }
}

// Parallelograms and triangles: the rule with 7 points is exact, so everything holds to round-off.
TEUCHOS_UNIT_TEST(DualMortar, seven_points_are_exact_where_maps_are_affine) {
  Stack stack = apart(Topology::Tet4, Topology::Hex8);
  stack.upperMap = [](const Point& x) { return Point{x[0], x[1], x[2]}; };
  const Mortar mortar(makeStack(stack));
  for (const MortarRow& row : mortar.rows)
    TEST_COMPARE(distance(moment(mortar.secondary, row.secondary), moment(mortar.primary, row.primary)), <=, 1e-13);
}

TEUCHOS_UNIT_TEST(DualMortar, matching_meshes_give_node_to_node) {
  for (const Topology topology : {Topology::Hex8, Topology::Tet4})
    for (const bool isBent : {false, true}) {
      Stack stack;
      stack.lowerTopology = stack.upperTopology = topology;
      stack.lowerMap = stack.upperMap = [isBent](const Point& x) {
        const Point y = distort(0.1, 0.5)(x);
        return isBent ? bend(2.5)(y) : y;
      };
      const Mesh mesh = turned(makeStack(stack), randomRotation(11));
      ContactSpec spec = contact();
      const auto nodal = buildContact(mesh, {spec})[0];
      spec.discretization = Discretization::Mortar;
      spec.sides = ContactSides::AsGiven;
      const auto mortar = buildContact(mesh, {spec})[0];
      TEST_ASSERT(mortar.isMortar && !nodal.isMortar);
      TEST_EQUALITY(mortar.pairs.size(), nodal.pairs.size());
      for (std::size_t i = 0; i < std::min(nodal.pairs.size(), mortar.pairs.size()); ++i) {
        const ContactPair &a = nodal.pairs[i], &b = mortar.pairs[i];
        TEST_EQUALITY(a.secondaryNode, b.secondaryNode);
        TEST_COMPARE(distance(a.frame.normal, b.frame.normal) + std::abs(a.gap - b.gap), <=, 1e-12);
        TEST_COMPARE(std::abs(a.area - b.area), <=, isBent && topology == Topology::Hex8 ? 1e-4 : 1e-9);  // 2 x 2 points on warped faces
        for (const auto& [node, weight] : b.secondary) TEST_COMPARE(std::abs(weight - (node == a.secondaryNode)), <=, 1e-12);
        for (const auto& [node, weight] : b.primary) TEST_COMPARE(std::abs(weight - (node == a.primary[0].node)), <=, 1e-12);
      }
    }
}

// Independent: a fine grid of points on every secondary face, each followed along the normal of its face's middle to the primary
// surface by bisecting faces, instead of polygons and Newton's method.
struct DenseQuadrature {
  const ContactSurface &s, &p;
  std::map<std::pair<int, int>, double> across;  // (secondary node, primary node) -> int phi N_p
  std::vector<double> w;

  static constexpr int kGrid = 60;

  Point place(const ContactSurface& surface, const SurfaceFace& face, const Point2& at) const {
    const auto v = faceValues(face.size, at);
    Point x{};
    for (int i = 0; i < face.size; ++i)
      x = Vec3::add(x, Vec3::scale(v.N[std::size_t(i)], surface.coordinates[std::size_t(face.nodes[std::size_t(i)])]));
    return x;
  }

  // Least distance from the line over a square of the face, on ever smaller squares.
  std::pair<double, Point2> nearest(const SurfaceFace& face, const Point& x, const Point& n) const {
    Point2 middle{0, 0};
    double best = 1e300;
    for (double half = 1; half > 1e-7; half *= 0.7) {
      Point2 next = middle;
      for (double a = -1; a <= 1; a += 0.5)
        for (double b = -1; b <= 1; b += 0.5) {
          const Point2 at = {std::max(-1.0, std::min(1.0, middle[0] + a * half)), std::max(-1.0, std::min(1.0, middle[1] + b * half))};
          const double d = Vec3::distanceFromLine(Vec3::subtract(place(p, face, at), x), n);
          if (d < best) best = d, next = at;
        }
      middle = next;
    }
    return {best, middle};
  }

  DenseQuadrature(const ContactSurface& secondary, const ContactSurface& primary, int f) : s(secondary), p(primary), w(secondary.numNodes(), 0.0) {
    const SurfaceFace& face = s.faces[std::size_t(f)];
    const Point n = s.facetNormals[std::size_t(f)];
    Eigen::Matrix4d M = Eigen::Matrix4d::Zero();
    std::map<int, Eigen::Vector4d> X;
    for (int i = 0; i < kGrid; ++i)
      for (int j = 0; j < kGrid; ++j) {
        const Point2 at = {(2 * i + 1.0) / kGrid - 1, (2 * j + 1.0) / kGrid - 1};
        const auto v = faceValues(4, at);
        Point a{}, b{};
        for (std::size_t k = 0; k < 4; ++k) {
          a = Vec3::add(a, Vec3::scale(v.dXi[k], s.coordinates[std::size_t(face.nodes[k])]));
          b = Vec3::add(b, Vec3::scale(v.dEta[k], s.coordinates[std::size_t(face.nodes[k])]));
        }
        const double dA = 4.0 / (kGrid * kGrid) * Vec3::norm(Vec3::cross(a, b));
        const Eigen::Vector4d N(v.N[0], v.N[1], v.N[2], v.N[3]);
        M += dA * N * N.transpose();
        const Point x = place(s, face, at);
        std::pair<double, Point2> best{1e300, {}};
        const SurfaceFace* where = nullptr;
        for (const auto& other : p.faces) {
          const auto found = nearest(other, x, n);
          if (found.first < best.first) best = found, where = &other;
        }
        const auto u = faceValues(4, best.second);
        for (std::size_t k = 0; k < 4; ++k) X.emplace(where->nodes[k], Eigen::Vector4d::Zero()).first->second += dA * u.N[k] * N;
      }
    const Eigen::Vector4d d = M.rowwise().sum();
    const Eigen::Matrix4d A = Eigen::Matrix4d(d.asDiagonal()) * M.inverse();
    for (const auto& [node, x] : X) {
      const Eigen::Vector4d phi = A * x;
      for (int k = 0; k < 4; ++k) across[{face.nodes[std::size_t(k)], node}] += phi[k];
    }
    for (int k = 0; k < 4; ++k) w[std::size_t(face.nodes[std::size_t(k)])] += d[k];
  }
};

// One secondary face over a few primary ones, both bent and warped, some way apart.
TEUCHOS_UNIT_TEST(DualMortar, curved_faces_against_dense_quadrature) {
  Stack stack;
  stack.lowerDivisions = {3, 2, 1};
  stack.upperDivisions = {1, 1, 1};
  stack.lowerFrom = {-0.4, -0.4, -1};
  stack.lowerTo = {1.4, 1.4, 0};
  stack.upperTo = {1, 1, 1};
  const auto wave = [](const Point& x) { return Point{x[0], x[1], x[2] + 0.1 * std::sin(2 * x[0] + x[1]) + 0.08 * x[0] * x[1]}; };
  stack.lowerMap = [&](const Point& x) { return wave({x[0] + 0.1 * x[1] * x[0], x[1] - 0.07 * x[0] * x[1], x[2]}); };
  stack.upperMap = [&](const Point& x) { return wave({x[0] + 0.13 * x[1], x[1] + 0.1 * x[0] * x[1], x[2] + 0.05}); };
  const Mortar mortar(makeStack(stack));
  const DenseQuadrature dense(mortar.secondary, mortar.primary, 0);
  TEST_EQUALITY(mortar.rows.size(), 4u);
  TEST_COMPARE(mortar.rows[0].primary.size(), >=, 6u);
  for (const MortarRow& row : mortar.rows) {
    TEST_COMPARE(std::abs(row.w - dense.w[std::size_t(row.node)]), <=, 1e-3 * row.w);
    for (const auto& [node, weight] : row.primary) {
      const auto found = dense.across.find({row.node, node});
      TEST_COMPARE(std::abs(weight - (found == dense.across.end() ? 0.0 : found->second / row.w)), <=, 2e-3);
    }
  }
}

// Real coverage ends inside faces: rows stay bounded, no weight is tiny, nodes beyond have none.
TEUCHOS_UNIT_TEST(DualMortar, partly_covered_faces) {
  for (const double beyond : {1e-9, 0.003, 0.05, 0.11, 0.2, 0.27}) {
    Stack stack = apart(Topology::Hex8, Topology::Hex8);
    stack.upperFrom = {-beyond, 0.1, 0};
    stack.upperTo = {2 + beyond, 0.9, 1};
    stack.upperMap = nullptr;
    const Mortar mortar(makeStack(stack));
    double area = 0, largest = 0, smallest = 1e300;
    for (const MortarRow& row : mortar.rows) {
      double norm = 0;
      for (const auto& item : row.secondary) norm += item.second * item.second;
      largest = std::max(largest, std::sqrt(norm));
      smallest = std::min(smallest, row.w / mortar.secondary.areas[std::size_t(row.node)]);
      area += row.w;
      TEST_COMPARE(std::abs(sumOf(row.secondary) - 1), <=, 1e-11);
      TEST_COMPARE(distance(moment(mortar.secondary, row.secondary), moment(mortar.primary, row.primary)), <=, 1e-9);
    }
    TEST_FLOATING_EQUALITY(area, 2 * 0.8, 1e-8);
    TEST_COMPARE(largest, <=, 1.5);
    TEST_COMPARE(smallest, >=, 0.3);
    const bool losesColumns = beyond > 0.05 * 2.5 / 7;  // nodes farther out than their faces' tolerance
    TEST_EQUALITY(mortar.rows.size() < mortar.secondary.numNodes(), losesColumns);
  }
}

// A strip narrower than a face, along its middle, covers no node: one of them stands for the face.
TEUCHOS_UNIT_TEST(DualMortar, a_face_that_is_covered_in_the_middle_has_a_multiplier) {
  Stack stack;
  stack.upperDivisions = {1, 1, 1};
  stack.lowerDivisions = {3, 1, 1};
  stack.lowerFrom = {0.9, 0.3, -1};
  stack.lowerTo = {1.2, 0.7, 0};
  const Mortar mortar(makeStack(stack));
  TEST_EQUALITY(mortar.rows.size(), 1u);
  TEST_FLOATING_EQUALITY(mortar.rows[0].w, 0.3 * 0.4, 1e-12);
  TEST_COMPARE(distance(moment(mortar.secondary, mortar.rows[0].secondary), moment(mortar.primary, mortar.rows[0].primary)), <=, 1e-13);
}

// Of two layers that look the same way, the nearer one counts.
TEUCHOS_UNIT_TEST(DualMortar, the_nearer_of_two_layers_counts) {
  Stack stack = apart(Topology::Hex8, Topology::Hex8);
  Mesh mesh = makeStack(stack);
  BoxSpec far;
  far.blockName = "far";
  far.lower = {0, 0, -4};
  far.upper = {2, 1, -3};
  far.divisions = {2, 2, 1};
  far.sideSetNames = {"", "", "", "", "", "lower_contact"};
  BoxSpec lower, upper = far;
  lower.lower = {0, 0, -1};
  lower.upper = {2, 1, 0};
  lower.divisions = {5, 3, 1};
  lower.blockName = "lower";
  lower.sideSetNames = {"", "", "", "", "", "lower_contact"};
  upper.lower = {0, 0, 0};
  upper.upper = {2, 1, 1};
  upper.divisions = {7, 4, 1};
  upper.blockName = "upper";
  upper.sideSetNames = {"", "", "", "", "upper_contact", ""};
  const Mortar mortar(makeBoxes({far, lower, upper}));
  double area = 0;
  for (const MortarRow& row : mortar.rows) {
    area += row.w;
    for (const auto& [node, weight] : row.primary) TEST_COMPARE(mortar.primary.coordinates[std::size_t(node)][2], >, -1.0);
  }
  TEST_FLOATING_EQUALITY(area, 2.0, 1e-12);
}

}  // namespace
