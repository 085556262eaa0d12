// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ModelBuilder.hpp"

#include <Teuchos_Array.hpp>
#include <Teuchos_DefaultSerialComm.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_DualGraph.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_MeshFiles.hpp"
#include "Haptos_ParameterValue.hpp"
#include "Haptos_SubdomainOrder.hpp"

namespace Haptos {
namespace {

using Teuchos::ParameterList;
using Names = Teuchos::Array<std::string>;

std::string blockLabel(const ElementBlock& block) { return block.name.empty() ? std::to_string(block.id) : block.name; }

// [blocks]
std::vector<int> assignMaterials(const ParameterList& list, const Mesh& mesh, const std::vector<IsotropicMaterial>& materials) {
  std::vector<int> materialOfBlock(mesh.blocks.size(), -1);
  int own = 0;
  for (auto it = list.begin(); it != list.end(); ++it) {
    const auto& material = list.sublist(it->first);
    const std::string path = "Materials->" + it->first + "->Element Blocks";
    for (const auto& name : material.get<Names>("Element Blocks")) {
      const int block = findBlock(mesh, name);
      if (block < 0)
        throw InputError(path + ": the mesh has no element block '" + name + "'; its blocks are: " + listBlocks(mesh));
      if (materialOfBlock[block] == own) throw InputError(path + ": names block '" + name + "' twice, by its name or number; once is enough");
      if (materialOfBlock[block] >= 0)
        throw InputError(path + ": block '" + name + "' already has the material '" + materials[materialOfBlock[block]].name +
                         "'; a block takes one material");
      materialOfBlock[block] = own;
    }
    ++own;
  }
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b)
    if (materialOfBlock[b] < 0 && mesh.blocks[b].numElements() > 0)
      throw InputError("Materials: element block '" + blockLabel(mesh.blocks[b]) +
                       "' has no material; name it in the Element Blocks of one");
  return materialOfBlock;
}

PartitionOptions partitionOptions(const ParameterList& list, const std::vector<int>& bricks) {
  PartitionOptions options;
  const auto method = list.get<std::string>("Method");
  options.subdomains = list.get<int>("Subdomains");
  options.seed = list.get<int>("Seed");
  if (method == "Block") options.method = PartitionMethod::Block;
  if (method == "Bricks") {
    if (bricks.empty())
      throw InputError("Decomposition->Method: Bricks is for the generated Two Beams mesh only; use METIS for a mesh from a file");
    options.method = PartitionMethod::Bricks;
    options.bricks = bricks;
  }
  return options;
}

std::array<double, 3> threeOf(const ParameterList& list, const std::string& name) {
  const auto array = list.get<Teuchos::Array<double>>(name);
  return {array[0], array[1], array[2]};
}

ContactSpec contactSpec(const std::string& name, const ParameterList& list) {
  ContactSpec spec;
  spec.name = name;
  if (list.get<std::string>("Discretization") == "Mortar")
    throw InputError("Contact->" + name +
                     "->Discretization: Mortar is not in this version; use Node To Node, which needs meshes that match");
  spec.secondarySideSet = list.get<std::string>("Secondary Side Set");
  if (list.isParameter("Primary Side Set")) spec.primarySideSet = list.get<std::string>("Primary Side Set");
  if (list.isSublist("Rigid Plane"))
    spec.rigidPlane = RigidPlane{threeOf(list.sublist("Rigid Plane"), "Point"), threeOf(list.sublist("Rigid Plane"), "Normal")};
  spec.matchingTolerance = list.get<double>("Matching Tolerance");
  spec.tied = list.sublist("Friction").get<std::string>("Law") == "Tied";
  spec.principalDirection = threeOf(list.sublist("Friction"), "Principal Direction");
  return spec;
}

FrictionSpec frictionSpec(const ParameterList& list) {
  FrictionSpec spec;
  const auto law = list.get<std::string>("Law");
  spec.tied = law == "Tied";
  if (law == "Frictionless" || spec.tied) return spec;
  spec.law = law == "Coulomb" ? FrictionLaw::Coulomb : FrictionLaw::Tresca;
  const auto coefficients = list.get<Teuchos::Array<double>>("Coefficients");
  spec.coefficients = {coefficients[0], coefficients[1]};
  if (spec.law == FrictionLaw::Tresca) spec.slipBound = list.get<double>("Slip Bound");
  // Without any tangential resistance the tangential rows would only cost.
  if (spec.coefficients == std::array<double, 2>{0, 0} || (spec.law == FrictionLaw::Tresca && spec.slipBound == 0))
    spec.law = FrictionLaw::Frictionless;
  return spec;
}

// Throws the message of the first bad element, if there is one.
void checkElements(const Mesh& mesh) {
  std::int64_t first = 0;
  for (const auto& block : mesh.blocks) {
    ElementGroup group;
    group.topology = block.topology;
    group.blockName = blockLabel(block);
    group.connectivity.assign(block.connectivity.begin(), block.connectivity.end());
    group.elementNumbers.assign(mesh.elementNumbers.begin() + first, mesh.elementNumbers.begin() + first + group.numElements());
    first += group.numElements();
    for (int e = 0; e < group.numElements(); ++e) {
      if (block.topology == Topology::Hex8) elementGradients<Hex8Shape>(mesh.coordinates, group, e);
      else elementGradients<Tet4Shape>(mesh.coordinates, group, e);
    }
  }
}

// A surface of inverted elements cannot be paired: then the element is what must be named.
std::vector<ContactInterface> pairSurfaces(const Mesh& mesh, const std::vector<ContactSpec>& specs) {
  try {
    return buildContact(mesh, specs);
  } catch (const InputError&) {
    checkElements(mesh);
    throw;
  }
}

// Plain hexahedra lock near incompressibility; the mean dilatation frees them.
void chooseFormulation(const std::vector<int>& materialOfBlock, const Mesh& mesh, ModelData& data) {
  constexpr double kNearlyIncompressible = 0.45;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    if (mesh.blocks[b].topology != Topology::Hex8 || materialOfBlock[b] < 0) continue;
    const IsotropicMaterial& material = data.materials[materialOfBlock[b]];
    if (material.poissonsRatio <= kNearlyIncompressible || data.formulation == Formulation::BBar) continue;
    data.formulation = Formulation::BBar;
    data.remarks.push_back("HEX8 elements use B-bar (mean dilatation), because Poisson's ratio of '" + material.name +
                           "' is close to 0.5");
  }
}

void readContact(const ParameterList& list, ModelData& data, GlobalModel& model) {
  std::vector<ContactSpec> specs;
  for (auto it = list.begin(); it != list.end(); ++it) {
    const auto& contact = list.sublist(it->first);
    data.interfaceNames.push_back(it->first);
    data.friction.push_back(frictionSpec(contact.sublist("Friction")));
    specs.push_back(contactSpec(it->first, contact));
  }
  model.interfaces = pairSurfaces(model.mesh, specs);
  for (const auto& interface : model.interfaces) {
    data.notes.insert(data.notes.end(), interface.notes.begin(), interface.notes.end());
    data.unpairedNodes += interface.unpairedNodes;
    if (interface.tied) data.tiedPairs += long(interface.pairs.size());
  }
}

// A pinned normal row cannot move: its data must already respect the gap.
void checkPinnedRows(const GlobalModel& model, const ModelData& data) {
  double size = 0;
  for (const auto& x : model.mesh.coordinates)
    for (int d = 0; d < 3; ++d) size = std::max(size, std::abs(x[d] - model.mesh.coordinates.front()[d]));
  for (const auto& pair : model.rows.pairs)
    if (model.rows.pinned[pair.normal] && model.rows.c[pair.normal] < -1e-9 * size)
      throw InsufficientModel("The model has no solution: at " + describeNode(model.mesh, pair.geometry.secondaryNode) + " of contact '" +
                              data.interfaceNames[pair.interface] + "' the prescribed displacements make the surfaces overlap by " +
                              numberText(-model.rows.c[pair.normal]) + ".");
}

std::vector<std::string> hingedBodies(const BodyPieces& pieces, const Bodies& bodies) {
  std::vector<int> count(bodies.names.size(), 0);
  for (const auto& elements : pieces.elements) ++count[std::size_t(bodies.ofElement[std::size_t(elements.front())])];
  std::vector<std::string> names;
  for (std::size_t b = 0; b < count.size(); ++b)
    if (count[b] > 1) names.push_back(bodies.names[b]);
  return names;
}

// Messages name nodes and elements by their numbers, which a mesh in memory need not have.
void numberFromOne(std::vector<std::int64_t>& numbers, std::size_t count) {
  if (numbers.size() == count) return;
  numbers.resize(count);
  std::iota(numbers.begin(), numbers.end(), std::int64_t(1));
}

}  // namespace

namespace {

// Volumes, moments and their squares must stay within the range of double precision.
void requireOrdinarySize(const Mesh& mesh) {
  constexpr double kLargest = 1e50, kSmallest = 1e-50;
  double extent = 0, largest = 0;
  for (int c = 0; c < 3; ++c) {
    const auto along = [c](const auto& a, const auto& b) { return a[std::size_t(c)] < b[std::size_t(c)]; };
    const auto [low, high] = std::minmax_element(mesh.coordinates.begin(), mesh.coordinates.end(), along);
    const double first = (*low)[std::size_t(c)], last = (*high)[std::size_t(c)];
    extent = std::max(extent, last - first);
    largest = std::max({largest, std::abs(first), std::abs(last)});
  }
  if (largest <= kLargest && extent >= kSmallest) return;
  throw InputError("Mesh: extends over " + numberText(extent) + " and to coordinates of " + numberText(largest) + "; lengths from " +
                   numberText(kSmallest) + " to " + numberText(kLargest) + " can be computed with, so use another unit of length");
}

// Beyond the ratio, round-off in the stiff body is larger than what the soft one does.
void requireOrdinaryStiffness(const std::vector<IsotropicMaterial>& materials) {
  constexpr double kLargestRatio = 1e14, kSmallest = 1e-100;
  const auto softer = [](const IsotropicMaterial& a, const IsotropicMaterial& b) { return a.youngsModulus < b.youngsModulus; };
  const auto [soft, stiff] = std::minmax_element(materials.begin(), materials.end(), softer);
  if (materials.empty()) return;
  if (soft->youngsModulus < kSmallest)
    throw InputError("Materials->" + soft->name + "->Young's Modulus: " + numberText(soft->youngsModulus) +
                     " is too small to be computed with, the limit is " + numberText(kSmallest) + "; use other units");
  if (stiff->youngsModulus <= kLargestRatio * soft->youngsModulus) return;
  throw InputError("Materials: the Young's moduli of '" + stiff->name + "' (" + numberText(stiff->youngsModulus) + ") and '" + soft->name +
                   "' (" + numberText(soft->youngsModulus) + ") differ by more than " + numberText(kLargestRatio) +
                   ", the limit of double precision; model the stiff body as a rigid plane or by prescribed displacements");
}

}  // namespace

std::vector<IsotropicMaterial> materialsOf(const ParameterList& list) {
  std::vector<IsotropicMaterial> materials;
  for (auto it = list.begin(); it != list.end(); ++it) {
    const auto& material = list.sublist(it->first);
    materials.push_back({it->first, material.get<double>("Young's Modulus"), material.get<double>("Poisson's Ratio")});
  }
  return materials;
}

SourceMesh makeMesh(const ParameterList& parameters) {
  const auto& list = parameters.sublist("Mesh");
  SourceMesh source;
  if (list.isSublist("Two Beams")) {
    const auto& beams = list.sublist("Two Beams");
    const TwoBeamsSpec spec{beams.get<int>("Subdomains Per Edge"), beams.get<int>("Elements Per Subdomain Edge")};
    source.mesh = makeTwoBeams(spec);
    source.bricks = brickSubdomains(spec);
  } else {
    source.mesh = readMeshFiles(Teuchos::SerialComm<int>(), list.get<std::string>("File")).part;
  }
  return source;
}

ModelDraft draftModel(const ParameterList& parameters, SourceMesh source, ModelData& data, GlobalModel& model) {
  ModelDraft draft;
  model.mesh = std::move(source.mesh);
  if (model.mesh.numElements() == 0) throw InputError("Mesh: has no elements");
  requireOrdinarySize(model.mesh);
  if (model.mesh.numElements() + model.mesh.numNodes() > std::size_t(std::numeric_limits<int>::max()))
    throw InputError("Mesh: has " + std::to_string(model.mesh.numElements()) + " elements and " + std::to_string(model.mesh.numNodes()) +
                     " nodes; the one rank that cuts it takes at most 2147483647 of both together");
  if (const auto& title = parameters.get<std::string>("Title"); !title.empty()) model.mesh.title = title;
  numberFromOne(model.mesh.nodeNumbers, model.mesh.numNodes());
  numberFromOne(model.mesh.elementNumbers, model.mesh.numElements());
  data.materials = materialsOf(parameters.sublist("Materials"));
  requireOrdinaryStiffness(data.materials);
  draft.materialOfBlock = assignMaterials(parameters.sublist("Materials"), model.mesh, data.materials);
  chooseFormulation(draft.materialOfBlock, model.mesh, data);
  model.prescribed = collectDisplacements(parameters.sublist("Boundary Conditions"), model.mesh);
  data.loads = collectLoads(parameters.sublist("Boundary Conditions"), model.mesh);
  requireLoadedSides(data.loads, model.mesh);
  readContact(parameters.sublist("Contact"), data, model);

  draft.graph = buildDualGraph(model.mesh);
  draft.bodies = findBodies(model.mesh);
  data.bodyNames = draft.bodies.names;
  draft.options = partitionOptions(parameters.sublist("Decomposition"), source.bricks);
  data.metis = draft.options.method == PartitionMethod::Metis;
  draft.plan = planPartition(model.mesh, draft.graph, draft.options);
  data.hinged = hingedBodies(draft.plan.pieces, draft.bodies);
  return draft;
}

void finishModel(const ModelDraft& draft, const std::vector<std::vector<int>>& partsOfPieces, ModelData& data, GlobalModel& model) {
  model.partition = finishPartition(draft.graph, draft.bodies, draft.options, draft.plan, partsOfPieces);
  data.mendedFragments = model.partition.mended;
  const bool comesInOrder = draft.options.method == PartitionMethod::Bricks;
  if (!comesInOrder) orderSubdomains(model.mesh, model.interfaces, model.partition);
  model.subdomains = extractSubdomains(model.mesh, model.partition, draft.materialOfBlock);

  std::vector<char> frictional;
  for (const auto& spec : data.friction) frictional.push_back(spec.law != FrictionLaw::Frictionless);
  std::vector<double> youngsModulus;
  for (const auto& material : data.materials) youngsModulus.push_back(material.youngsModulus);
  model.rows = buildConstraintRows(model.mesh, model.subdomains, model.prescribed, model.interfaces, frictional, youngsModulus);
  checkPinnedRows(model, data);
}

}  // namespace Haptos
