// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Bodies.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

using Index = std::int64_t;
using Couple = std::pair<int, int>;

struct NodePiece {
  Index node;
  int piece;
};

template <class Visit>
void forEachElement(const Mesh& mesh, Visit&& visit) {  // block, element, its nodes
  std::size_t element = 0;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const auto& block = mesh.blocks[b];
    const int n = nodesPerElement(block.topology);
    for (std::size_t e = 0; e < block.numElements(); ++e, ++element)
      visit(int(b), element, block.connectivity.data() + e * std::size_t(n), n);
  }
}

std::vector<Couple> gatheredCouples(const Communicator& comm, const std::set<Couple>& mine) {
  struct Plain {
    int a, b;
  };
  std::vector<Plain> list;
  for (const auto& [a, b] : mine) list.push_back({a, b});
  std::set<Couple> all;
  for (const Plain& couple : gatheredOnAll(comm, list)) all.emplace(couple.a, couple.b);
  return {all.begin(), all.end()};
}

// Pieces that meet at a node, each couple at least along a chain.
std::vector<Couple> piecesAtNodes(const Communicator& comm, const OwnElements& own, const std::vector<int>& pieceOf) {
  std::vector<int> pieceAt(own.part.nodes.size(), -1);
  std::set<Couple> couples;
  forEachElement(own.part.mesh, [&](int, std::size_t element, const Index* nodes, int n) {
    for (int i = 0; i < n; ++i) {
      int& piece = pieceAt[std::size_t(nodes[i])];
      if (piece < 0) piece = pieceOf[element];
      else if (piece != pieceOf[element]) couples.emplace(piece, pieceOf[element]);
    }
  });
  std::vector<NodePiece> shared;
  for (std::size_t i = 0; i < pieceAt.size(); ++i)
    if (own.isShared[i]) shared.push_back({own.part.nodes[i], pieceAt[i]});
  auto met = sendItems(comm, shared, [&](const NodePiece& p) { return own.nodes.owner(p.node); });
  std::sort(met.begin(), met.end(), [](const NodePiece& a, const NodePiece& b) { return a.node < b.node; });
  for (std::size_t i = 1; i < met.size(); ++i)
    if (met[i].node == met[i - 1].node && met[i].piece != met[i - 1].piece) couples.emplace(met[i - 1].piece, met[i].piece);
  return gatheredCouples(comm, couples);
}

// By the blocks that a body is made of; where a block is in several bodies, these are counted.
std::vector<std::string> nameBodies(const Mesh& names, const std::vector<std::set<int>>& blocksOfBody) {
  std::vector<int> bodiesOfBlock(names.blocks.size(), 0), seen(names.blocks.size(), 0);
  for (const auto& blocks : blocksOfBody)
    for (int b : blocks) ++bodiesOfBlock[std::size_t(b)];
  std::vector<std::string> result;
  for (const auto& blocks : blocksOfBody) {
    std::string name;
    for (int b : blocks) {
      const auto& block = names.blocks[std::size_t(b)];
      name += (name.empty() ? "" : "+") + (block.name.empty() ? std::to_string(block.id) : block.name);
      if (bodiesOfBlock[std::size_t(b)] > 1) name += "#" + std::to_string(++seen[std::size_t(b)]);  // several pieces in one block
    }
    result.push_back(name);
  }
  return result;
}

}  // namespace

// Pieces hang together by sides, bodies by nodes, too: pieces that meet at a node of any rank are joined, and a body is what is left.
Bodies findBodies(const Communicator& comm, const OwnElements& own, const DualGraph& graph) {
  Bodies bodies;
  bodies.pieces = connectedComponents(comm, own, graph, {});
  DisjointSets sets(bodies.pieces.first.size());
  for (const auto& [a, b] : piecesAtNodes(comm, own, bodies.pieces.ofElement)) sets.join(a, b);
  int count = 0;
  bodies.ofPiece = sets.numbered(count);
  std::set<Couple> mine;  // body, block
  forEachElement(own.part.mesh, [&](int block, std::size_t element, const Index*, int) {
    mine.emplace(bodies.ofPiece[std::size_t(bodies.pieces.ofElement[element])], block);
  });
  std::vector<std::set<int>> blocksOfBody(static_cast<std::size_t>(count));
  for (const auto& [body, block] : gatheredCouples(comm, mine)) blocksOfBody[std::size_t(body)].insert(block);
  bodies.names = nameBodies(own.part.mesh, blocksOfBody);
  return bodies;
}

}  // namespace Haptos
