// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "Haptos_ContactPair.hpp"
#include "Haptos_Subdomain.hpp"

namespace Haptos {

enum class RowKind : std::uint8_t { Gluing, Dirichlet, Tied, Normal, Tangential };

/// \brief Rows of B u = c: the multiplier has no bound.
inline bool isEquality(RowKind kind) { return kind != RowKind::Normal && kind != RowKind::Tangential; }

/// \brief u_component(node) = value, in the user's length.
struct PrescribedDisplacement {
  std::int64_t node;
  int component;
  double value;
};

/// \brief What rows of B must know of a subdomain.
struct SubdomainNodes {
  int id;                                  ///< global, 0-based; a rank has a contiguous range
  const std::vector<std::int64_t>& nodes;  ///< mesh index, in the order of the unknowns
  std::vector<double> stiffness;           ///< [nodes] > 0: what the subdomain holds the node with, in any unit common to all
};

/// \brief A pair, and where it stands among all.
struct PlacedPair {
  int interface;  ///< position in the list of interfaces
  int position;   ///< in the interface, from 0 without gaps over all ranks
  ContactPair pair;

  auto parts() { return std::tie(interface, position, pair); }  ///< see ByteWriter
};

struct InterfaceRows {
  std::string name;         ///< for messages
  bool tied = false;        ///< three equality rows a pair
  bool frictional = false;  ///< tangential rows beside the normal one
  std::array<double, 2> coefficients{0, 0};  ///< F1, F2 [-] of pairs that have none of their own
};

/// \brief What one rank brings to the rows of B.  Every item comes from one rank, whichever.
struct RowSources {
  std::vector<SubdomainNodes> subdomains;  ///< those that this rank solves with
  std::vector<PrescribedDisplacement> prescribed;
  std::vector<PlacedPair> pairs;
  std::vector<InterfaceRows> interfaces;  ///< the same on all ranks
};

/// \brief The pairs of all interfaces, each in its place.
std::vector<PlacedPair> placedPairs(const std::vector<ContactInterface>& interfaces);

}  // namespace Haptos
