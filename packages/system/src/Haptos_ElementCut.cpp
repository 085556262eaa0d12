// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ElementCut.hpp"

#include <Teuchos_Comm.hpp>
#include <algorithm>
#include <cmath>
#include <map>

#include "Haptos_Components.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_PieceCut.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_SubdomainOrder.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

// An element where it was brought.
struct Place {
  int body, rank, position;
  std::vector<std::int64_t> nodes;
  std::array<double, 3> centroid;

  auto parts() { return std::tie(body, rank, position, nodes, centroid); }
};

// What rank 0 tells a rank: subdomain of each of its elements; body and rank of every subdomain.
struct Cut {
  std::vector<int> subdomainOf, bodyOf, rankOf;

  auto parts() { return std::tie(subdomainOf, bodyOf, rankOf); }
};

// On rank 0, in an order that does not depend on who brought them.
std::vector<Place> gatherPlaces(const Communicator& comm, const std::vector<ElementMatrix>& elements) {
  std::vector<Place> mine;
  for (const auto& element : elements) {
    mine.push_back({element.body, comm.getRank(), int(mine.size()), element.nodes, {0, 0, 0}});
    for (const auto& x : element.places)
      mine.back().centroid = Vec3::add(mine.back().centroid, Vec3::scale(1.0 / double(element.places.size()), x));
  }
  auto places = gatheredOnRoot(comm, mine);
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return std::tie(a.body, a.nodes) < std::tie(b.body, b.nodes); });
  return places;
}

// Elements [first, last) that share a side.
DualGraph connect(const std::vector<Place>& places, std::size_t first, std::size_t last) {
  std::map<std::int64_t, std::vector<int>> elementsAt;
  for (std::size_t i = first; i < last; ++i)
    for (auto node : places[i].nodes) elementsAt[node].push_back(int(i - first));
  DualGraph graph;
  graph.offsets.push_back(0);
  std::map<int, std::size_t> shared;
  for (std::size_t i = first; i < last; ++i) {
    shared.clear();
    for (auto node : places[i].nodes)
      for (int other : elementsAt[node]) ++shared[other];
    for (const auto& [other, count] : shared) {
      const std::size_t fewest = std::min(places[i].nodes.size(), places[first + std::size_t(other)].nodes.size());
      if (other != int(i - first) && count >= std::min<std::size_t>(3, fewest - 1)) graph.neighbours.push_back(other);
    }
    graph.offsets.push_back(std::int64_t(graph.neighbours.size()));
  }
  graph.couplings.assign(graph.neighbours.size(), 1.0);
  return graph;
}

// As many as were asked for, or parts of about 200 elements and at least one a rank.
double partsWanted(const DecompositionOptions& options, std::size_t elements, int ranks) {
  constexpr double kElements = 200;
  return options.subdomains > 0 ? options.subdomains : std::max(double(ranks), double(elements) / kElements);
}

// [ranks] body by body, each in parts in proportion to its elements.
std::vector<Cut> cutPlaces(const std::vector<Place>& places, const DecompositionOptions& options, int ranks) {
  std::vector<std::vector<int>> subdomainOf(static_cast<std::size_t>(ranks));
  const double share = partsWanted(options, places.size(), ranks) / double(places.size());
  std::vector<double> work;
  std::vector<int> bodyOf;
  for (std::size_t first = 0, last = 0; first < places.size(); first = last) {
    PieceToCut piece;
    for (; last < places.size() && places[last].body == places[first].body; ++last) piece.centroids.push_back(places[last].centroid);
    piece.graph = connect(places, first, last);
    int pieces = 0;
    connectedComponents(piece.graph, {}, pieces);
    if (pieces > 1)
      throw InputError("Body " + std::to_string(places[first].body) +
                       " is in pieces that share no side of an element; give every piece a body of its own.");
    piece.parts = std::clamp(int(std::lround(share * double(last - first))), 1, int(last - first));
    piece.seed = options.seed;
    const auto part = cutPiece(piece).part;
    const int before = int(work.size());
    work.resize(work.size() + std::size_t(piece.parts), 0.0);
    bodyOf.resize(work.size(), places[first].body);
    for (std::size_t i = first; i < last; ++i) {
      const int subdomain = before + part[i - first];
      work[std::size_t(subdomain)] += 1;
      auto& list = subdomainOf[std::size_t(places[i].rank)];
      list.resize(std::max(list.size(), std::size_t(places[i].position) + 1));
      list[std::size_t(places[i].position)] = subdomain;
    }
  }
  const auto rankOf = dealToRanks(work, ranks);
  std::vector<Cut> cuts;
  for (auto& list : subdomainOf) cuts.push_back({std::move(list), bodyOf, rankOf});
  return cuts;
}

struct SentElement {
  int subdomain;
  ElementMatrix element;

  auto parts() { return std::tie(subdomain, element); }
};

}  // namespace

// The cut is made from node ids and places only: matrices go straight from who brought them to who needs them.
std::vector<ElementPart> cutElements(const Communicator& comm, const std::vector<ElementMatrix>& elements, const DecompositionOptions& options) {
  const auto places = gatherPlaces(comm, elements);
  std::vector<Cut> cuts;
  runOnRoot(comm, [&] { cuts = cutPlaces(places, options, comm.getSize()); });
  const Cut cut = scattered(comm, cuts);
  std::vector<SentElement> sent;
  for (std::size_t i = 0; i < elements.size(); ++i) sent.push_back({cut.subdomainOf[i], elements[i]});
  std::map<int, ElementPart> parts;  // of this rank, by number
  for (std::size_t s = 0; s < cut.rankOf.size(); ++s)
    if (cut.rankOf[s] == comm.getRank()) parts[int(s)].body = cut.bodyOf[s];
  for (auto& [subdomain, element] : sendItems(comm, sent, [&](const SentElement& s) { return cut.rankOf[std::size_t(s.subdomain)]; }))
    parts[subdomain].elements.push_back(std::move(element));
  std::vector<ElementPart> result;
  for (auto& [number, part] : parts) {
    // The order of summation is that of the nodes, not of the ranks.
    std::sort(part.elements.begin(), part.elements.end(), [](const ElementMatrix& a, const ElementMatrix& b) { return a.nodes < b.nodes; });
    result.push_back(std::move(part));
  }
  return result;
}

}  // namespace Haptos
