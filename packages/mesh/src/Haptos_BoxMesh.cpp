// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_BoxMesh.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>

#include "Haptos_Error.hpp"
#include "Haptos_Format.hpp"

namespace Haptos {
namespace {

using Index = std::int64_t;
using Grid = std::array<Index, 3>;

// Corners of a cell in Exodus' order.
constexpr std::array<std::array<int, 3>, 8> corners = {
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

// Kuhn's six tetrahedra, by corner; all hold the diagonal 0-6 and have positive volume.
constexpr std::array<std::array<int, 4>, 6> kuhnTets = {
    {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}}};

constexpr std::array<int, 8> hexCorners = {0, 1, 2, 3, 4, 5, 6, 7};

int elementsPerCell(Topology topology) { return topology == Topology::Hex8 ? 1 : int(kuhnTets.size()); }

const int* cornersOfElement(Topology topology, int inCell) {
  return topology == Topology::Hex8 ? hexCorners.data() : kuhnTets[std::size_t(inCell)].data();
}

/// \brief Adds one box to a mesh.
class BoxBuilder {
 public:
  BoxBuilder(const BoxSpec& spec, Mesh& mesh)
      : spec_(spec),
        mesh_(mesh),
        firstNode_(Index(mesh.numNodes())),
        firstElement_(Index(mesh.numElements())) {}

  void addNodes() {
    const auto& n = spec_.divisions;
    for (Index k = 0; k <= n[2]; ++k)
      for (Index j = 0; j <= n[1]; ++j)
        for (Index i = 0; i <= n[0]; ++i) {
          const std::array<double, 3> x{position(0, i), position(1, j), position(2, k)};
          mesh_.coordinates.push_back(spec_.map ? spec_.map(x) : x);
        }
  }

  void addBlock(Index id) {
    ElementBlock block;
    block.id = id;
    block.name = spec_.blockName;
    block.topology = spec_.topology;
    const auto& n = spec_.divisions;
    for (Index k = 0; k < n[2]; ++k)
      for (Index j = 0; j < n[1]; ++j)
        for (Index i = 0; i < n[0]; ++i) addCell({i, j, k}, block.connectivity);
    mesh_.blocks.push_back(std::move(block));
  }

  /// Sides on face 2 axis + (upper ? 1 : 0), cell by cell.
  void addSides(int axis, bool upper, std::vector<ElementSide>& sides) const {
    Grid first{0, 0, 0}, last{spec_.divisions[0], spec_.divisions[1], spec_.divisions[2]};
    if (upper)
      first[std::size_t(axis)] = last[std::size_t(axis)] - 1;
    else
      last[std::size_t(axis)] = 1;
    for (Index k = first[2]; k < last[2]; ++k)
      for (Index j = first[1]; j < last[1]; ++j)
        for (Index i = first[0]; i < last[0]; ++i) addSidesOfCell({i, j, k}, axis, upper, sides);
  }

 private:
  /// The end is exactly `upper`, so that faces of neighbouring boxes coincide bit by bit.
  double position(std::size_t axis, Index i) const {
    const Index n = spec_.divisions[axis];
    if (i == n) return spec_.upper[axis];
    return spec_.lower[axis] + (spec_.upper[axis] - spec_.lower[axis]) * double(i) / double(n);
  }
  Index cellIndex(const Grid& c) const {
    return c[0] + spec_.divisions[0] * (c[1] + spec_.divisions[1] * c[2]);
  }
  Index nodeIndex(const Grid& c, int corner) const {
    const auto& d = corners[std::size_t(corner)];
    const Index nx = spec_.divisions[0] + 1, ny = spec_.divisions[1] + 1;
    return firstNode_ + c[0] + d[0] + nx * (c[1] + d[1] + ny * (c[2] + d[2]));
  }

  void addCell(const Grid& cell, std::vector<Index>& connectivity) const {
    for (int e = 0; e < elementsPerCell(spec_.topology); ++e) {
      const int* at = cornersOfElement(spec_.topology, e);
      for (int i = 0; i < nodesPerElement(spec_.topology); ++i)
        connectivity.push_back(nodeIndex(cell, at[i]));
    }
  }

  void addSidesOfCell(const Grid& cell, int axis, bool upper, std::vector<ElementSide>& sides) const {
    const int perCell = elementsPerCell(spec_.topology);
    for (int e = 0; e < perCell; ++e)
      for (int side = 0; side < sidesPerElement(spec_.topology); ++side)
        if (liesOnFace(e, side, axis, upper))
          sides.push_back({firstElement_ + perCell * cellIndex(cell) + e, side});
  }

  bool liesOnFace(int inCell, int side, int axis, bool upper) const {
    const auto& nodes = sideNodes(spec_.topology, side);
    const int* at = cornersOfElement(spec_.topology, inCell);
    for (int i = 0; i < nodesPerSide(spec_.topology); ++i)
      if (corners[std::size_t(at[nodes[std::size_t(i)]])][std::size_t(axis)] != int(upper)) return false;
    return true;
  }

  const BoxSpec& spec_;
  Mesh& mesh_;
  Index firstNode_, firstElement_;
};

void checkBox(const BoxSpec& box) {
  constexpr const char* axes[3] = {"x", "y", "z"};
  for (std::size_t a = 0; a < 3; ++a) {
    if (box.divisions[a] < 1)
      throw InputError("Box '" + box.blockName + "': the divisions in " + axes[a] + " are " +
                       std::to_string(box.divisions[a]) + "; at least 1 is wanted.");
    if (!(box.upper[a] > box.lower[a]))
      throw InputError("Box '" + box.blockName + "': its upper corner must lie above the lower one in " +
                       axes[a] + ", but they are " + formatted("%g", box.upper[a]) + " and " +
                       formatted("%g", box.lower[a]) + ".");
  }
}

/// In double: the products may overflow any integer.
void checkTotals(const std::vector<BoxSpec>& boxes) {
  double nodes = 0, elements = 0;
  for (const auto& box : boxes) {
    const auto& n = box.divisions;
    nodes += (n[0] + 1.0) * (n[1] + 1.0) * (n[2] + 1.0);
    elements += double(n[0]) * n[1] * n[2] * elementsPerCell(box.topology);
  }
  if (std::max(nodes, elements) > double(std::numeric_limits<int>::max()))
    throw InputError("The generated mesh would have " + std::to_string(std::max(nodes, elements)) +
                     " nodes or elements; at most 2147483647 are possible.");
}

SideSet& sideSetNamed(Mesh& mesh, const std::string& name) {
  const int found = findSideSet(mesh, name);
  if (found >= 0 && mesh.sideSets[std::size_t(found)].name == name) return mesh.sideSets[std::size_t(found)];
  mesh.sideSets.push_back({Index(mesh.sideSets.size()) + 1, name, {}});
  return mesh.sideSets.back();
}

std::vector<Index> countFromOne(std::size_t size) {
  std::vector<Index> numbers(size);
  std::iota(numbers.begin(), numbers.end(), Index(1));
  return numbers;
}

}  // namespace

Mesh makeBoxes(const std::vector<BoxSpec>& boxes) {
  if (boxes.empty()) throw InputError("A generated mesh needs at least one box.");
  for (const auto& box : boxes) checkBox(box);
  checkTotals(boxes);

  Mesh mesh;
  mesh.title = "boxes";
  std::set<Index> ids;
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    const auto& box = boxes[b];
    const Index id = box.blockId != 0 ? box.blockId : Index(b) + 1;
    if (!ids.insert(id).second)
      throw InputError("Box '" + box.blockName + "': block number " + std::to_string(id) + " is used twice.");
    BoxBuilder builder(box, mesh);
    builder.addNodes();
    builder.addBlock(id);
    for (int face = 0; face < 6; ++face)
      if (const auto& name = box.sideSetNames[std::size_t(face)]; !name.empty())
        builder.addSides(face / 2, face % 2 == 1, sideSetNamed(mesh, name).sides);
  }
  mesh.nodeNumbers = countFromOne(mesh.numNodes());
  mesh.elementNumbers = countFromOne(mesh.numElements());
  return mesh;
}

Mesh makeTwoBeams(const TwoBeamsSpec& spec) {
  const int k = spec.subdomainsPerEdge, p = spec.elementsPerSubdomainEdge;
  if (k < 1)
    throw InputError("Two Beams: 'Subdomains Per Edge' is " + std::to_string(k) + "; at least 1 is wanted.");
  if (p < 1)
    throw InputError("Two Beams: 'Elements Per Subdomain Edge' is " + std::to_string(p) +
                     "; at least 1 is wanted.");
  if (4.0 * k * k * k * p * p * p > double(std::numeric_limits<int>::max()))
    throw InputError("Two Beams: " + std::to_string(k) + " subdomains per edge with " + std::to_string(p) +
                     " elements per edge make more than 2147483647 elements; take fewer.");
  const int n = k * p;

  BoxSpec lower, upper;
  lower.blockName = "lower";
  lower.lower = {0.0, 0.0, -1.0};
  lower.upper = {2.0, 1.0, 0.0};
  lower.divisions = {2 * n, n, n};
  lower.sideSetNames = {"lower_clamp", "", "", "", "lower_bottom", "lower_contact"};
  upper.blockName = "upper";
  upper.lower = {0.0, 0.0, 0.0};
  upper.upper = {2.0, 1.0, 1.0};
  upper.divisions = lower.divisions;
  upper.sideSetNames = {"upper_clamp", "upper_end", "", "", "upper_contact", "upper_top"};
  Mesh mesh = makeBoxes({lower, upper});
  mesh.title = "two beams, " + std::to_string(k) + " subdomains per edge, H/h = " + std::to_string(p);
  return mesh;
}

std::vector<int> brickSubdomains(const TwoBeamsSpec& spec) {
  const int k = spec.subdomainsPerEdge, p = spec.elementsPerSubdomainEdge, n = k * p;
  std::vector<int> bricks;
  bricks.reserve(std::size_t(4) * std::size_t(n) * std::size_t(n) * std::size_t(n));
  for (int body = 0; body < 2; ++body)
    for (int z = 0; z < n; ++z)
      for (int y = 0; y < n; ++y)
        for (int x = 0; x < 2 * n; ++x)
          bricks.push_back(2 * k * k * k * body + x / p + 2 * k * (y / p + k * (z / p)));
  return bricks;
}

}  // namespace Haptos
