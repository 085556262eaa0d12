// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DualGraph.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <tuple>

#include "Haptos_Error.hpp"

namespace Haptos {
namespace {

struct Face {
  std::array<std::int64_t, 4> nodes;  // sorted; -1 first on triangles
  std::int64_t element;
  double area;
};

// Area of a plane triangle or quadrilateral; of a warped one, that of its projection along its mean normal.
double sideArea(const Mesh& mesh, const std::int64_t* element, const std::array<int, 4>& side, int nodes) {
  const auto diagonal = [&](int from, int to) {
    const auto &a = mesh.coordinates[element[side[from]]], &b = mesh.coordinates[element[side[to]]];
    return std::array<double, 3>{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  };
  const auto p = diagonal(0, 2), q = nodes == 3 ? diagonal(0, 1) : diagonal(1, 3);
  return 0.5 * std::hypot(p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]);
}

std::vector<Face> sortedFaces(const Mesh& mesh) {
  std::vector<Face> faces;
  std::int64_t element = 0;
  for (const auto& block : mesh.blocks) {
    const int perElement = nodesPerElement(block.topology), sides = sidesPerElement(block.topology);
    const int perSide = nodesPerSide(block.topology);
    for (std::size_t e = 0; e < block.numElements(); ++e, ++element)
      for (int side = 0; side < sides; ++side) {
        const auto& local = sideNodes(block.topology, side);
        Face face{{-1, -1, -1, -1}, element, sideArea(mesh, &block.connectivity[e * perElement], local, perSide)};
        for (int i = 0; i < perSide; ++i) face.nodes[i] = block.connectivity[e * perElement + local[i]];
        std::sort(face.nodes.begin(), face.nodes.end());
        faces.push_back(face);
      }
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return a.nodes != b.nodes ? a.nodes < b.nodes : a.element < b.element;
  });
  return faces;
}

int findRoot(std::vector<int>& parent, int i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

// Numbers the trees of a union-find forest by their first member.
std::vector<int> numberRoots(std::vector<int>& parent, std::size_t members, int& count) {
  std::vector<int> number(parent.size(), -1), result(members);
  count = 0;
  for (std::size_t i = 0; i < members; ++i) {
    int& n = number[findRoot(parent, int(i))];
    if (n < 0) n = count++;
    result[i] = n;
  }
  return result;
}

}  // namespace

std::vector<std::array<double, 3>> elementCentroids(const Mesh& mesh) {
  std::vector<std::array<double, 3>> centroids;
  for (const auto& block : mesh.blocks) {
    const int n = nodesPerElement(block.topology);
    for (std::size_t e = 0; e < block.numElements(); ++e) {
      std::array<double, 3> x{0, 0, 0};
      for (int i = 0; i < n; ++i)
        for (int d = 0; d < 3; ++d) x[d] += mesh.coordinates[block.connectivity[e * n + i]][d] / n;
      centroids.push_back(x);
    }
  }
  return centroids;
}

DualGraph buildDualGraph(const Mesh& mesh) {
  const auto faces = sortedFaces(mesh);
  const auto centroids = elementCentroids(mesh);
  std::vector<std::tuple<std::int64_t, std::int64_t, double>> edges;
  for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
    if (faces[i].nodes != faces[i + 1].nodes) continue;
    if (i + 2 < faces.size() && faces[i].nodes == faces[i + 2].nodes)
      throw InputError("Mesh: elements " + std::to_string(mesh.elementNumbers[faces[i].element]) + ", " +
                       std::to_string(mesh.elementNumbers[faces[i + 1].element]) + " and " +
                       std::to_string(mesh.elementNumbers[faces[i + 2].element]) +
                       " share one side; at most two elements may. Is the mesh doubled?");
    const auto &a = centroids[faces[i].element], &b = centroids[faces[i + 1].element];
    const double distance = std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    const double coupling = distance > 0 ? faces[i].area / distance : 0.0;  // 0: an element turned inside out
    edges.emplace_back(faces[i].element, faces[i + 1].element, coupling);
    edges.emplace_back(faces[i + 1].element, faces[i].element, coupling);
  }
  std::sort(edges.begin(), edges.end());
  DualGraph graph;
  graph.offsets.assign(mesh.numElements() + 1, 0);
  for (const auto& [element, neighbour, coupling] : edges) {
    ++graph.offsets[element + 1];
    graph.neighbours.push_back(neighbour);
    graph.couplings.push_back(coupling);
  }
  std::partial_sum(graph.offsets.begin(), graph.offsets.end(), graph.offsets.begin());
  return graph;
}

std::vector<int> connectedComponents(const DualGraph& graph, const std::vector<int>& colour, int& count) {
  const std::size_t n = graph.offsets.size() - 1;
  std::vector<int> parent(n);
  std::iota(parent.begin(), parent.end(), 0);
  for (std::size_t e = 0; e < n; ++e)
    for (auto k = graph.offsets[e]; k < graph.offsets[e + 1]; ++k) {
      const auto other = graph.neighbours[k];
      if (colour.empty() || colour[e] == colour[other]) parent[findRoot(parent, int(e))] = findRoot(parent, int(other));
    }
  return numberRoots(parent, n, count);
}

Bodies findBodies(const Mesh& mesh) {
  const std::size_t numElements = mesh.numElements();
  std::vector<int> parent(numElements + mesh.numNodes());  // elements, then nodes
  std::iota(parent.begin(), parent.end(), 0);
  std::size_t element = 0;
  for (const auto& block : mesh.blocks) {
    const int perElement = nodesPerElement(block.topology);
    for (std::size_t e = 0; e < block.numElements(); ++e, ++element)
      for (int i = 0; i < perElement; ++i) {
        const int node = int(numElements + block.connectivity[e * perElement + i]);
        parent[findRoot(parent, int(element))] = findRoot(parent, node);
      }
  }
  Bodies bodies;
  bodies.ofElement = numberRoots(parent, numElements, bodies.count);

  std::vector<std::set<int>> blocksOfBody(bodies.count);
  element = 0;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b)
    for (std::size_t e = 0; e < mesh.blocks[b].numElements(); ++e) blocksOfBody[bodies.ofElement[element++]].insert(int(b));
  std::vector<int> bodiesOfBlock(mesh.blocks.size(), 0), seen(mesh.blocks.size(), 0);
  for (const auto& blocks : blocksOfBody)
    for (int b : blocks) ++bodiesOfBlock[b];
  for (const auto& blocks : blocksOfBody) {
    std::string name;
    for (int b : blocks) {
      const auto& block = mesh.blocks[b];
      name += (name.empty() ? "" : "+") + (block.name.empty() ? std::to_string(block.id) : block.name);
      if (bodiesOfBlock[b] > 1) name += "#" + std::to_string(++seen[b]);  // several pieces in one block
    }
    bodies.names.push_back(name);
  }
  return bodies;
}

}  // namespace Haptos
