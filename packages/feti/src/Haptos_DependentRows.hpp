// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_MultiplierMap.hpp"

namespace Haptos {

struct DependentGroup;

/// \brief E = sum k_i Q_i, Q_i the projectors onto forces of pairs' rows that do nothing to displacements, B^T Q_i = 0, k_i [force/length].
///
/// Where rows depend on each other (`DependentGroup`) the law alone decides how much of a force is whose.  M = B_D S B_D^T makes no such forces,
/// M + E does, and F E = 0.  k_i is the mean of M's diagonal over rows of Q_i times a large number.
/// Decision: 057-nodes-in-several-contacts.
struct DependentRows {
  RCP<const CrsMatrix> all;          ///< E on `MultiplierMap::map`; null where no rows depend on others
  RCP<const CrsMatrix> contactRows;  ///< its rows on `MultiplierMap::contactMap`
  RCP<const CrsMatrix> contact;      ///< between those
};

/// \param groups as `findDependentGroups` found them  \param diagonal of M, [owned rows].  Collective.
DependentRows makeDependentRows(const MultiplierMap& multipliers, const std::vector<DependentGroup>& groups, const Vector& diagonal);

}  // namespace Haptos
