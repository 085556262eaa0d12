// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <vector>

#include "Haptos_ContactPair.hpp"
#include "Haptos_Subdomain.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief One nonzero of a row of B: local degree of freedom `dof` of `subdomain`, and its stiffness weight.
struct RowEntry {
  int subdomain;
  int dof;
  double value;
  double weight;  ///< stiffness of the node in this subdomain, sum of E h over its elements [force/length]
};

enum class RowKind : std::uint8_t { Gluing, Dirichlet, Tied, Normal, Tangential };

/// \brief Rows of B u = c: the multiplier has no bound.
inline bool isEquality(RowKind kind) { return kind != RowKind::Normal && kind != RowKind::Tangential; }

/// \brief u_component(node) = value, in the user's length.
struct PrescribedDisplacement {
  std::int64_t node;
  int component;
  double value;
};

/// \brief The rows of one contact pair; global row indices.
struct PairRows {
  int interface;             ///< position in the list of interfaces
  int pair;                  ///< position in the interface's pairs
  GlobalOrdinal normal;
  GlobalOrdinal tangential[2];  ///< -1, -1 without friction
  ContactPair geometry;         ///< nodes, axes, gap, area
};

/// \brief All rows of B u <= / = c of Total FETI, in the paper's order: gluing, Dirichlet, (tied,) N, T1, T2.
///
/// Gluing rows are non-redundant and orthonormal: a node with mu copies in its body has mu - 1 rows per
/// component, (1, .., 1, -j, 0, ..) / sqrt(j (j+1)), the owner's copies first.  Dirichlet rows have the entries 1/sqrt(mu), once per
/// node and component, so c = sqrt(mu) value.  Contact rows act on the mean of the copies, so that B u is
/// the jump [length] and the multiplier the nodal force [force]; prescribed components are eliminated from
/// them, which keeps B of full row rank.  A row that is left empty by this is `pinned`.  A tied pair has three
/// equality rows of the same kind, one per global axis, with c = 0; one that is left empty is not there at all.
/// Everything here is serial and lives on the reader; indices are global.
struct ConstraintRows {
  std::vector<std::size_t> offsets{0};  ///< [numRows + 1] into entries
  std::vector<RowEntry> entries;
  std::vector<RowKind> kinds;           ///< [numRows]
  std::vector<double> c;                ///< [numRows] right-hand side; gap on normal rows [length]
  std::vector<char> pinned;             ///< [numRows]
  std::vector<int> owner;               ///< [numRows] subdomain whose rank owns the row
  std::vector<std::int64_t> node;       ///< [numRows] mesh node (the secondary one on contact rows)
  std::vector<PairRows> pairs;
  GlobalOrdinal numEquality = 0;        ///< m: gluing, Dirichlet and tied rows

  GlobalOrdinal numRows() const { return GlobalOrdinal(kinds.size()); }
};

/// \param subdomains all of them, in order
/// \param prescribed sorted by node and component, without repetition
/// \param frictional [interfaces] whether the interface has tangential rows
/// \param youngsModulus [materials]
/// \throws InsufficientModel where displacements prescribed on both sides part a tied pair
ConstraintRows buildConstraintRows(const Mesh& mesh, const std::vector<Subdomain>& subdomains,
                                   const std::vector<PrescribedDisplacement>& prescribed,
                                   const std::vector<ContactInterface>& interfaces, const std::vector<char>& frictional,
                                   const std::vector<double>& youngsModulus);

}  // namespace Haptos
