// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DistributedModel.hpp"

#include <Teuchos_Comm.hpp>
#include <algorithm>
#include <numeric>
#include <utility>

#include "Haptos_Error.hpp"
#include "Haptos_NodalGather.hpp"
#include "Haptos_NodeNeighbours.hpp"
#include "Haptos_PairLaws.hpp"
#include "Haptos_PartShape.hpp"
#include "Haptos_Partition.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_StiffnessAssembler.hpp"
#include "Haptos_SubdomainCopies.hpp"
#include "Haptos_SubdomainOrder.hpp"
#include "Haptos_ThinBodies.hpp"
#include "Haptos_UnpairedNodes.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

// The name of a body that is one piece; of one that nodes or edges alone hold together, those of its pieces.
std::vector<std::string> namePieces(const Bodies& bodies) {
  std::vector<int> pieces(bodies.names.size(), 0), seen(bodies.names.size(), 0);
  for (int body : bodies.ofPiece) ++pieces[std::size_t(body)];
  std::vector<std::string> names;
  for (const int body : bodies.ofPiece) {
    const auto b = std::size_t(body);
    names.push_back(bodies.names[b]);
    if (pieces[b] > 1) names.back() += " (piece " + std::to_string(++seen[b]) + " of " + std::to_string(pieces[b]) + ", joined by nodes or edges alone)";
  }
  return names;
}

// Bodies come before the cut: no subdomain may span two, and METIS is asked piece by piece.
Partition cutMesh(const Communicator& comm, const OwnElements& own, const PartitionOptions& options, ModelData& data) {
  const DualGraph graph = buildDualGraph(comm, own);
  const Bodies bodies = findBodies(comm, own, graph);
  data.bodyNames = bodies.names;
  data.metis = options.method == PartitionMethod::Metis;
  data.pieceNames = namePieces(bodies);
  Partition partition = partitionMesh(comm, own, graph, bodies, options);
  data.mendedFragments = partition.mended;
  return partition;
}

// Subdomains in the order of the ranks that get them.
struct OrderedPartition {
  Partition partition;
  std::vector<int> numNodes, copyOf;  // [partition.count]
};

// Bricks come in order, and all alike: whoever gives them has said which rank gets how many.
OrderedPartition ordered(const Communicator& comm, const OwnElements& own, const std::vector<ContactInterface>& interfaces,
                         const std::vector<int>& materialOfBlock, bool bricks, Partition partition) {
  OrderedPartition result;
  result.numNodes = bricks ? countNodes(comm, own, partition) : orderSubdomains(comm, own, interfaces, partition);
  if (!bricks) {
    result.copyOf = findCopies(comm, own, partition, materialOfBlock);
  } else {
    result.copyOf.resize(std::size_t(partition.count));
    std::iota(result.copyOf.begin(), result.copyOf.end(), 0);
  }
  result.partition = std::move(partition);
  return result;
}

// Contiguous ranges of subdomains, about equal in the work of their factors: neighbours in the order come to the same rank.
void deal(const OwnElements& own, const OrderedPartition& parts, const std::vector<int>& materialOfBlock, DistributedModel& model) {
  std::vector<double> work;
  for (int nodes : parts.numNodes) {
    work.push_back(workOfSubdomain(nodes));
    model.primalUnknowns += 3L * nodes;
  }
  const Partition& partition = parts.partition;
  const auto rankOf = dealCopiesToRanks(work, parts.copyOf, model.comm->getSize());
  model.numSubdomains = partition.count;
  model.firstSubdomain = int(std::lower_bound(rankOf.begin(), rankOf.end(), model.comm->getRank()) - rankOf.begin());
  model.subdomains = dealSubdomains(*model.comm, own, partition, rankOf, materialOfBlock);
}

// What subdomains hold their nodes with, by the diagonals of K and by what nodes of thin bodies meet; how thin they are.
std::vector<SubdomainNodes> weighNodes(DistributedModel& model, const std::vector<PlacedPair>& pairs) {
  std::vector<double> youngsModulus;
  for (const auto& material : model.data.materials) youngsModulus.push_back(material.youngsModulus);
  std::vector<SubdomainNodes> result;
  std::vector<PartOfBody> parts;
  runOnAllRanks(*model.comm, [&] {
    for (const auto& sub : model.subdomains) {
      PartVolume volume;
      const auto neighbours = [&sub] { return nodeNeighbours(sub.numNodes(), sub.groups); };
      result.push_back({sub.id, sub.nodes, nodalStiffness(sub.coordinates, sub.groups, youngsModulus, &volume)});
      model.aspects.push_back(aspectOfPart(sub.coordinates, neighbours(), volume));
      parts.push_back({sub.body, model.aspects.back(), sub.coordinates, neighbours});
    }
  });
  weighThinBodies(*model.comm, model.mesh.nodes, parts, pairs, result);
  return result;
}

RowSources rowSources(DistributedModel& model, const std::vector<ContactInterface>& interfaces) {
  RowSources sources;
  sources.pairs = placedPairs(interfaces);
  sources.subdomains = weighNodes(model, sources.pairs);
  sources.prescribed = model.prescribed;
  for (std::size_t k = 0; k < model.data.friction.size(); ++k)
    sources.interfaces.push_back(interfaceRows(model.data.interfaceNames[k], model.data.friction[k]));
  return sources;
}

}  // namespace

// Pairs are found before the cut, which keeps both sides of a contact together; nobody holds more of the mesh than its share.
DistributedModel distributeModel(const RCP<const Communicator>& comm, const RunOptions& options,
                                 const SourceMesh* source, RunClock& clock, const LatePairs& late) {
  DistributedModel model;
  model.comm = comm;
  SourceShare share;
  {
    const auto scope = clock.time(Phase::Read);
    share = makeShare(*comm, options, source);
  }
  const auto scope = clock.time(Phase::Decompose);
  ModelDraft draft = draftModel(*comm, options, share.mesh);
  draft.late = late;
  OwnElements own = completeElements(*comm, share.mesh);
  model.prescribed = collectDisplacements(*comm, options.conditions, share.mesh, own);
  const auto interfaces = pairSurfaces(*comm, share.mesh, model.prescribed, own, draft);
  PartitionOptions cut;
  runOnAllRanks(*comm, [&] { cut = partitionOptions(options.decomposition, share); });
  const OrderedPartition parts = ordered(*comm, own, interfaces, draft.materialOfBlock, cut.method == PartitionMethod::Bricks,
                                         cutMesh(*comm, own, cut, draft.data));
  model.mesh = std::move(share.mesh);
  model.data = std::move(draft.data);
  deal(own, parts, draft.materialOfBlock, model);
  model.work = {own.elements.count(own.rank), own.nodes.count(own.rank), parts.partition.elementsCut, 0, draft.surfaceElements};
  for (const auto& sub : model.subdomains) model.work.elementsHeld += std::int64_t(sub.elements.size());
  model.multipliers = Teuchos::rcp(new MultiplierMap(comm, rowSources(model, interfaces)));
  checkPinnedRows(*comm, *model.multipliers, model.mesh, model.data);
  for (const auto& interface : interfaces) model.unpaired.push_back(interface.unpaired);
  return model;
}

LatePairs findLatePairs(const DistributedModel& model, const NodalGather& gather, const std::vector<double>& displacement, double tolerance, bool& isAny) {
  isAny = false;
  LatePairs late(model.unpaired.size());
  if (model.data.unpairedNodes == 0) return late;
  for (std::size_t k = 0; k < model.data.interfaceNames.size(); ++k) {
    const UnpairedNodes* unpaired = model.unpaired.empty() ? nullptr : model.unpaired[k].get();
    const auto wanted = unpaired ? unpaired->meshNodes() : std::vector<std::int64_t>();
    const auto u = gather.fetch(displacement, wanted);
    if (!unpaired) continue;
    std::vector<Vec3::Array> vectors;
    for (std::size_t i = 0; i < u.size(); i += 3) vectors.push_back({u[i], u[i + 1], u[i + 2]});
    late[k] = unpaired->pairsUnder(vectors, tolerance);
    isAny = isAny || !late[k].empty();
  }
  isAny = broadcasted(*model.comm, isAny);
  return late;
}

}  // namespace Haptos
