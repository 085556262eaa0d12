// SPDX-License-Identifier: BSD-3-Clause
// From a scene's description to a mesh, to parameters of the program and to the reference's plain problem.
#include <Eigen/Geometry>
#include <Teuchos_Array.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_NodalLoads.hpp"
#include "Haptos_Parameters.hpp"
#include "Scenes.hpp"

namespace Haptos::Scenes {
namespace {

using Teuchos::Array;
using Teuchos::ParameterList;

BoxSpec box(const Scene& scene, bool upper, double from, double to) {
  const int n = scene.k * scene.p;
  BoxSpec spec;
  spec.blockName = upper ? "upper" : "lower";
  spec.lower = {from, 0.0, upper ? 0.0 : -1.0};
  spec.upper = {to, 1.0, upper ? 1.0 : 0.0};
  spec.divisions = {int(std::lround((to - from) * n)), n, n};
  const std::string name = spec.blockName;
  spec.sideSetNames = {from == 0 ? name + "_clamp" : "", to == 2 ? name + "_end" : "", "", "",
                       upper ? "upper_contact" : "lower_bottom", upper ? "upper_top" : "lower_contact"};
  spec.map = [scene, upper](const std::array<double, 3>& x) {
    std::array<double, 3> y = x;
    if (scene.skew) {  // the contact plane and the ends stay plane, so the meshes still match
      const double bump = 0.04 * std::sin(3.1 * x[0]) * std::sin(2.3 * x[1] + 0.4);
      y[0] += bump * x[0] * (2 - x[0]);
      y[1] += bump * x[1] * (1 - x[1]);
      y[2] += 2 * bump * x[2] * (1 - std::abs(x[2]));
    }
    for (int d = 0; d < 3; ++d) y[d] *= scene.stretch[d];
    if (upper) y[1] += scene.shift, y[2] += scene.gap;
    for (double& c : y) c *= scene.length;
    return y;
  };
  return spec;
}

// makeBoxes gives every box a block; the two halves of the upper body are one.
void joinBlocks(Mesh& mesh) {
  auto& from = mesh.blocks.back();
  auto& to = mesh.blocks[mesh.blocks.size() - 2];
  to.connectivity.insert(to.connectivity.end(), from.connectivity.begin(), from.connectivity.end());
  mesh.blocks.pop_back();
}

void invert(Mesh& mesh, int element) {
  const auto place = locateElement(blockOffsets(mesh), element);
  auto* nodes = mesh.blocks[place.block].connectivity.data() + 8 * place.position;
  for (int i = 0; i < 4; ++i) std::swap(nodes[i], nodes[4 + i]);
}

std::array<double, 3> scaled(const std::array<double, 3>& v, double factor) {
  return {factor * v[0], factor * v[1], factor * v[2]};
}

std::string rampText(const Scene& scene) {
  std::ostringstream text;
  text.precision(17);
  text << "clip(1.5 - x/" << scene.stretch[0] * scene.length << ", 0, 1)";
  return text.str();
}

std::string numberText(double value) {
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

void addLoad(const Scene& scene, const SceneLoad& load, ParameterList& list) {
  const double stress = scene.force / (scene.length * scene.length);
  list.set("Type", std::string(load.pressure ? "Pressure" : "Traction"));
  list.set("Sets", Array<std::string>(1, load.set));
  if (load.pressure && load.ramp) list.set("Value", numberText(load.value[0] * stress) + "*" + rampText(scene));
  else if (load.pressure) list.set("Value", load.value[0] * stress);
  else {
    const auto value = scaled(load.value, stress);
    list.set("Value", Array<double>(value.begin(), value.end()));
  }
}

void addContact(const Scene& scene, ParameterList& list) {
  list.set("Secondary Side Set", std::string("upper_contact"));
  list.set("Primary Side Set", std::string("lower_contact"));
  auto& friction = list.sublist("Friction");
  friction.set("Law", scene.law);
  if (scene.law == "Frictionless") return;
  friction.set("Coefficients", Array<double>(scene.friction.begin(), scene.friction.end()));
  friction.set("Principal Direction", Array<double>(scene.direction.begin(), scene.direction.end()));
  if (scene.law == "Tresca") friction.set("Slip Bound", scene.slipBound * scene.force / (scene.length * scene.length));
}

std::vector<IsotropicMaterial> materialsOf(const Scene& scene) {
  const double stress = scene.force / (scene.length * scene.length);
  return {{"below", scene.young[0] * stress, scene.poisson[0]}, {"above", scene.young[1] * stress, scene.poisson[1]}};
}

std::set<std::int64_t> nodesOf(const Mesh& mesh, const std::string& sideSet) {
  std::set<std::int64_t> nodes;
  const auto offsets = blockOffsets(mesh);
  const int set = findSideSet(mesh, sideSet);
  for (const auto& side : mesh.sideSets.at(set).sides)
    for (auto node : nodesOfSide(mesh, offsets, side)) nodes.insert(node);
  return nodes;
}

std::vector<HeldComponent> heldComponents(const Scene& scene, const Mesh& mesh) {
  std::map<std::pair<std::int64_t, int>, double> held;
  for (const auto& hold : scene.holds)
    for (auto node : nodesOf(mesh, hold.set))
      for (char c : hold.components) held[{node, c - 'x'}] = scene.length * hold.value[c - 'x'];
  std::vector<HeldComponent> result;
  for (const auto& [key, value] : held) result.push_back({key.first, key.second, value});
  return result;
}

Eigen::VectorXd integrateLoads(const Scene& scene, const Mesh& mesh) {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(3 * Eigen::Index(mesh.numNodes()));
  const double stress = scene.force / (scene.length * scene.length);
  const auto offsets = blockOffsets(mesh);
  for (const auto& load : scene.loads)
    for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
      ElementGroup group;
      for (auto node : mesh.blocks[b].connectivity) group.connectivity.push_back(int(node));
      std::vector<GroupSide> sides;
      for (const auto& side : mesh.sideSets.at(findSideSet(mesh, load.set)).sides)
        if (locateElement(offsets, side.element).block == int(b))
          sides.push_back({int(locateElement(offsets, side.element).position), side.side});
      if (sides.empty()) continue;
      const double width = scene.stretch[0] * scene.length;
      const auto amplitude = [&](double x) { return stress * (load.ramp ? std::clamp(1.5 - x / width, 0.0, 1.0) : 1.0); };
      if (load.pressure)
        addPressure(mesh.coordinates, group, sides,
                    [&](double x, double, double) { return load.value[0] * amplitude(x); }, f);
      else
        addTraction(mesh.coordinates, group, sides,
                    [&](double x, double, double) { return scaled(load.value, amplitude(x)); }, f);
    }
  return f;
}

// The contact surface is the plane z = 0 whose normal, outward from the upper body, is -z.
std::vector<ReferencePair> pairsByPlace(const Scene& scene, const Mesh& mesh) {
  std::vector<ReferencePair> pairs;
  if (!scene.contact) return pairs;
  const Eigen::Vector3d n(0, 0, -1);
  Eigen::Vector3d axis(scene.direction[0], scene.direction[1], 0);
  if (axis.norm() <= std::sin(0.1 * M_PI / 180) * Eigen::Vector3d(scene.direction.data()).norm()) axis = {1, 0, 0};
  const Eigen::Vector3d t1 = axis.normalized(), t2 = n.cross(t1);
  const double near = 1e-9 * scene.length * std::min(scene.stretch[0], scene.stretch[1]);
  const auto below = nodesOf(mesh, "lower_contact");
  for (auto node : nodesOf(mesh, "upper_contact")) {
    const auto& x = mesh.coordinates[node];
    for (auto other : below) {
      const auto& y = mesh.coordinates[other];
      if (std::hypot(x[0] - y[0], x[1] - y[1]) > near) continue;
      ReferencePair pair{node, other, n, t1, t2, x[2] - y[2], {}};
      if (scene.law != "Frictionless") pair.law.coefficients = scene.friction;
      pairs.push_back(pair);
    }
  }
  return pairs;
}

void addTrescaBounds(const Scene& scene, const Mesh& mesh, std::vector<ReferencePair>& pairs) {
  SceneLoad unit{"upper_contact", true, {1, 0, 0}, false};
  Scene measure = scene;
  measure.loads = {unit};
  measure.force = scene.length * scene.length;  // so that the unit pressure integrates to areas
  const Eigen::VectorXd areas = integrateLoads(measure, mesh);
  for (auto& pair : pairs)
    pair.law.slipForce = scene.slipBound * scene.force / (scene.length * scene.length) * areas[3 * pair.secondary + 2];
}

}  // namespace

SourceMesh makeSceneMesh(const Scene& scene) {
  std::vector<BoxSpec> boxes{box(scene, false, 0, 2)};
  if (scene.upperInTwo) {
    boxes.push_back(box(scene, true, 0, 1 - 1.0 / (scene.k * scene.p)));
    boxes.push_back(box(scene, true, 1, 2));
  } else {
    boxes.push_back(box(scene, true, 0, 2));
  }
  SourceMesh source;
  source.mesh = makeBoxes(boxes);
  if (scene.upperInTwo) joinBlocks(source.mesh);
  else source.bricks = brickSubdomains({scene.k, scene.p});
  if (scene.invertedElement >= 0) invert(source.mesh, scene.invertedElement);
  return source;
}

ParameterList makeSceneParameters(const Scene& scene, const std::string& method, double tolerance) {
  ParameterList list("Haptos");
  auto& beams = list.sublist("Mesh").sublist("Two Beams");  // replaced by the mesh in memory
  beams.set("Subdomains Per Edge", scene.k);
  beams.set("Elements Per Subdomain Edge", scene.p);
  auto& cut = list.sublist("Decomposition");
  cut.set("Method", scene.decomposition);
  cut.set("Subdomains", scene.subdomains);
  cut.set("Seed", scene.seed);
  const auto materials = materialsOf(scene);
  for (int i = 0; i < 2; ++i) {
    auto& material = list.sublist("Materials").sublist(materials[i].name);
    material.set("Element Blocks", Array<std::string>(1, i == 0 ? "lower" : "upper"));
    material.set("Young's Modulus", materials[i].youngsModulus);
    material.set("Poisson's Ratio", materials[i].poissonsRatio);
  }
  auto& conditions = list.sublist("Boundary Conditions");
  for (std::size_t i = 0; i < scene.holds.size(); ++i) {
    const auto& hold = scene.holds[i];
    auto& condition = conditions.sublist("hold " + std::to_string(i + 1));
    condition.set("Type", std::string("Displacement"));
    condition.set("Sets", Array<std::string>(1, hold.set));
    condition.set("Components", hold.components);
    const auto value = scaled(hold.value, scene.length);
    condition.set("Value", Array<double>(value.begin(), value.end()));
  }
  for (std::size_t i = 0; i < scene.loads.size(); ++i)
    addLoad(scene, scene.loads[i], conditions.sublist("load " + std::to_string(i + 1)));
  if (scene.contact) addContact(scene, list.sublist("Contact").sublist("interface"));
  auto& solver = list.sublist("Solver");
  solver.set("Method", method);
  solver.set("Relative Tolerance", tolerance);
  return validatedParameters(list);
}

ReferenceProblem makeReferenceProblem(const Scene& scene, Formulation formulation) {
  ReferenceProblem problem;
  problem.mesh = makeSceneMesh(scene).mesh;
  problem.materials = materialsOf(scene);
  for (const auto& block : problem.mesh.blocks) problem.materialOfBlock.push_back(block.name == "lower" ? 0 : 1);
  problem.formulation = formulation;
  problem.held = heldComponents(scene, problem.mesh);
  problem.loads = integrateLoads(scene, problem.mesh);
  problem.pairs = pairsByPlace(scene, problem.mesh);
  if (scene.law == "Tresca") addTrescaBounds(scene, problem.mesh, problem.pairs);
  return problem;
}

}  // namespace Haptos::Scenes
