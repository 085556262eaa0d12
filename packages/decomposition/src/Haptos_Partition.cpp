// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Partition.hpp"

#include <metis.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "Haptos_Error.hpp"
#include "Haptos_RoundParts.hpp"

namespace Haptos {
namespace {

// Small enough for cheap factors, large enough to keep the coarse problem small.
constexpr double kElementsPerSubdomainHex = 180, kElementsPerSubdomainTet = 1500;

struct Pieces {
  int count = 0;
  std::vector<int> ofElement;            // [numElements] side-connected piece
  std::vector<int> body;                 // [count]
  std::vector<std::vector<int>> elements;  // [count]
};

Pieces sideConnectedPieces(const DualGraph& graph, const Bodies& bodies) {
  Pieces pieces;
  pieces.ofElement = connectedComponents(graph, {}, pieces.count);
  pieces.body.resize(pieces.count);
  pieces.elements.resize(pieces.count);
  for (std::size_t e = 0; e < pieces.ofElement.size(); ++e) {
    pieces.body[pieces.ofElement[e]] = bodies.ofElement[e];
    pieces.elements[pieces.ofElement[e]].push_back(int(e));
  }
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
std::vector<int> sharePartsOut(const Mesh& mesh, const Pieces& pieces, int total) {
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

// METIS takes whole numbers, whose sum must stay within an idx_t.  The least coupling counts 1, so that a regular mesh
// of cubes has no weights at all.
std::vector<idx_t> edgeWeights(const std::vector<double>& couplings) {
  double least = std::numeric_limits<double>::infinity();
  for (double c : couplings)
    if (c > 0) least = std::min(least, c);
  const double largest = std::max(1.0, std::min(1e4, 1e9 / double(couplings.size() + 1)));
  std::vector<idx_t> weights;
  for (double c : couplings) weights.push_back(c > 0 ? idx_t(std::lround(std::min(largest, c / least))) : 1);
  return weights;
}

std::vector<int> runMetis(const DualGraph& graph, const std::vector<int>& elements, int parts, int seed) {
  std::vector<idx_t> position(graph.offsets.size() - 1, -1), offsets{0}, neighbours;
  std::vector<double> couplings;
  for (std::size_t i = 0; i < elements.size(); ++i) position[elements[i]] = idx_t(i);
  for (int e : elements) {
    for (auto k = graph.offsets[e]; k < graph.offsets[e + 1]; ++k) {
      neighbours.push_back(position[graph.neighbours[k]]);
      couplings.push_back(graph.couplings[k]);
    }
    offsets.push_back(idx_t(neighbours.size()));
  }
  auto weights = edgeWeights(couplings);
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = seed;
  options[METIS_OPTION_NUMBERING] = 0;
  options[METIS_OPTION_CONTIG] = 1;
  options[METIS_OPTION_NCUTS] = 1;
  options[METIS_OPTION_UFACTOR] = 50;
  idx_t n = idx_t(elements.size()), constraints = 1, count = parts, cut = 0;
  std::vector<idx_t> part(elements.size(), 0);
  if (parts > 1) {
    const int status = METIS_PartGraphKway(&n, &constraints, offsets.data(), neighbours.data(), nullptr, nullptr,
                                           weights.data(), &count, nullptr, nullptr, options, &cut, part.data());
    TEUCHOS_TEST_FOR_EXCEPTION(status != METIS_OK, std::runtime_error, "METIS_PartGraphKway failed with status " << status);
  }
  return std::vector<int>(part.begin(), part.end());
}

// METIS may leave parts empty where there are few elements for each.  Every empty one takes from the largest part the
// element that a breadth-first walk reaches last: what remains of that part stays connected.
void fillEmptyParts(const DualGraph& graph, const std::vector<int>& elements, int parts, std::vector<int>& part) {
  std::vector<int> size(parts, 0), position(graph.offsets.size() - 1, -1);
  for (std::size_t i = 0; i < elements.size(); ++i) position[elements[i]] = int(i), ++size[part[i]];
  for (int empty = 0; empty < parts; ++empty) {
    if (size[empty] > 0) continue;
    const int from = int(std::max_element(size.begin(), size.end()) - size.begin());
    std::vector<int> walk{int(std::find(part.begin(), part.end(), from) - part.begin())};
    std::vector<char> seen(part.size(), 0);
    seen[walk[0]] = 1;
    for (std::size_t at = 0; at < walk.size(); ++at) {
      const int e = elements[walk[at]];
      for (auto k = graph.offsets[e]; k < graph.offsets[e + 1]; ++k) {
        const int other = position[graph.neighbours[k]];
        if (!seen[other] && part[other] == from) seen[other] = 1, walk.push_back(other);
      }
    }
    part[walk.back()] = empty;
    --size[from], ++size[empty];
  }
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

void checkCount(const Mesh& mesh, const Pieces& pieces, int wanted) {
  if (wanted < pieces.count)
    throw InputError("Decomposition->Subdomains = " + std::to_string(wanted) + " is too small: the mesh has " +
                     std::to_string(pieces.count) + " separate pieces and each needs a subdomain of its own");
  if (std::size_t(wanted) > mesh.numElements())
    throw InputError("Decomposition->Subdomains = " + std::to_string(wanted) + " is larger than the number of elements (" +
                     std::to_string(mesh.numElements()) + ")");
}

std::vector<int> cutByMetis(const Mesh& mesh, const DualGraph& graph, const Pieces& pieces, const PartitionOptions& options) {
  const int automatic = std::max(pieces.count, int(std::lround(idealCount(mesh))));
  const int total = options.subdomains == 0 ? automatic : options.subdomains;
  checkCount(mesh, pieces, total);
  const auto parts = sharePartsOut(mesh, pieces, total);
  std::vector<int> result(mesh.numElements());
  std::vector<double> wanted;
  int first = 0;
  for (int p = 0; p < pieces.count; ++p) {
    auto local = runMetis(graph, pieces.elements[p], parts[p], options.seed);
    fillEmptyParts(graph, pieces.elements[p], parts[p], local);
    for (std::size_t i = 0; i < local.size(); ++i) result[pieces.elements[p][i]] = first + local[i];
    wanted.insert(wanted.end(), parts[p], double(pieces.elements[p].size()) / parts[p]);
    first += parts[p];
  }
  roundParts(graph, elementCentroids(mesh), wanted, result);
  return result;
}

}  // namespace

Partition partitionMesh(const Mesh& mesh, const DualGraph& graph, const Bodies& bodies, const PartitionOptions& options) {
  const Pieces pieces = sideConnectedPieces(graph, bodies);
  Partition result;
  switch (options.method) {
    case PartitionMethod::Metis: result.ofElement = cutByMetis(mesh, graph, pieces, options); break;
    case PartitionMethod::Block: result.ofElement = pieces.ofElement; break;
    case PartitionMethod::Bricks:
      TEUCHOS_ASSERT(options.bricks.size() == mesh.numElements());
      result.ofElement = options.bricks;
      break;
  }
  result.mended = mendFragments(graph, result.ofElement);
  result.count = compress(result.ofElement);
  result.bodyOfSubdomain.resize(result.count);
  for (std::size_t e = 0; e < result.ofElement.size(); ++e) result.bodyOfSubdomain[result.ofElement[e]] = bodies.ofElement[e];
  return result;
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
