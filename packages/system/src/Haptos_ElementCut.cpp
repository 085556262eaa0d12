// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ElementCut.hpp"

#include <Teuchos_Comm.hpp>
#include <algorithm>
#include <cmath>
#include <map>

#include "Haptos_Components.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Partition.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_SampledCuts.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

using Index = std::int64_t;

// An element where it was brought.
struct Place {
  int body, rank, position;
  std::vector<Index> nodes;
  std::array<double, 3> centroid;

  auto parts() { return std::tie(body, rank, position, nodes, centroid); }
  // An order that does not depend on who brought them.
  bool operator<(const Place& other) const { return std::tie(body, nodes) < std::tie(other.body, other.nodes); }
};

std::vector<Place> placesOf(const std::vector<ElementMatrix>& elements, int rank) {
  std::vector<Place> places;
  for (const auto& element : elements) {
    places.push_back({element.body, rank, int(places.size()), element.nodes, {0, 0, 0}});
    for (const auto& x : element.places)
      places.back().centroid = Vec3::add(places.back().centroid, Vec3::scale(1.0 / double(element.places.size()), x));
  }
  return places;
}

// Sorted over the ranks, in even ranges.
std::vector<Place> sortedInRanges(const Communicator& comm, std::vector<Place> mine, ElementRange& range) {
  std::sort(mine.begin(), mine.end());
  const std::vector<Place> cuts = sampledCuts(comm, mine);
  mine = sendItems(comm, mine, [&](const Place& place) { return int(std::upper_bound(cuts.begin(), cuts.end(), place) - cuts.begin()); });
  std::stable_sort(mine.begin(), mine.end());
  const Index count = Index(mine.size()), first = sumOfLower(comm, count);
  range = {{sumOfAll(comm, count), comm.getSize()}, comm.getRank()};
  return sendItems(comm, mine, [&](const Place& place) { return range.elements.owner(first + (&place - mine.data())); });
}

// An element at one of its nodes.
struct AtNode {
  Index node;
  int body, nodes;  // of the element
  Index element;

  bool operator<(const AtNode& other) const { return std::tie(node, body, element) < std::tie(other.node, other.body, other.element); }
};

// Two elements with a node in common; one for each such node.
struct Meeting {
  Index element, other;
  int fewest;  // nodes of the smaller one

  bool operator<(const Meeting& b) const { return std::tie(element, other) < std::tie(b.element, b.other); }
};

// Whatever the ids are, every rank gets its share.
int rankOfNode(Index node, int ranks) {
  constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15u;  // 2^64 / golden ratio: multiples of it are spread evenly
  return int((std::uint64_t(node) * kGolden >> 32) % std::uint64_t(ranks));
}

// Elements meet at their nodes, body by body; each is told whom it has met.
std::vector<Meeting> meetings(const Communicator& comm, const ElementRange& range, const std::vector<Place>& places) {
  std::vector<AtNode> visits;
  for (std::size_t e = 0; e < places.size(); ++e)
    for (Index node : places[e].nodes) visits.push_back({node, places[e].body, int(places[e].nodes.size()), range.firstElement() + Index(e)});
  visits = sendItems(comm, visits, [&](const AtNode& visit) { return rankOfNode(visit.node, comm.getSize()); });
  std::sort(visits.begin(), visits.end());
  std::vector<Meeting> met;
  for (auto first = visits.begin(), last = first; first != visits.end(); first = last) {
    last = std::find_if(first, visits.end(), [&](const AtNode& v) { return v.node != first->node || v.body != first->body; });
    for (auto a = first; a != last; ++a)
      for (auto b = first; b != last; ++b)
        if (a->element != b->element) met.push_back({a->element, b->element, std::min(a->nodes, b->nodes)});
  }
  met = sendItems(comm, met, [&](const Meeting& m) { return range.elements.owner(m.element); });
  std::sort(met.begin(), met.end());
  return met;
}

// Elements that share a side: three nodes, or all but one of the smaller one's.
DualGraph connect(const ElementRange& range, const std::vector<Meeting>& met) {
  DualGraph graph;
  graph.offsets.push_back(0);
  auto first = met.begin();
  for (Index e = range.firstElement(); e < range.elements.begin(range.rank + 1); ++e) {
    for (auto last = first; first != met.end() && first->element == e; first = last) {
      last = std::find_if(first, met.end(), [&](const Meeting& m) { return m.element != e || m.other != first->other; });
      if (last - first >= std::min(3, first->fewest - 1)) graph.neighbours.push_back(first->other);
    }
    graph.offsets.push_back(Index(graph.neighbours.size()));
  }
  graph.couplings.assign(graph.neighbours.size(), 1.0);
  return graph;
}

// [pieces], the same on all ranks: from who has the first element.
std::vector<int> bodiesOf(const Communicator& comm, const ElementRange& range, const Components& pieces, const std::vector<Place>& places) {
  std::vector<int> bodies(pieces.first.size(), 0);
  for (std::size_t p = 0; p < bodies.size(); ++p)
    if (const Index e = pieces.first[p] - range.firstElement(); e >= 0 && e < Index(places.size())) bodies[p] = places[std::size_t(e)].body;
  bodies = sumOfAll(comm, bodies);
  for (std::size_t p = 1; p < bodies.size(); ++p)
    if (bodies[p] == bodies[p - 1])
      throw InputError("Body " + std::to_string(bodies[p]) + " is in pieces that share no side of an element; give every piece a body of its own.");
  return bodies;
}

// The subdomain of an element, on its way to who brought it.
struct Told {
  int rank, position, subdomain;
};

struct SentElement {
  int subdomain;
  ElementMatrix element;

  auto parts() { return std::tie(subdomain, element); }
};

struct Cut {
  std::vector<int> subdomainOf;     // [elements of this rank]
  std::vector<int> bodyOf, rankOf;  // [subdomains]
};

Cut cutPlaces(const Communicator& comm, const std::vector<ElementMatrix>& elements, const PartitionOptions& options) {
  constexpr double kElements = 200;  // of a subdomain, where no number is asked for
  ElementRange range;
  const auto places = sortedInRanges(comm, placesOf(elements, comm.getRank()), range);
  const auto graph = connect(range, meetings(comm, range, places));
  const auto pieces = connectedComponents(comm, range, graph, {});
  const auto bodies = bodiesOf(comm, range, pieces, places);
  const int wanted = options.subdomains > 0 ? options.subdomains : std::max(pieces.count(), int(std::lround(double(range.elements.size) / kElements)));
  Coordinates centroids;
  for (const Place& place : places) centroids.push_back(place.centroid);
  const auto partition = partitionGraph(comm, range, graph, centroids, pieces, wanted, options);
  std::vector<double> work(std::size_t(partition.count), 0.0);
  for (int subdomain : partition.ofElement) work[std::size_t(subdomain)] += 1;
  Cut cut{std::vector<int>(elements.size()), {}, dealToRanks(sumOfAll(comm, work), comm.getSize())};
  for (int piece : partition.pieceOfSubdomain) cut.bodyOf.push_back(bodies[std::size_t(piece)]);
  std::vector<Told> told;
  for (std::size_t e = 0; e < places.size(); ++e) told.push_back({places[e].rank, places[e].position, partition.ofElement[e]});
  for (const Told& one : sendItems(comm, told, [](const Told& t) { return t.rank; })) cut.subdomainOf[std::size_t(one.position)] = one.subdomain;
  return cut;
}

}  // namespace

// The cut is made from node ids and places only: matrices go straight from who brought them to who needs them.
std::vector<ElementPart> cutElements(const Communicator& comm, const std::vector<ElementMatrix>& elements, const PartitionOptions& options) {
  const Cut cut = cutPlaces(comm, elements, options);
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
