// SPDX-License-Identifier: BSD-3-Clause
// Writes the small meshes of the regression tests into the folder that is named, right ones and wrong ones.
#include <cmath>
#include <iostream>
#include <string>
#include <utility>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_ExodusWriter.hpp"

namespace {

using namespace Haptos;

/// A unit cube standing on z = `floor`; side sets are called after it: lower_bottom, lower_top, ...
BoxSpec cube(const std::string& name, double floor, int divisions) {
  BoxSpec box;
  box.blockName = name;
  box.lower = {0, 0, floor};
  box.upper = {1, 1, floor + 1};
  box.divisions = {divisions, divisions, divisions};
  box.sideSetNames = {name + "_west", name + "_east", name + "_south", name + "_north", name + "_bottom", name + "_top"};
  return box;
}

Mesh stack(int lowerDivisions, int upperDivisions) {
  return makeBoxes({cube("lower", 0, lowerDivisions), cube("upper", 1, upperDivisions)});
}

/// The upper cube beside the lower one, not over it.
Mesh apart() {
  auto upper = cube("upper", 1, 2);
  upper.lower[0] += 10;
  upper.upper[0] += 10;
  return makeBoxes({cube("lower", 0, 2), upper});
}

/// Element 6 of the upper cube with its bottom and top changed: every corner has a negative Jacobian.
Mesh inverted() {
  Mesh mesh = stack(2, 2);
  for (int i = 0; i < 4; ++i)
    std::swap(mesh.blocks[1].connectivity[8 * 5 + i], mesh.blocks[1].connectivity[8 * 5 + 4 + i]);
  return mesh;
}

Mesh notANumber() {
  Mesh mesh = stack(2, 2);
  mesh.coordinates[7][1] = std::nan("");
  return mesh;
}

/// In another unit of length.
Mesh scaled(double factor) {
  Mesh mesh = stack(2, 2);
  for (auto& x : mesh.coordinates)
    for (double& component : x) component *= factor;
  return mesh;
}

/// Every side is listed twice.
Mesh doubled() {
  Mesh mesh = stack(2, 2);
  for (auto& set : mesh.sideSets) {
    const auto once = set.sides;
    set.sides.insert(set.sides.end(), once.begin(), once.end());
  }
  return mesh;
}

}  // namespace

int main(int argc, char* argv[]) {
  if (argc != 2) {
    std::cerr << "usage: regression_meshes FOLDER\n";
    return 1;
  }
  const std::string folder = argv[1];
  writeMesh(folder + "/stack.exo", stack(2, 2));
  writeMesh(folder + "/tower.exo", makeBoxes({cube("lower", 0, 2), cube("upper", 1, 2), cube("third", 5, 2)}));
  writeMesh(folder + "/apart.exo", apart());
  writeMesh(folder + "/non_matching.exo", stack(2, 3));
  writeMesh(folder + "/inverted.exo", inverted());
  writeMesh(folder + "/not_a_number.exo", notANumber());
  writeMesh(folder + "/tiny.exo", scaled(1e-60));
  writeMesh(folder + "/huge.exo", scaled(1e60));
  writeMesh(folder + "/doubled.exo", doubled());
  return 0;
}
