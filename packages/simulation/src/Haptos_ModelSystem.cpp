// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ModelSystem.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "Haptos_ElasticStiffness.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_FetiSystem.hpp"
#include "Haptos_HardElements.hpp"
#include "Haptos_NodalLoads.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

bool contains(const std::vector<int>& list, int value) { return std::find(list.begin(), list.end(), value) != list.end(); }

// Sides of a group that a load acts on, each once: sets overlap, and some programs list a face twice.
std::vector<GroupSide> loadedSides(const Subdomain& sub, int group, const Load& load) {
  // A set sorts them, too: sums of loads come in the same order however the file lists sides.
  std::set<std::pair<int, int>> found;
  for (const auto& side : sub.sides)
    if (side.group == group && contains(load.sideSets, side.sideSet)) found.emplace(side.element, side.side);
  std::vector<GroupSide> sides;
  for (const auto& [element, side] : found) sides.push_back({element, side});
  return sides;
}

void addLoad(const Subdomain& sub, const Load& load, Eigen::Ref<Eigen::VectorXd> f) {
  const ScalarField pressure = [&](double x, double y, double z) { return load.pressure(x, y, z); };
  const VectorField vector = [&](double x, double y, double z) { return load.value(x, y, z); };
  for (int g = 0; g < int(sub.groups.size()); ++g) {
    if (load.kind == Load::Kind::BodyForce) {
      if (contains(load.blocks, sub.blockOfGroup[g])) addBodyForce(sub.coordinates, sub.groups[g], vector, f);
      continue;
    }
    const auto sides = loadedSides(sub, g, load);
    if (sides.empty()) continue;
    if (load.kind == Load::Kind::Pressure) addPressure(sub.coordinates, sub.groups[g], sides, pressure, f);
    else addTraction(sub.coordinates, sub.groups[g], sides, vector, f);
  }
}

// The copies of a node share its force equally.
/// \param copies [nodes of the subdomain]
void addForces(const Subdomain& sub, const std::vector<int>& copies, const NodalForces& forces, Eigen::Ref<Eigen::VectorXd> f) {
  for (int i = 0; i < sub.numNodes(); ++i) {
    const auto force = forces(sub.nodes[i], sub.coordinates[i]);
    for (int d = 0; d < 3; ++d) {
      if (!std::isfinite(force[d]))
        throw InputError("The nodal force at node " + std::to_string(sub.nodes[i] + 1) + " of the mesh is not finite.");
      f[3 * i + d] += force[d] / copies[std::size_t(i)];
    }
  }
}

// Near incompressibility S is stiff against changes of volume, which F does not mirror: a capped ratio does better.
bool capMaterials(const std::vector<IsotropicMaterial>& materials, std::vector<IsotropicMaterial>& capped) {
  bool any = false;
  capped = materials;
  for (auto& material : capped) {
    any = any || material.poissonsRatio > kNearlyIncompressible;
    material.poissonsRatio = std::min(material.poissonsRatio, kNearlyIncompressible);
  }
  return any;
}

// The file's number of a node; that of rank 0 counts.  Collective.
std::string numberOf(const DistributedModel& model, std::int64_t node) {
  const MeshShare& mesh = model.mesh;
  // Ranks may know different nodes, and all must ask for the same.
  const auto asked = broadcasted(*model.comm, node);
  const bool isMine = asked >= mesh.firstNode() && asked < mesh.endNode();
  return std::to_string(sumOfAll(*model.comm, isMine ? mesh.part.nodeNumbers[std::size_t(asked - mesh.firstNode())] : 0));
}

}  // namespace

// Elements become matrices behind `SubdomainStiffness`: what solves does not know that there is a mesh.
SystemModel systemModelOf(const DistributedModel& model, std::int64_t numMeshNodes) {
  SystemModel system;
  system.comm = model.comm;
  system.stiffness = std::make_shared<ElasticStiffness>(model.subdomains, model.data.materials, model.data.formulation);
  std::vector<IsotropicMaterial> capped;
  if (capMaterials(model.data.materials, capped))
    system.softened = std::make_shared<ElasticStiffness>(model.subdomains, capped, model.data.formulation);
  system.aspects = model.aspects;
  for (const auto& material : model.data.materials) system.isHardlyCompressible = system.isHardlyCompressible || material.poissonsRatio > kHardlyCompressible;
  system.isHard = hasHardElements(*model.comm, model.subdomains, model.data.materials);
  system.firstSubdomain = model.firstSubdomain;
  for (const auto& sub : model.subdomains) {
    system.bodies.push_back(sub.body);
    system.pieces.push_back(sub.piece);
  }
  system.bodyNames = model.data.bodyNames;
  system.pieceNames = model.data.pieceNames;
  system.interfaceNames = model.data.interfaceNames;
  system.friction = model.data.friction;
  system.multipliers = model.multipliers;
  system.gather = std::make_shared<NodalGather>(model.comm, nodesOf(model.subdomains), numMeshNodes);
  system.nameOfNode = [&model](std::int64_t node) { return numberOf(model, node); };
  return system;
}

// f = sum of loads on every copy: surface loads fall on the element that has the side, nodal forces on all copies of a node.
StepData firstStep(const DistributedModel& model, const FetiSystem& system) {
  const JumpOperator& jump = system.jump();
  std::vector<std::vector<int>> copies;  // [local subdomains][nodes] subdomains that share a node; only for nodal forces
  if (!model.nodalForces.empty()) copies = countCopies(*model.comm, model.mesh.nodes, model.subdomains);
  const auto f = Teuchos::rcp(new Vector(jump.getDomainMap())), c = Teuchos::rcp(new Vector(model.multipliers->map()));
  runOnAllRanks(*model.comm, [&] {
    const auto data = f->getDataNonConst(0);
    for (std::size_t i = 0; i < model.subdomains.size(); ++i) {
      Eigen::Map<Eigen::VectorXd> own(data.getRawPtr() + jump.primalOffsets()[i], model.subdomains[i].numDofs());
      for (const auto& load : model.data.loads) addLoad(model.subdomains[i], load, own);
      for (const auto& forces : model.nodalForces) addForces(model.subdomains[i], copies[i], forces, own);
    }
  });
  const auto data = c->getDataNonConst(0);
  std::copy(model.multipliers->c().begin(), model.multipliers->c().end(), data.begin());
  return {f, c, model.prescribed};
}

}  // namespace Haptos
