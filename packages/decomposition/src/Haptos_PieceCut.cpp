// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_PieceCut.hpp"

#include <metis.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>

#include "Haptos_Error.hpp"
#include "Haptos_Fragments.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_RoundParts.hpp"
#include "Haptos_SmoothWalls.hpp"

namespace Haptos {
namespace {

using Index = std::int64_t;

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

// One call for the piece as a whole: contiguous parts, at most 5 % too large, and digits that follow from graph and seed alone.
std::vector<int> runMetis(const PieceToCut& piece) {
  const DualGraph& graph = piece.graph;
  std::vector<idx_t> offsets(graph.offsets.begin(), graph.offsets.end()), neighbours(graph.neighbours.begin(), graph.neighbours.end());
  TEUCHOS_TEST_FOR_EXCEPTION(graph.neighbours.size() > std::size_t(std::numeric_limits<idx_t>::max()), std::runtime_error,
                             "METIS counts the " << graph.neighbours.size() << " neighbours in a piece of " << piece.centroids.size()
                                                 << " elements in " << 8 * sizeof(idx_t) << " bits");
  auto weights = edgeWeights(graph.couplings);
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = piece.seed;
  options[METIS_OPTION_NUMBERING] = 0;
  options[METIS_OPTION_CONTIG] = 1;
  options[METIS_OPTION_NCUTS] = 1;
  options[METIS_OPTION_UFACTOR] = 50;
  idx_t n = idx_t(piece.centroids.size()), constraints = 1, count = piece.parts, cut = 0;
  std::vector<idx_t> part(piece.centroids.size(), 0);
  if (piece.parts > 1) {
    const int status = METIS_PartGraphKway(&n, &constraints, offsets.data(), neighbours.data(), nullptr, nullptr,
                                           weights.data(), &count, nullptr, nullptr, options, &cut, part.data());
    TEUCHOS_TEST_FOR_EXCEPTION(status != METIS_OK, std::runtime_error, "METIS_PartGraphKway failed with status " << status);
  }
  return std::vector<int>(part.begin(), part.end());
}

// METIS may leave parts empty where there are few elements for each.  Every empty one takes from the largest part the
// element that a breadth-first walk reaches last: what remains of that part stays connected.
void fillEmptyParts(const DualGraph& graph, int parts, std::vector<int>& part) {
  std::vector<int> size(parts, 0);
  for (int p : part) ++size[p];
  for (int empty = 0; empty < parts; ++empty) {
    if (size[empty] > 0) continue;
    const int from = int(std::max_element(size.begin(), size.end()) - size.begin());
    std::vector<int> walk{int(std::find(part.begin(), part.end(), from) - part.begin())};
    std::vector<char> seen(part.size(), 0);
    seen[walk[0]] = 1;
    for (std::size_t at = 0; at < walk.size(); ++at) {
      const int e = walk[at];
      for (auto k = graph.offsets[e]; k < graph.offsets[e + 1]; ++k) {
        const int other = int(graph.neighbours[k]);
        if (!seen[other] && part[other] == from) seen[other] = 1, walk.push_back(other);
      }
    }
    part[walk.back()] = empty;
    --size[from], ++size[empty];
  }
}

// What the walls of a partition cut, each side once from either part.
double couplingsCut(const DualGraph& graph, const std::vector<int>& part) {
  double sum = 0;
  for (std::size_t e = 0; e < part.size(); ++e)
    for (auto k = graph.offsets[e]; k < graph.offsets[e + 1]; ++k)
      if (part[std::size_t(graph.neighbours[std::size_t(k)])] != part[e]) sum += graph.couplings[std::size_t(k)];
  return sum;
}

// Walls of a Voronoi diagram know centroids alone: among tetrahedra they have teeth, as slender as the elements are, which are taken off.  Where
// more than that is left METIS' parts stay (decisions/039, 048).
void roundWithoutTeeth(const PieceToCut& piece, std::vector<int>& part) {
  constexpr double kTeeth = 1.25;  // couplings cut, to those of METIS: 0.8 to 1.1 in ordinary meshes, 1.4 to 6 with teeth
  std::vector<int> round = part;
  roundParts(piece.graph, piece.centroids, std::vector<double>(std::size_t(piece.parts), double(part.size()) / piece.parts), round);
  smoothWalls(piece.graph, round);
  if (couplingsCut(piece.graph, round) <= kTeeth * couplingsCut(piece.graph, part)) part = std::move(round);
}

// The largest piece first, each to the rank with least to do.  -1: there is nothing to cut.
std::vector<int> shareOut(const PiecesToCut& pieces, int ranks) {
  std::vector<int> order(pieces.sizes.size()), rankOf(pieces.sizes.size(), -1);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return pieces.sizes[a] > pieces.sizes[b]; });
  std::vector<Index> load(static_cast<std::size_t>(ranks), 0);
  for (int p : order) {
    if (pieces.parts[p] == 1) continue;
    const auto rank = std::min_element(load.begin(), load.end()) - load.begin();
    load[std::size_t(rank)] += pieces.sizes[p];
    rankOf[p] = int(rank);
  }
  return rankOf;
}

struct SentElement {
  Index element;
  std::array<double, 3> centroid;
  int piece, neighbours;
};

/// Rows of the graph on their way to the rank that cuts their piece.
struct SentRows {
  std::vector<std::vector<SentElement>> elements;
  std::vector<std::vector<Index>> neighbours;
  std::vector<std::vector<double>> couplings;
  explicit SentRows(int ranks) : elements(std::size_t(ranks)), neighbours(std::size_t(ranks)), couplings(std::size_t(ranks)) {}
};

// Rows of a piece go to one rank; pieces of a single part stay where they are.
SentRows rowsByRank(const ElementRange& own, const DualGraph& graph, const Coordinates& centroids,
                    const std::vector<int>& pieceOf, const std::vector<int>& rankOf) {
  SentRows rows(own.elements.ranks);
  for (std::size_t e = 0; e < pieceOf.size(); ++e) {
    if (rankOf[pieceOf[e]] < 0) continue;
    const auto r = std::size_t(rankOf[pieceOf[e]]), begin = std::size_t(graph.offsets[e]), end = std::size_t(graph.offsets[e + 1]);
    rows.elements[r].push_back({own.firstElement() + Index(e), centroids[e], pieceOf[e], int(end - begin)});
    rows.neighbours[r].insert(rows.neighbours[r].end(), &graph.neighbours[begin], &graph.neighbours[begin] + (end - begin));
    rows.couplings[r].insert(rows.couplings[r].end(), &graph.couplings[begin], &graph.couplings[begin] + (end - begin));
  }
  return rows;
}

/// A piece as its rows come in, in the order of the elements.
struct GatheredPiece {
  std::vector<Index> elements, ends, neighbours;  // ends of rows
  std::vector<double> couplings;
  PieceToCut piece;
};

// By rank, and so by element: a piece comes in the order of the mesh, whoever had its elements.
std::map<int, GatheredPiece> gatherPieces(const Communicator& comm, SentRows rows, const PiecesToCut& pieces,
                                          std::vector<std::vector<SentElement>>& received) {
  received = exchangeValues(comm, rows.elements);
  const auto neighbours = joined(exchangeValues(comm, rows.neighbours));
  const auto couplings = joined(exchangeValues(comm, rows.couplings));
  std::map<int, GatheredPiece> result;
  std::size_t at = 0;
  for (const auto& fromRank : received)
    for (const SentElement& sent : fromRank) {
      GatheredPiece& to = result[sent.piece];
      to.elements.push_back(sent.element);
      to.piece.centroids.push_back(sent.centroid);
      to.neighbours.insert(to.neighbours.end(), &neighbours[at], &neighbours[at] + sent.neighbours);
      to.couplings.insert(to.couplings.end(), &couplings[at], &couplings[at] + sent.neighbours);
      to.ends.push_back(Index(to.neighbours.size()));
      at += std::size_t(sent.neighbours);
    }
  for (auto& [p, gathered] : result) {
    gathered.piece.parts = pieces.parts[std::size_t(p)];
    gathered.piece.seed = pieces.seed;
  }
  return result;
}

// Neighbours outside the piece are none of its business.
void localise(GatheredPiece& gathered) {
  DualGraph& graph = gathered.piece.graph;
  const auto& elements = gathered.elements;
  const bool isRange = elements.back() - elements.front() + 1 == Index(elements.size());
  graph.offsets.push_back(0);
  Index k = 0;
  for (Index end : gathered.ends) {
    for (; k < end; ++k) {
      const Index neighbour = gathered.neighbours[std::size_t(k)];
      if (neighbour < elements.front() || neighbour > elements.back()) continue;
      const Index place = isRange ? neighbour - elements.front()
                                  : std::lower_bound(elements.begin(), elements.end(), neighbour) - elements.begin();
      if (elements[std::size_t(place)] != neighbour) continue;
      graph.neighbours.push_back(place);
      graph.couplings.push_back(gathered.couplings[std::size_t(k)]);
    }
    graph.offsets.push_back(Index(graph.neighbours.size()));
  }
  gathered.ends = {}, gathered.neighbours = {}, gathered.couplings = {};
}

}  // namespace

PartsOfPiece cutPiece(const PieceToCut& piece) {
  PartsOfPiece result;
  result.part = runMetis(piece);
  fillEmptyParts(piece.graph, piece.parts, result.part);
  roundWithoutTeeth(piece, result.part);
  result.mended = mendParts(piece.graph, result.part);
  return result;
}

PartsOfPiece cutOnRanks(const Communicator& comm, const ElementRange& own, const DualGraph& graph,
                        const Coordinates& centroids, const PiecesToCut& pieces, std::int64_t& elementsCut) {
  const auto rankOf = shareOut(pieces, comm.getSize());
  std::vector<std::vector<SentElement>> received;
  auto gathered = gatherPieces(comm, rowsByRank(own, graph, centroids, pieces.ofElement, rankOf), pieces, received);
  std::map<int, std::vector<int>> partsOf;
  int mended = 0;
  runOnAllRanks(comm, [&] {
    for (auto& [p, one] : gathered) {
      localise(one);
      elementsCut += Index(one.elements.size());
      auto cut = cutPiece(one.piece);
      one = {};
      mended += cut.mended;
      partsOf[p] = std::move(cut.part);
    }
  });
  std::map<int, std::size_t> next;  // piece -> its next element: they come back as they came
  std::vector<std::vector<int>> replies(received.size());
  for (std::size_t r = 0; r < received.size(); ++r)
    for (const SentElement& sent : received[r]) replies[r].push_back(partsOf[sent.piece][next[sent.piece]++]);
  replies = exchangeValues(comm, replies);
  PartsOfPiece result;
  std::vector<std::size_t> taken(replies.size(), 0);
  for (int p : pieces.ofElement) {
    const int r = rankOf[p];
    result.part.push_back(r < 0 ? 0 : replies[std::size_t(r)][taken[std::size_t(r)]++]);
  }
  result.mended = sumOfAll(comm, mended);
  return result;
}

}  // namespace Haptos
