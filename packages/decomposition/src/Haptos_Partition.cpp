// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Partition.hpp"

#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "Haptos_CoordinateBlocks.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Fragments.hpp"
#include "Haptos_PieceCut.hpp"
#include "Haptos_Reductions.hpp"

namespace Haptos {
namespace {

using Index = std::int64_t;

// Elements of a subdomain that is small enough for cheap factors and large enough to keep the coarse problem small: 180 nodes
// inside of it, but for linear tetrahedra, in the order of `Topology`.
constexpr std::array<double, kNumTopologies> kElementsPerSubdomain = {180, 1500, 45, 22, 135, 360, 72, 540, 83};

double idealCount(const Communicator& comm, const Mesh& mesh) {
  std::vector<Index> mine;
  for (const auto& block : mesh.blocks) mine.push_back(Index(block.numElements()));
  const auto all = sumOfAll(comm, mine);
  double count = 0;
  for (std::size_t b = 0; b < all.size(); ++b)
    count += double(all[b]) / kElementsPerSubdomain[std::size_t(mesh.blocks[b].topology)];
  return count;
}

// Parts per piece in proportion to its elements, at least one and at most one per element.
std::vector<int> sharePartsOut(const std::vector<Index>& sizes, int total) {
  const double numElements = double(std::accumulate(sizes.begin(), sizes.end(), Index(0)));
  const int pieces = int(sizes.size());
  std::vector<int> parts(sizes.size(), 1);
  std::vector<double> ideal(sizes.size());
  for (int p = 0; p < pieces; ++p) ideal[p] = total * double(sizes[p]) / numElements;
  for (int left = total - pieces; left > 0; --left) {  // to the piece with the largest parts
    int best = -1;
    for (int p = 0; p < pieces; ++p)
      if (parts[p] < sizes[p] && (best < 0 || ideal[p] / parts[p] > ideal[best] / parts[best])) best = p;
    ++parts[best];
  }
  return parts;
}

void checkCount(Index elements, int pieces, int wanted) {
  if (wanted < pieces)
    throw InputError("Decomposition->Subdomains = " + std::to_string(wanted) + " is too small: the mesh has " + std::to_string(pieces) +
                     " separate pieces and each needs a subdomain of its own");
  if (wanted > elements)
    throw InputError("Decomposition->Subdomains = " + std::to_string(wanted) + " is larger than the number of elements (" +
                     std::to_string(elements) + ")");
}

/// What METIS gets at once, with the piece that it belongs to.
struct Portions {
  PiecesToCut cuts;
  std::vector<int> pieceOf;  // [portions]
};

// One block of a large piece for so many elements, but none without a part.
std::vector<int> blocksOfPieces(const Components& pieces, const std::vector<int>& parts, const PartitionOptions& options) {
  std::vector<int> blocks;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const Index size = pieces.sizes[p], wanted = size > options.wholeUpTo ? (size + options.blockSize - 1) / options.blockSize : 1;
    blocks.push_back(int(std::min(wanted, Index(parts[p]))));
  }
  return blocks;
}

// Blocks are connected: what a cut left behind goes to the neighbour.
Portions cutLargePieces(const Communicator& comm, const ElementRange& own, const DualGraph& graph, const Coordinates& centroids,
                        const Components& pieces, const std::vector<int>& blocks) {
  Portions portions;
  auto& ofElement = portions.cuts.ofElement;
  cutIntoBlocks(comm, centroids, pieces.ofElement, blocks, ofElement);
  portions.pieceOf = mendParts(comm, own, graph, pieces, ofElement).firstPiece;
  std::vector<Index> mine(portions.pieceOf.size(), 0);
  for (int portion : ofElement) ++mine[std::size_t(portion)];
  portions.cuts.sizes = sumOfAll(comm, mine);
  return portions;
}

// Parts are shared out to the pieces first, and to the blocks of a large piece then: what METIS cuts at once has a fixed number.
Portions portionsOf(const Communicator& comm, const ElementRange& own, const DualGraph& graph, const Coordinates& centroids,
                    const Components& pieces, int total, const PartitionOptions& options) {
  checkCount(own.elements.size, pieces.count(), total);
  const auto parts = sharePartsOut(pieces.sizes, total);
  const auto blocks = blocksOfPieces(pieces, parts, options);
  Portions portions;
  if (std::all_of(blocks.begin(), blocks.end(), [](int count) { return count == 1; })) {
    portions.cuts = {pieces.ofElement, pieces.sizes, parts, options.seed};
    portions.pieceOf.resize(parts.size());
    std::iota(portions.pieceOf.begin(), portions.pieceOf.end(), 0);
    return portions;
  }
  portions = cutLargePieces(comm, own, graph, centroids, pieces, blocks);
  portions.cuts.seed = options.seed;
  for (std::size_t first = 0, last = 0; first < portions.pieceOf.size(); first = last) {
    const int piece = portions.pieceOf[first];
    while (last < portions.pieceOf.size() && portions.pieceOf[last] == piece) ++last;
    const auto& sizes = portions.cuts.sizes;
    const auto shared = sharePartsOut({sizes.begin() + long(first), sizes.begin() + long(last)}, parts[std::size_t(piece)]);
    portions.cuts.parts.insert(portions.cuts.parts.end(), shared.begin(), shared.end());
  }
  return portions;
}

Partition asItComes(const Communicator& comm, const OwnElements& own, const DualGraph& graph, const Components& pieces,
                    const PartitionOptions& options) {
  Partition result;
  result.ofElement = options.method == PartitionMethod::Bricks ? options.bricks : pieces.ofElement;
  TEUCHOS_ASSERT(result.ofElement.size() == own.part.elements.size());
  auto mended = mendParts(comm, own, graph, pieces, result.ofElement);
  result.mended = mended.moved;
  result.count = int(mended.firstPiece.size());
  result.pieceOfSubdomain = std::move(mended.firstPiece);
  return result;
}

}  // namespace

// Subdomains are numbered portion after portion: every portion knows its first number without asking.
Partition partitionGraph(const Communicator& comm, const ElementRange& own, const DualGraph& graph, const Coordinates& centroids,
                         const Components& pieces, int total, const PartitionOptions& options) {
  const Portions portions = portionsOf(comm, own, graph, centroids, pieces, total, options);
  Partition result;
  auto cut = cutOnRanks(comm, own, graph, centroids, portions.cuts, result.elementsCut);
  std::vector<int> first;
  for (std::size_t p = 0; p < portions.pieceOf.size(); ++p) {
    first.push_back(result.count);
    result.count += portions.cuts.parts[p];
    result.pieceOfSubdomain.resize(std::size_t(result.count), portions.pieceOf[p]);
  }
  result.ofElement = std::move(cut.part);
  for (std::size_t e = 0; e < result.ofElement.size(); ++e) result.ofElement[e] += first[std::size_t(portions.cuts.ofElement[e])];
  result.mended = cut.mended;
  return result;
}

Partition partitionMesh(const Communicator& comm, const OwnElements& own, const DualGraph& graph, const Bodies& bodies,
                        const PartitionOptions& options) {
  const int wanted = options.subdomains > 0 ? options.subdomains : std::max(bodies.pieces.count(), int(std::lround(idealCount(comm, own.part.mesh))));
  Partition result = options.method == PartitionMethod::Metis
                         ? partitionGraph(comm, own, graph, elementCentroids(own.part.mesh), bodies.pieces, wanted, options)
                         : asItComes(comm, own, graph, bodies.pieces, options);
  for (int piece : result.pieceOfSubdomain) result.bodyOfSubdomain.push_back(bodies.ofPiece[std::size_t(piece)]);
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
