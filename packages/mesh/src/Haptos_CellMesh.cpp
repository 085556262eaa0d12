// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CellMesh.hpp"

#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace Haptos {
namespace {

using Index = std::int64_t;
using Nodes = std::vector<Index>;

// Corners of a hexahedron, 8 its centre.
const std::vector<std::vector<int>> wedgePieces{{0, 1, 2, 4, 5, 6}, {0, 2, 3, 4, 6, 7}};
const std::vector<std::vector<int>> tetPieces{{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};

Topology topologyOf(std::size_t corners, ElementOrder order) {
  const bool linear = order == ElementOrder::Linear;
  switch (corners) {
    case 4: return linear ? Topology::Tet4 : Topology::Tet10;
    case 5: return linear ? Topology::Pyramid5 : Topology::Pyramid13;
    case 6: return linear ? Topology::Wedge6 : Topology::Wedge15;
    default: return linear ? Topology::Hex8 : order == ElementOrder::Quadratic ? Topology::Hex20 : Topology::Hex27;
  }
}

Nodes sorted(Nodes nodes) {
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

/// \brief Numbers for new nodes, each between some others, in the order of those.
class NewNodes {
 public:
  // Neighbours ask for the same node by the same corners, in whatever order they have them.
  void want(const Nodes& between) { numbers_[sorted(between)] = -1; }
  Index at(const Nodes& between) const { return numbers_.at(sorted(between)); }
  /// Each in the mean of the nodes around.
  void addTo(Mesh& mesh) {
    for (auto& [between, number] : numbers_) {
      number = Index(mesh.numNodes());
      std::array<double, 3> x{0, 0, 0};
      for (const Index node : between)
        for (std::size_t d = 0; d < 3; ++d) x[d] += mesh.coordinates[std::size_t(node)][d] / double(between.size());
      mesh.coordinates.push_back(x);
    }
  }

 private:
  std::map<Nodes, Index> numbers_;
};

/// \brief An element by its corners, and the hexahedron that it is of.
struct Piece {
  Nodes corners;
  std::size_t block;
  Index cell;
};

class CellSplitter {
 public:
  CellSplitter(const Mesh& source, const std::vector<Cell>& cells, ElementOrder order) : source_(source), cells_(cells), order_(order) {
    TEUCHOS_ASSERT(cells.size() == source.numElements());
    mesh_.title = source.title;
    mesh_.coordinates = source.coordinates;
    mesh_.nodeSets = source.nodeSets;
  }

  Mesh split() {
    for (const auto& block : source_.blocks) TEUCHOS_ASSERT(block.topology == Topology::Hex8);
    for (Index cell = 0; cell < offsets_.back(); ++cell) findWedgeSides(cornersOf(cell), cell);
    std::sort(halves_.begin(), halves_.end());
    Index cell = 0;
    for (std::size_t b = 0; b < source_.blocks.size(); ++b)
      for (std::size_t e = 0; e < source_.blocks[b].numElements(); ++e, ++cell) addPieces(b, cell);
    makeBlocks();
    makeSideSets();
    mesh_.nodeNumbers.resize(mesh_.numNodes());
    std::iota(mesh_.nodeNumbers.begin(), mesh_.nodeNumbers.end(), 1);
    mesh_.elementNumbers.resize(pieces_.size());
    std::iota(mesh_.elementNumbers.begin(), mesh_.elementNumbers.end(), 1);
    return std::move(mesh_);
  }

 private:
  Nodes cornersOf(Index cell) const {
    const auto where = locateElement(offsets_, cell);
    const auto first = source_.blocks[std::size_t(where.block)].connectivity.begin() + 8 * where.position;
    return {first, first + 8};
  }

  // The triangles of wedges decide how quadrilaterals beside them are cut, so they are listed before anything else is made.
  void findWedgeSides(const Nodes& nodes, Index cell) {
    if (cells_[std::size_t(cell)] != Cell::Wedges) return;
    for (const auto& half : wedgePieces)
      for (const int begin : {0, 3})
        halves_.push_back(sorted({nodes[std::size_t(half[std::size_t(begin)])], nodes[std::size_t(half[std::size_t(begin) + 1])],
                                  nodes[std::size_t(half[std::size_t(begin) + 2])]}));
  }

  void addPieces(std::size_t block, Index cell) {
    const Nodes nodes = cornersOf(cell);
    const auto add = [&](const std::vector<std::vector<int>>& parts) {
      for (const auto& part : parts) {
        Nodes corners;
        for (const int i : part) corners.push_back(nodes[std::size_t(i)]);
        pieces_.push_back({std::move(corners), block, cell});
      }
    };
    switch (cells_[std::size_t(cell)]) {
      case Cell::Hexahedron: return add({{0, 1, 2, 3, 4, 5, 6, 7}});
      case Cell::Wedges: return add(wedgePieces);
      case Cell::Tetrahedra: return add(tetPieces);
      case Cell::Pyramids: break;
    }
    // Six pyramids meet in a node of their own in the middle of the hexahedron.
    const Index centre = Index(mesh_.numNodes());
    NewNodes middle;
    middle.want(nodes);
    middle.addTo(mesh_);
    for (int side = 0; side < 6; ++side) addPyramid(nodes, sideNodes(Topology::Hex8, side), centre, block, cell);
  }

  // The base is seen from the apex, inside: turned round.  Where it is cut, the first diagonal that fits.
  void addPyramid(const Nodes& nodes, const SideNodes& side, Index apex, std::size_t block, Index cell) {
    Nodes base;
    for (const int i : {0, 3, 2, 1}) base.push_back(nodes[std::size_t(side[i])]);
    for (std::size_t i = 0; i < 2; ++i) {
      const Nodes half{base[i], base[i + 1], base[i + 2]}, other{base[i], base[i + 2], base[(i + 3) % 4]};
      if (!std::binary_search(halves_.begin(), halves_.end(), sorted(half))) continue;
      for (Nodes corners : {half, other}) {
        corners.push_back(apex);
        pieces_.push_back({std::move(corners), block, cell});
      }
      return;
    }
    base.push_back(apex);
    pieces_.push_back({std::move(base), block, cell});
  }

  // Pieces of a block by their topology, in the order of their cells; then the nodes between their corners.
  void makeBlocks() {
    Index highest = 0;
    for (const auto& block : source_.blocks) highest = std::max(highest, block.id);
    const auto kindOf = [&](const Piece& piece) { return std::pair{piece.block, -Index(piece.corners.size())}; };
    // Larger numbers of corners first, so that what is left of the hexahedra keeps the name of the block.
    std::stable_sort(pieces_.begin(), pieces_.end(), [&](const Piece& a, const Piece& b) { return kindOf(a) < kindOf(b); });
    addMiddles();
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const Topology topology = topologyOf(pieces_[i].corners.size(), order_);
      if (i == 0 || kindOf(pieces_[i]) != kindOf(pieces_[i - 1])) {
        const auto& from = source_.blocks[pieces_[i].block];
        const bool isFirst = i == 0 || pieces_[i].block != pieces_[i - 1].block;
        constexpr std::array<const char*, 3> endings{"_tet", "_pyramid", "_wedge"};
        const std::string ending = isFirst ? "" : endings[pieces_[i].corners.size() - 4];
        mesh_.blocks.push_back({isFirst ? from.id : ++highest, from.name + ending, topology, {}});
      }
      const Nodes nodes = allNodes(pieces_[i], elementShape(topology));
      mesh_.blocks.back().connectivity.insert(mesh_.blocks.back().connectivity.end(), nodes.begin(), nodes.end());
    }
  }

  // Middles of edges before those of sides, before those of hexahedra.
  void addMiddles() {
    std::array<NewNodes, 3> levels;
    for (const auto& piece : pieces_) forEachMiddle(piece, [&](std::size_t level, int, const Nodes& between) { levels[level].want(between); });
    for (auto& level : levels) level.addTo(mesh_);
    middles_ = std::move(levels);
  }

  /// visit(level, position in the element, corners around)
  template <class Visit>
  void forEachMiddle(const Piece& piece, const Visit& visit) const {
    const ElementShape& shape = elementShape(topologyOf(piece.corners.size(), order_));
    if (!shape.hasMidNodes()) return;
    const auto corner = [&](int i) { return piece.corners[std::size_t(i)]; };
    for (int i = 0; i < shape.numEdges; ++i)
      visit(0, shape.numCorners + i, {corner(shape.edges[std::size_t(i)][0]), corner(shape.edges[std::size_t(i)][1])});
    // Exodus numbers of HEX27: 20 in the middle of the element, those of its sides after it.
    if (shape.numNodes < 27) return;
    for (const SideNodes& side : shape.sides) visit(1, side[8], {corner(side[0]), corner(side[1]), corner(side[2]), corner(side[3])});
    visit(2, 20, piece.corners);
  }

  Nodes allNodes(const Piece& piece, const ElementShape& shape) const {
    Nodes nodes = piece.corners;
    nodes.resize(std::size_t(shape.numNodes));
    forEachMiddle(piece, [&](std::size_t level, int position, const Nodes& between) {
      nodes[std::size_t(position)] = middles_[level].at(between);
    });
    return nodes;
  }

  // A side of a piece lies on that of its hexahedron if all its corners do.
  void makeSideSets() {
    std::map<Index, std::vector<Index>> piecesOf;
    for (std::size_t i = 0; i < pieces_.size(); ++i) piecesOf[pieces_[i].cell].push_back(Index(i));
    for (const auto& set : source_.sideSets) {
      mesh_.sideSets.push_back({set.id, set.name, {}});
      for (const auto& side : set.sides) {
        const Nodes whole = sorted(nodesOfSide(source_, offsets_, side));
        for (const Index i : piecesOf[side.element]) addSidesWithin(whole, i, mesh_.sideSets.back().sides);
      }
    }
  }

  void addSidesWithin(const Nodes& whole, Index element, std::vector<ElementSide>& sides) const {
    const Piece& piece = pieces_[std::size_t(element)];
    const Topology topology = topologyOf(piece.corners.size(), order_);
    for (int s = 0; s < sidesPerElement(topology); ++s) {
      const SideNodes& side = sideNodes(topology, s);
      if (std::all_of(side.begin(), side.endOfCorners(),
                      [&](int i) { return std::binary_search(whole.begin(), whole.end(), piece.corners[std::size_t(i)]); }))
        sides.push_back({element, s});
    }
  }

  const Mesh& source_;
  const std::vector<Cell>& cells_;
  ElementOrder order_;
  std::vector<Index> offsets_ = blockOffsets(source_);
  std::vector<Nodes> halves_;  // triangles of wedges, sorted
  std::vector<Piece> pieces_;
  std::array<NewNodes, 3> middles_;
  Mesh mesh_;
};

}  // namespace

Mesh withCells(const Mesh& hexahedra, const std::vector<Cell>& cells, ElementOrder order) {
  return CellSplitter(hexahedra, cells, order).split();
}

Mesh withElements(const Mesh& hexahedra, Topology topology) {
  const ElementShape& shape = elementShape(topology);
  const Cell cell = shape.numCorners == 4   ? Cell::Tetrahedra
                    : shape.numCorners == 5 ? Cell::Pyramids
                    : shape.numCorners == 6 ? Cell::Wedges
                                            : Cell::Hexahedron;
  const ElementOrder order = !shape.hasMidNodes()          ? ElementOrder::Linear
                             : topology == Topology::Hex27 ? ElementOrder::FullQuadratic
                                                           : ElementOrder::Quadratic;
  return withCells(hexahedra, std::vector<Cell>(hexahedra.numElements(), cell), order);
}

Mesh distortedBox(const BoxSpec& box, double distortion) {
  Mesh mesh = makeBoxes({box});
  const auto& n = box.divisions;
  std::size_t node = 0;
  for (int k = 0; k <= n[2]; ++k)
    for (int j = 0; j <= n[1]; ++j)
      for (int i = 0; i <= n[0]; ++i, ++node)
        if (i > 0 && j > 0 && k > 0 && i < n[0] && j < n[1] && k < n[2])
          for (std::size_t c = 0; c < 3; ++c)
            mesh.coordinates[node][c] +=
                distortion * (box.upper[c] - box.lower[c]) / n[c] * std::sin(12.9 * i + 78.2 * j + 37.7 * k + 4.1 * double(c));
  return mesh;
}

}  // namespace Haptos
