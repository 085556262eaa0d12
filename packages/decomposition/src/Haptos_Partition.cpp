// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Partition.hpp"

#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "Haptos_Error.hpp"

namespace Haptos {
namespace {

// Small enough for cheap factors, large enough to keep the coarse problem small.
constexpr double kElementsPerSubdomainHex = 180, kElementsPerSubdomainTet = 1500;

BodyPieces sideConnectedPieces(const DualGraph& graph) {
  BodyPieces pieces;
  pieces.ofElement = connectedComponents(graph, {}, pieces.count);
  pieces.elements.resize(pieces.count);
  for (std::size_t e = 0; e < pieces.ofElement.size(); ++e) pieces.elements[pieces.ofElement[e]].push_back(int(e));
  return pieces;
}

double idealCount(const Mesh& mesh) {
  double count = 0;
  for (const auto& block : mesh.blocks)
    count += double(block.numElements()) /
             (block.topology == Topology::Hex8 ? kElementsPerSubdomainHex : kElementsPerSubdomainTet);
  return count;
}

// Parts per piece in proportion to its elements, at least one and at most one per element.
std::vector<int> sharePartsOut(const Mesh& mesh, const BodyPieces& pieces, int total) {
  const double numElements = double(mesh.numElements());
  std::vector<int> parts(pieces.count, 1);
  std::vector<double> ideal(pieces.count);
  for (int p = 0; p < pieces.count; ++p) ideal[p] = total * double(pieces.elements[p].size()) / numElements;
  for (int left = total - pieces.count; left > 0; --left) {  // to the piece with the largest parts
    int best = -1;
    for (int p = 0; p < pieces.count; ++p)
      if (parts[p] < int(pieces.elements[p].size()) && (best < 0 || ideal[p] / parts[p] > ideal[best] / parts[best])) best = p;
    ++parts[best];
  }
  return parts;
}

// A part in several fragments keeps its largest one.  Each other fragment goes to the part with whose main fragment it
// shares most sides; only to main fragments, or two fragments could change places for ever.  A fragment that reaches
// none becomes a part of its own.  Returns the number of fragments moved.
int mendFragments(const DualGraph& graph, std::vector<int>& part) {
  for (int moved = 0;;) {
    int count = 0;
    const auto fragment = connectedComponents(graph, part, count);
    std::vector<int> size(count, 0), owner(count);
    for (std::size_t e = 0; e < part.size(); ++e) ++size[fragment[e]], owner[fragment[e]] = part[e];
    std::map<int, int> mainOf;  // part -> fragment
    for (int f = 0; f < count; ++f) {
      const auto [it, isNew] = mainOf.emplace(owner[f], f);
      if (!isNew && size[f] > size[it->second]) it->second = f;
    }
    std::map<int, std::map<int, int>> shared;  // lost fragment -> neighbouring part -> sides
    for (std::size_t e = 0; e < part.size(); ++e) {
      if (mainOf[part[e]] == fragment[e]) continue;
      auto& sides = shared[fragment[e]];
      for (auto k = graph.offsets[e]; k < graph.offsets[e + 1]; ++k) {
        const auto other = graph.neighbours[k];
        if (mainOf[part[other]] == fragment[other]) ++sides[part[other]];
      }
    }
    if (shared.empty()) return moved;
    std::map<int, int> target;
    for (const auto& [f, parts] : shared)
      if (!parts.empty())
        target[f] = std::max_element(parts.begin(), parts.end(), [](auto& a, auto& b) { return a.second < b.second; })->first;
    if (target.empty()) target[shared.begin()->first] = mainOf.rbegin()->first + 1;
    for (std::size_t e = 0; e < part.size(); ++e) {
      const auto it = target.find(fragment[e]);
      if (it != target.end()) part[e] = it->second;
    }
    moved += int(target.size());
  }
}

// Renumbers so that no number is unused, in the order of the old numbers.
int compress(std::vector<int>& part) {
  std::map<int, int> number;
  for (int p : part) number.emplace(p, 0);
  int next = 0;
  for (auto& [old, now] : number) now = next++;
  for (int& p : part) p = number[p];
  return next;
}

void checkCount(const Mesh& mesh, const BodyPieces& pieces, int wanted) {
  if (wanted < pieces.count)
    throw InputError("Decomposition->Subdomains = " + std::to_string(wanted) + " is too small: the mesh has " +
                     std::to_string(pieces.count) + " separate pieces and each needs a subdomain of its own");
  if (std::size_t(wanted) > mesh.numElements())
    throw InputError("Decomposition->Subdomains = " + std::to_string(wanted) + " is larger than the number of elements (" +
                     std::to_string(mesh.numElements()) + ")");
}

// A piece alone: its elements by their place in it.
PieceToCut extractPiece(const DualGraph& graph, const std::vector<std::array<double, 3>>& centroids, const std::vector<int>& elements,
                        std::vector<int>& place) {
  PieceToCut piece;
  piece.graph.offsets.push_back(0);
  for (std::size_t i = 0; i < elements.size(); ++i) place[std::size_t(elements[i])] = int(i);
  for (int e : elements) {
    for (auto k = graph.offsets[e]; k < graph.offsets[e + 1]; ++k) {
      piece.graph.neighbours.push_back(place[std::size_t(graph.neighbours[k])]);
      piece.graph.couplings.push_back(graph.couplings[k]);
    }
    piece.graph.offsets.push_back(std::int64_t(piece.graph.neighbours.size()));
    piece.centroids.push_back(centroids[std::size_t(e)]);
  }
  return piece;
}

std::vector<PieceToCut> piecesToCut(const Mesh& mesh, const DualGraph& graph, const BodyPieces& pieces, const PartitionOptions& options) {
  const int automatic = std::max(pieces.count, int(std::lround(idealCount(mesh))));
  const int total = options.subdomains == 0 ? automatic : options.subdomains;
  checkCount(mesh, pieces, total);
  const auto parts = sharePartsOut(mesh, pieces, total);
  const auto centroids = elementCentroids(mesh);
  std::vector<int> place(mesh.numElements());
  std::vector<PieceToCut> result;
  for (int p = 0; p < pieces.count; ++p) {
    result.push_back(extractPiece(graph, centroids, pieces.elements[p], place));
    result.back().parts = parts[p];
    result.back().seed = options.seed;
  }
  return result;
}

// Parts of all pieces, one piece after the other.
std::vector<int> numberParts(const BodyPieces& pieces, const std::vector<std::vector<int>>& partsOfPieces) {
  std::vector<int> part(pieces.ofElement.size());
  int first = 0;
  for (int p = 0; p < pieces.count; ++p) {
    for (std::size_t i = 0; i < pieces.elements[p].size(); ++i) part[std::size_t(pieces.elements[p][i])] = first + partsOfPieces[p][i];
    first += 1 + *std::max_element(partsOfPieces[p].begin(), partsOfPieces[p].end());  // none is empty
  }
  return part;
}

}  // namespace

PartitionPlan planPartition(const Mesh& mesh, const DualGraph& graph, const PartitionOptions& options) {
  PartitionPlan plan;
  plan.pieces = sideConnectedPieces(graph);
  if (options.method == PartitionMethod::Metis) plan.cuts = piecesToCut(mesh, graph, plan.pieces, options);
  return plan;
}

Partition finishPartition(const DualGraph& graph, const Bodies& bodies, const PartitionOptions& options, const PartitionPlan& plan,
                          const std::vector<std::vector<int>>& partsOfPieces) {
  Partition result;
  switch (options.method) {
    case PartitionMethod::Metis: result.ofElement = numberParts(plan.pieces, partsOfPieces); break;
    case PartitionMethod::Block: result.ofElement = plan.pieces.ofElement; break;
    case PartitionMethod::Bricks:
      TEUCHOS_ASSERT(options.bricks.size() == bodies.ofElement.size());
      result.ofElement = options.bricks;
      break;
  }
  result.mended = mendFragments(graph, result.ofElement);
  result.count = compress(result.ofElement);
  result.bodyOfSubdomain.resize(result.count);
  for (std::size_t e = 0; e < result.ofElement.size(); ++e) result.bodyOfSubdomain[result.ofElement[e]] = bodies.ofElement[e];
  return result;
}

Partition partitionMesh(const Mesh& mesh, const DualGraph& graph, const Bodies& bodies, const PartitionOptions& options) {
  const PartitionPlan plan = planPartition(mesh, graph, options);
  std::vector<std::vector<int>> parts;
  for (const auto& piece : plan.cuts) parts.push_back(cutPiece(piece));
  return finishPartition(graph, bodies, options, plan, parts);
}

std::vector<int> dealToRanks(const std::vector<double>& weights, int ranks) {
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  std::vector<int> rankOf(weights.size());
  double before = 0;
  for (std::size_t s = 0; s < weights.size(); ++s) {
    const double middle = before + 0.5 * weights[s];
    rankOf[s] = std::min(ranks - 1, int(middle / total * ranks));
    before += weights[s];
  }
  return rankOf;
}

}  // namespace Haptos
