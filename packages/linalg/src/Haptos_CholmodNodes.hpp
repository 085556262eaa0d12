// SPDX-License-Identifier: BSD-3-Clause
// Order and analysis of matrices whose unknowns come in threes, by the graph of their nodes: nine times fewer entries to look at.
// For CholmodSolver only.
#pragma once
#include <cholmod.h>

#include <algorithm>
#include <climits>
#include <cstddef>
#include <vector>

namespace Haptos {

/// The lower triangle of the graph of nodes; empty where the pattern does not consist of blocks of three by three.
class NodeGraph {
 public:
  /// \param starts, indices a symmetric pattern by rows
  NodeGraph(const std::vector<int>& starts, const int* indices) {
    const int n = int(starts.size()) - 1, nodes = n / 3;
    if (n % 3 != 0 || n < 60) return;
    std::vector<int> seenBy(std::size_t(nodes), -1);
    for (int node = 0; node < nodes; ++node) {
      for (int k = starts[3 * node]; k < starts[3 * node + 3]; ++k) {
        const int other = indices[k] / 3;
        if (seenBy[other] == node) continue;
        seenBy[other] = node;
        if (other >= node) neighbours_.push_back(other);
      }
      starts_.push_back(int(neighbours_.size()));
    }
    if (2 * neighbours_.size() > std::size_t(starts.back()) / 6) starts_ = {0};
  }

  bool isEmpty() const { return starts_.size() == 1; }

  cholmod_sparse view() const {
    cholmod_sparse graph{};
    graph.nrow = graph.ncol = starts_.size() - 1;
    graph.nzmax = neighbours_.size();
    graph.p = const_cast<int*>(starts_.data());
    graph.i = const_cast<int*>(neighbours_.data());
    graph.stype = -1;
    graph.itype = CHOLMOD_INT;
    graph.xtype = CHOLMOD_PATTERN;
    graph.packed = 1;
    return graph;
  }

  /// AMD for the graphs of subdomains, where it is as good as any; larger ones are analysed, and METIS tried where it fills in much.
  std::vector<int> order(cholmod_common& common) const {
    constexpr std::size_t kSmall = 1500;
    cholmod_sparse graph = view();
    std::vector<int> order(graph.nrow);
    if (graph.nrow <= kSmall) return cholmod_amd(&graph, nullptr, 0, order.data(), &common) ? order : std::vector<int>{};
    cholmod_factor* analysis = cholmod_analyze(&graph, &common);
    if (analysis == nullptr) return {};
    std::copy_n(static_cast<const int*>(analysis->Perm), graph.nrow, order.begin());
    cholmod_free_factor(&analysis, &common);
    return order;
  }

  /// Supernodes of the unknowns from those of the nodes, symbolic only; null where they would be too narrow to pay, or without memory.
  cholmod_factor* analyse(std::vector<int>& order, cholmod_common& common) const {
    cholmod_sparse graph = view();
    const int supernodal = common.supernodal;
    const std::size_t relaxed = common.nrelax[0];
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.nrelax[0] = relaxed / 3;
    cholmod_factor* nodes = cholmod_analyze_p(&graph, order.data(), nullptr, 0, &common);
    common.supernodal = supernodal;
    common.nrelax[0] = relaxed;
    if (nodes == nullptr) return nullptr;
    cholmod_factor* unknowns = pays(*nodes, common) ? expand(*nodes, common) : nullptr;
    cholmod_free_factor(&nodes, &common);
    return unknowns;
  }

 private:
  // As CHOLMOD chooses, from entries and multiplications of the unknowns' factor.
  static bool pays(const cholmod_factor& nodes, cholmod_common& common) {
    common.fl = common.lnz = 0;
    for (std::size_t j = 0; j < nodes.n; ++j)
      for (int c = 0; c < 3; ++c) {
        const double count = 3.0 * static_cast<const int*>(nodes.ColCount)[j] - c;
        common.lnz += count;
        common.fl += count * count;
      }
    return common.fl >= common.supernodal_switch * common.lnz && 9.0 * double(nodes.xsize) < double(INT_MAX);
  }

  static int* scaled(const void* from, std::size_t count, int factor, cholmod_common& common) {
    auto* to = static_cast<int*>(cholmod_malloc(count, sizeof(int), &common));
    if (to != nullptr) std::transform(static_cast<const int*>(from), static_cast<const int*>(from) + count, to, [=](int x) { return factor * x; });
    return to;
  }

  // Every row of nodes three rows of unknowns.
  static void expandRows(const void* from, std::size_t count, void* to) {
    for (std::size_t k = 0; k < 3 * count; ++k) static_cast<int*>(to)[k] = 3 * static_cast<const int*>(from)[k / 3] + int(k % 3);
  }

  // Numbers of rows and columns times three, those of entries times nine.
  static cholmod_factor* expand(const cholmod_factor& nodes, cholmod_common& common) {
    cholmod_factor* L = cholmod_allocate_factor(3 * nodes.n, &common);
    if (L == nullptr) return nullptr;
    expandRows(nodes.Perm, nodes.n, L->Perm);
    for (std::size_t k = 0; k < L->n; ++k)
      static_cast<int*>(L->ColCount)[k] = 3 * static_cast<const int*>(nodes.ColCount)[k / 3] - int(k % 3);
    L->ordering = CHOLMOD_GIVEN;
    L->is_ll = L->is_super = 1;
    L->nsuper = nodes.nsuper;
    L->ssize = 3 * nodes.ssize;
    L->xsize = 9 * nodes.xsize;
    L->maxcsize = 9 * nodes.maxcsize;
    L->maxesize = 3 * nodes.maxesize;
    L->super = scaled(nodes.super, nodes.nsuper + 1, 3, common);
    L->pi = scaled(nodes.pi, nodes.nsuper + 1, 3, common);
    L->px = scaled(nodes.px, nodes.nsuper + 1, 9, common);
    L->s = cholmod_malloc(L->ssize, sizeof(int), &common);
    if (common.status < CHOLMOD_OK) {
      cholmod_free_factor(&L, &common);
      return nullptr;
    }
    expandRows(nodes.s, nodes.ssize, L->s);
    return L;
  }

  std::vector<int> starts_{0}, neighbours_;
};

}  // namespace Haptos
