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

Index numNodes(const BoxSpec& box) {
  return (box.divisions[0] + Index(1)) * (box.divisions[1] + Index(1)) * (box.divisions[2] + Index(1));
}

Index numElements(const BoxSpec& box) {
  return Index(box.divisions[0]) * box.divisions[1] * box.divisions[2] * elementsPerCell(box.topology);
}

/// \brief Adds what a rank has of one box to its share of the mesh.
class BoxBuilder {
 public:
  BoxBuilder(const BoxSpec& spec, MeshShare& share, Index firstNode, Index firstElement)
      : spec_(spec), share_(share), firstNode_(firstNode), firstElement_(firstElement) {}

  // Nodes go along x, then y, then z; a rank's range of them is cut out of the box's.
  void addNodes() {
    const Index nx = spec_.divisions[0] + 1, ny = spec_.divisions[1] + 1;
    const Index begin = std::max(share_.firstNode() - firstNode_, Index(0));
    const Index end = std::min(share_.endNode() - firstNode_, numNodes(spec_));
    for (Index node = begin; node < end; ++node) {
      const std::array<double, 3> x{position(0, node % nx), position(1, node / nx % ny), position(2, node / nx / ny)};
      share_.part.coordinates.push_back(spec_.map ? spec_.map(x) : x);
    }
  }

  // Cells in the same order, the tetrahedra of a cell one after the other.
  void addBlock(Index id) {
    ElementBlock block{id, spec_.blockName, spec_.topology, {}};
    const auto [begin, end] = ownElements();
    const Index perCell = elementsPerCell(spec_.topology), nx = spec_.divisions[0], ny = spec_.divisions[1];
    for (Index e = begin; e < end; ++e) {
      const Index cell = e / perCell;
      const int* at = cornersOfElement(spec_.topology, int(e % perCell));
      for (int i = 0; i < nodesPerElement(spec_.topology); ++i)
        block.connectivity.push_back(nodeIndex({cell % nx, cell / nx % ny, cell / nx / ny}, at[i]));
    }
    share_.part.blocks.push_back(std::move(block));
  }

  /// Adds the sides on face 2 axis + (upper ? 1 : 0) to a side set, cell by cell.
  void addSides(int axis, bool upper, std::size_t set) {
    Grid first{0, 0, 0}, last{spec_.divisions[0], spec_.divisions[1], spec_.divisions[2]};
    if (upper)
      first[std::size_t(axis)] = last[std::size_t(axis)] - 1;
    else
      last[std::size_t(axis)] = 1;
    const auto inCell = sidesOnFace(axis, upper);
    const Index nx = spec_.divisions[0], ny = spec_.divisions[1], perCell = elementsPerCell(spec_.topology);
    const auto [begin, end] = ownElements();
    if (begin < end)
      for (Index line = begin / perCell / nx; line <= (end - 1) / perCell / nx; ++line) {
        const Index j = line % ny, k = line / ny;
        if (j < first[1] || j >= last[1] || k < first[2] || k >= last[2]) continue;
        const Index before = ((k - first[2]) * (last[1] - first[1]) + j - first[1]) * (last[0] - first[0]);
        for (Index i = first[0]; i < last[0]; ++i)
          addSidesOfCell(line * nx + i, (before + i - first[0]) * Index(inCell.size()), inCell, set);
      }
    share_.sideSetSizes[set] += Index(inCell.size()) * (last[0] - first[0]) * (last[1] - first[1]) * (last[2] - first[2]);
  }

 private:
  /// This rank's elements, counted in the box.
  std::pair<Index, Index> ownElements() const {
    return {std::max(share_.firstElement() - firstElement_, Index(0)),
            std::min(share_.endElement() - firstElement_, numElements(spec_))};
  }
  /// The end is exactly `upper`, so that faces of neighbouring boxes coincide bit by bit.
  double position(std::size_t axis, Index i) const {
    const Index n = spec_.divisions[axis];
    if (i == n) return spec_.upper[axis];
    return spec_.lower[axis] + (spec_.upper[axis] - spec_.lower[axis]) * double(i) / double(n);
  }
  Index nodeIndex(const Grid& c, int corner) const {
    const auto& d = corners[std::size_t(corner)];
    const Index nx = spec_.divisions[0] + 1, ny = spec_.divisions[1] + 1;
    return firstNode_ + c[0] + d[0] + nx * (c[1] + d[1] + ny * (c[2] + d[2]));
  }

  /// \param before place of the cell's first side among those of the face
  void addSidesOfCell(Index cell, Index before, const std::vector<ElementSide>& inCell, std::size_t set) {
    const auto [begin, end] = ownElements();
    for (std::size_t s = 0; s < inCell.size(); ++s) {
      const Index element = cell * elementsPerCell(spec_.topology) + inCell[s].element;
      if (element < begin || element >= end) continue;
      share_.part.sideSets[set].sides.push_back({firstElement_ + element, inCell[s].side});
      share_.sidePositions[set].push_back(share_.sideSetSizes[set] + before + Index(s));
    }
  }

  /// Sides of a cell on one of its faces, elements counted in the cell.
  std::vector<ElementSide> sidesOnFace(int axis, bool upper) const {
    std::vector<ElementSide> sides;
    for (int e = 0; e < elementsPerCell(spec_.topology); ++e)
      for (int side = 0; side < sidesPerElement(spec_.topology); ++side)
        if (liesOnFace(e, side, axis, upper)) sides.push_back({e, side});
    return sides;
  }

  bool liesOnFace(int inCell, int side, int axis, bool upper) const {
    const auto& nodes = sideNodes(spec_.topology, side);
    const int* at = cornersOfElement(spec_.topology, inCell);
    return std::all_of(nodes.begin(), nodes.end(), [&](int node) { return corners[std::size_t(at[node])][std::size_t(axis)] == int(upper); });
  }

  const BoxSpec& spec_;
  MeshShare& share_;
  Index firstNode_, firstElement_;
};

/// Divisions and corners that make a box.
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

/// \return position of the side set of that name, a new one if there is none
std::size_t sideSetNamed(MeshShare& share, const std::string& name) {
  auto& sets = share.part.sideSets;
  const int found = findSideSet(share.part, name);
  if (found >= 0 && sets[std::size_t(found)].name == name) return std::size_t(found);
  sets.push_back({Index(sets.size()) + 1, name, {}});
  share.sideSetSizes.push_back(0);
  share.sidePositions.emplace_back();
  return sets.size() - 1;
}

std::vector<Index> numbersFrom(Index first, Index end) {
  std::vector<Index> numbers(std::size_t(end - first));
  std::iota(numbers.begin(), numbers.end(), first + 1);
  return numbers;
}

void checkBoxes(const std::vector<BoxSpec>& boxes) {
  if (boxes.empty()) throw InputError("A generated mesh needs at least one box.");
  for (const auto& box : boxes) checkBox(box);
  checkTotals(boxes);
}

}  // namespace

// Every rank makes its ranges of nodes and elements of every box, and nothing else: no rank holds the mesh.
MeshShare shareBoxes(const std::vector<BoxSpec>& boxes, int rank, int ranks) {
  checkBoxes(boxes);
  MeshShare share;
  share.part.title = "boxes";
  share.rank = rank;
  share.nodes.ranks = share.elements.ranks = ranks;
  for (const auto& box : boxes) share.nodes.size += numNodes(box), share.elements.size += numElements(box);
  share.blockStarts = {0};
  std::set<Index> ids;
  Index firstNode = 0;
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    const auto& box = boxes[b];
    const Index id = box.blockId != 0 ? box.blockId : Index(b) + 1;
    if (!ids.insert(id).second)
      throw InputError("Box '" + box.blockName + "': block number " + std::to_string(id) + " is used twice.");
    BoxBuilder builder(box, share, firstNode, share.blockStarts.back());
    builder.addNodes();
    builder.addBlock(id);
    for (int face = 0; face < 6; ++face)
      if (const auto& name = box.sideSetNames[std::size_t(face)]; !name.empty())
        builder.addSides(face / 2, face % 2 == 1, sideSetNamed(share, name));
    firstNode += numNodes(box);
    share.blockStarts.push_back(share.blockStarts.back() + numElements(box));
  }
  share.part.nodeNumbers = numbersFrom(share.firstNode(), share.endNode());
  share.part.elementNumbers = numbersFrom(share.firstElement(), share.endElement());
  return share;
}

Mesh makeBoxes(const std::vector<BoxSpec>& boxes) { return shareBoxes(boxes, 0, 1).part; }

// The benchmark: 2 x 1 x 1 on 2 x 1 x 1, node on node at z = 0.
MeshShare shareTwoBeams(const TwoBeamsSpec& spec, int rank, int ranks) {
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
  MeshShare share = shareBoxes({lower, upper}, rank, ranks);
  share.part.title = "two beams, " + std::to_string(k) + " subdomains per edge, H/h = " + std::to_string(p);
  return share;
}

Mesh makeTwoBeams(const TwoBeamsSpec& spec) { return shareTwoBeams(spec, 0, 1).part; }

// Bodies one after the other, in each bricks along x, y, z as cells go.
int brickOfElement(const TwoBeamsSpec& spec, std::int64_t element) {
  const Index k = spec.subdomainsPerEdge, p = spec.elementsPerSubdomainEdge, n = k * p;
  const Index x = element % (2 * n), y = element / (2 * n) % n, layer = element / (2 * n * n), z = layer % n;
  return int(2 * k * k * k * (layer / n) + x / p + 2 * k * (y / p + k * (z / p)));
}

std::vector<int> brickSubdomains(const TwoBeamsSpec& spec) {
  const Index n = Index(spec.subdomainsPerEdge) * spec.elementsPerSubdomainEdge;
  std::vector<int> bricks(std::size_t(4 * n * n * n));
  for (std::size_t e = 0; e < bricks.size(); ++e) bricks[e] = brickOfElement(spec, Index(e));
  return bricks;
}

}  // namespace Haptos
