// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ModelBuilder.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_ByteBuffer.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_FrictionFields.hpp"
#include "Haptos_HardElements.hpp"
#include "Haptos_MeshFiles.hpp"
#include "Haptos_ParameterValue.hpp"
#include "Haptos_Partition.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_SystemChecks.hpp"

namespace Haptos {
namespace {

std::string blockLabel(const ElementBlock& block) { return block.name.empty() ? std::to_string(block.id) : block.name; }

// [blocks]
std::vector<int> assignMaterials(const std::vector<MaterialOptions>& options, const MeshShare& share) {
  const Mesh& mesh = share.part;
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
    if (materialOfBlock[b] < 0 && share.blockStarts[b + 1] > share.blockStarts[b])
      throw InputError("Materials: element block '" + blockLabel(mesh.blocks[b]) +
                       "' has no material; name it in the Element Blocks of one");
  return materialOfBlock;
}

ContactSpec contactSpec(const ContactOptions& options) {
  ContactSpec spec;
  spec.name = options.name;
  spec.secondarySideSet = options.secondarySideSet;
  spec.primarySideSet = options.primarySideSet;
  if (options.rigidPlane) spec.rigidPlane = RigidPlane{options.rigidPlane->point, options.rigidPlane->normal};
  spec.matchingTolerance = options.matchingTolerance;
  spec.discretization = options.discretization;
  spec.sides = options.sides;
  spec.multiplierSpace = options.multiplierSpace;
  spec.initialPenetration = options.initialPenetration;
  spec.smoothing = options.smoothing;
  spec.tied = !options.friction.law;
  spec.isFrictionless = options.friction.law == FrictionLaw::Frictionless;
  spec.principalDirection = options.friction.principalDirection;
  return spec;
}

FrictionSpec frictionSpec(const FrictionOptions& options) {
  FrictionSpec spec;
  spec.tied = !options.law;
  spec.law = options.law.value_or(FrictionLaw::Frictionless);
  if (spec.law == FrictionLaw::Frictionless) return spec;
  if (spec.law == FrictionLaw::Tresca) spec.slipBound = options.slipBound;
  if (!options.hasFields()) spec.coefficients = {options.coefficients[0].expression(0, 0, 0), options.coefficients[1].expression(0, 0, 0)};
  // Without any tangential resistance the tangential rows would only cost.
  if ((!options.hasFields() && spec.coefficients == std::array<double, 2>{0, 0}) || (spec.law == FrictionLaw::Tresca && spec.slipBound == 0))
    spec.law = FrictionLaw::Frictionless;
  return spec;
}

// Plain elements lock near incompressibility; B-bar frees all but linear tetrahedra, wedges and pyramids (doc/decisions/027).
void chooseFormulation(const std::vector<int>& materialOfBlock, const Mesh& mesh, ModelData& data) {
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const Topology topology = mesh.blocks[b].topology;
    if (materialOfBlock[b] < 0 || data.materials[std::size_t(materialOfBlock[b])].poissonsRatio <= kHardlyCompressible) continue;
    const std::string why = ", because Poisson's ratio of '" + data.materials[std::size_t(materialOfBlock[b])].name + "' is close to 0.5";
    if (topology != Topology::Hex8 && !elementShape(topology).hasMidNodes()) {
      data.remarks.push_back(std::string(topologyName(topology)) + " elements of block '" + blockLabel(mesh.blocks[b]) + "' are too stiff" +
                             why + "; HEX8 or quadratic elements are not");
    } else if (data.formulation != Formulation::BBar) {
      data.formulation = Formulation::BBar;
      data.remarks.push_back(std::string(topologyName(topology)) + " elements use B-bar (mean dilatation)" + why);
    }
  }
}

// Volumes, moments and their squares must stay within the range of double precision.
void requireOrdinarySize(const std::array<double, 6>& box) {
  constexpr double kLargest = 1e50, kSmallest = 1e-50;
  double extent = 0, largest = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double first = box[c], last = -box[c + 3];
    extent = std::max(extent, last - first);
    largest = std::max({largest, std::abs(first), std::abs(last)});
  }
  if (largest <= kLargest && extent >= kSmallest) return;
  throw InputError("Mesh: extends over " + numberText(extent) + " and to coordinates of " + numberText(largest) + "; lengths from " +
                   numberText(kSmallest) + " to " + numberText(kLargest) + " can be computed with, so use another unit of length");
}

// Least x, y, z of all nodes, and of -x, -y, -z.
std::array<double, 6> boxOf(const Communicator& comm, const MeshShare& mesh) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::array<double, 6> mine, all;
  mine.fill(kInfinity);
  for (const auto& x : mesh.part.coordinates)
    for (std::size_t c = 0; c < 3; ++c) {
      mine[c] = std::min(mine[c], x[c]);
      mine[c + 3] = std::min(mine[c + 3], -x[c]);
    }
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MIN, 6, mine.data(), all.data());
  return all;
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

std::vector<IsotropicMaterial> materialsOf(const std::vector<MaterialOptions>& options) {
  std::vector<IsotropicMaterial> materials;
  for (const auto& material : options) materials.push_back({material.name, material.youngsModulus, material.poissonsRatio});
  return materials;
}

// Messages name nodes and elements by their numbers, which a mesh in memory need not have.
void numberFromOne(std::vector<std::int64_t>& numbers, std::int64_t first, std::int64_t end) {
  if (std::int64_t(numbers.size()) == end - first) return;
  numbers.resize(std::size_t(end - first));
  std::iota(numbers.begin(), numbers.end(), first + 1);
}

// A mesh in memory may have fields of any length.
void requireFieldsOfNodes(const Mesh& mesh) {
  for (const auto& field : mesh.nodalFields)
    if (!field.values.empty() && field.values.size() != mesh.numNodes())
      throw InputError("Mesh: its nodal field '" + field.name + "' has " + std::to_string(field.values.size()) + " values for " +
                       std::to_string(mesh.numNodes()) + " nodes; give one for each");
}

SourceShare dealMesh(const Communicator& comm, const SourceMesh* source) {
  SourceShare share;
  static const Mesh nothing;
  const bool isRoot = comm.getRank() == 0;
  int hasBricks = isRoot && !source->bricks.empty();
  Teuchos::broadcast(comm, 0, Teuchos::outArg(hasBricks));
  share.hasBricks = hasBricks;
  runOnRoot(comm, [&] { requireFieldsOfNodes(isRoot ? source->mesh : nothing); });
  share.mesh = scatterMesh(comm, isRoot ? source->mesh : nothing);
  std::vector<std::vector<int>> bricks(std::size_t(comm.getSize()));
  if (isRoot && hasBricks)
    for (int r = 0; r < comm.getSize(); ++r)
      bricks[std::size_t(r)].assign(source->bricks.begin() + share.mesh.elements.begin(r),
                                    source->bricks.begin() + share.mesh.elements.begin(r + 1));
  share.bricks = joined(exchangeValues(comm, bricks));
  return share;
}

SourceShare makeBeams(const TwoBeamsOptions& options, int rank, int ranks) {
  SourceShare share;
  share.hasBricks = true;
  const TwoBeamsSpec spec{options.subdomainsPerEdge, options.elementsPerSubdomainEdge};
  share.mesh = shareTwoBeams(spec, rank, ranks);
  for (auto e = share.mesh.firstElement(); e < share.mesh.endElement(); ++e) share.bricks.push_back(brickOfElement(spec, e));
  return share;
}

}  // namespace

SourceShare makeShare(const Communicator& comm, const RunOptions& options, const SourceMesh* source) {
  int isInMemory = source != nullptr;
  Teuchos::broadcast(comm, 0, Teuchos::outArg(isInMemory));
  SourceShare share;
  if (isInMemory) share = dealMesh(comm, source);
  else if (options.mesh.twoBeams) runOnAllRanks(comm, [&] { share = makeBeams(*options.mesh.twoBeams, comm.getRank(), comm.getSize()); });
  else share.mesh = readMeshFiles(comm, options.mesh.file, namedFields(options.contacts));
  numberFromOne(share.mesh.part.nodeNumbers, share.mesh.firstNode(), share.mesh.endNode());
  numberFromOne(share.mesh.part.elementNumbers, share.mesh.firstElement(), share.mesh.endElement());
  if (!options.title.empty()) share.mesh.part.title = options.title;
  return share;
}

PartitionOptions partitionOptions(const DecompositionOptions& options, SourceShare& source) {
  PartitionOptions result;
  static_cast<DecompositionOptions&>(result) = options;
  if (options.method != PartitionMethod::Bricks) return result;
  if (!source.hasBricks)
    throw InputError("Decomposition->Method: Bricks is for the generated Two Beams mesh only; use METIS for a mesh from a file");
  result.bricks = std::move(source.bricks);
  return result;
}

ModelDraft draftModel(const Communicator& comm, const RunOptions& options, const MeshShare& mesh) {
  ModelDraft draft;
  ModelData& data = draft.data;
  const auto box = boxOf(comm, mesh);
  runOnAllRanks(comm, [&] {
    if (mesh.elements.size == 0) throw InputError("Mesh: has no elements");
    requireOrdinarySize(box);
    data.materials = materialsOf(options.materials);
    requireOrdinaryStiffness(data.materials);
    draft.materialOfBlock = assignMaterials(options.materials, mesh);
    chooseFormulation(draft.materialOfBlock, mesh.part, data);
    data.loads = collectLoads(options.conditions, mesh.part);
    requireLoadedSides(data.loads, mesh);
    draft.contactOptions = options.contacts;
    for (const auto& contact : options.contacts) {
      requireNodalFields(contact, mesh.part);
      data.interfaceNames.push_back(contact.name);
      data.friction.push_back(frictionSpec(contact.friction));
      draft.contacts.push_back(contactSpec(contact));
    }
  });
  return draft;
}

std::string describeNode(const Communicator& comm, const MeshShare& mesh, std::int64_t node) {
  ByteWriter writer;
  if (node >= mesh.firstNode() && node < mesh.endNode()) writer.write(describeNode(mesh.part, node - mesh.firstNode()));
  const Bytes message = gatherOnAll(comm, writer.take())[std::size_t(mesh.nodes.owner(node))];
  return ByteReader(message).readString();
}

namespace {

double sizeOf(const Communicator& comm, const MeshShare& mesh) {
  const auto box = boxOf(comm, mesh);
  return std::max({-box[3] - box[0], -box[4] - box[1], -box[5] - box[2]});
}

}  // namespace

void checkPinnedRows(const Communicator& comm, const MultiplierMap& multipliers, const MeshShare& mesh, const ModelData& data) {
  const auto overlap = firstPinnedOverlap(comm, multipliers, sizeOf(comm, mesh));
  if (!overlap) return;
  throw InsufficientModel("The model has no solution: at " + describeNode(comm, mesh, overlap->node) + " of contact '" +
                          data.interfaceNames[std::size_t(overlap->interface)] + "' the prescribed displacements make the surfaces overlap by " +
                          numberText(overlap->depth) + ".");
}

}  // namespace Haptos
