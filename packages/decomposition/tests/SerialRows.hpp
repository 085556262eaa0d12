// SPDX-License-Identifier: BSD-3-Clause
// All rows of B from the whole mesh on one rank: the plain reference for what ranks make together.
#pragma once
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "Haptos_ConstraintRows.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Format.hpp"
#include "Haptos_StiffnessAssembler.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos::Testing {

/// One nonzero of a row of B: local degree of freedom `dof` of `subdomain`, and its stiffness weight.
struct RowEntry {
  int subdomain;
  int dof;
  double value;
  double weight;
};

/// The rows of one contact pair; global row indices.
struct PairRows {
  int interface;
  int pair;
  GlobalOrdinal normal;
  GlobalOrdinal tangential[2];  ///< -1, -1 without friction
  ContactPair geometry;
};

struct ConstraintRows {
  std::vector<std::size_t> offsets{0};  ///< [numRows + 1] into entries
  std::vector<RowEntry> entries;
  std::vector<RowKind> kinds;           ///< [numRows]
  std::vector<double> c;                ///< [numRows] right-hand side; gap on normal rows [length]
  std::vector<char> pinned;             ///< [numRows]
  std::vector<int> owner;               ///< [numRows] subdomain whose rank owns the row
  std::vector<std::int64_t> node;       ///< [numRows] mesh node (the secondary one on rows of pairs)
  std::vector<PairRows> pairs;
  GlobalOrdinal numEquality = 0;        ///< m: gluing, Dirichlet and tied rows

  GlobalOrdinal numRows() const { return GlobalOrdinal(kinds.size()); }
};


struct Copy {
  int subdomain, localNode;
  double weight;
};

// Copies of every node in CSR form, ascending in the subdomain.
struct NodeCopies {
  std::vector<std::size_t> offsets;
  std::vector<Copy> copies;
  int count(std::int64_t node) const { return int(offsets[node + 1] - offsets[node]); }
  const Copy* begin(std::int64_t node) const { return copies.data() + offsets[node]; }
};

inline NodeCopies findCopies(const Mesh& mesh, const std::vector<Subdomain>& subdomains, const std::vector<double>& youngsModulus) {
  NodeCopies result;
  result.offsets.assign(mesh.numNodes() + 1, 0);
  for (const auto& sub : subdomains)
    for (auto node : sub.nodes) ++result.offsets[node + 1];
  std::partial_sum(result.offsets.begin(), result.offsets.end(), result.offsets.begin());
  result.copies.resize(result.offsets.back());
  std::vector<std::size_t> next(result.offsets.begin(), result.offsets.end() - 1);
  for (const auto& sub : subdomains) {
    const auto weights = nodalStiffness(sub.coordinates, sub.groups, youngsModulus);
    for (int i = 0; i < sub.numNodes(); ++i) result.copies[next[sub.nodes[i]]++] = {sub.id, i, weights[i]};
  }
  return result;
}

// Rows at a node are the lowest subdomain's, or the highest's where the lowest has an odd number; nodes that are paired one by
// one count as one.
class Ownership {
 public:
  Ownership(const NodeCopies& copies, const std::vector<ContactInterface>& interfaces) : parent_(copies.offsets.size() - 1) {
    std::iota(parent_.begin(), parent_.end(), std::int64_t(0));
    for (const auto& interface : interfaces)
      for (const auto& pair : interface.pairs) {
        if (pair.secondary.size() == 1 && pair.primary.size() == 1)
          parent_[root(pair.secondary[0].node)] = root(pair.primary[0].node);
      }
    lowest_.assign(parent_.size(), -1);
    highest_.assign(parent_.size(), -1);
    for (std::size_t node = 0; node < parent_.size(); ++node) {
      if (copies.count(std::int64_t(node)) == 0) continue;
      const std::int64_t group = root(std::int64_t(node));
      const int mine = copies.begin(std::int64_t(node))->subdomain;
      lowest_[group] = lowest_[group] < 0 ? mine : std::min(lowest_[group], mine);
      highest_[group] = std::max(highest_[group], (copies.begin(std::int64_t(node + 1)) - 1)->subdomain);
    }
  }
  int owner(std::int64_t node) { return (isHighest(node) ? highest_ : lowest_)[root(node)]; }
  bool isHighest(std::int64_t node) { return lowest_[root(node)] % 2 == 1; }

 private:
  std::int64_t root(std::int64_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  std::vector<std::int64_t> parent_;
  std::vector<int> lowest_, highest_;  // by root; -1: none
};

class RowBuilder {
 public:
  RowBuilder(const NodeCopies& copies, Ownership& ownership, const std::vector<PrescribedDisplacement>& prescribed)
      : copies_(copies), ownership_(ownership), prescribed_(prescribed) {}

  void addEntry(const Copy& copy, int component, double value) {
    rows.entries.push_back({copy.subdomain, 3 * copy.localNode + component, value, copy.weight});
  }

  GlobalOrdinal closeRow(RowKind kind, double c, std::int64_t node) {
    rows.pinned.push_back(rows.entries.size() == rows.offsets.back());
    rows.offsets.push_back(rows.entries.size());
    rows.kinds.push_back(kind);
    rows.c.push_back(c);
    rows.owner.push_back(ownership_.owner(node));
    rows.node.push_back(node);
    return rows.numRows() - 1;
  }

  // Starts with the owner's copies: rows among them are nobody else's.
  void addGluing(std::int64_t node) {
    const int mu = copies_.count(node);
    const bool descending = ownership_.isHighest(node);
    const auto copy = [&](int i) { return copies_.begin(node)[descending ? mu - 1 - i : i]; };
    for (int j = 1; j < mu; ++j)
      for (int component = 0; component < 3; ++component) {
        const double norm = std::sqrt(double(j) * (j + 1));
        for (int i = 0; i < j; ++i) addEntry(copy(i), component, 1.0 / norm);
        addEntry(copy(j), component, -j / norm);
        closeRow(RowKind::Gluing, 0.0, node);
      }
  }

  void addDirichlet(const PrescribedDisplacement& p) {
    const int mu = copies_.count(p.node);
    for (int i = 0; i < mu; ++i) addEntry(copies_.begin(p.node)[i], p.component, 1.0 / std::sqrt(double(mu)));
    closeRow(RowKind::Dirichlet, std::sqrt(double(mu)) * p.value, p.node);
  }

  GlobalOrdinal addContact(RowKind kind, const ContactPair& pair, const std::array<double, 3>& direction, double c) {
    addJump(pair, direction, c);
    return closeRow(kind, c, pair.secondaryNode);
  }

  // The mean displacements of both sides are the same along one axis.
  void addTied(const ContactInterface& interface, const ContactPair& pair, int component) {
    constexpr double kRoundOff = 1e-12;
    std::array<double, 3> axis{0, 0, 0};
    axis[component] = pair.isPinned[component] ? 0 : 1;
    double c = 0;
    addJump(pair, axis, c);
    if (rows.entries.size() > rows.offsets.back()) {
      closeRow(RowKind::Tied, c, pair.secondaryNode);
      return;
    }
    const auto* p = findPrescribed(pair.secondaryNode, component);
    if (std::abs(c) > kRoundOff * (p ? std::abs(p->value) : 0.0))
      throw InsufficientModel("The model has no solution: the displacements prescribed on both sides of contact '" + interface.name +
                              "' part a tied pair by " + formatted("%g", std::abs(c)) + " along " + "xyz"[component] + ".");
  }

  ConstraintRows rows;

 private:
  const PrescribedDisplacement* findPrescribed(std::int64_t node, int component) const {
    const auto it = std::lower_bound(prescribed_.begin(), prescribed_.end(), std::make_pair(node, component),
                                     [](const PrescribedDisplacement& p, const std::pair<std::int64_t, int>& key) {
                                       return std::make_pair(p.node, p.component) < key;
                                     });
    return it != prescribed_.end() && it->node == node && it->component == component ? &*it : nullptr;
  }

  void addJump(const ContactPair& pair, const std::array<double, 3>& direction, double& c) {
    for (const auto& [node, weight] : pair.secondary) addMean(node, direction, +weight, c);
    for (const auto& [node, weight] : pair.primary) addMean(node, direction, -weight, c);
  }

  // factor * direction . (mean of the copies of node); prescribed components move to the right-hand side.
  void addMean(std::int64_t node, const std::array<double, 3>& direction, double factor, double& c) {
    constexpr double kRoundOff = 1e-12;  // of a unit vector: such entries would only hide an empty row
    const int mu = copies_.count(node);
    for (int component = 0; component < 3; ++component) {
      const double value = factor * direction[component];
      if (const auto* p = findPrescribed(node, component)) {
        c -= value * p->value;
        continue;
      }
      if (std::abs(direction[component]) < kRoundOff) continue;
      for (int i = 0; i < mu; ++i) addEntry(copies_.begin(node)[i], component, value / mu);
    }
  }

  const NodeCopies& copies_;
  Ownership& ownership_;
  const std::vector<PrescribedDisplacement>& prescribed_;
};

inline void addTiedRows(RowBuilder& builder, const std::vector<ContactInterface>& interfaces) {
  for (const auto& interface : interfaces) {
    if (!interface.tied) continue;
    for (const auto& pair : interface.pairs)
      for (int component = 0; component < 3; ++component) builder.addTied(interface, pair, component);
  }
}

inline void addContactRows(RowBuilder& builder, const std::vector<ContactInterface>& interfaces, const std::vector<char>& frictional) {
  const std::array<double, 3> none{0, 0, 0};
  auto& pairs = builder.rows.pairs;
  for (std::size_t k = 0; k < interfaces.size(); ++k)
    for (std::size_t i = 0; i < interfaces[k].pairs.size() && !interfaces[k].tied; ++i) {
      const ContactPair& pair = interfaces[k].pairs[i];
      pairs.push_back({int(k), int(i), builder.addContact(RowKind::Normal, pair, pair.frame.normal, pair.gap), {-1, -1}, pair});
    }
  for (int t = 0; t < 2; ++t)
    for (auto& rows : pairs) {
      if (!frictional[rows.interface]) continue;
      const ContactPair& pair = interfaces[rows.interface].pairs[rows.pair];
      rows.tangential[t] =
          builder.addContact(RowKind::Tangential, pair, pair.isPinned[t + 1] ? none : t == 0 ? pair.frame.t1 : pair.frame.t2, 0.0);
    }
}

/// \param subdomains all of them, in order
/// \param prescribed sorted by node and component, without repetition
inline ConstraintRows buildConstraintRows(const Mesh& mesh, const std::vector<Subdomain>& subdomains,
                                   const std::vector<PrescribedDisplacement>& prescribed,
                                   const std::vector<ContactInterface>& interfaces, const std::vector<char>& frictional,
                                   const std::vector<double>& youngsModulus) {
  const NodeCopies copies = findCopies(mesh, subdomains, youngsModulus);
  Ownership ownership(copies, interfaces);
  RowBuilder builder(copies, ownership, prescribed);
  for (std::size_t node = 0; node < mesh.numNodes(); ++node) builder.addGluing(std::int64_t(node));
  for (const auto& p : prescribed) builder.addDirichlet(p);
  addTiedRows(builder, interfaces);
  builder.rows.numEquality = builder.rows.numRows();
  addContactRows(builder, interfaces, frictional);
  return std::move(builder.rows);
}

}  // namespace Haptos::Testing
