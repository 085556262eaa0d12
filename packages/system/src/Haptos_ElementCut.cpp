// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ElementCut.hpp"

#include <metis.h>

#include <Teuchos_Comm.hpp>
#include <algorithm>
#include <map>
#include <numeric>

#include "Haptos_ByteBuffer.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Exchange.hpp"
#include "Haptos_SubdomainOrder.hpp"

namespace Haptos {
namespace {

using Nodes = std::vector<std::int64_t>;

// An element where it was brought.
struct Place {
  int body, rank, position;
  Nodes nodes;
};

// What rank 0 tells the others: subdomain of each of their elements; body and rank of every subdomain.
struct Cut {
  std::vector<std::vector<int>> subdomainOf;  // [ranks][elements]
  std::vector<int> bodyOf, rankOf;            // [subdomains]
};

std::vector<Place> gatherPlaces(const Communicator& comm, const std::vector<ElementMatrix>& elements) {
  ByteWriter writer;
  writer.write(elements.size());
  for (const auto& element : elements) {
    writer.write(element.body);
    writer.write(element.nodes);
  }
  std::vector<Place> places;
  const auto messages = gatherOnRoot(comm, writer.take());
  for (std::size_t rank = 0; rank < messages.size(); ++rank) {
    ByteReader reader(messages[rank]);
    const auto count = reader.read<std::size_t>();
    for (std::size_t i = 0; i < count; ++i) {
      const int body = reader.read<int>();
      places.push_back({body, int(rank), int(i), reader.readVector<std::int64_t>()});
    }
  }
  // Whoever brought them.
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return std::tie(a.body, a.nodes) < std::tie(b.body, b.nodes); });
  return places;
}

struct Graph {
  std::vector<idx_t> offsets{0}, neighbours;
};

// Elements [first, last) that share a side.
Graph connect(const std::vector<Place>& places, std::size_t first, std::size_t last) {
  std::map<std::int64_t, std::vector<int>> elementsAt;
  for (std::size_t i = first; i < last; ++i)
    for (auto node : places[i].nodes) elementsAt[node].push_back(int(i - first));
  Graph graph;
  std::map<int, std::size_t> shared;
  for (std::size_t i = first; i < last; ++i) {
    shared.clear();
    for (auto node : places[i].nodes)
      for (int other : elementsAt[node]) ++shared[other];
    for (const auto& [other, count] : shared) {
      const std::size_t fewest = std::min(places[i].nodes.size(), places[first + std::size_t(other)].nodes.size());
      if (other != int(i - first) && count >= std::min<std::size_t>(3, fewest - 1)) graph.neighbours.push_back(other);
    }
    graph.offsets.push_back(idx_t(graph.neighbours.size()));
  }
  return graph;
}

// Numbers of connected parts of the graph, counted within equal labels.
int splitPieces(const Graph& graph, const std::vector<idx_t>& labels, std::vector<int>& piece) {
  int count = 0;
  piece.assign(labels.size(), -1);
  for (std::size_t seed = 0; seed < labels.size(); ++seed) {
    if (piece[seed] >= 0) continue;
    std::vector<std::size_t> queue{seed};
    piece[seed] = count;
    for (std::size_t at = 0; at < queue.size(); ++at)
      for (auto k = graph.offsets[queue[at]]; k < graph.offsets[queue[at] + 1]; ++k) {
        const auto next = std::size_t(graph.neighbours[std::size_t(k)]);
        if (piece[next] >= 0 || labels[next] != labels[seed]) continue;
        piece[next] = count;
        queue.push_back(next);
      }
    ++count;
  }
  return count;
}

std::vector<idx_t> cutGraph(Graph& graph, idx_t parts, int seed) {
  idx_t n = idx_t(graph.offsets.size()) - 1, constraints = 1, edges = 0;
  std::vector<idx_t> part(std::size_t(n), 0);
  parts = std::min(parts, n);
  if (parts <= 1) return part;
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = seed;
  options[METIS_OPTION_NUMBERING] = 0;
  options[METIS_OPTION_CONTIG] = 1;
  const int status = METIS_PartGraphKway(&n, &constraints, graph.offsets.data(), graph.neighbours.data(), nullptr, nullptr, nullptr, &parts,
                                         nullptr, nullptr, options, &edges, part.data());
  if (status != METIS_OK) throw std::runtime_error("METIS_PartGraphKway failed with status " + std::to_string(status));
  return part;
}

// As many as were asked for, or parts of about 200 elements and at least one a rank.
double partsWanted(const DecompositionOptions& options, std::size_t elements, int ranks) {
  constexpr double kElements = 200;
  return options.subdomains > 0 ? options.subdomains : std::max(double(ranks), double(elements) / kElements);
}

Cut cutPlaces(const std::vector<Place>& places, const DecompositionOptions& options, int ranks) {
  Cut cut;
  cut.subdomainOf.resize(std::size_t(ranks));
  const double share = partsWanted(options, places.size(), ranks) / double(places.size());
  std::vector<double> work;
  for (std::size_t first = 0, last = 0; first < places.size(); first = last) {
    while (last < places.size() && places[last].body == places[first].body) ++last;
    Graph graph = connect(places, first, last);
    std::vector<int> piece;
    if (splitPieces(graph, std::vector<idx_t>(last - first, 0), piece) > 1)
      throw InputError("Body " + std::to_string(places[first].body) +
                       " is in pieces that share no side of an element; give every piece a body of its own.");
    const auto parts = idx_t(std::lround(share * double(last - first)));
    const int count = splitPieces(graph, cutGraph(graph, parts, options.seed), piece), before = int(work.size());
    work.resize(work.size() + std::size_t(count), 0.0);
    cut.bodyOf.resize(work.size(), places[first].body);
    for (std::size_t i = first; i < last; ++i) {
      const int subdomain = before + piece[i - first];
      work[std::size_t(subdomain)] += 1;
      auto& list = cut.subdomainOf[std::size_t(places[i].rank)];
      list.resize(std::max(list.size(), std::size_t(places[i].position) + 1));
      list[std::size_t(places[i].position)] = subdomain;
    }
  }
  cut.rankOf = dealToRanks(work, ranks);
  return cut;
}

void pack(ByteWriter& writer, const ElementMatrix& element) {
  writer.write(element.body);
  writer.write(element.nodes);
  writer.write(element.K);
  writer.write(element.places);
}

ElementMatrix unpackElement(ByteReader& reader) {
  ElementMatrix element;
  element.body = reader.read<int>();
  element.nodes = reader.readVector<std::int64_t>();
  element.K = reader.readVector<double>();
  element.places = reader.readVector<std::array<double, 3>>();
  return element;
}

}  // namespace

std::vector<ElementPart> cutElements(const Communicator& comm, const std::vector<ElementMatrix>& elements, const DecompositionOptions& options) {
  const auto places = gatherPlaces(comm, elements);
  std::vector<Bytes> tasks;
  runOnRoot(comm, [&] {
    const Cut cut = cutPlaces(places, options, comm.getSize());
    for (const auto& list : cut.subdomainOf) {
      ByteWriter writer;
      writer.write(list);
      writer.write(cut.bodyOf);
      writer.write(cut.rankOf);
      tasks.push_back(writer.take());
    }
  });
  const Bytes task = scatterFromRoot(comm, tasks);
  ByteReader mine(task);
  const auto subdomainOf = mine.readVector<int>(), bodyOf = mine.readVector<int>(), rankOf = mine.readVector<int>();
  std::vector<ByteWriter> writers(std::size_t(comm.getSize()));
  for (std::size_t i = 0; i < elements.size(); ++i) {
    ByteWriter& writer = writers[std::size_t(rankOf[std::size_t(subdomainOf[i])])];
    writer.write(subdomainOf[i]);
    pack(writer, elements[i]);
  }
  std::vector<Bytes> messages;
  for (auto& writer : writers) messages.push_back(writer.take());
  std::map<int, ElementPart> parts;  // of this rank, by number
  for (std::size_t s = 0; s < rankOf.size(); ++s)
    if (rankOf[s] == comm.getRank()) parts[int(s)].body = bodyOf[s];
  for (const auto& message : exchangeAll(comm, messages)) {
    ByteReader reader(message);
    while (!reader.atEnd()) {
      const int subdomain = reader.read<int>();
      parts[subdomain].elements.push_back(unpackElement(reader));
    }
  }
  std::vector<ElementPart> result;
  for (auto& [number, part] : parts) {
    // The order of summation is that of the nodes, not of the ranks.
    std::sort(part.elements.begin(), part.elements.end(), [](const ElementMatrix& a, const ElementMatrix& b) { return a.nodes < b.nodes; });
    result.push_back(std::move(part));
  }
  return result;
}

}  // namespace Haptos
