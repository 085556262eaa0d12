// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ModelBuilder.hpp"

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

std::string blockLabel(const ElementBlock& block) { return block.name.empty() ? std::to_string(block.id) : block.name; }

// [blocks]
std::vector<int> assignMaterials(const std::vector<MaterialOptions>& options, const Mesh& mesh) {
  std::vector<int> materialOfBlock(mesh.blocks.size(), -1);
  int own = 0;
  for (const auto& material : options) {
    const std::string path = "Materials->" + material.name + "->Element Blocks";
    for (const auto& name : material.blocks) {
      const int block = findBlock(mesh, name);
      if (block < 0)
        throw InputError(path + ": the mesh has no element block '" + name + "'; its blocks are: " + listBlocks(mesh));
      if (materialOfBlock[block] == own) throw InputError(path + ": names block '" + name + "' twice, by its name or number; once is enough");
      if (materialOfBlock[block] >= 0)
        throw InputError(path + ": block '" + name + "' already has the material '" + options[std::size_t(materialOfBlock[block])].name +
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

PartitionOptions partitionOptions(const DecompositionOptions& options, const std::vector<int>& bricks) {
  if (options.method == PartitionMethod::Bricks && bricks.empty())
    throw InputError("Decomposition->Method: Bricks is for the generated Two Beams mesh only; use METIS for a mesh from a file");
  return {options, options.method == PartitionMethod::Bricks ? bricks : std::vector<int>{}};
}

ContactSpec contactSpec(const ContactOptions& options) {
  if (options.discretization == Discretization::Mortar)
    throw InputError("Contact->" + options.name +
                     "->Discretization: Mortar is not in this version; use Node To Node, which needs meshes that match");
  ContactSpec spec;
  spec.name = options.name;
  spec.secondarySideSet = options.secondarySideSet;
  spec.primarySideSet = options.primarySideSet;
  if (options.rigidPlane) spec.rigidPlane = RigidPlane{options.rigidPlane->point, options.rigidPlane->normal};
  spec.matchingTolerance = options.matchingTolerance;
  spec.tied = !options.friction.law;
  spec.principalDirection = options.friction.principalDirection;
  return spec;
}

FrictionSpec frictionSpec(const FrictionOptions& options) {
  FrictionSpec spec;
  spec.tied = !options.law;
  spec.law = options.law.value_or(FrictionLaw::Frictionless);
  if (spec.law == FrictionLaw::Frictionless) return spec;
  spec.coefficients = options.coefficients;
  if (spec.law == FrictionLaw::Tresca) spec.slipBound = options.slipBound;
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

void readContact(const std::vector<ContactOptions>& contacts, ModelData& data, GlobalModel& model) {
  std::vector<ContactSpec> specs;
  for (const auto& contact : contacts) {
    data.interfaceNames.push_back(contact.name);
    data.friction.push_back(frictionSpec(contact.friction));
    specs.push_back(contactSpec(contact));
  }
  model.interfaces = pairSurfaces(model.mesh, specs);
  for (const auto& interface : model.interfaces) {
    data.notes.insert(data.notes.end(), interface.notes.begin(), interface.notes.end());
    data.unpairedNodes += interface.unpairedNodes;
    if (interface.tied) data.tiedPairs += long(interface.pairs.size());
  }
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

std::vector<IsotropicMaterial> materialsOf(const std::vector<MaterialOptions>& options) {
  std::vector<IsotropicMaterial> materials;
  for (const auto& material : options) materials.push_back({material.name, material.youngsModulus, material.poissonsRatio});
  return materials;
}

SourceMesh makeMesh(const MeshOptions& options) {
  SourceMesh source;
  if (options.twoBeams) {
    const TwoBeamsSpec spec{options.twoBeams->subdomainsPerEdge, options.twoBeams->elementsPerSubdomainEdge};
    source.mesh = makeTwoBeams(spec);
    source.bricks = brickSubdomains(spec);
  } else {
    source.mesh = readMeshFiles(Teuchos::SerialComm<int>(), options.file).part;
  }
  return source;
}

ModelDraft draftModel(const RunOptions& options, SourceMesh source, ModelData& data, GlobalModel& model) {
  ModelDraft draft;
  model.mesh = std::move(source.mesh);
  if (model.mesh.numElements() == 0) throw InputError("Mesh: has no elements");
  requireOrdinarySize(model.mesh);
  if (model.mesh.numElements() + model.mesh.numNodes() > std::size_t(std::numeric_limits<int>::max()))
    throw InputError("Mesh: has " + std::to_string(model.mesh.numElements()) + " elements and " + std::to_string(model.mesh.numNodes()) +
                     " nodes; the one rank that cuts it takes at most 2147483647 of both together");
  if (!options.title.empty()) model.mesh.title = options.title;
  numberFromOne(model.mesh.nodeNumbers, model.mesh.numNodes());
  numberFromOne(model.mesh.elementNumbers, model.mesh.numElements());
  data.materials = materialsOf(options.materials);
  requireOrdinaryStiffness(data.materials);
  draft.materialOfBlock = assignMaterials(options.materials, model.mesh);
  chooseFormulation(draft.materialOfBlock, model.mesh, data);
  model.prescribed = collectDisplacements(options.conditions, model.mesh);
  data.loads = collectLoads(options.conditions, model.mesh);
  requireLoadedSides(data.loads, model.mesh);
  readContact(options.contacts, data, model);

  draft.graph = buildDualGraph(model.mesh);
  draft.bodies = findBodies(model.mesh);
  data.bodyNames = draft.bodies.names;
  draft.options = partitionOptions(options.decomposition, source.bricks);
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
}

}  // namespace Haptos
