// SPDX-License-Identifier: BSD-3-Clause
// Two stacked boxes, bent, turned and renumbered, as scenes for the tests of this package.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_ContactPairs.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos::Scenes {

using Point = std::array<double, 3>;
using Rotation = std::array<Point, 3>;  // rows

/// Lower box below z = 0, upper box above z = 0; the maps move their nodes.
struct Stack {
  std::array<int, 3> lowerDivisions{4, 3, 1}, upperDivisions{4, 3, 1};
  Point lowerFrom{0, 0, -1}, lowerTo{2, 1, 0}, upperFrom{0, 0, 0}, upperTo{2, 1, 1};
  Topology lowerTopology = Topology::Hex8, upperTopology = Topology::Hex8;
  std::function<Point(const Point&)> lowerMap, upperMap;
};

inline Mesh makeStack(const Stack& stack) {
  BoxSpec lower, upper;
  lower.blockName = "lower";
  lower.lower = stack.lowerFrom;
  lower.upper = stack.lowerTo;
  lower.divisions = stack.lowerDivisions;
  lower.topology = stack.lowerTopology;
  lower.sideSetNames = {"", "lower_end", "", "", "lower_bottom", "lower_contact"};
  lower.map = stack.lowerMap;
  upper.blockName = "upper";
  upper.lower = stack.upperFrom;
  upper.upper = stack.upperTo;
  upper.divisions = stack.upperDivisions;
  upper.topology = stack.upperTopology;
  upper.sideSetNames = {"", "", "", "", "upper_contact", "upper_top"};
  upper.map = stack.upperMap;
  return makeBoxes({lower, upper});
}

inline std::function<Point(const Point&)> shift(const Point& by) {
  return [by](const Point& x) { return Vec3::add(x, by); };
}

/// Bends the stack around the y axis: z = 0 becomes the cylinder of this radius.
inline std::function<Point(const Point&)> bend(double radius, double lift = 0.0) {
  return [=](const Point& x) {
    const double r = radius + x[2] + lift, angle = x[0] / radius;
    return Point{r * std::sin(angle), x[1], r * std::cos(angle)};
  };
}

inline ContactSpec contact(const std::string& secondary = "upper_contact",
                           const std::string& primary = "lower_contact") {
  ContactSpec spec;
  spec.name = "interface";
  spec.secondarySideSet = secondary;
  spec.primarySideSet = primary;
  spec.discretization = Discretization::NodeToNode;
  return spec;
}

inline Rotation randomRotation(unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  const auto random = [&] { return Point{normal(generator), normal(generator), normal(generator)}; };
  const Point a = Vec3::normalized(random());
  const Point b = Vec3::normalized(Vec3::cross(a, random()));
  return {a, b, Vec3::cross(a, b)};
}

inline Point rotate(const Rotation& r, const Point& x) {
  return {Vec3::dot(r[0], x), Vec3::dot(r[1], x), Vec3::dot(r[2], x)};
}

inline Mesh turned(Mesh mesh, const Rotation& rotation) {
  for (auto& x : mesh.coordinates) x = rotate(rotation, x);
  return mesh;
}

inline std::vector<std::int64_t> randomPermutation(std::size_t n, unsigned seed) {
  std::vector<std::int64_t> permutation(n);
  std::iota(permutation.begin(), permutation.end(), 0);
  std::shuffle(permutation.begin(), permutation.end(), std::mt19937(seed));
  return permutation;
}

/// Node i becomes node permutation[i]; the sides of the side sets are listed backwards.
inline Mesh renumbered(const Mesh& mesh, const std::vector<std::int64_t>& permutation) {
  Mesh result = mesh;
  for (std::size_t i = 0; i < mesh.numNodes(); ++i)
    result.coordinates[std::size_t(permutation[i])] = mesh.coordinates[i];
  for (auto& block : result.blocks)
    for (auto& node : block.connectivity) node = permutation[std::size_t(node)];
  for (auto& set : result.sideSets) std::reverse(set.sides.begin(), set.sides.end());
  return result;
}

inline double distance(const Point& a, const Point& b) { return Vec3::norm(Vec3::subtract(a, b)); }

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// What buildContact says when it refuses; "" if it does not.
template <class Error = InputError>
std::string refusal(const Mesh& mesh, const ContactSpec& spec) {
  try {
    buildContact(mesh, {spec});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace Haptos::Scenes
