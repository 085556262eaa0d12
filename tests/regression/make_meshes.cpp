// SPDX-License-Identifier: BSD-3-Clause
// Writes the small meshes of the regression tests into the folder that is named, right ones and wrong ones.
#include <Teuchos_DefaultSerialComm.hpp>
#include <cmath>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_CellMesh.hpp"
#include "Haptos_ExodusWriter.hpp"
#include "Haptos_MeshShare.hpp"

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

/// Nodes between the two layers of the lower cube on one line: the upper layer can turn about it.
Mesh folded() {
  Mesh mesh = stack(2, 2);
  for (auto& x : mesh.coordinates)
    if (x[2] == 0.5) x[1] = 0;
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

/// Every side of a set is listed twice.
Mesh doubled(const std::string& name) {
  Mesh mesh = stack(2, 2);
  auto& sides = mesh.sideSets[std::size_t(findSideSet(mesh, name))].sides;
  const auto once = sides;
  sides.insert(sides.end(), once.begin(), once.end());
  return mesh;
}

/// HEX20; the middle of the first edge of element 1, which no other has, lies at its first corner, or is that node.
Mesh middleAtCorner(bool isSameNode) {
  Mesh mesh = withElements(stack(2, 2), Topology::Hex20);
  auto* nodes = mesh.blocks[0].connectivity.data();
  if (isSameNode) nodes[8] = nodes[0];
  else mesh.coordinates[std::size_t(nodes[8])] = mesh.coordinates[std::size_t(nodes[0])];
  return mesh;
}

/// The stack with nodal fields: MU = 0.1 + 0.05 x and axes that are right, others that are wrong at one or all nodes.
void writeFields(const std::string& path) {
  const auto comm = Teuchos::rcp(new Teuchos::SerialComm<int>());
  const Mesh mesh = stack(2, 2);
  const std::vector<double> zero(mesh.numNodes(), 0.0), one(mesh.numNodes(), 1.0);
  ResultFields fields;
  auto& mu = fields.nodal.emplace_back("MU", zero).second;
  for (std::size_t i = 0; i < mu.size(); ++i) mu[i] = 0.1 + 0.05 * mesh.coordinates[i][0];
  fields.nodal.emplace_back("NEGATIVE", one);
  fields.nodal.emplace_back("NAN_AT_ONE", one);
  fields.nodal.emplace_back("ONE", one);
  fields.nodal.emplace_back("ZERO", zero);
  for (std::size_t i = 0; i < mesh.numNodes(); ++i)
    if (mesh.coordinates[i] == std::array<double, 3>{0.5, 1, 1}) {  // on both sides of the joint
      fields.nodal[1].second[i] = -0.25;
      fields.nodal[2].second[i] = std::nan("");
    }
  ExodusWriter writer(comm, path, sliceOfMesh(mesh, 0, 1));
  ResultFields before = fields;  // the last step counts
  for (auto& field : before.nodal) field.second = std::vector<double>(mesh.numNodes(), -7.0);
  writer.writeStep(0.5, before);
  writer.writeStep(1.0, fields);
  writer.close();
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
  writeMesh(folder + "/folded.exo", folded());
  writeMesh(folder + "/not_a_number.exo", notANumber());
  writeMesh(folder + "/tiny.exo", scaled(1e-60));
  writeMesh(folder + "/huge.exo", scaled(1e60));
  writeMesh(folder + "/doubled.exo", doubled("upper_top"));
  writeMesh(folder + "/contact_twice.exo", doubled("upper_bottom"));
  writeMesh(folder + "/middle_at_corner.exo", middleAtCorner(false));
  writeMesh(folder + "/middle_is_corner.exo", middleAtCorner(true));
  writeFields(folder + "/fields.exo");
  return 0;
}
