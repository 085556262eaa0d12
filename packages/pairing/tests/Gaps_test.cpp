// SPDX-License-Identifier: BSD-3-Clause
// Gaps as the user wants them, and of curved surfaces that are meshed with facets.
#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>

#include "ContactScenes.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_NagataSurface.hpp"
#include "Haptos_RoundSurface.hpp"

using namespace Haptos;
using namespace Haptos::Scenes;

namespace {

ContactSpec spec(PrimarySmoothing smoothing) {
  ContactSpec result;
  result.name = "joint";
  result.secondarySideSet = "upper_contact";
  result.primarySideSet = "lower_contact";
  result.discretization = Discretization::Mortar;
  result.sides = ContactSides::AsGiven;
  result.smoothing = smoothing;
  return result;
}

// A pin of radius 1 in a hole of radius 1, the hole's nodes opposite the middles of the pin's facets.
Mesh pinInHole(int n) {
  Stack stack;
  const double h = 2.0 / n;
  stack.lowerDivisions = stack.upperDivisions = {n, 3, 1};
  stack.lowerFrom = {-1, 0, -0.5};
  stack.lowerTo = {1, 1, 0};
  stack.upperFrom = {-1 + h / 2, 0, 0};
  stack.upperTo = {1 + h / 2, 1, 0.5};
  stack.lowerMap = stack.upperMap = bend(1.0);
  return makeStack(stack);
}

std::vector<ContactPair> pairsWithGaps(const Mesh& mesh, const ContactSpec& contact) { return buildContact(mesh, {contact})[0].pairs; }

// Gaps away from the ends of the arcs.
std::vector<double> gapsInside(const Mesh& mesh, const ContactSpec& contact) {
  std::vector<double> gaps;
  for (const auto& pair : pairsWithGaps(mesh, contact))
    if (std::abs(mesh.coordinates[std::size_t(pair.secondaryNode)][0]) < 0.5) gaps.push_back(pair.gap);
  return gaps;
}

double largest(const std::vector<double>& gaps) {
  double result = 0;
  for (const double gap : gaps) result = std::max(result, std::abs(gap));
  return result;
}

}  // namespace

// ANALYTIC: a chord lies 1 - cos(h/2) inside the circle, the parabola with its tangents (h/2)^4 / 8 outside.
TEUCHOS_UNIT_TEST(Gaps, FacetsOfAPinInAHole) {
  double before = 0;
  for (const int n : {8, 16, 32}) {
    const Mesh mesh = pinInHole(n);
    const double theta = 1.0 / n;
    const auto facets = gapsInside(mesh, spec(PrimarySmoothing::None));
    TEST_COMPARE(facets.size(), >, std::size_t(n));
    for (const double gap : facets) TEST_COMPARE(std::abs(gap - (1 - std::cos(theta))), <, 1e-13);
    TEST_COMPARE(largest(gapsInside(mesh, spec(PrimarySmoothing::Cylinder))), <, 1e-13);
    const double patches = largest(gapsInside(mesh, spec(PrimarySmoothing::Nagata)));
    TEST_FLOATING_EQUALITY(patches, std::pow(theta, 4) / 8, 0.02);
    if (before > 0) TEST_COMPARE(std::log2(before / patches), >, 3.95);
    before = patches;
  }
}

TEUCHOS_UNIT_TEST(Gaps, FacetsOfABallInItsSocket) {
  Stack stack;
  stack.lowerDivisions = {6, 6, 1};
  stack.upperDivisions = {7, 5, 1};
  stack.lowerFrom = stack.upperFrom = {-1, -1, 0};
  stack.lowerFrom[2] = -0.5;
  stack.lowerTo = {1, 1, 0};
  stack.upperTo = {1, 1, 0.5};
  stack.lowerMap = stack.upperMap = [](const Point& x) {  // on the ball of radius 3 about (5, 0, 0)
    return Vec3::add({5, 0, 0}, Vec3::scale(3 + x[2], Vec3::normalized({0.4 * x[0], 0.4 * x[1], 1})));
  };
  for (const auto topology : {Topology::Hex8, Topology::Tet4}) {
    stack.lowerTopology = topology;
    const Mesh mesh = makeStack(stack);
    ContactSpec contact = spec(PrimarySmoothing::None);
    const auto gapOf = [&](PrimarySmoothing smoothing) {
      contact.smoothing = smoothing;
      double result = 0;
      for (const auto& pair : pairsWithGaps(mesh, contact)) result = std::max(result, std::abs(pair.gap));
      return result;
    };
    const double facets = gapOf(PrimarySmoothing::None);
    TEST_COMPARE(facets, >, 1e-3);
    TEST_COMPARE(gapOf(PrimarySmoothing::Sphere), <, 1e-12);
    TEST_COMPARE(gapOf(PrimarySmoothing::Nagata), <, 0.6 * facets);  // normals at its edge are those of single faces
    TEST_THROW(gapOf(PrimarySmoothing::Cylinder), InputError);
  }
}

TEUCHOS_UNIT_TEST(Gaps, FitsFindWhatNodesLieOn) {
  const auto turn = bend(2.5);
  Stack stack;
  stack.lowerMap = [&](const Point& x) {
    const Point y = turn(x);
    return Point{y[1] + 1, 0.6 * y[0] - 0.8 * y[2] + 2, 0.8 * y[0] + 0.6 * y[2] - 3};  // the axis y becomes x
  };
  const auto round = fitCylinder(makeContactSurface(makeStack(stack), "lower_contact"));
  TEST_FLOATING_EQUALITY(round.radius, 2.5, 1e-11);
  TEST_COMPARE(std::abs((*round.axis)[0]), >, 1 - 1e-12);
  TEST_FLOATING_EQUALITY(round.centre[1], 2.0, 1e-10);
  TEST_FLOATING_EQUALITY(round.centre[2], -3.0, 1e-10);
  TEST_COMPARE(round.misfit, <, 1e-13);
  TEST_THROW(fitCylinder(makeContactSurface(makeStack({}), "lower_contact")), InputError);
  TEST_THROW(fitSphere(makeContactSurface(makeStack({}), "lower_contact")), InputError);
}

// What lies beyond an edge of a body turns no patch.
TEUCHOS_UNIT_TEST(Gaps, PatchesKnowCreases) {
  Mesh mesh = makeStack({});
  const auto end = mesh.sideSets[std::size_t(findSideSet(mesh, "lower_end"))].sides;
  auto& sides = mesh.sideSets[std::size_t(findSideSet(mesh, "lower_contact"))].sides;
  sides.insert(sides.end(), end.begin(), end.end());
  const auto flat = makeContactSurface(mesh, "lower_contact"), patches = nagataSurface(flat);
  TEST_EQUALITY(patches.coordinates.size(), flat.coordinates.size() + 4 * flat.faces.size());
  for (const auto& face : patches.faces) {
    TEST_EQUALITY(face.size, 8);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto at = [&](std::size_t k) { return patches.coordinates[std::size_t(face.nodes[k])]; };
      TEST_COMPARE(Vec3::norm(Vec3::subtract(at(4 + i), Vec3::scale(0.5, Vec3::add(at(i), at((i + 1) % 4))))), <, 1e-14);
    }
  }
}

TEUCHOS_UNIT_TEST(Gaps, GivenClosedAndIgnored) {
  for (const auto discretization : {Discretization::NodeToNode, Discretization::Mortar}) {
    Stack stack;
    stack.upperMap = [](const Point& x) { return Point{x[0], x[1], x[2] + 0.1 * (x[0] - 0.5)}; };  // from -0.05 to 0.15
    const Mesh mesh = makeStack(stack);
    ContactSpec contact = spec(PrimarySmoothing::None);
    contact.discretization = discretization;
    const auto plain = buildContact(mesh, {contact})[0];
    TEST_COMPARE(std::abs(plain.overlap.depth - 0.05), <, 1e-3);
    TEST_EQUALITY(plain.overlap.place[0], 0.0);
    contact.initialPenetration = InitialPenetration::Ignore;
    const auto ignored = buildContact(mesh, {contact})[0];
    TEST_EQUALITY(ignored.overlap.depth, plain.overlap.depth);
    std::size_t changed = 0;
    for (std::size_t i = 0; i < plain.pairs.size(); ++i) {
      TEST_EQUALITY(ignored.pairs[i].gap, std::max(0.0, plain.pairs[i].gap));
      changed += plain.pairs[i].gap < 0;
    }
    TEST_ASSERT(changed > 0 && changed < plain.pairs.size());
    contact.initialPenetration = InitialPenetration::Resolve;
    contact.gapAt = [&](std::int64_t node) { return 0.25 * mesh.coordinates[std::size_t(node)][0]; };
    for (const auto& pair : pairsWithGaps(mesh, contact))
      TEST_COMPARE(std::abs(pair.gap - 0.25 * mesh.coordinates[std::size_t(pair.secondaryNode)][0]), <, 1e-13);
    contact.gapAt = [](std::int64_t) { return -5.0; };  // deeper than many elements, as the user wants it
    for (const auto& pair : pairsWithGaps(mesh, contact)) TEST_COMPARE(std::abs(pair.gap + 5), <, 1e-13);
  }
}
