// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_MultiplierMap.hpp"

namespace Haptos {

/// \brief E = sum k_i Q_i, Q_i the projectors onto forces of pairs' rows that do nothing to displacements, B^T Q_i = 0, k_i [force/length].
///
/// A node in several contacts has more rows than displacements: the normal force of one and the friction of another may be the same force, and
/// the law alone decides how much of it is whose.  M = B_D S B_D^T makes no such forces, M + E does, and F E = 0.
/// Q_i come group by group of rows that depend on each other, whatever the ranks; k_i is the mean of M's diagonal over its rows times a large number.
/// Decision: 057-nodes-in-several-contacts.
struct DependentRows {
  RCP<const CrsMatrix> all;          ///< E on `MultiplierMap::map`; null where no rows depend on others
  RCP<const CrsMatrix> contactRows;  ///< its rows on `MultiplierMap::contactMap`
  RCP<const CrsMatrix> contact;      ///< between those
};

/// \param diagonal of M, [owned rows].  Collective.
DependentRows findDependentRows(const MultiplierMap& multipliers, const Vector& diagonal);

}  // namespace Haptos
