// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DualGraph.hpp"

#include <Teuchos_Comm.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "Haptos_Error.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

using Index = std::int64_t;
using Point = std::array<double, 3>;

// Sides are known by their corners; those of quadratic elements must agree in the other nodes, too.
struct Face {
  std::array<int, 4> nodes;  // corners, sorted; -1 first on triangles
  int element;
  double area;
  Index sumOfOthers;  // indices in the whole mesh
};

// A side that other ranks may have, too.
struct SentFace {
  std::array<Index, 4> nodes;  // of the whole mesh, sorted; the last of a triangle is above all others
  Index element, number, sumOfOthers;
  double area;
  Point centroid;
};

struct Edge {
  Index element, neighbour;
  double coupling;
};

// Area of a plane triangle or quadrilateral; of a warped one, that of its projection along its mean normal.  0 where the corners lie on
// one line: as stiff as the side is flat, squared, the joint is lost in round-off from 1e-7 on.
double sideArea(const Mesh& mesh, const Index* element, const SideNodes& side) {
  constexpr double kFlat = 1e-10;
  const auto diagonal = [&](int from, int to) {
    const auto &a = mesh.coordinates[std::size_t(element[side[from]])], &b = mesh.coordinates[std::size_t(element[side[to]])];
    return Point{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  };
  const auto p = diagonal(0, 2), q = side.numCorners == 3 ? diagonal(0, 1) : diagonal(1, 3);
  const double area = 0.5 * std::hypot(p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]);
  return area < kFlat * std::hypot(p[0], p[1], p[2]) * std::hypot(q[0], q[1], q[2]) ? 0 : area;
}

std::vector<Face> sortedFaces(const PartialMesh& part) {
  std::vector<Face> faces;
  int element = 0;
  for (const auto& block : part.mesh.blocks) {
    const int perElement = nodesPerElement(block.topology), sides = sidesPerElement(block.topology);
    for (std::size_t e = 0; e < block.numElements(); ++e, ++element)
      for (int s = 0; s < sides; ++s) {
        const Index* nodes = &block.connectivity[e * std::size_t(perElement)];
        const auto& side = sideNodes(block.topology, s);
        Face face{{-1, -1, -1, -1}, element, sideArea(part.mesh, nodes, side), 0};
        for (int i = 0; i < side.numCorners; ++i) face.nodes[std::size_t(i)] = int(nodes[side[i]]);
        std::for_each(side.endOfCorners(), side.end(), [&](int i) { face.sumOfOthers += part.nodes[std::size_t(nodes[i])]; });
        std::sort(face.nodes.begin(), face.nodes.end());
        faces.push_back(face);
      }
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return a.nodes != b.nodes ? a.nodes < b.nodes : a.element < b.element;
  });
  return faces;
}

// 0: an element turned inside out.
double couplingOf(double area, const Point& a, const Point& b) {
  const double distance = std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
  return distance > 0 ? area / distance : 0.0;
}

SentFace sentFace(const OwnElements& own, const Face& face, const Point& centroid) {
  const auto e = std::size_t(face.element);
  SentFace sent{{}, own.part.elements[e], own.part.mesh.elementNumbers[e], face.sumOfOthers, face.area, centroid};
  std::transform(face.nodes.begin(), face.nodes.end(), sent.nodes.begin(),
                 [&](int node) { return node < 0 ? std::numeric_limits<Index>::max() : own.part.nodes[std::size_t(node)]; });
  std::sort(sent.nodes.begin(), sent.nodes.end());
  return sent;
}

// Joins the elements of this rank, and says which sides others may have, or do not fit here.
std::vector<Edge> matchOwnFaces(const OwnElements& own, std::vector<SentFace>& toSend) {
  const auto faces = sortedFaces(own.part);
  const auto centroids = elementCentroids(own.part.mesh);
  const auto isShared = [&](int node) { return node < 0 || own.isShared[std::size_t(node)]; };
  std::vector<Edge> edges;
  for (std::size_t i = 0, j = 0; i < faces.size(); i = j) {
    while (j < faces.size() && faces[j].nodes == faces[i].nodes) ++j;
    const bool fits = j - i == 1 || (j - i == 2 && faces[i].sumOfOthers == faces[i + 1].sumOfOthers && faces[i].area != 0);
    if (j - i == 2) {
      const int a = faces[i].element, b = faces[i + 1].element;
      const double coupling = couplingOf(faces[i].area, centroids[std::size_t(a)], centroids[std::size_t(b)]);
      edges.push_back({own.part.elements[std::size_t(a)], own.part.elements[std::size_t(b)], coupling});
    }
    if (fits && !std::all_of(faces[i].nodes.begin(), faces[i].nodes.end(), isShared)) continue;
    for (std::size_t k = i; k < j; ++k) toSend.push_back(sentFace(own, faces[k], centroids[std::size_t(faces[k].element)]));
  }
  return edges;
}

// Joins elements of different ranks: each end is told its edge.
void matchSentFaces(const OwnElements& own, std::vector<SentFace> faces, std::vector<std::vector<Edge>>& toRank) {
  std::sort(faces.begin(), faces.end(), [](const SentFace& a, const SentFace& b) {
    return a.nodes != b.nodes ? a.nodes < b.nodes : a.element < b.element;
  });
  for (std::size_t i = 0, j = 0; i < faces.size(); i = j) {
    while (j < faces.size() && faces[j].nodes == faces[i].nodes) ++j;
    if (j - i > 2)
      throw InputError("Mesh: elements " + std::to_string(faces[i].number) + ", " + std::to_string(faces[i + 1].number) + " and " +
                       std::to_string(faces[i + 2].number) + " share one side; at most two elements may. Is the mesh doubled?");
    if (j - i < 2) continue;
    if (faces[i].sumOfOthers != faces[i + 1].sumOfOthers)
      throw InputError("Mesh: elements " + std::to_string(faces[i].number) + " and " + std::to_string(faces[i + 1].number) +
                       " share the corners of a side, but not the nodes in the middle of its edges or of itself; where linear and "
                       "quadratic elements meet, or HEX27 and others, give each side nodes of its own and tie the two by a contact.");
    if (faces[i].area == 0)
      throw InputError("Mesh: elements " + std::to_string(faces[i].number) + " and " + std::to_string(faces[i + 1].number) +
                       " share a side without area: its corners lie on one line, about which the two could turn; move or merge its nodes.");
    const Index a = faces[i].element, b = faces[i + 1].element;
    const int rankOfA = own.elements.owner(a), rankOfB = own.elements.owner(b);
    if (rankOfA == rankOfB) continue;  // joined there
    const Edge edge{a, b, couplingOf(faces[i].area, faces[i].centroid, faces[i + 1].centroid)};
    toRank[std::size_t(rankOfA)].push_back(edge);
    toRank[std::size_t(rankOfB)].push_back(edge);
  }
}

// CSR in two passes: rows are counted, then filled; an edge within the rank fills both of its rows, one across only its own.
DualGraph graphOf(const OwnElements& own, const std::vector<Edge>& edges) {
  const Index first = own.firstElement(), count = Index(own.part.elements.size());
  const auto forEachRow = [&](auto&& add) {
    for (const Edge& edge : edges) {
      if (const Index row = edge.element - first; row >= 0 && row < count) add(std::size_t(row), edge.neighbour, edge.coupling);
      if (const Index row = edge.neighbour - first; row >= 0 && row < count) add(std::size_t(row), edge.element, edge.coupling);
    }
  };
  DualGraph graph;
  graph.offsets.assign(std::size_t(count) + 1, 0);
  forEachRow([&](std::size_t row, Index, double) { ++graph.offsets[row + 1]; });
  std::partial_sum(graph.offsets.begin(), graph.offsets.end(), graph.offsets.begin());
  graph.neighbours.resize(std::size_t(graph.offsets.back()));
  graph.couplings.resize(graph.neighbours.size());
  std::vector<Index> end(graph.offsets.begin(), graph.offsets.end() - 1);
  forEachRow([&](std::size_t row, Index neighbour, double coupling) {  // inserted where it belongs: rows are short
    Index k = end[row]++;
    for (; k > graph.offsets[row] && graph.neighbours[std::size_t(k - 1)] > neighbour; --k) {
      graph.neighbours[std::size_t(k)] = graph.neighbours[std::size_t(k - 1)];
      graph.couplings[std::size_t(k)] = graph.couplings[std::size_t(k - 1)];
    }
    graph.neighbours[std::size_t(k)] = neighbour;
    graph.couplings[std::size_t(k)] = coupling;
  });
  return graph;
}

}  // namespace

std::vector<Point> elementCentroids(const Mesh& mesh) {
  std::vector<Point> centroids;
  for (const auto& block : mesh.blocks) {
    const int n = nodesPerElement(block.topology);
    for (std::size_t e = 0; e < block.numElements(); ++e) {
      Point x{0, 0, 0};
      for (int i = 0; i < n; ++i)
        for (int d = 0; d < 3; ++d) x[d] += mesh.coordinates[block.connectivity[e * n + i]][d] / n;
      centroids.push_back(x);
    }
  }
  return centroids;
}

// Sides whose nodes are this rank's alone are matched here; the others meet where their lowest node lies, and edges come back.
DualGraph buildDualGraph(const Communicator& comm, const OwnElements& own) {
  std::vector<SentFace> faces;
  auto edges = matchOwnFaces(own, faces);
  faces = sendItems(comm, faces, [&](const SentFace& face) { return own.nodes.owner(face.nodes[0]); });
  std::vector<std::vector<Edge>> found(static_cast<std::size_t>(comm.getSize()));
  runOnAllRanks(comm, [&] { matchSentFaces(own, std::move(faces), found); });
  for (const Edge& edge : joined(exchangeValues(comm, found))) edges.push_back(edge);
  return graphOf(own, edges);
}

}  // namespace Haptos
