// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_PieceCut.hpp"

#include <metis.h>

#include <Teuchos_Comm.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "Haptos_ByteBuffer.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Exchange.hpp"
#include "Haptos_RoundParts.hpp"

namespace Haptos {
namespace {

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

void pack(ByteWriter& writer, const PieceToCut& piece) {
  writer.write(piece.graph.offsets);
  writer.write(piece.graph.neighbours);
  writer.write(piece.graph.couplings);
  writer.write(piece.centroids);
  writer.write(piece.parts);
  writer.write(piece.seed);
}

PieceToCut unpackPiece(ByteReader& reader) {
  PieceToCut piece;
  piece.graph.offsets = reader.readVector<std::int64_t>();
  piece.graph.neighbours = reader.readVector<std::int64_t>();
  piece.graph.couplings = reader.readVector<double>();
  piece.centroids = reader.readVector<std::array<double, 3>>();
  piece.parts = reader.read<int>();
  piece.seed = reader.read<int>();
  return piece;
}

// The largest piece first, each to the rank with least to do.
std::vector<std::vector<int>> shareOut(const std::vector<PieceToCut>& pieces, int ranks) {
  std::vector<int> order(pieces.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return pieces[a].centroids.size() > pieces[b].centroids.size(); });
  std::vector<std::vector<int>> piecesOf(ranks);
  std::vector<std::size_t> load(ranks, 0);
  for (int p : order) {
    const auto rank = std::min_element(load.begin(), load.end()) - load.begin();
    load[rank] += pieces[p].centroids.size();
    piecesOf[rank].push_back(p);
  }
  return piecesOf;
}

// The pieces of a message, cut; first the reason where that failed.
Bytes cutPieces(const Bytes& message) {
  std::string failure;
  std::vector<std::vector<int>> cuts;
  try {
    for (ByteReader reader(message); !reader.atEnd();) cuts.push_back(cutPiece(unpackPiece(reader)));
  } catch (const std::exception& e) {
    failure = e.what();
  }
  ByteWriter reply;
  reply.write(failure);
  for (const auto& cut : cuts) reply.write(cut);
  return reply.take();
}

}  // namespace

std::vector<int> cutPiece(const PieceToCut& piece) {
  auto part = runMetis(piece);
  fillEmptyParts(piece.graph, piece.parts, part);
  roundParts(piece.graph, piece.centroids, std::vector<double>(piece.parts, double(part.size()) / piece.parts), part);
  return part;
}

std::vector<std::vector<int>> cutOnRanks(const Communicator& comm, const std::vector<PieceToCut>& pieces) {
  if (comm.getSize() == 1) {
    std::vector<std::vector<int>> parts;
    runOnRoot(comm, [&] { std::transform(pieces.begin(), pieces.end(), std::back_inserter(parts), cutPiece); });
    return parts;
  }
  const auto piecesOf = shareOut(pieces, comm.getSize());
  std::vector<Bytes> messages;
  for (const auto& shared : piecesOf) {
    ByteWriter writer;
    for (int p : shared) pack(writer, pieces[p]);
    messages.push_back(writer.take());
  }
  const auto replies = gatherOnRoot(comm, cutPieces(scatterFromRoot(comm, messages)));
  std::vector<std::vector<int>> result(pieces.size());
  runOnRoot(comm, [&] {
    for (std::size_t r = 0; r < replies.size(); ++r) {
      ByteReader reader(replies[r]);
      const std::string failure = reader.readString();
      TEUCHOS_TEST_FOR_EXCEPTION(!failure.empty(), std::runtime_error, failure);
      for (int p : piecesOf[r]) result[p] = reader.readVector<int>();
    }
  });
  return result;
}

}  // namespace Haptos
